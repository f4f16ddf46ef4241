// CGAL behind the protocol of protocol.hpp.
#include "protocol.hpp"

// Jets are fitted by Eigen.
#define CGAL_EIGEN3_ENABLED
#include "holes.hpp"
#include "mending.hpp"
#include "spatial.hpp"

#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh/IO.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/Weights/utils.h>
#include <CGAL/boost/graph/IO/polygon_mesh_io.h>
#include <CGAL/subdivision_method_3.h>
#include <boost/graph/dijkstra_shortest_paths.hpp>

#include <Eigen/Sparse>

#include <limits>
#include <memory>
#include <set>

namespace pmp = CGAL::Polygon_mesh_processing;
typedef CGAL::Simple_cartesian<double> Kernel;
typedef Kernel::Point_3 Point;
typedef Kernel::Vector_3 Vector;
typedef CGAL::Surface_mesh<Point> Mesh;
typedef std::vector<std::vector<std::size_t>> Faces;

bool fill(Mesh& mesh, const Raw& raw) {
    mesh.reserve(raw.points.size(), raw.points.size() + raw.faces(), raw.faces());
    for (const auto& p : raw.points) mesh.add_vertex(Point(p[0], p[1], p[2]));
    std::vector<Mesh::Vertex_index> face;
    bool accepted = true;
    for (std::size_t f = 0; f < raw.faces(); ++f) {
        face.clear();
        for (uint32_t c = raw.starts[f]; c < raw.starts[f + 1]; ++c)
            face.push_back(Mesh::Vertex_index(raw.corners[c]));
        accepted &= face.size() >= 3 && mesh.add_face(face) != Mesh::null_face();
    }
    return accepted;
}

std::unique_ptr<Mesh> built(const Raw& raw) {
    auto mesh = std::make_unique<Mesh>();
    if (!fill(*mesh, raw)) throw std::runtime_error("CGAL refuses a face");
    return mesh;
}

Faces soup(const Raw& raw) {
    Faces faces(raw.faces());
    for (std::size_t f = 0; f < raw.faces(); ++f)
        faces[f].assign(raw.corners.begin() + raw.starts[f], raw.corners.begin() + raw.starts[f + 1]);
    return faces;
}

std::vector<Point> points(const Raw& raw) {
    std::vector<Point> points;
    for (const auto& p : raw.points) points.emplace_back(p[0], p[1], p[2]);
    return points;
}

void counts(Report& report, const Mesh& mesh) {
    report.number("vertices", double(num_vertices(mesh)));
    report.number("edges", double(num_edges(mesh)));
    report.number("faces", double(num_faces(mesh)));
    std::vector<Mesh::Halfedge_index> cycles;
    pmp::extract_boundary_cycles(mesh, std::back_inserter(cycles));
    std::vector<double> loops;
    for (const auto h : cycles) loops.push_back(double(halfedges_around_face(h, mesh).size()));
    std::sort(loops.begin(), loops.end());
    report.list("boundary_loops", loops);
    std::vector<std::size_t> component(num_faces(mesh));
    const auto map = boost::make_iterator_property_map(component.begin(), get(boost::face_index, mesh));
    report.number("components", double(pmp::connected_components(mesh, map)));
}

void facts(Report& report, const Raw& raw, const std::string& prefix) {
    Mesh mesh;
    const bool accepted = pmp::is_polygon_soup_a_polygon_mesh(soup(raw)) && fill(mesh, raw);
    report.truth("accepted", accepted);
    if (!accepted) return;
    counts(report, mesh);

    RingHash rings;
    std::vector<uint32_t> ring;
    for (const auto v : mesh.vertices()) {
        ring.clear();
        if (!mesh.is_isolated(v))
            for (const auto w : vertices_around_target(halfedge(v, mesh), mesh)) ring.push_back(uint32_t(w));
        // CGAL goes clockwise.
        std::reverse(ring.begin(), ring.end());
        rings.add(uint32_t(v), ring);
    }
    report.text("rings", rings.hex());

    const bool triangles = raw.triangles();
    std::vector<double> normals, areas, angles, cotangents;
    for (const auto f : mesh.faces()) {
        const Vector n = pmp::compute_face_normal(f, mesh);
        normals.insert(normals.end(), {n.x(), n.y(), n.z()});
        if (triangles) areas.push_back(pmp::face_area(f, mesh));
        const uint32_t start = raw.starts[uint32_t(f)], degree = raw.starts[uint32_t(f) + 1] - start;
        for (uint32_t k = 0; k < degree; ++k) {
            const auto at = [&](uint32_t i) -> const Point& {
                return mesh.point(Mesh::Vertex_index(raw.corners[start + i % degree]));
            };
            angles.push_back(CGAL::approximate_angle(at(k + degree - 1), at(k), at(k + 1)) * CGAL_PI / 180.0);
            if (!triangles) continue;
            cotangents.push_back(CGAL::Weights::cotangent(at(k + degree - 1), at(k), at(k + 1)));
        }
    }
    column(prefix, "face_normals", normals);
    if (triangles) {
        column(prefix, "face_areas", areas);
        column(prefix, "corner_angles", angles);
        column(prefix, "corner_cotangents", cotangents);
        report.number("area", pmp::area(mesh));
        if (CGAL::is_closed(mesh)) report.number("volume", pmp::volume(mesh));
        // CGAL's own vertex normal is another one; these sums are written on its kernel.
        std::vector<double> by_angle, by_max;
        for (const auto v : mesh.vertices()) {
            Vector a(0, 0, 0), m(0, 0, 0);
            if (mesh.is_isolated(v)) {
                by_angle.insert(by_angle.end(), 3, 0.0);
                by_max.insert(by_max.end(), 3, 0.0);
                continue;
            }
            for (const auto h : halfedges_around_target(halfedge(v, mesh), mesh)) {
                if (is_border(h, mesh)) continue;
                const Point& p = mesh.point(v);
                const Vector in(p, mesh.point(source(h, mesh))), out(p, mesh.point(target(next(h, mesh), mesh)));
                const Vector n = CGAL::cross_product(out, in);
                const double length = std::sqrt(n.squared_length());
                if (length == 0) continue;
                // Not CGAL's approximate_angle, whose arc cosine loses half the digits near 0 and π.
                a = a + n * (std::atan2(length, CGAL::scalar_product(out, in)) / length);
                m = m + n / (in.squared_length() * out.squared_length());
            }
            const auto unit = [](const Vector& n) {
                const double length = std::sqrt(n.squared_length());
                return length > 0 ? n / length : n;
            };
            a = unit(a), m = unit(m);
            by_angle.insert(by_angle.end(), {a.x(), a.y(), a.z()});
            by_max.insert(by_max.end(), {m.x(), m.y(), m.z()});
        }
        column(prefix, "vertex_normals_angle", by_angle);
        column(prefix, "vertex_normals_max", by_max);
    }
}

void dijkstra(Report& report, const Raw& raw, const Call& call) {
    const auto mesh = built(raw);
    std::vector<double> distance(num_vertices(*mesh));
    std::vector<double> length(num_edges(*mesh));
    report.time(call.repeat, [&] {
        for (const auto e : mesh->edges()) length[e] = pmp::edge_length(mesh->halfedge(e), *mesh);
        const auto weight = boost::make_iterator_property_map(length.begin(), get(boost::edge_index, *mesh));
        const auto map = boost::make_iterator_property_map(distance.begin(), get(boost::vertex_index, *mesh));
        boost::dijkstra_shortest_paths(*mesh, Mesh::Vertex_index(0),
            boost::distance_map(map).weight_map(weight).vertex_index_map(get(boost::vertex_index, *mesh)));
        return 0;
    });
    // Vertices that cannot be reached are told as -1.
    for (double& d : distance)
        if (d == (std::numeric_limits<double>::max)()) d = -1;
    column(call.out, "distances", distance);
}

void repair(Report& report, const Raw& raw, const Call& call) {
    const auto all_points = points(raw);
    const auto all_faces = soup(raw);
    report.time(call.repeat, [&] {
        auto corners = all_points;
        auto faces = all_faces;
        pmp::orient_polygon_soup(corners, faces);
        auto mesh = std::make_unique<Mesh>();
        if (pmp::is_polygon_soup_a_polygon_mesh(faces)) pmp::polygon_soup_to_polygon_mesh(corners, faces, *mesh);
        return mesh;
    });
    auto corners = all_points;
    auto faces = all_faces;
    report.truth("oriented", pmp::orient_polygon_soup(corners, faces));
    report.number("points", double(corners.size()));
    const bool mesh_now = pmp::is_polygon_soup_a_polygon_mesh(faces);
    report.truth("accepted", mesh_now);
    Raw out;
    for (const auto& p : corners) out.points.push_back({p.x(), p.y(), p.z()});
    out.starts.push_back(0);
    for (const auto& face : faces) {
        for (const auto v : face) out.corners.push_back(uint32_t(v));
        out.starts.push_back(uint32_t(out.corners.size()));
    }
    if (!call.out.empty()) write_raw(call.out + ".raw", out);
    if (!mesh_now) return;
    Mesh mesh;
    pmp::polygon_soup_to_polygon_mesh(corners, faces, mesh);
    counts(report, mesh);
}

template <class AnyMesh>
void write_mesh_raw(const AnyMesh& mesh, const std::string& path) {
    Raw out;
    std::vector<uint32_t> number(mesh.num_vertices());
    for (const auto v : mesh.vertices()) {
        number[v] = uint32_t(out.points.size());
        const auto& p = mesh.point(v);
        out.points.push_back({p.x(), p.y(), p.z()});
    }
    out.starts.push_back(0);
    for (const auto f : mesh.faces()) {
        for (const auto v : vertices_around_face(halfedge(f, mesh), mesh)) out.corners.push_back(number[v]);
        out.starts.push_back(uint32_t(out.corners.size()));
    }
    write_raw(path, out);
}

double border_edges(const Mesh& mesh) {
    double count = 0;
    for (const auto e : mesh.edges()) count += is_border(e, mesh);
    return count;
}

// Decimates a copy to `--levels` faces; the last one is written. CGAL counts edges.
void decimate(Report& report, const Raw& raw, const Call& call) {
    namespace simplification = CGAL::Surface_mesh_simplification;
    const auto original = built(raw);
    const auto last = time_on_copies(report, call.repeat, *original, [&](Mesh& mesh) {
        const double edges = 1.5 * call.levels + 0.5 * border_edges(mesh) * call.levels / double(num_faces(mesh));
        const simplification::Count_stop_predicate<Mesh> stop{std::size_t(edges) + 1};
        if (call.scheme == "lindstrom-turk") {
            simplification::edge_collapse(mesh, stop,
                CGAL::parameters::get_cost(simplification::LindstromTurk_cost<Mesh>())
                    .get_placement(simplification::LindstromTurk_placement<Mesh>()));
        } else if (call.scheme == "garland-heckbert") {
            simplification::GarlandHeckbert_policies<Mesh, Kernel> policies(mesh);
            simplification::edge_collapse(mesh, stop,
                CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()));
        } else throw std::runtime_error("CGAL has no policy " + call.scheme);
    });
    last->collect_garbage();
    report.number("vertices", double(last->number_of_vertices()));
    report.number("faces", double(last->number_of_faces()));
    if (!call.out.empty()) write_mesh_raw(*last, call.out + ".raw");
}

// Five iterations on a copy, edges of `--levels` percent of the mean length; `sharp` keeps edges that bend by more than
// 40 degrees. The last one is written.
void remesh(Report& report, const Raw& raw, const Call& call) {
    const auto original = built(raw);
    double length = 0;
    for (const auto e : original->edges()) length += pmp::edge_length(original->halfedge(e), *original);
    // Without `--levels` the length is the mean one.
    length *= (call.levels == 1 ? 1.0 : call.levels / 100.0) / double(original->number_of_edges());
    std::unique_ptr<Mesh> last;
    report.time_from(
        call.repeat,
        [&] {
            last.reset();
            last = std::make_unique<Mesh>(*original);
            return last.get();
        },
        [&](Mesh* mesh) {
            const auto sharp = mesh->add_property_map<Mesh::Edge_index, bool>("e:sharp", false).first;
            if (call.scheme == "sharp") pmp::detect_sharp_edges(*mesh, 40.0, sharp);
            pmp::isotropic_remeshing(mesh->faces(), length, *mesh,
                CGAL::parameters::number_of_iterations(5).edge_is_constrained_map(sharp));
            return 0;
        });
    last->collect_garbage();
    report.number("length", length);
    report.number("vertices", double(last->number_of_vertices()));
    report.number("faces", double(last->number_of_faces()));
    if (!call.out.empty()) write_mesh_raw(*last, call.out + ".raw");
}

// Refines a copy; the last one is written.
void subdivide(Report& report, const Raw& raw, const Call& call) {
    namespace method = CGAL::Subdivision_method_3;
    const auto original = built(raw);
    const auto last = time_on_copies(report, call.repeat, *original, [&](Mesh& mesh) {
        const auto levels = CGAL::parameters::number_of_iterations(unsigned(call.levels));
        if (call.scheme == "loop") method::Loop_subdivision(mesh, levels);
        else if (call.scheme == "catmull-clark") method::CatmullClark_subdivision(mesh, levels);
        else if (call.scheme == "doo-sabin") method::DooSabin_subdivision(mesh, levels);
        else if (call.scheme == "sqrt3") method::Sqrt3_subdivision(mesh, levels);
        else throw std::runtime_error("CGAL has no scheme " + call.scheme);
    });
    report.number("vertices", double(last->number_of_vertices()));
    report.number("faces", double(last->number_of_faces()));
    if (call.out.empty()) return;
    write_mesh_raw(*last, call.out + ".raw");
}

void rings(Report& report, const Raw& raw, int repeat) {
    const auto mesh = built(raw);
    double sum = 0;
    report.time(repeat, [&] {
        std::vector<Vector> sums(mesh->num_vertices());
        for (const auto v : mesh->vertices()) {
            Vector total(0, 0, 0);
            for (const auto w : vertices_around_target(halfedge(v, *mesh), *mesh))
                total = total + (mesh->point(w) - CGAL::ORIGIN);
            sums[v] = total;
        }
        sum = sums[sums.size() / 2].x();
        return sums;
    });
    report.number("value", sum);
}

void normals(Report& report, const Raw& raw, int repeat) {
    const auto mesh = built(raw);
    auto map = mesh->add_property_map<Mesh::Vertex_index, Vector>("v:normal", CGAL::NULL_VECTOR).first;
    report.time(repeat, [&] {
        pmp::compute_vertex_normals(*mesh, map);
        return 0;
    });
    report.number("value", map[Mesh::Vertex_index(uint32_t(mesh->num_vertices() / 2))].x());
}

// Cotangent weights of the corners of each face as Eigen's triplets.
void laplacian(Report& report, const Raw& raw, int repeat) {
    const auto mesh = built(raw);
    double value = 0;
    report.time(repeat, [&] {
        std::vector<Eigen::Triplet<double>> triplets;
        triplets.reserve(12 * mesh->num_faces());
        for (const auto f : mesh->faces())
            for (const auto h : halfedges_around_face(halfedge(f, *mesh), *mesh)) {
                const auto a = source(h, *mesh), b = target(h, *mesh);
                const auto c = target(next(h, *mesh), *mesh);
                const Vector u = mesh->point(a) - mesh->point(c), v = mesh->point(b) - mesh->point(c);
                const double w = 0.5 * (u * v) / std::sqrt(CGAL::cross_product(u, v).squared_length());
                const int i = int(a), j = int(b);
                triplets.emplace_back(i, j, -w);
                triplets.emplace_back(j, i, -w);
                triplets.emplace_back(i, i, w);
                triplets.emplace_back(j, j, w);
            }
        Eigen::SparseMatrix<double> matrix(int(mesh->num_vertices()), int(mesh->num_vertices()));
        matrix.setFromTriplets(triplets.begin(), triplets.end());
        value = matrix.coeff(0, 0);
        return matrix;
    });
    report.number("value", value);
}

// Jets of degree 4 fitted to the vertices of as many rings as have 18 of them: 15 coefficients and some to spare.
// Curvatures are positive where the surface bends toward the given normal.
void curvature(const Raw& raw, const Call& call) {
    typedef CGAL::Monge_via_jet_fitting<Kernel> Fitting;
    const auto mesh = built(raw);
    std::vector<double> most, least;
    for (const auto v : mesh->vertices()) {
        std::vector<Mesh::Vertex_index> around{v};
        std::set<Mesh::Vertex_index> seen{v};
        for (std::size_t done = 0; around.size() < 18 && done < around.size();) {
            const std::size_t ring = around.size();
            for (; done < ring; ++done)
                for (const auto w : vertices_around_target(halfedge(around[done], *mesh), *mesh))
                    if (seen.insert(w).second) around.push_back(w);
        }
        std::vector<Point> points;
        for (const auto w : around) points.push_back(mesh->point(w));
        Fitting fitting;
        auto form = fitting(points.begin(), points.end(), 4, 2);
        form.comply_wrt_given_normal(pmp::compute_vertex_normal(v, *mesh));
        most.push_back(form.principal_curvatures(0));
        least.push_back(form.principal_curvatures(1));
    }
    column(call.out, "curvature_max", most);
    column(call.out, "curvature_min", least);
}

void read(Report& report, const Call& call) {
    double vertices = 0, faces = 0;
    report.time(call.repeat, [&] {
        auto mesh = std::make_unique<Mesh>();
        if (!CGAL::IO::read_polygon_mesh(call.input, *mesh)) throw std::runtime_error("CGAL cannot read it");
        vertices = double(num_vertices(*mesh));
        faces = double(num_faces(*mesh));
        return mesh;
    });
    report.number("vertices", vertices);
    report.number("faces", faces);
}

void write(Report& report, const Raw& raw, const Call& call, bool binary) {
    const auto mesh = built(raw);
    report.time(call.repeat, [&] {
        const auto options = CGAL::parameters::use_binary_mode(binary).stream_precision(17);
        if (!CGAL::IO::write_polygon_mesh(call.out, *mesh, options)) throw std::runtime_error("CGAL cannot write it");
        return 0;
    });
}

int main(int count, char** arguments) {
    try {
        const Call call = Call::parse(count, arguments);
        Report report;
        if (call.operation == "read") read(report, call);
        else {
            const Raw raw = read_raw(call.input);
            if (call.operation == "facts") facts(report, raw, call.out);
            else if (call.operation == "subdivide") subdivide(report, raw, call);
            else if (call.operation == "decimate") decimate(report, raw, call);
            else if (call.operation == "remesh") remesh(report, raw, call);
            else if (call.operation == "repair") repair(report, raw, call);
            else if (call.operation == "dijkstra") dijkstra(report, raw, call);
            else if (call.operation == "curvature") curvature(raw, call);
            else if (call.operation == "build") report.time(call.repeat, [&] { return built(raw); });
            else if (call.operation == "memory") memory(report, [&] { return built(raw); });
            else if (call.operation == "rings") rings(report, raw, call.repeat);
            else if (call.operation == "laplacian") laplacian(report, raw, call.repeat);
            else if (call.operation == "normals") normals(report, raw, call.repeat);
            else if (call.operation == "write-ascii") write(report, raw, call, false);
            else if (call.operation == "write-binary") write(report, raw, call, true);
            else if (spatial::perform(report, raw, call)) {}
            else if (mending::perform(report, raw, call)) {}
            else if (holes::perform(report, raw, call, [&](const auto& mesh) { write_mesh_raw(mesh, call.out + ".raw"); })) {}
            else throw std::runtime_error("CGAL's driver has no operation " + call.operation);
        }
        report.print();
        return 0;
    } catch (const std::exception& error) {
        std::cerr << error.what() << std::endl;
        return 1;
    }
}

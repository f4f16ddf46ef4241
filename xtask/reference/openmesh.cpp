// OpenMesh behind the protocol of protocol.hpp.
#include "protocol.hpp"

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <OpenMesh/Tools/Smoother/JacobiLaplaceSmootherT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/CatmullClarkT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/Sqrt3T.hh>

#include <memory>

struct Doubles : OpenMesh::DefaultTraits {
    typedef OpenMesh::Vec3d Point;
    typedef OpenMesh::Vec3d Normal;
};
typedef OpenMesh::TriMesh_ArrayKernelT<Doubles> Triangles;
typedef OpenMesh::PolyMesh_ArrayKernelT<Doubles> Polygons;

// Adds all faces; false if OpenMesh refused one.
template <class Mesh>
bool fill(Mesh& mesh, const Raw& raw) {
    mesh.reserve(raw.points.size(), raw.points.size() + raw.faces(), raw.faces());
    for (const auto& p : raw.points) mesh.add_vertex(typename Mesh::Point(p[0], p[1], p[2]));
    std::vector<typename Mesh::VertexHandle> face;
    bool accepted = true;
    for (std::size_t f = 0; f < raw.faces(); ++f) {
        face.clear();
        for (uint32_t c = raw.starts[f]; c < raw.starts[f + 1]; ++c)
            face.push_back(typename Mesh::VertexHandle(int(raw.corners[c])));
        accepted &= face.size() >= 3 && mesh.add_face(face).is_valid();
    }
    return accepted;
}

template <class Mesh>
std::unique_ptr<Mesh> built(const Raw& raw) {
    auto mesh = std::make_unique<Mesh>();
    if (!fill(*mesh, raw)) throw std::runtime_error("OpenMesh refuses a face");
    return mesh;
}

template <class Mesh>
void facts(Report& report, const Raw& raw, const std::string& prefix) {
    // Refused faces are told on standard error one by one.
    omerr().disable();
    Mesh mesh;
    const bool accepted = fill(mesh, raw);
    report.truth("accepted", accepted);
    if (!accepted) return;
    report.number("vertices", double(mesh.n_vertices()));
    report.number("edges", double(mesh.n_edges()));
    report.number("faces", double(mesh.n_faces()));

    std::vector<double> loops;
    std::vector<bool> met(mesh.n_halfedges(), false);
    for (const auto h : mesh.halfedges()) {
        if (!mesh.is_boundary(h) || met[h.idx()]) continue;
        double size = 0;
        for (auto walk = typename Mesh::HalfedgeHandle(h); !met[walk.idx()];
             walk = mesh.next_halfedge_handle(walk), ++size)
            met[walk.idx()] = true;
        loops.push_back(size);
    }
    std::sort(loops.begin(), loops.end());
    report.list("boundary_loops", loops);

    // Connected components of faces; vertices of no face are counted apart.
    std::vector<bool> seen(mesh.n_faces(), false);
    double components = 0;
    std::vector<typename Mesh::FaceHandle> stack;
    for (const auto f : mesh.faces()) {
        if (seen[f.idx()]) continue;
        ++components;
        stack.push_back(f);
        seen[f.idx()] = true;
        while (!stack.empty()) {
            const auto top = stack.back();
            stack.pop_back();
            for (auto it = mesh.cff_iter(top); it.is_valid(); ++it)
                if (!seen[it->idx()]) {
                    seen[it->idx()] = true;
                    stack.push_back(*it);
                }
        }
    }
    report.number("components", components);

    RingHash rings;
    std::vector<uint32_t> ring;
    for (const auto v : mesh.vertices()) {
        ring.clear();
        for (auto it = mesh.cvv_ccwiter(v); !mesh.is_isolated(v) && it.is_valid(); ++it) ring.push_back(uint32_t(it->idx()));
        rings.add(uint32_t(v.idx()), ring);
    }
    report.text("rings", rings.hex());

    mesh.request_face_normals();
    mesh.request_vertex_normals();
    std::vector<double> normals, area_weighted, areas, angles;
    double area = 0;
    for (const auto f : mesh.faces()) {
        const auto n = mesh.calc_face_normal(f);
        mesh.set_normal(f, n);
        normals.insert(normals.end(), {n[0], n[1], n[2]});
        // In the order of the corners of the input.
        for (uint32_t c = raw.starts[f.idx()]; c < raw.starts[f.idx() + 1]; ++c)
            for (auto it = mesh.cfh_iter(f); it.is_valid(); ++it)
                if (uint32_t(mesh.to_vertex_handle(*it).idx()) == raw.corners[c]) {
                    angles.push_back(mesh.calc_sector_angle(*it));
                    if (c == raw.starts[f.idx()]) {
                        areas.push_back(mesh.calc_sector_area(*it));
                        area += areas.back();
                    }
                }
    }
    for (const auto v : mesh.vertices()) {
        typename Mesh::Normal n(0, 0, 0);
        if (!mesh.is_isolated(v)) {
            mesh.calc_vertex_normal_correct(v, n);
            if (n.norm() > 0) n.normalize();
        }
        area_weighted.insert(area_weighted.end(), {n[0], n[1], n[2]});
    }
    column(prefix, "face_normals", normals);
    if (raw.triangles()) {
        column(prefix, "vertex_normals_area", area_weighted);
        column(prefix, "face_areas", areas);
        column(prefix, "corner_angles", angles);
        report.number("area", area);
    }
}

template <class Mesh>
void rings(Report& report, const Raw& raw, int repeat) {
    const auto mesh = built<Mesh>(raw);
    double sum = 0;
    report.time(repeat, [&] {
        std::vector<typename Mesh::Point> sums(mesh->n_vertices());
        for (const auto v : mesh->vertices()) {
            typename Mesh::Point total(0, 0, 0);
            for (auto it = mesh->cvv_iter(v); it.is_valid(); ++it) total += mesh->point(*it);
            sums[v.idx()] = total;
        }
        sum = sums[sums.size() / 2][0];
        return sums;
    });
    report.number("value", sum);
}

template <class Mesh>
void normals(Report& report, const Raw& raw, int repeat) {
    const auto mesh = built<Mesh>(raw);
    mesh->request_face_normals();
    mesh->request_vertex_normals();
    report.time(repeat, [&] {
        mesh->update_face_normals();
        mesh->update_vertex_normals();
        return 0;
    });
    report.number("value", mesh->normal(typename Mesh::VertexHandle(int(mesh->n_vertices() / 2)))[0]);
}

template <class Mesh>
void smooth(Report& report, const Raw& raw, int repeat) {
    const auto original = built<Mesh>(raw);
    original->request_face_normals();
    original->request_vertex_normals();
    original->request_vertex_status();
    original->update_normals();
    std::vector<double> wall, cpu;
    for (int i = 0; i < repeat; ++i) {
        Mesh mesh = *original;
        OpenMesh::Smoother::JacobiLaplaceSmootherT<Mesh> smoother(mesh);
        const double w = Clock::wall(), c = Clock::cpu();
        smoother.initialize(OpenMesh::Smoother::SmootherT<Mesh>::Tangential_and_Normal,
                            OpenMesh::Smoother::SmootherT<Mesh>::C0);
        smoother.smooth(10);
        wall.push_back(Clock::wall() - w);
        cpu.push_back(Clock::cpu() - c);
    }
    report.list("ms", wall);
    report.list("cpu_ms", cpu);
}

template <class Mesh>
void write_mesh_raw(const Mesh& mesh, const std::string& path) {
    Raw out;
    for (const auto v : mesh.vertices()) {
        const auto p = mesh.point(v);
        out.points.push_back({p[0], p[1], p[2]});
    }
    out.starts.push_back(0);
    for (const auto f : mesh.faces()) {
        for (auto it = mesh.cfv_ccwiter(f); it.is_valid(); ++it) out.corners.push_back(uint32_t(it->idx()));
        out.starts.push_back(uint32_t(out.corners.size()));
    }
    write_raw(path, out);
}

// Decimates a copy by quadrics to `--levels` faces; the last one is written.
void decimate(Report& report, const Raw& raw, const Call& call) {
    const auto original = built<Triangles>(raw);
    original->request_face_normals();
    original->request_vertex_status();
    original->request_edge_status();
    original->request_face_status();
    original->update_face_normals();
    const auto last = time_on_copies(report, call.repeat, *original, [&](Triangles& mesh) {
        OpenMesh::Decimater::DecimaterT<Triangles> decimater(mesh);
        OpenMesh::Decimater::ModQuadricT<Triangles>::Handle quadric;
        decimater.add(quadric);
        decimater.module(quadric).unset_max_err();
        if (!decimater.initialize()) throw std::runtime_error("OpenMesh does not decimate it");
        decimater.decimate_to_faces(0, std::size_t(call.levels));
        mesh.garbage_collection();
    });
    report.number("vertices", double(last->n_vertices()));
    report.number("faces", double(last->n_faces()));
    if (!call.out.empty()) write_mesh_raw(*last, call.out + ".raw");
}

// Refines a copy; the last one is written.
template <class Mesh, class Subdivider>
void refined(Report& report, const Raw& raw, const Call& call) {
    const auto original = built<Mesh>(raw);
    const auto last = time_on_copies(report, call.repeat, *original, [&](Mesh& mesh) {
        Subdivider subdivider;
        if (!subdivider(mesh, std::size_t(call.levels))) throw std::runtime_error("OpenMesh does not refine it");
    });
    report.number("vertices", double(last->n_vertices()));
    report.number("faces", double(last->n_faces()));
    if (call.out.empty()) return;
    write_mesh_raw(*last, call.out + ".raw");
}

void subdivide(Report& report, const Raw& raw, const Call& call) {
    namespace uniform = OpenMesh::Subdivider::Uniform;
    if (call.scheme == "catmull-clark") refined<Polygons, uniform::CatmullClarkT<Polygons, double>>(report, raw, call);
    else if (call.scheme == "loop") refined<Triangles, uniform::LoopT<Triangles, double>>(report, raw, call);
    else if (call.scheme == "sqrt3") refined<Triangles, uniform::Sqrt3T<Triangles, double>>(report, raw, call);
    else if (call.scheme == "butterfly")
        refined<Triangles, uniform::ModifiedButterflyT<Triangles, double>>(report, raw, call);
    else throw std::runtime_error("OpenMesh has no scheme " + call.scheme);
}

void read(Report& report, const Call& call) {
    double vertices = 0, faces = 0;
    report.time(call.repeat, [&] {
        auto mesh = std::make_unique<Polygons>();
        if (!OpenMesh::IO::read_mesh(*mesh, call.input)) throw std::runtime_error("OpenMesh cannot read it");
        vertices = double(mesh->n_vertices());
        faces = double(mesh->n_faces());
        return mesh;
    });
    report.number("vertices", vertices);
    report.number("faces", faces);
}

void read_triangles(Report& report, const Call& call) {
    double vertices = 0, faces = 0;
    report.time(call.repeat, [&] {
        auto mesh = std::make_unique<Triangles>();
        if (!OpenMesh::IO::read_mesh(*mesh, call.input)) throw std::runtime_error("OpenMesh cannot read it");
        vertices = double(mesh->n_vertices());
        faces = double(mesh->n_faces());
        return mesh;
    });
    report.number("vertices", vertices);
    report.number("faces", faces);
}

template <class Mesh>
void write(Report& report, const Raw& raw, const Call& call, bool binary) {
    const auto mesh = built<Mesh>(raw);
    mesh->request_face_normals();
    mesh->update_face_normals();
    OpenMesh::IO::Options options = binary ? OpenMesh::IO::Options::Binary : OpenMesh::IO::Options::Default;
    report.time(call.repeat, [&] {
        if (!OpenMesh::IO::write_mesh(*mesh, call.out, options, 17))
            throw std::runtime_error("OpenMesh cannot write it");
        return 0;
    });
}

template <class Mesh>
void run(Report& report, const Call& call, const Raw& raw) {
    if (call.operation == "facts") facts<Mesh>(report, raw, call.out);
    else if (call.operation == "build") report.time(call.repeat, [&] { return built<Mesh>(raw); });
    else if (call.operation == "memory") memory(report, [&] { return built<Mesh>(raw); });
    else if (call.operation == "rings") rings<Mesh>(report, raw, call.repeat);
    else if (call.operation == "normals") normals<Mesh>(report, raw, call.repeat);
    else if (call.operation == "smooth") smooth<Mesh>(report, raw, call.repeat);
    else if (call.operation == "write-ascii") write<Mesh>(report, raw, call, false);
    else if (call.operation == "write-binary") write<Mesh>(report, raw, call, true);
    else throw std::runtime_error("OpenMesh's driver has no operation " + call.operation);
}

int main(int count, char** arguments) {
    try {
        const Call call = Call::parse(count, arguments);
        Report report;
        if (call.operation == "read") read(report, call);
        else if (call.operation == "read-triangles") read_triangles(report, call);
        else {
            const Raw raw = read_raw(call.input);
            if (call.operation == "subdivide") subdivide(report, raw, call);
            else if (call.operation == "decimate") decimate(report, raw, call);
            else if (raw.triangles()) run<Triangles>(report, call, raw);
            else run<Polygons>(report, call, raw);
        }
        report.print();
        return 0;
    } catch (const std::exception& error) {
        std::cerr << error.what() << std::endl;
        return 1;
    }
}

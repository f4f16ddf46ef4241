// CGAL's hierarchy of triangles, and what it builds on it.
#pragma once

#include "protocol.hpp"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <memory>

namespace spatial {

// The same numbers as in xtask/src/drive/spatial.rs: SplitMix64 (Steele, Lea and Flood 2014).
struct Numbers {
    uint64_t state;
    double next() {
        uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return double((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
};

typedef std::array<double, 3> Triple;

struct Box {
    Triple lo, hi;
    explicit Box(const Raw& raw) : lo(raw.points[0]), hi(raw.points[0]) {
        for (const auto& p : raw.points)
            for (int i = 0; i < 3; ++i) lo[i] = std::min(lo[i], p[i]), hi[i] = std::max(hi[i], p[i]);
    }
    double diagonal() const { return std::hypot(hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]); }
    Triple inside(Numbers& numbers) const {
        Triple p;
        for (int i = 0; i < 3; ++i) p[i] = lo[i] + (hi[i] - lo[i]) * numbers.next();
        return p;
    }
};

// Vertices moved by up to half a percent of the diagonal.
inline std::vector<Triple> near(const Raw& raw, std::size_t count) {
    const Box box(raw);
    Numbers numbers{2};
    std::vector<Triple> points(count);
    for (auto& p : points) {
        p = raw.points[std::size_t(numbers.next() * double(raw.points.size()))];
        for (double& x : p) x += (numbers.next() - 0.5) * 0.01 * box.diagonal();
    }
    return points;
}

inline std::vector<Triple> in_box(const Raw& raw, std::size_t count) {
    const Box box(raw);
    Numbers numbers{1};
    std::vector<Triple> points(count);
    for (auto& p : points) p = box.inside(numbers);
    return points;
}

template <class Kernel>
std::unique_ptr<CGAL::Surface_mesh<typename Kernel::Point_3>> mesh_of(const Raw& raw) {
    typedef CGAL::Surface_mesh<typename Kernel::Point_3> Mesh;
    auto mesh = std::make_unique<Mesh>();
    for (const auto& p : raw.points) mesh->add_vertex(typename Kernel::Point_3(p[0], p[1], p[2]));
    for (std::size_t f = 0; f < raw.faces(); ++f) {
        std::vector<typename Mesh::Vertex_index> face;
        for (uint32_t c = raw.starts[f]; c < raw.starts[f + 1]; ++c)
            face.push_back(typename Mesh::Vertex_index(raw.corners[c]));
        if (mesh->add_face(face) == Mesh::null_face()) throw std::runtime_error("CGAL refuses a face");
    }
    return mesh;
}

typedef CGAL::Simple_cartesian<double> Kernel;
typedef CGAL::Surface_mesh<Kernel::Point_3> Mesh;
typedef CGAL::AABB_face_graph_triangle_primitive<Mesh> Primitive;
typedef CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> Tree;

const std::size_t QUERIES = 100000;

inline Kernel::Point_3 point(const Triple& p) { return Kernel::Point_3(p[0], p[1], p[2]); }

// Sum of the distances.
inline void closest(Report& report, const Raw& raw, const Call& call, const std::vector<Triple>& points) {
    const auto mesh = mesh_of<Kernel>(raw);
    Tree tree(faces(*mesh).first, faces(*mesh).second, *mesh);
    tree.build();
    tree.accelerate_distance_queries();
    double sum = 0;
    report.time(call.repeat, [&] {
        sum = 0;
        for (const auto& p : points) {
            const auto found = tree.closest_point_and_primitive(point(p));
            sum += std::sqrt(CGAL::squared_distance(point(p), found.first));
        }
        return 0;
    });
    report.number("value", sum);
}

// From points of the box toward others: how many hit something, and the sum of the distances.
inline void rays(Report& report, const Raw& raw, const Call& call) {
    const auto mesh = mesh_of<Kernel>(raw);
    Tree tree(faces(*mesh).first, faces(*mesh).second, *mesh);
    tree.build();
    const auto points = in_box(raw, 2 * QUERIES);
    double sum = 0;
    const bool any = call.operation == "ray-any", segments = call.operation == "segment-any";
    report.time(call.repeat, [&] {
        sum = 0;
        for (std::size_t i = 0; i < QUERIES; ++i) {
            const auto a = point(points[2 * i]), b = point(points[2 * i + 1]);
            if (segments) {
                sum += tree.do_intersect(Kernel::Segment_3(a, b));
                continue;
            }
            const Kernel::Ray_3 ray(a, b);
            if (any) {
                sum += tree.do_intersect(ray);
                continue;
            }
            const auto found = tree.first_intersection(ray);
            if (!found) continue;
            if (const auto* hit = boost::get<Kernel::Point_3>(&found->first))
                sum += std::sqrt(CGAL::squared_distance(a, *hit));
        }
        return 0;
    });
    report.number("value", sum);
}

// How many faces meet boxes of a fiftieth of the size.
inline void boxes(Report& report, const Raw& raw, const Call& call) {
    const auto mesh = mesh_of<Kernel>(raw);
    Tree tree(faces(*mesh).first, faces(*mesh).second, *mesh);
    tree.build();
    const Box box(raw);
    const auto points = near(raw, QUERIES / 10);
    double sum = 0;
    report.time(call.repeat, [&] {
        sum = 0;
        for (const auto& p : points) {
            const double half = 0.005 * box.diagonal();
            const CGAL::Bbox_3 query(p[0] - half, p[1] - half, p[2] - half, p[0] + half, p[1] + half, p[2] + half);
            std::vector<Tree::Primitive_id> found;
            tree.all_intersected_primitives(query, std::back_inserter(found));
            sum += double(found.size());
        }
        return 0;
    });
    report.number("value", sum);
}

inline Raw moved(const Raw& raw) {
    Raw other = raw;
    Numbers numbers{3};
    const double size = 0.002 * Box(raw).diagonal();
    for (auto& p : other.points)
        for (double& x : p) x += size * (numbers.next() - 0.5);
    return other;
}

typedef CGAL::Exact_predicates_inexact_constructions_kernel Exact;

inline void self_intersections(Report& report, const Raw& raw, const Call& call) {
    const auto mesh = mesh_of<Exact>(moved(raw));
    typedef CGAL::Surface_mesh<Exact::Point_3>::Face_index Face;
    std::vector<std::pair<Face, Face>> pairs;
    report.time(call.repeat, [&] {
        pairs.clear();
        CGAL::Polygon_mesh_processing::self_intersections(*mesh, std::back_inserter(pairs));
        return 0;
    });
    report.number("value", double(pairs.size()));
}

// One way, to a ten-thousandth of the diagonal.
inline void hausdorff(Report& report, const Raw& raw, const Call& call) {
    const auto a = mesh_of<Exact>(raw), b = mesh_of<Exact>(moved(raw));
    const double bound = 1e-4 * Box(raw).diagonal();
    double distance = 0;
    report.time(call.repeat, [&] {
        distance = CGAL::Polygon_mesh_processing::bounded_error_Hausdorff_distance<CGAL::Sequential_tag>(*a, *b, bound);
        return 0;
    });
    report.number("value", distance);
    report.number("bound", bound);
}

// Whether the operation is one of these.
inline bool perform(Report& report, const Raw& raw, const Call& call) {
    const std::string& operation = call.operation;
    if (operation == "tree-build") {
        const auto mesh = mesh_of<Kernel>(raw);
        report.time(call.repeat, [&] {
            auto tree = std::make_unique<Tree>(faces(*mesh).first, faces(*mesh).second, *mesh);
            tree->build();
            return tree;
        });
    } else if (operation == "closest-near") closest(report, raw, call, near(raw, QUERIES));
    else if (operation == "closest-box") closest(report, raw, call, in_box(raw, QUERIES / 10));
    else if (operation == "ray-first" || operation == "ray-any" || operation == "segment-any") rays(report, raw, call);
    else if (operation == "box-faces") boxes(report, raw, call);
    else if (operation == "self-intersections") self_intersections(report, raw, call);
    else if (operation == "hausdorff") hausdorff(report, raw, call);
    else return false;
    return true;
}

}  // namespace spatial

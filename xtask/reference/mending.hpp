// Counts of defects by CGAL's Polygon Mesh Processing, and what its soup repair and its stitching leave.
#pragma once
#include "spatial.hpp"

#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/shape_predicates.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>

#include <cmath>

namespace mending {

namespace pmp = CGAL::Polygon_mesh_processing;
typedef CGAL::Exact_predicates_inexact_constructions_kernel Kernel;
typedef CGAL::Surface_mesh<Kernel::Point_3> Mesh;

// Faces of a manifold: what meets, what is a sliver, what hangs together, what can be stitched.
inline void counts(Report& report, const Raw& raw, const Call&) {
    auto mesh = spatial::mesh_of<Kernel>(raw);
    std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
    pmp::self_intersections(*mesh, std::back_inserter(pairs));
    report.number("self_intersections", double(pairs.size()));
    report.number("self_intersects", pmp::does_self_intersect(*mesh) ? 1 : 0);
    double degenerate = 0, needles = 0, caps = 0;
    const double cap = std::cos(160.0 / 180.0 * 3.14159265358979323846);
    for (const auto f : mesh->faces()) {
        degenerate += pmp::is_degenerate_triangle_face(f, *mesh);
        needles += pmp::is_needle_triangle_face(f, *mesh, 4.0) != Mesh::null_halfedge();
        caps += pmp::is_cap_triangle_face(f, *mesh, cap) != Mesh::null_halfedge();
    }
    report.number("degenerate_faces", degenerate);
    report.number("needles", needles);
    report.number("caps", caps);
    auto parts = mesh->add_property_map<Mesh::Face_index, std::size_t>("f:part", 0).first;
    report.number("components", double(pmp::connected_components(*mesh, parts)));
    report.number("joined_edges", double(pmp::stitch_borders(*mesh)));
}

// Any faces: points and polygons that are left when copies have gone.
inline void soup(Report& report, const Raw& raw, const Call&) {
    std::vector<Kernel::Point_3> points;
    for (const auto& p : raw.points) points.emplace_back(p[0], p[1], p[2]);
    std::vector<std::vector<std::size_t>> polygons(raw.faces());
    for (std::size_t f = 0; f < raw.faces(); ++f)
        polygons[f].assign(raw.corners.begin() + raw.starts[f], raw.corners.begin() + raw.starts[f + 1]);
    pmp::repair_polygon_soup(points, polygons);
    report.number("soup_points", double(points.size()));
    report.number("soup_polygons", double(polygons.size()));
}

inline bool perform(Report& report, const Raw& raw, const Call& call) {
    if (call.operation == "defect-counts") counts(report, raw, call);
    else if (call.operation == "soup-counts") soup(report, raw, call);
    else return false;
    return true;
}

}  // namespace mending

// CGAL's filling of holes.
#pragma once

#include "spatial.hpp"

#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <iterator>
#include <tuple>

namespace holes {

typedef CGAL::Surface_mesh<spatial::Exact::Point_3> Mesh;

// Fills all holes of a copy: `fill-cover`, `fill-refined` or `fill-fair`. `write` gets the last one; faces that were
// there come first.
template <class Write>
bool perform(Report& report, const Raw& raw, const Call& call, Write write) {
    namespace pmp = CGAL::Polygon_mesh_processing;
    const std::string& operation = call.operation;
    if (operation.rfind("fill-", 0) != 0) return false;
    const auto original = spatial::mesh_of<spatial::Exact>(raw);
    std::unique_ptr<Mesh> last;
    bool filled = true;
    report.time_from(
        call.repeat,
        [&] {
            last.reset();
            last = std::make_unique<Mesh>(*original);
            return last.get();
        },
        [&](Mesh* mesh) {
            std::vector<Mesh::Halfedge_index> cycles;
            pmp::extract_boundary_cycles(*mesh, std::back_inserter(cycles));
            std::vector<Mesh::Face_index> faces;
            std::vector<Mesh::Vertex_index> vertices;
            const auto face_out = std::back_inserter(faces);
            const auto vertex_out = std::back_inserter(vertices);
            for (const auto h : cycles) {
                const std::size_t before = faces.size();
                if (operation == "fill-cover") pmp::triangulate_hole(*mesh, h, face_out);
                else if (operation == "fill-refined") pmp::triangulate_and_refine_hole(*mesh, h, face_out, vertex_out);
                else filled &= std::get<0>(pmp::triangulate_refine_and_fair_hole(*mesh, h, face_out, vertex_out));
                filled &= faces.size() > before;
            }
            return 0;
        });
    report.truth("filled", filled);
    report.number("vertices", double(last->number_of_vertices()));
    report.number("faces", double(last->number_of_faces()));
    if (!call.out.empty()) write(*last);
    return true;
}

}  // namespace holes

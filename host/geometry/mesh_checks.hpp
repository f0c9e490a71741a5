// Is a surface fit to be simulated: closed, oriented outward, without NaN and needles of no area?
#pragma once
#include <optional>
#include <string>

#include "host/geometry/mesh.hpp"

namespace pvg {

// Points closer than `tolerance` [m] on every axis become one (the first of them); triangles that lose a corner by it
// go. Points that no triangle uses go too. The order of what stays is kept.
TriangleMesh weld_points(const TriangleMesh& mesh, double tolerance);

// First defect of a surface that must enclose a solid, as the end of a sentence that says what is wrong, where, and
// what to do; empty: none. Checked in this order: no triangles, not finite, wrong index, triangles without area, holes,
// edges with more than two triangles, neighbours that face opposite ways, parts that face inward.
std::optional<std::string> closed_surface_defect(const TriangleMesh& mesh);

// Throws UsageError "NAME: DEFECT".
void check_closed_surface(const TriangleMesh& mesh, const std::string& name);

// Component of each triangle: triangles that share an edge belong together. [n_triangles], numbered from 0 in order.
std::vector<int> triangle_components(const TriangleMesh& mesh);

// Signed volume enclosed [m^3], and of one component.
double enclosed_volume(const TriangleMesh& mesh);

}  // namespace pvg

// The section `shape` of a body of a scene file. Internal to the loaders.
#pragma once
#include "host/geometry/mesh.hpp"
#include "host/load/fields/yaml_section.hpp"

namespace pvg {

// may_be_open: a body that never moves needs no inside
TriangleMesh read_surface_shape(YamlSection section, bool may_be_open);
TetMesh read_solid_shape(YamlSection section);
TriangleMesh read_sheet_shape(YamlSection section);  // of a cloth: open or closed

// Indices of the points inside a box: `low` and `high` of this section, in the frame of the points.
std::vector<std::uint32_t> read_points_within(YamlSection& section, const std::vector<Vec3>& points,
                                              const std::string& body);
// The same of a box that has been read.
std::vector<std::uint32_t> points_within(const YamlSection& section, const Vec3& low, const Vec3& high,
                                         const std::vector<Vec3>& points, const std::string& body);

}  // namespace pvg

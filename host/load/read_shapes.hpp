// The tables of the section `shape` of bodies and cloths. Internal to the loaders.
#pragma once
#include "host/geometry/mesh.hpp"
#include "host/load/fields/one_of.hpp"

namespace pvg {

const OneOf<TriangleMesh>& closed_shapes();  // of bodies that move
const OneOf<TriangleMesh>& open_shapes();    // and of those that need no inside, because nothing moves them
const OneOf<TetMesh>& solid_shapes();
const OneOf<TriangleMesh>& sheet_shapes();  // of cloths: open or closed

// Indices of the points inside a box: `low` and `high` of this section, in the frame of the points.
std::vector<std::uint32_t> read_points_within(YamlSection& section, const std::vector<Vec3>& points,
                                              const std::string& body);
// The same of a box that has been read.
std::vector<std::uint32_t> points_within(const YamlSection& section, const Vec3& low, const Vec3& high,
                                         const std::vector<Vec3>& points, const std::string& body);

}  // namespace pvg

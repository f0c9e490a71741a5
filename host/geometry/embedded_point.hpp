// A point of a soft body or cloth as a few of its nodes with weights that sum to one.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

using NodeWeights = std::vector<std::pair<std::uint32_t, double>>;

// As embed_points (tet_embedding.hpp) embeds it, so that a marker moves with the surface that is seen.
NodeWeights embed(const TetMesh& mesh, const Vec3& point);
// The corners of the triangle nearest to the point.
NodeWeights embed(const TriangleMesh& mesh, const Vec3& point);

}  // namespace pvg

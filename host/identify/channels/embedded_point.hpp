// A point of a soft body or cloth as a few of its nodes with weights that sum to one.
#pragma once
#include <utility>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg::diagnose {

using NodeWeights = std::vector<std::pair<std::uint32_t, double>>;

// The corners of the element that holds the point, or nearly does: a point outside is carried on linearly.
NodeWeights embed(const TetMesh& mesh, const Vec3& point);
NodeWeights embed(const TriangleMesh& mesh, const Vec3& point);

}  // namespace pvg::diagnose

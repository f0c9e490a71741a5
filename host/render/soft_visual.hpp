// The visual mesh of a soft body or cloth, carried by its nodes: its surface by Loop subdivision, or any mesh that is
// embedded in its tetrahedra. Moved on the device, its tree refitted.
#pragma once
#include <vector>

#include "host/geometry/loop_subdivision.hpp"
#include "host/render/dual_mesh.hpp"
#include "host/render/refit.hpp"
#include "host/render/stages.hpp"

namespace pvg {

// What is seen, as weights of the body's nodes.
struct CarriedMesh {
  SparseRows weights;                      // W: points = W nodes
  VisualMesh rest;                         // in the body's frame
  std::vector<std::uint32_t> normal_from;  // [n_points] the first vertex with which a vertex shares its normal
};

// Throws a UsageError where the visual's mesh is not near the body: no point of it may be further outside than a tenth
// of the body's size (the diagonal of its box).
CarriedMesh carried_mesh(const Scene& scene, const Visual& visual);

// of moved points, the area-weighted means of the triangles at each vertex; unit
std::vector<Vec3f> moved_normals(const CarriedMesh& mesh, const std::vector<Vec3f>& points);

class SoftVisual {
 public:
  SoftVisual(Device& device, CarriedMesh mesh);
  // rest shape in the body's frame, to be added to the scene's geometry
  const VisualMesh& mesh() const { return mesh_; }
  // nodes: of the body, world [m]. Moves the vertices and fits the tree to them, or builds it anew where it has become
  // bad; the box of what is seen is the return value.
  Box follow(const std::vector<Vec3>& nodes, MeshRange& range, DeviceScene& scene);

 private:
  VisualMesh mesh_;
  DualMesh dual_mesh_;
  Refit refit_;
  float cost_when_built_ = 0;  // of the tree; 0: it was built for the rest shape and has not been fitted yet
};

}  // namespace pvg

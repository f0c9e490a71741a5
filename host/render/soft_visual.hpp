// The visual mesh of a soft body: its surface by Loop subdivision, moved with its nodes, its tree refitted; on the
// device.
#pragma once
#include <vector>

#include "host/render/dual_mesh.hpp"
#include "host/render/refit.hpp"
#include "host/render/stages.hpp"

namespace pvg {

class SoftVisual {
 public:
  SoftVisual(Device& device, const SoftBody& body, const Visual& visual);
  // rest shape in the body's frame, to be added to the scene's geometry
  const VisualMesh& mesh() const { return mesh_; }
  // nodes: of the soft body, world [m]. Moves the vertices, refits the tree; the box of what is seen is the return
  // value.
  Box follow(const std::vector<Vec3>& nodes, const MeshRange& range, DeviceScene& scene);

 private:
  SoftVisual(Device& device, const SoftBody& body, const Subdivision& subdivision);
  VisualMesh mesh_;
  DualMesh dual_mesh_;
  Refit refit_;
};

}  // namespace pvg

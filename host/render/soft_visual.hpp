// The visual mesh of a soft body or cloth: its surface by Loop subdivision, moved with its nodes, its tree refitted; on
// the device.
#pragma once
#include <vector>

#include "host/render/dual_mesh.hpp"
#include "host/render/refit.hpp"
#include "host/render/stages.hpp"

namespace pvg {

// The visual's surface as weights of the body's points. points, surface: of the body of this name, at rest.
Subdivision visual_subdivision(const std::string& body, const std::vector<Vec3>& points,
                               const std::vector<Triangle>& surface, const Visual& visual);

class SoftVisual {
 public:
  // points, surface: at rest, in the frame of the body of this name
  SoftVisual(Device& device, const std::string& body, const std::vector<Vec3>& points,
             const std::vector<Triangle>& surface, const Visual& visual);
  // rest shape in the body's frame, to be added to the scene's geometry
  const VisualMesh& mesh() const { return mesh_; }
  // nodes: of the body, world [m]. Moves the vertices and fits the tree to them, or builds it anew where it has become
  // bad; the box of what is seen is the return value.
  Box follow(const std::vector<Vec3>& nodes, MeshRange& range, DeviceScene& scene);

 private:
  SoftVisual(Device& device, const std::vector<Vec3>& points, const Subdivision& subdivision);
  VisualMesh mesh_;
  DualMesh dual_mesh_;
  Refit refit_;
  float cost_when_built_ = 0;  // of the tree; 0: it was built for the rest shape and has not been fitted yet
};

}  // namespace pvg

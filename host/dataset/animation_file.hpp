// A simulated motion as a binary glTF (.glb), which any glTF viewer plays: the surfaces of all bodies, rigid ones as
// animated nodes, soft bodies and cloths as morph targets, one per picture. glTF's y is up; a root node turns z there.
#pragma once
#include <filesystem>
#include <vector>

#include "host/model/scene.hpp"
#include "host/model/state.hpp"

namespace pvg {

class AnimationFile {
 public:
  explicit AnimationFile(const Scene& scene) : scene_(scene) {}
  void append(const SceneState& state) { states_.push_back(state); }  // times must ascend
  // The whole file or none; a Failure names it where it cannot be written. Needs at least one state.
  void write(const std::filesystem::path& file) const;

 private:
  const Scene& scene_;
  std::vector<SceneState> states_;
};

}  // namespace pvg

// Masks as the cameras of a recording would have seen them in a simulated state.
#pragma once
#include <cstdint>
#include <vector>

#include "host/identify/data/problem.hpp"
#include "host/render/renderer.hpp"

namespace pvg::diagnose {

class MaskSight {
 public:
  MaskSight(Device& device, const Problem& problem);
  // source: of Recording::mask_sources;  k1: added to that of its camera's lens;  1 where its part is seen
  // [height x width]
  std::vector<std::uint8_t> look(std::size_t source, const SceneState& state, double k1 = 0);
  int camera(std::size_t source) const { return sources_.at(source).camera; }  // of Problem::seen

 private:
  struct Source {
    int camera;
    std::vector<char> is_part;  // [1 + n_visuals] by instance
  };
  const Problem* problem_;
  std::vector<Source> sources_;
  Renderer renderer_;
};

}  // namespace pvg::diagnose

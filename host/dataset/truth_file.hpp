// <camera>_truth.h5: what is exactly known of every picture, at the middles of its pixels.
//   /depth /distance [F, H, W, m]      along the optical axis; from the camera; infinite where nothing is
//   /normal [F, H, W, 3]               unit, world, toward the camera; 0 where nothing is
//   /albedo [F, H, W, 3]               colour in [0, 1], and
//   /mean_normal [F, H, W, 3]          normal of the first surface that scatters, seen through clear glass and in
//                                      mirrors: means over the samples of the pixel
//   /instance [F, H, W] /part [F, H, W]  as in masks_file.hpp
//   /flow_forward /flow_backward [F, H, W, 2, pixels]    where the point is in the next / last picture: right and down
//   /flow_forward_state /flow_backward_state [F, H, W]   0: seen there, 1: hidden, 2: outside or no such picture
//   /box [F, N, 4]                     columns and rows x0 y0 x1 y1 that hold an instance, both ends; -1: not seen
//   /visible [F, N]                    its number of pixels
//   /pose [F, N, 3, 4]                 rows of [A | p], the instance's mesh to world; of a soft body or cloth: identity
//   /K [3, 3]  /T_world_camera [F, 4, 4]  /time [F, s]
// N: instances 1, 2 ... in the order of /instance's `names` without the first.
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "host/hdf5/series.hpp"
#include "host/model/scene.hpp"
#include "host/model/state.hpp"
#include "host/pictures/rendered_frame.hpp"

namespace pvg {

// Names of what the numbers of masks mean; 0: nothing.
struct MaskLabels {
  std::vector<std::string> instances, parts;
  std::vector<std::uint8_t> part_of_instance;
};
// Throws a Failure that names `file` where there are more than a mask has room for.
MaskLabels mask_labels(const Scene& scene, const std::filesystem::path& file);

// Where an instance is in a picture.
struct InstanceBox {
  std::array<std::int32_t, 4> corners{-1, -1, -1, -1};  // x0 y0 x1 y1 [pixels], both ends
  std::uint32_t visible = 0;                            // pixels
};
// [n_instances], of instances 1, 2 ...
std::vector<InstanceBox> instance_boxes(std::span<const std::uint32_t> instance, int width, std::size_t n_instances);

class TruthFile {
 public:
  TruthFile(const std::filesystem::path& path, const Scene& scene, const Camera& camera);
  ~TruthFile();
  TruthFile(const TruthFile&) = delete;

  // forward, backward: empty where there is no such picture
  void append(const RenderedFrame& frame, const FlowFrame& forward, const FlowFrame& backward, const SceneState& state,
              const Eigen::Matrix4d& T_world_camera);
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pvg

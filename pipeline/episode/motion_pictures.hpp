// The pictures of a motion that is known, made in the stage graph: while one is traced, the states of the next are read
// and the one before is encoded and written. They leave in their order: by frame, then by camera.
#pragma once
#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "pipeline/episode/picture_stages.hpp"
#include "pipeline/episode/shown_scene.hpp"

namespace pvg {

struct MotionSettings {
  FrameRange range;
  std::vector<int> cameras;  // of the scene
  RenderSettings pictures;
  std::optional<Lut> lut;
  bool finds_flow = false;  // to the neighbouring frames
};

// What leaves, valid for the call.
struct MotionPicture {
  std::size_t frame;
  int camera;
  const SceneState& state;
  const RenderedFrame& linear;
  const Picture8& encoded;
  const FlowFrame &forward, &backward;  // empty where it was not asked for, or there is no such frame
  const Eigen::Matrix4d& T_world_camera;
  double seconds;  // of tracing it
};

// The stages in their order.
Table motion_table();

// What a stage throws comes out as it was thrown; TryAgain once `stop` is true. At most PICTURES_UNDER_WAY pictures are
// held at a time.
inline constexpr std::size_t PICTURES_UNDER_WAY = 4;
void render_motion(Device& device, const Scene& scene, const Frames& frames, const MotionSettings& settings,
                   const std::function<void(const MotionPicture&)>& write, const std::atomic<bool>& stop);

}  // namespace pvg

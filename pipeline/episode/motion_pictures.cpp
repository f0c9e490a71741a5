#include "pipeline/episode/motion_pictures.hpp"

#include <algorithm>

namespace pvg {
namespace {

struct MotionState {
  const Frames* frames = nullptr;
  FrameRange range;
  std::vector<int> cameras;
  double shutter = 0;  // longest time that a picture looks back [s]
  bool finds_flow = false;
  Shown shown;  // of the frame that was read last
};

struct MotionSink {
  std::function<void(const MotionPicture&)> write;
};

// clang-format off
//                                     name       shape         unit  state
const Field<MotionState> moved        ("motion",  "n_frame",    "SI", true);
const Field<MotionSink> motion_sink   ("written", "n_picture",  "-",  true);
// clang-format on

Shown read_frame(const MotionState& state, std::size_t frame) {
  const Frames& frames = *state.frames;
  Shown shown;
  shown.frame = std::uint32_t(frame);
  shown.state = frames.state(frame);
  if (state.shutter > 0) shown.motion = frames.motion(shown.state.time - state.shutter, shown.state.time);
  if (state.finds_flow && frame + 1 < frames.size()) shown.after = frames.state(frame + 1);
  if (state.finds_flow && frame > 0) shown.before = frames.state(frame - 1);
  return shown;
}

void read_states(const Access& access) {
  MotionState& state = access.write(moved);
  const std::size_t n = state.cameras.size(), camera = access.frame() % n;
  if (camera == 0) state.shown = read_frame(state, state.range.begin + access.frame() / n);
  Shown& shown = access.write(fields::shown);
  shown = state.shown;
  shown.cameras = {state.cameras[camera]};
}

void write_one(const Access& access) {
  const Shown& shown = access.read(fields::shown);
  const Pictures& made = access.read(fields::pictures);
  access.write(motion_sink)
      .write({shown.frame, shown.cameras.front(), shown.state, made.frames.front(),
              access.read(fields::images).pictures.front(), made.forward.front(), made.backward.front(),
              made.T_world_camera.front(), made.seconds.front()});
}

}  // namespace

// clang-format off
Table motion_table() {
  return {
      // stage   reads                                                      writes                     width  does
      {"read",  {&moved},                                                  {&moved, &fields::shown},  1,     read_states},
      render_stage(),
      finish_stage(),
      encode_stage(),
      {"write", {&fields::shown, &fields::pictures, &fields::images},      {&motion_sink},            1,     write_one},
  };
}
// clang-format on

void render_motion(Device& device, const Scene& scene, const Frames& frames, const MotionSettings& settings,
                   const std::function<void(const MotionPicture&)>& write, const std::atomic<bool>& stop) {
  const Table table = motion_table();
  Store store(table, PICTURES_UNDER_WAY);
  MotionState& state = store.state(moved);
  state.frames = &frames;
  state.range = settings.range;
  state.cameras = settings.cameras;
  state.finds_flow = settings.finds_flow;
  for (const int camera : settings.cameras)
    state.shutter = std::max(state.shutter, shutter_of(scene.cameras.at(std::size_t(camera))));
  start_pictures(store, std::make_unique<Renderer>(device, scene, settings.pictures), settings.lut,
                 std::vector<bool>(scene.cameras.size(), true));
  store.state(motion_sink).write = write;
  const std::size_t n = settings.cameras.size() * (settings.range.end - settings.range.begin);
  try {
    stream(table, store, n, stop);
  } catch (const StageError& error) {
    std::rethrow_exception(error.cause);
  }
}

}  // namespace pvg

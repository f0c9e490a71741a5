#include "pipeline/episode/picture_stages.hpp"

#include <chrono>

#include "host/render/motion.hpp"

namespace pvg {
namespace fields {

// clang-format off
//                                     name        shape               unit            state
const Field<Shown> shown              ("shown",    "steps x n_node x 3", "m");
const Field<RenderState> renderer     ("renderer", "n_camera",         "-",            true);
const Field<Pictures> pictures        ("pictures", "n_camera x h x w", "W/(sr m^2)");
const Field<FramePictures> images     ("images",   "n_camera x h x w", "sRGB");
// clang-format on

}  // namespace fields

namespace {

// The device is held for one picture at a time.
std::unique_lock<std::mutex> turn_of(const RenderState& state) {
  return state.turn ? std::unique_lock(*state.turn) : std::unique_lock<std::mutex>();
}

void render_one(RenderState& state, const Shown& seen, int camera, Pictures& made) {
  const auto turn = turn_of(state);
  const auto start = std::chrono::steady_clock::now();
  Renderer& renderer = *state.renderer;
  RenderedFrame picture = renderer.render(
      camera, seen.frame, [&](double time) { return state_at(seen.motion, time); }, seen.state.time);
  made.seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  if (state.lut) apply_lut(*state.lut, picture.rgb);
  if (!state.records_mask[std::size_t(camera)]) picture.instance.clear();
  made.frames.push_back(std::move(picture));
  made.forward.push_back(seen.after ? renderer.flow(*seen.after) : FlowFrame());
  made.backward.push_back(seen.before ? renderer.flow(*seen.before) : FlowFrame());
  made.T_world_camera.push_back(renderer.camera_pose(camera));
}

void render_all(const Access& access) {
  RenderState& state = access.write(fields::renderer);
  if (!state.renderer) return;
  const Shown& seen = access.read(fields::shown);
  if (state.frame != seen.frame) {
    const auto turn = turn_of(state);
    state.renderer->set_state(seen.state);
    state.frame = seen.frame;
  }
  std::vector<int> cameras = seen.cameras;
  if (cameras.empty())
    for (std::size_t camera = 0; camera < state.records_mask.size(); ++camera) cameras.push_back(int(camera));
  for (const int camera : cameras) {
    access.stop_here_if_asked();
    render_one(state, seen, camera, access.write(fields::pictures));
  }
}

void encode_all(const Access& access) {
  const Pictures& linear = access.read(fields::pictures);
  FramePictures& encoded = access.write(fields::images);
  encoded.T_world_camera = linear.T_world_camera;
  for (const RenderedFrame& frame : linear.frames) {
    encoded.pictures.push_back(encode_srgb8(frame.rgb, frame.width, frame.height));
    encoded.instance.push_back(frame.instance);
  }
}

}  // namespace

// clang-format off
//                                reads                              writes                               width
Stage render_stage() {
  return {"render", {&fields::shown, &fields::renderer}, {&fields::renderer, &fields::pictures}, 1, render_all};
}
Stage encode_stage() { return {"encode", {&fields::pictures}, {&fields::images}, 2, encode_all}; }
// clang-format on

}  // namespace pvg

#include "pipeline/episode/picture_stages.hpp"

#include <chrono>

#include "host/render/motion.hpp"
#include "host/render/picture_finish.hpp"

namespace pvg {
namespace fields {

// clang-format off
//                                     name        shape               unit            state
const Field<Shown> shown              ("shown",    "steps x n_node x 3", "m");
const Field<RenderState> renderer     ("renderer", "n_camera",         "-",            true);
const Field<FinishState> finish       ("sensors",  "n_camera",         "-",            true);
const Field<Pictures> traced          ("traced",   "n_camera x h x w", "W/(sr m^2)");
const Field<Pictures> pictures        ("pictures", "n_camera x h x w", "exposed");
const Field<FramePictures> images     ("images",   "n_camera x h x w", "sRGB");
// clang-format on

}  // namespace fields

namespace {

// The device is held for one picture at a time.
std::unique_lock<std::mutex> turn_of(const RenderState& state) {
  return state.turn ? std::unique_lock(*state.turn) : std::unique_lock<std::mutex>();
}

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void render_one(RenderState& state, const Shown& seen, int camera, Pictures& made) {
  const auto turn = turn_of(state);
  const Clock::time_point start = Clock::now();
  Renderer& renderer = *state.renderer;
  RenderedFrame picture = renderer.trace(
      camera, seen.frame, [&](double time) { return state_at(seen.motion, time); }, seen.state.time);
  made.cameras.push_back(camera);
  made.seconds.push_back(seconds_since(start));
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
    render_one(state, seen, camera, access.write(fields::traced));
  }
}

void finish_all(const Access& access) {
  FinishState& state = access.write(fields::finish);
  if (!state.finish) return;
  Pictures& made = access.write(fields::pictures);
  made = access.read(fields::traced);
  for (std::size_t i = 0; i < made.frames.size(); ++i) {
    access.stop_here_if_asked();
    const Clock::time_point start = Clock::now();
    (*state.finish)(made.frames[i], made.cameras[i], access.read(fields::shown).frame);
    if (state.lut) apply_lut(*state.lut, made.frames[i].rgb);
    made.seconds[i] += seconds_since(start);
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

void start_pictures(Store& store, std::unique_ptr<Renderer> renderer, std::optional<Lut> lut,
                    std::vector<bool> records_mask) {
  FinishState& finish = store.state(fields::finish);
  finish.finish = renderer->finish();
  finish.lut = std::move(lut);
  RenderState& render = store.state(fields::renderer);
  render.renderer = std::move(renderer);
  render.records_mask = std::move(records_mask);
}

FramePictures pictures_at_rest(Renderer& renderer, std::size_t n_cameras, const SceneState& state, std::uint32_t frame,
                               const std::optional<Lut>& lut) {
  FramePictures made;
  renderer.set_state(state);
  for (int camera = 0; camera < int(n_cameras); ++camera) {
    RenderedFrame seen = renderer.render(
        camera, frame, [&](double) { return state; }, state.time);
    if (lut) apply_lut(*lut, seen.rgb);
    made.pictures.push_back(encode_srgb8(seen.rgb, seen.width, seen.height));
    made.T_world_camera.push_back(renderer.camera_pose(camera));
  }
  return made;
}

// clang-format off
//                                reads                              writes                               width
Stage render_stage() {
  return {"render", {&fields::shown, &fields::renderer}, {&fields::renderer, &fields::traced}, 1, render_all};
}
Stage finish_stage() {
  return {"finish", {&fields::shown, &fields::traced, &fields::finish}, {&fields::finish, &fields::pictures}, 1, finish_all};
}
Stage encode_stage() { return {"encode", {&fields::pictures}, {&fields::images}, 2, encode_all}; }
// clang-format on

}  // namespace pvg

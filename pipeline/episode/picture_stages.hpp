// The stages that make pictures of what stands somewhere, the same in the table of an episode and in that of `render`.
#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "host/formats/lut_file.hpp"
#include "host/render/renderer.hpp"
#include "pipeline/episode/record.hpp"
#include "pipeline/graph/graph.hpp"

namespace pvg {

// What is pictured.
struct Shown {
  std::uint32_t frame = 0;                  // enters the random numbers
  std::vector<int> cameras;                 // whose pictures are made; empty: all of the scene
  SceneState state;                         // at the time of the picture
  std::vector<SceneState> motion;           // of ascending times, for shutters that are open before it
  std::optional<SceneState> before, after;  // of the neighbouring frames, where flow is asked for
};

struct RenderState {
  std::unique_ptr<Renderer> renderer;  // nothing: no pictures
  std::mutex* turn = nullptr;          // of a device on which others render, too
  std::vector<bool> records_mask;      // [n_cameras of the scene]
  std::optional<std::uint32_t> frame;  // in whose state everything stands
};

struct FinishState {
  std::shared_ptr<PictureFinish> finish;  // of the renderer; nothing: no pictures
  std::optional<Lut> lut;
};

struct Pictures {  // [n_cameras shown]
  std::vector<int> cameras;
  std::vector<RenderedFrame> frames;
  std::vector<FlowFrame> forward, backward;  // empty where Shown names no neighbour
  std::vector<Eigen::Matrix4d> T_world_camera;
  std::vector<double> seconds;  // that each took
};

namespace fields {
extern const Field<Shown> shown;
extern const Field<RenderState> renderer;
extern const Field<FinishState> finish;
extern const Field<Pictures> traced;    // their light alone
extern const Field<Pictures> pictures;  // finished
extern const Field<FramePictures> images;
}  // namespace fields

// Gives the stages what they keep.
void start_pictures(Store& store, std::unique_ptr<Renderer> renderer, std::optional<Lut> lut,
                    std::vector<bool> records_mask);

// Frame number of the picture of an episode's start, which none of its frames has. `serve` shows the same picture.
inline constexpr std::uint32_t START_FRAME = std::numeric_limits<std::uint32_t>::max();

// What every camera sees of a scene at rest, without masks.
FramePictures pictures_at_rest(Renderer& renderer, std::size_t n_cameras, const SceneState& state, std::uint32_t frame,
                               const std::optional<Lut>& lut);

Stage render_stage();  // shown -> traced: one after the other, each with its ground truth
Stage finish_stage();  // traced -> pictures: filtered and exposed, while the next are traced
Stage encode_stage();  // pictures -> images: to 8 bits

}  // namespace pvg

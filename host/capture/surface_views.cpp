#include "host/capture/surface_views.hpp"

#include <algorithm>
#include <cmath>

#include "host/pictures/srgb.hpp"

namespace pvg {

Scene scene_of(std::span<const CapturedSurface> surfaces, VisualMaterial::Kind kind, std::span<const Camera> cameras) {
  Scene scene;
  for (const CapturedSurface& surface : surfaces) {
    if (surface.mesh.triangles.empty()) continue;
    VisualMaterial material;
    material.name = "room";
    material.kind = kind;
    material.color = Vec3f::Ones();
    if (!surface.texture.rgba.empty()) {
      material.texture = int(scene.textures.size());
      scene.textures.push_back(surface.texture);
    }
    Visual visual;
    visual.name = "room";
    visual.mesh = int(scene.visual_meshes.size());
    visual.material = int(scene.materials.size());
    visual.casts_shadow_on_receivers = false;
    scene.materials.push_back(material);
    scene.visual_meshes.push_back(surface.mesh);
    scene.visuals.push_back(visual);
  }
  scene.cameras.assign(cameras.begin(), cameras.end());
  if (kind == VisualMaterial::Kind::diffuse) scene.environment = Vec3f::Ones();
  return scene;
}

namespace {

RenderSettings one_ray_per_pixel() {
  RenderSettings settings;
  settings.samples = 1;
  settings.max_depth = 1;
  return settings;
}

constexpr std::size_t FEWEST_PIXELS = 1000;  // that a photo's table is fitted to

// each camera on a body of its own, which moves it
Scene with_movable_cameras(Scene scene) {
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    scene.rigid_bodies.emplace_back().pose = scene.cameras[i].pose;
    scene.cameras[i].rigid = int(i);
    scene.cameras[i].pose = Pose::Identity();
  }
  return scene;
}

std::vector<Camera> color_cameras(std::span<const CaptureFrame> frames) {
  std::vector<Camera> cameras;
  for (const CaptureFrame& frame : frames) cameras.push_back(frame.color_camera);
  return cameras;
}

std::vector<CapturedSurface> without_textures(std::span<const VisualMesh> meshes) {
  std::vector<CapturedSurface> surfaces;
  for (const VisualMesh& mesh : meshes) surfaces.push_back({mesh, {}});
  return surfaces;
}

}  // namespace

SurfaceViews::SurfaceViews(Device& device, std::span<const VisualMesh> meshes, std::span<const Camera> cameras)
    : scene_(scene_of(without_textures(meshes), VisualMaterial::Kind::shadow_receiver, cameras)),
      renderer_(device, scene_, one_ray_per_pixel()) {
  renderer_.set_state(initial_state(scene_));
}

DepthPicture SurfaceViews::depth(std::size_t camera) {
  RenderedFrame frame = renderer_.render(int(camera), 0);
  for (float& z : frame.depth)
    if (!std::isfinite(z)) z = 0;
  return {frame.width, frame.height, std::move(frame.depth)};
}

PhotoViews::PhotoViews(Device& device, std::span<const CaptureFrame> frames, std::span<const CapturedSurface> surfaces,
                       VisualMaterial::Kind kind, const RenderSettings& settings)
    : scene_(with_movable_cameras(scene_of(surfaces, kind, color_cameras(frames)))),
      renderer_(device, scene_, settings) {
  for (const CaptureFrame& frame : frames) {
    std::vector<float>& photo = photos_.emplace_back();
    for (const std::uint8_t byte : color_of(frame).rgb) photo.push_back(srgb_to_linear(float(byte) / 255));
  }
}

PhotoView PhotoViews::at(std::size_t frame, const Pose& camera) {
  SceneState state = initial_state(scene_);
  state.rigid[frame] = camera.matrix().topRows<3>();
  renderer_.set_state(state);
  RenderedFrame drawn = renderer_.render(int(frame), 0);
  PhotoView view{drawn.width, drawn.height, photos_[frame], std::move(drawn.rgb), std::move(drawn.depth), {}, {}};
  for (const std::uint32_t instance : drawn.instance) {
    view.is_covered.push_back(instance == 1);
    view.is_drawn.push_back(instance != 0);
  }
  return view;
}

std::optional<Lut> own_lut(const PhotoView& view) {
  const PicturePair pair{view.width, view.height, view.rendered, view.photo};
  std::vector<bool> use = valid_pixels(pair);
  for (std::size_t i = 0; i < use.size(); ++i) use[i] = use[i] && view.is_drawn[i];
  if (std::size_t(std::count(use.begin(), use.end(), true)) < FEWEST_PIXELS) return std::nullopt;
  return fit_lut({&pair, 1}, {&use, 1});
}

void apply_lut(const Lut& lut, PhotoView& view) {
  apply_lut(lut, view.rendered);
  for (std::size_t i = 0; i < view.is_drawn.size(); ++i)
    for (std::size_t k = 0; !view.is_drawn[i] && k < 3; ++k) view.rendered[3 * i + k] = 0;
}

}  // namespace pvg

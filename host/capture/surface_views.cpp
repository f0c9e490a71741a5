#include "host/capture/surface_views.hpp"

#include <cmath>

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

}  // namespace pvg

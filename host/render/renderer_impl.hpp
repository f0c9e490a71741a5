// What a renderer holds. Internal to host/render.
#pragma once
#include <optional>

#include "host/render/denoiser.hpp"
#include "host/render/geometry.hpp"
#include "host/render/lights.hpp"
#include "host/render/look.hpp"
#include "host/render/picture_finish.hpp"
#include "host/render/renderer.hpp"
#include "host/render/soft_visual.hpp"
#include "host/render/stages.hpp"

namespace pvg {

struct Renderer::Impl {
  struct Shown {  // a Visual or a light, one instance each: visuals, rectangle lights, sphere lights
    std::string name;
    MeshRange mesh;
    int soft = -1;            // index into soft_visuals
    std::int32_t light = -1;  // of a shining visual: its first triangle's
  };

  // renderer_scene.cpp
  Impl(Device& device_, const Scene& scene_, const RenderSettings& settings_);
  Shown add_visual(const Visual& visual, GeometryArrays& geometry);
  void add_lights(GeometryArrays& geometry);
  std::vector<ShiningMesh> shining_meshes() const;
  Eigen::Matrix<double, 3, 4> visual_pose(const Visual& visual, const SceneState& state) const;
  Instance visual_instance(std::size_t visual, const SceneState& state) const;
  Instance light_instance(std::size_t light) const;  // rectangles, then spheres
  void move_to(const SceneState& state);
  void show_readings(const SceneState& state);
  void aim_light_paths();  // at what is mirror-like where everything stands

  // renderer.cpp
  Launch begin_launch(int camera, std::uint32_t frame);
  // samples first_sample .. of the pixels first .. last - 1 of a list, into the film
  std::uint64_t add_samples(Launch launch, const Buffer<std::uint32_t>& pixels, std::uint32_t first, std::uint32_t last,
                            int first_sample, int n_samples);
  // light paths of the samples first_sample .. of a picture, into the film's splats
  std::uint64_t add_light_paths(const Launch& launch, int first_sample, int n_samples);
  std::uint64_t add_adaptive_samples(const Launch& launch, float exposure);
  std::uint64_t add_moving_samples(int camera, std::uint32_t frame, const std::function<SceneState(double)>& at,
                                   double time);
  void find_ground_truth(Launch launch);
  void read_features(RenderedFrame& picture) const;
  RenderedFrame take_picture(const Launch& launch, int camera, std::uint64_t rays);
  RenderedFrame read_film(int camera) const;
  RenderedFrame trace(int camera, std::uint32_t frame);
  void check_camera_index(int camera) const;

  Device& device;
  Scene scene;  // without its geometry and textures
  RenderSettings settings;
  std::vector<Shown> shown;
  std::vector<MeshRange> meshes;  // [Scene::visual_meshes], filled when first used
  std::vector<bool> mesh_is_packed;
  std::vector<SoftVisual> soft_visuals;
  std::vector<Instance> instances;
  std::vector<Box> boxes;
  std::vector<Eigen::Matrix4d> camera_poses;
  SceneState state;                  // that everything stands in
  std::vector<std::string> figures;  // [Scene::displays] shown
  Look look;
  bool traces_light;  // of lamps over mirror-like things onto others
  LightList lights;
  bool has_insides = false;  // of materials that a camera could be inside of
  std::unique_ptr<DeviceScene> on_device;
  std::shared_ptr<PictureFinish> finish;
  std::optional<Denoiser> denoiser;  // of renderers that denoise, where the library is not there
  Stages stages;
  Film film;
  Buffer<std::uint32_t> chosen;  // pixels that get more samples
  int last_camera = -1;          // whose ground truth the film holds
};

}  // namespace pvg

// A picture: every visual is moved to its body, the tree over instances rebuilt, then batches of paths run through the
// stages (stages.cpp) into the film.
#include "host/render/renderer.hpp"

#include <algorithm>
#include <cmath>

#include "host/render/camera.hpp"
#include "host/render/geometry.hpp"
#include "host/render/look.hpp"
#include "host/render/soft_visual.hpp"
#include "host/render/stages.hpp"

namespace pvg {
namespace {

// as hash_u32 in kernels/shared/rng.cl
std::uint32_t hash_u32(std::uint32_t x) {
  const std::uint32_t state = x * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
  return (word >> 22) ^ word;
}
std::uint32_t picture_key(std::uint64_t seed, std::uint32_t frame, std::uint32_t camera) {
  std::uint32_t key = 0;
  for (const std::uint32_t part : {std::uint32_t(seed), std::uint32_t(seed >> 32), frame, camera})
    key = hash_u32(key ^ hash_u32(part));
  return key;
}

void check_index(int index, std::size_t n, const std::string& visual, const char* what) {
  if (index >= int(n)) throw UsageError("visual " + visual + ": its " + what + " does not exist");
}

// the unit square, which a light's edges carry to its place
VisualMesh unit_square() {
  VisualMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

}  // namespace

SceneState initial_state(const Scene& scene) {
  SceneState state;
  for (const RigidBody& body : scene.rigid_bodies) state.rigid.push_back(body.pose.matrix().topRows<3>());
  for (const SoftBody& body : scene.soft_bodies) {
    state.soft.emplace_back();
    for (const Vec3& point : body.mesh.points) state.soft.back().push_back(body.pose * point);
  }
  for (const Cloth& cloth : scene.cloths) {
    state.cloth.emplace_back();
    for (const Vec3& point : cloth.mesh.points) state.cloth.back().push_back(cloth.pose * point);
  }
  return state;
}

struct Renderer::Impl {
  struct Shown {  // a Visual or a light, one instance each
    std::string name;
    MeshRange mesh;
    int soft = -1;  // index into soft_visuals
  };

  Impl(Device& device_, const Scene& scene_, const RenderSettings& settings_);
  Shown add_visual(const Visual& visual, GeometryArrays& geometry);
  void add_lights(GeometryArrays& geometry);
  Eigen::Matrix<double, 3, 4> visual_pose(const Visual& visual, const SceneState& state) const;
  Instance visual_instance(std::size_t visual, const SceneState& state) const;
  Instance light_instance(std::size_t light) const;
  Launch begin_launch(int camera, std::uint32_t frame) const;
  RenderedFrame read_film(int camera) const;

  Device& device;
  Scene scene;  // without its geometry
  RenderSettings settings;
  std::vector<Shown> shown;
  std::vector<MeshRange> meshes;  // [Scene::visual_meshes], filled when first used
  std::vector<bool> mesh_is_packed;
  std::vector<SoftVisual> soft_visuals;
  std::vector<Instance> instances;
  std::vector<Box> boxes;
  std::vector<Eigen::Matrix4d> camera_poses;
  Look look;
  std::unique_ptr<DeviceScene> on_device;
  Stages stages;
  Film film;
};

Renderer::Impl::Impl(Device& device_, const Scene& scene_, const RenderSettings& settings_)
    : device(device_), scene(scene_), settings(settings_), look(make_look(scene_)), stages(device_), film(device_) {
  if (settings.samples < 1 || settings.samples > 1 << 16)
    throw UsageError("samples is " + std::to_string(settings.samples) + "; 1 to 65536 paths per pixel");
  if (settings.max_depth < 0 || settings.max_depth > 1000)
    throw UsageError("max_depth is " + std::to_string(settings.max_depth) + "; 0 to 1000 bounces");
  for (const Camera& camera : scene.cameras) check_camera(camera);
  GeometryArrays geometry;
  meshes.resize(scene.visual_meshes.size());
  mesh_is_packed.resize(scene.visual_meshes.size());
  for (const Visual& visual : scene.visuals) shown.push_back(add_visual(visual, geometry));
  if (!scene.lights.empty()) add_lights(geometry);
  instances.resize(shown.size());
  boxes.resize(shown.size());
  on_device = std::make_unique<DeviceScene>(DeviceScene{
      {Buffer<BvhNode>(device, 0, "top"), Buffer<BvhNode>(device, geometry.nodes, "nodes"),
       Buffer<TriangleBlock>(device, geometry.blocks, "blocks"), Buffer<Instance>(device, shown.size(), "instances")},
      Buffer<std::uint32_t>(device, geometry.triangles, "triangles"),
      Buffer<Vertex>(device, geometry.vertices, "vertices"),
      Buffer<Material>(device, look.materials, "materials"),
      Buffer<TextureInfo>(device, look.textures, "textures"),
      Buffer<std::uint32_t>(device, look.texels, "texels"),
      Buffer<float>(device, look.decode, "decode"),
      Buffer<Light>(device, look.lights, "lights")});
  scene.visual_meshes.clear();
  scene.textures.clear();
}

Renderer::Impl::Shown Renderer::Impl::add_visual(const Visual& visual, GeometryArrays& geometry) {
  if (visual.material < 0) throw UsageError("visual " + visual.name + ": it has no material");
  check_index(visual.material, scene.materials.size(), visual.name, "material");
  check_index(visual.rigid, scene.rigid_bodies.size(), visual.name, "rigid body");
  check_index(visual.soft, scene.soft_bodies.size(), visual.name, "soft body");
  check_index(visual.cloth, scene.cloths.size(), visual.name, "cloth");
  check_index(visual.mesh, scene.visual_meshes.size(), visual.name, "mesh");
  Shown entry;
  entry.name = visual.name;
  if (visual.soft >= 0 || visual.cloth >= 0) {
    if (visual.mesh >= 0)
      throw UsageError("visual " + visual.name +
                       ": a soft body or cloth is shown by its own surface; leave its mesh out");
    entry.soft = int(soft_visuals.size());
    if (visual.soft >= 0) {
      const SoftBody& body = scene.soft_bodies[visual.soft];
      soft_visuals.emplace_back(device, body.name, body.mesh.points, body.mesh.surface, visual);
    } else {
      const Cloth& cloth = scene.cloths[visual.cloth];
      soft_visuals.emplace_back(device, cloth.name, cloth.mesh.points, cloth.mesh.triangles, visual);
    }
    entry.mesh = geometry.add(soft_visuals.back().mesh(), visual.name, true);
    return entry;
  }
  if (visual.mesh < 0) throw UsageError("visual " + visual.name + ": it has no mesh");
  if (!mesh_is_packed[visual.mesh]) {
    meshes[visual.mesh] = geometry.add(scene.visual_meshes[visual.mesh], visual.name);
    mesh_is_packed[visual.mesh] = true;
  }
  entry.mesh = meshes[visual.mesh];
  return entry;
}

void Renderer::Impl::add_lights(GeometryArrays& geometry) {
  const MeshRange square = geometry.add(unit_square(), "light");
  for (const RectangleLight& light : scene.lights) shown.push_back({light.name, square, -1});
}

Eigen::Matrix<double, 3, 4> Renderer::Impl::visual_pose(const Visual& visual, const SceneState& state) const {
  if (visual.soft >= 0 || visual.cloth >= 0) return Pose::Identity().matrix().topRows<3>();
  if (visual.rigid < 0) return visual.pose.matrix().topRows<3>();
  Eigen::Matrix4d body = Eigen::Matrix4d::Identity();
  body.topRows<3>() = state.rigid[visual.rigid];
  return (body * visual.pose.matrix()).topRows<3>();
}

Instance Renderer::Impl::visual_instance(std::size_t i, const SceneState& state) const {
  const Visual& visual = scene.visuals[i];
  Instance instance = make_instance(visual_pose(visual, state), shown[i].mesh, visual.name);
  instance.material = look.material_of[visual.material];
  instance.visual = std::uint32_t(i + 1);
  instance.mask = MASK_SURFACES | (visual.casts_shadow_on_receivers ? MASK_RECEIVERS : 0u);
  if (scene.materials[visual.material].kind == VisualMaterial::Kind::dielectric) instance.flags |= INSTANCE_CLEAR;
  return instance;
}

Instance Renderer::Impl::light_instance(std::size_t i) const {
  const RectangleLight& light = scene.lights[i];
  Eigen::Matrix<double, 3, 4> to_world;
  to_world << light.edge_u, light.edge_v, light.edge_u.cross(light.edge_v).normalized(), light.corner;
  Instance instance = make_instance(to_world, shown[scene.visuals.size() + i].mesh, light.name);
  instance.light = int(i);
  instance.mask = MASK_SURFACES;
  return instance;
}

Launch Renderer::Impl::begin_launch(int camera, std::uint32_t frame) const {
  const Camera& seen_by = scene.cameras[camera];
  Launch launch{};
  launch.camera = pinhole_camera(seen_by, camera_poses[camera]);
  launch.key = picture_key(settings.seed, frame, std::uint32_t(camera));
  launch.n_lights = std::uint32_t(look.lights.size());
  launch.max_depth = std::uint32_t(settings.max_depth);
  launch.transparent_shadows = settings.transparent_shadows;
  launch.receiver_scale = 1.0f / seen_by.exposure;
  for (int c = 0; c < 3; ++c) launch.environment[c] = scene.environment[c];
  return launch;
}

RenderedFrame Renderer::Impl::read_film(int camera) const {
  const Camera& seen_by = scene.cameras[camera];
  RenderedFrame picture;
  picture.width = seen_by.width;
  picture.height = seen_by.height;
  picture.depth = film.depth.read();
  picture.instance = film.instance.read();
  picture.normal = film.normal.read();
  const std::vector<F32x4> sums = film.sum.read();
  picture.rgb.resize(3 * sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    // a pixel that lost all its samples is black; dropped_samples tells
    const float scale = sums[i].v[3] > 0 ? seen_by.exposure / sums[i].v[3] : 0.0f;
    for (int c = 0; c < 3; ++c) picture.rgb[3 * i + c] = sums[i].v[c] * scale;
  }
  for (const std::uint32_t dropped : film.dropped.read()) picture.dropped_samples += dropped;
  return picture;
}

Renderer::Renderer(Device& device, const Scene& scene, const RenderSettings& settings)
    : impl_(std::make_unique<Impl>(device, scene, settings)) {
  set_state(initial_state(scene));
}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

void Renderer::set_state(const SceneState& state) {
  Impl& r = *impl_;
  const Scene& scene = r.scene;
  if (state.rigid.size() != scene.rigid_bodies.size() || state.soft.size() != scene.soft_bodies.size() ||
      state.cloth.size() != scene.cloths.size())
    throw UsageError("the state has " + std::to_string(state.rigid.size()) + " rigid and " +
                     std::to_string(state.soft.size()) + " soft bodies and " + std::to_string(state.cloth.size()) +
                     " cloths, the scene to be rendered " + std::to_string(scene.rigid_bodies.size()) + ", " +
                     std::to_string(scene.soft_bodies.size()) + " and " + std::to_string(scene.cloths.size()));
  const std::size_t n_visuals = scene.visuals.size();
  for (std::size_t i = 0; i < r.shown.size(); ++i) {
    Impl::Shown& shown = r.shown[i];
    r.instances[i] = i < n_visuals ? r.visual_instance(i, state) : r.light_instance(i - n_visuals);
    Box box = shown.mesh.box;
    if (shown.soft >= 0) {
      const Visual& visual = scene.visuals[i];
      const std::vector<Vec3>& nodes = visual.soft >= 0 ? state.soft[visual.soft] : state.cloth[visual.cloth];
      box = r.soft_visuals[shown.soft].follow(nodes, shown.mesh, *r.on_device);
    }
    r.boxes[i] = world_box(r.instances[i], box);
  }
  const std::vector<BvhNode> top = build_instance_tree(r.boxes);
  r.on_device->trees.top.resize(top.size());
  r.on_device->trees.top.write(top);
  r.on_device->trees.instances.write(r.instances);
  r.camera_poses.clear();
  for (const Camera& camera : scene.cameras) r.camera_poses.push_back(camera_to_world(camera, state));
}

RenderedFrame Renderer::render(int camera, std::uint32_t frame) {
  Impl& r = *impl_;
  if (camera < 0 || camera >= int(r.scene.cameras.size()))
    throw UsageError("the scene has " + std::to_string(r.scene.cameras.size()) + " cameras, number " +
                     std::to_string(camera) + " was asked for");
  std::uint64_t rays = 0;
  Launch launch = r.begin_launch(camera, frame);
  const std::uint32_t n_pixels = launch.camera.width * launch.camera.height;
  r.film.begin(n_pixels);

  launch.n_samples = std::uint32_t(r.settings.samples);
  launch.n_pixels = std::uint32_t(std::max<std::size_t>(1, Stages::MAX_PATHS / launch.n_samples));
  const std::uint32_t batch = launch.n_pixels;
  for (launch.first_pixel = 0; launch.first_pixel < n_pixels; launch.first_pixel += batch) {
    launch.n_pixels = std::min(batch, n_pixels - launch.first_pixel);
    rays += r.stages.trace(launch, *r.on_device, r.film);
  }
  launch.is_center = 1;
  launch.n_samples = 1;
  for (launch.first_pixel = 0; launch.first_pixel < n_pixels; launch.first_pixel += Stages::MAX_PATHS) {
    launch.n_pixels = std::min(std::uint32_t(Stages::MAX_PATHS), n_pixels - launch.first_pixel);
    r.stages.find_ground_truth(launch, *r.on_device, r.film);
  }

  RenderedFrame picture = r.read_film(camera);
  picture.rays = rays;
  return picture;
}

Eigen::Matrix4d Renderer::camera_pose(int camera) const { return impl_->camera_poses.at(std::size_t(camera)); }

}  // namespace pvg

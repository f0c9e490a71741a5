// What a renderer makes of a scene, and how it moves: geometry, instances, lights.
#include <Eigen/SVD>
#include <algorithm>
#include <cstring>

#include "host/base/counted.hpp"
#include "host/base/notes.hpp"
#include "host/model/camera_inside.hpp"
#include "host/model/display.hpp"
#include "host/render/camera.hpp"
#include "host/render/renderer_impl.hpp"

namespace pvg {
namespace {

// light of lamps over glass and mirrors is asked for, and there are such things
bool needs_light_tracing(const Scene& scene, const Look& look, const RenderSettings& settings) {
  if (settings.transparent_shadows) return false;
  bool has_lamps = !scene.lights.empty() || !scene.sphere_lights.empty(), has_mirrors = false;
  for (const Visual& visual : scene.visuals) {
    if (visual.material < 0 || visual.material >= int(scene.materials.size())) continue;  // refused later
    has_lamps |= shines(scene.materials[std::size_t(visual.material)]);
    has_mirrors |= is_mirror_like(look.materials[look.material_of[std::size_t(visual.material)]]);
  }
  return has_lamps && has_mirrors;
}

void check_index(int index, std::size_t n, const std::string& visual, const char* what) {
  if (index >= int(n)) throw UsageError("visual " + visual + ": its " + what + " does not exist");
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
  state.reading = unloaded_readings(scene);
  return state;
}

Renderer::Impl::Impl(Device& device_, const Scene& scene_, const RenderSettings& settings_)
    : device(device_),
      scene(scene_),
      settings(settings_),
      look(make_look(scene_)),
      traces_light(needs_light_tracing(scene_, look, settings_)),
      finish(std::make_shared<PictureFinish>(scene_, settings_, device.info().is_gpu)),
      stages(device_, settings.denoises || settings.notes_features, traces_light,
             settings.is_wavefront || device_.info().is_gpu),
      film(device_),
      chosen(device_, 0, "chosen") {
  if (settings.samples < 1 || settings.samples > 1 << 16)
    throw UsageError("samples is " + std::to_string(settings.samples) + "; 1 to 65536 paths per pixel");
  if (settings.max_depth < 0 || settings.max_depth > 1000)
    throw UsageError("max_depth is " + std::to_string(settings.max_depth) + "; 0 to 1000 bounces");
  for (const Camera& camera : scene.cameras) check_camera(camera);
  if (settings.denoises || settings.notes_features) film.guides.emplace(device);
  if (traces_light) film.splats.emplace(device, 0, "splats");
  if (settings.denoises && !finish->denoises()) {
    denoiser.emplace(device);
    tell_note(std::string("Open Image Denoise is not here (scripts/install_denoiser.sh installs it); ") + OWN_DENOISER +
              " takes its place, which leaves more noise");
  }
  for (const Camera& camera : scene.cameras)
    if (settings.is_adaptive && (camera.exposure_time > 0 || camera.row_time > 0))
      tell_note("camera " + camera.name +
                " has an exposure time or a rolling shutter; its samples are even, not adaptive, while things move");
  for (const std::string& sentence : cameras_inside(scene)) tell_note(sentence);
  GeometryArrays geometry;
  meshes.resize(scene.visual_meshes.size());
  mesh_is_packed.resize(scene.visual_meshes.size());
  for (const Visual& visual : scene.visuals) shown.push_back(add_visual(visual, geometry));
  add_lights(geometry);
  lights = make_lights(scene, shining_meshes());
  std::size_t n_shining = 0;
  for (std::size_t i = 0; i < scene.visuals.size(); ++i)
    if (shines(scene.materials[scene.visuals[i].material])) shown[i].light = lights.first_of_mesh[n_shining++];
  for (const Material& material : look.materials) has_insides |= (material.flags & MATERIAL_HAS_INSIDE) != 0;
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
      Buffer<float>(device, geometry.colors, "colors"),
      Buffer<float>(device, geometry.second_uvs, "second_uvs"),
      Buffer<Light>(device, lights.lights, "lights"),
      Buffer<float>(device, scene.environment_map.rgb, "environment"),
      Buffer<EnvironmentCell>(device, environment_cells(scene.environment_map), "cells"),
      Buffer<F32x4>(device, 0, "targets")});
  for (const Visual& visual : scene.visuals) on_device->has_cutouts |= is_cut_out(scene.materials[visual.material]);
  for (const Material& material : look.materials)
    on_device->has_clear_solids |= material.kind == MATERIAL_DIELECTRIC && (material.flags & MATERIAL_HAS_INSIDE) != 0;
  scene.visual_meshes.clear();
  scene.textures.clear();
  scene.environment_map.rgb.clear();
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
    entry.soft = int(soft_visuals.size());
    soft_visuals.emplace_back(device, carried_mesh(scene, visual));
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
  if (!scene.lights.empty()) {
    const MeshRange square = geometry.add(light_square(), "light");
    for (const RectangleLight& light : scene.lights) shown.push_back({light.name, square});
  }
  if (scene.sphere_lights.empty()) return;
  const MeshRange sphere = geometry.add(light_sphere(), "light");
  for (const SphereLight& light : scene.sphere_lights) shown.push_back({light.name, sphere});
}

std::vector<ShiningMesh> Renderer::Impl::shining_meshes() const {
  std::vector<ShiningMesh> meshes_that_shine;
  const SceneState start = initial_state(scene);
  for (std::size_t i = 0; i < scene.visuals.size(); ++i) {
    const Visual& visual = scene.visuals[i];
    const VisualMaterial& material = scene.materials[visual.material];
    if (!shines(material)) continue;
    ShiningMesh mesh;
    mesh.instance = std::uint32_t(i);
    mesh.first_triangle = shown[i].mesh.first_triangle;
    mesh.emission = mean_emission(scene, material);
    const VisualMesh& surface =
        shown[i].soft >= 0 ? soft_visuals[shown[i].soft].mesh() : scene.visual_meshes[visual.mesh];
    const Eigen::Matrix3d A = visual_pose(visual, start).leftCols<3>();
    for (const Triangle& t : surface.triangles) {
      const Vec3 p = surface.points[t[0]].cast<double>();
      const Vec3 e = A * (surface.points[t[1]].cast<double>() - p), f = A * (surface.points[t[2]].cast<double>() - p);
      mesh.areas.push_back(e.cross(f).norm() / 2);
    }
    meshes_that_shine.push_back(std::move(mesh));
  }
  return meshes_that_shine;
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
  if (shown[i].light >= 0) {
    instance.flags |= INSTANCE_SHINES;
    instance.light = shown[i].light - std::int32_t(shown[i].mesh.first_triangle);
  }
  const Material& material = look.materials[instance.material];
  if (material.kind == MATERIAL_DIELECTRIC) instance.flags |= INSTANCE_CLEAR;
  if (material.flags & (MATERIAL_MASK | MATERIAL_BLEND)) {
    instance.flags |= INSTANCE_CUTOUT;
    instance.mask <<= MASK_CUTOUT_SHIFT;
  }
  return instance;
}

Instance Renderer::Impl::light_instance(std::size_t i) const {
  Eigen::Matrix<double, 3, 4> to_world;
  if (i < scene.lights.size()) {
    const RectangleLight& light = scene.lights[i];
    to_world << light.edge_u, light.edge_v, light.edge_u.cross(light.edge_v).normalized(), light.corner;
  } else {
    const SphereLight& light = scene.sphere_lights[i - scene.lights.size()];
    to_world << light.radius * Eigen::Matrix3d::Identity(), light.center;
  }
  const Shown& entry = shown[scene.visuals.size() + i];
  Instance instance = make_instance(to_world, entry.mesh, entry.name);
  instance.light = std::int32_t(i);
  instance.mask = MASK_SURFACES;
  return instance;
}

void Renderer::Impl::aim_light_paths() {
  constexpr float MARGIN = 1.0001f;  // of rounding
  std::vector<F32x4> targets;
  for (std::size_t i = 0; i < scene.visuals.size(); ++i) {
    if (!is_mirror_like(look.materials[instances[i].material])) continue;
    const Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>> to_world(instances[i].to_world);
    Vec3f center = 0.5f * (boxes[i].lo + boxes[i].hi);
    float radius = 0.5f * (boxes[i].hi - boxes[i].lo).norm();
    if (shown[i].soft < 0) {  // a mesh that keeps its shape: a closer sphere
      const Eigen::JacobiSVD<Eigen::Matrix3f> svd(Eigen::Matrix3f(to_world.leftCols<3>()));
      center = to_world.leftCols<3>() * (0.5f * (shown[i].mesh.box.lo + shown[i].mesh.box.hi)) + to_world.col(3);
      radius = svd.singularValues()(0) * shown[i].mesh.radius;
    }
    targets.push_back({{center.x(), center.y(), center.z(), MARGIN * radius}});
  }
  on_device->targets.resize(targets.size());
  on_device->targets.write(targets);
}

// Lights are chosen by their mean emission at the start, which only weighs the samples: other figures have no bias.
void Renderer::Impl::show_readings(const SceneState& target) {
  figures.resize(scene.displays.size());
  for (std::size_t i = 0; i < scene.displays.size(); ++i) {
    const Display& display = scene.displays[i];
    std::string now = shown_figures(display, target.reading[i]);
    if (now == figures[i]) continue;
    figures[i] = std::move(now);
    const Texture picture = face_picture(display, figures[i]);
    std::vector<std::uint32_t> texels(picture.rgba.size() / 4);
    std::memcpy(texels.data(), picture.rgba.data(), picture.rgba.size());
    on_device->texels.write(look.textures[std::size_t(display.texture)].first, std::span<const std::uint32_t>(texels));
  }
}

void Renderer::Impl::move_to(const SceneState& target) {
  if (target.rigid.size() != scene.rigid_bodies.size() || target.soft.size() != scene.soft_bodies.size() ||
      target.cloth.size() != scene.cloths.size())
    throw UsageError("the state has " + std::to_string(target.rigid.size()) + " rigid and " +
                     counted(target.soft.size(), "soft body", "soft bodies") + " and " +
                     counted(target.cloth.size(), "cloth") + ", the scene to be rendered " +
                     std::to_string(scene.rigid_bodies.size()) + ", " + std::to_string(scene.soft_bodies.size()) +
                     " and " + std::to_string(scene.cloths.size()));
  if (target.reading.size() != scene.displays.size())
    throw UsageError("the state has " + counted(target.reading.size(), "reading") + ", the scene to be rendered " +
                     counted(scene.displays.size(), "display"));
  const std::size_t n_visuals = scene.visuals.size();
  for (std::size_t i = 0; i < shown.size(); ++i) {
    Shown& entry = shown[i];
    instances[i] = i < n_visuals ? visual_instance(i, target) : light_instance(i - n_visuals);
    Box box = entry.mesh.box;
    if (entry.soft >= 0) {
      const Visual& visual = scene.visuals[i];
      const std::vector<Vec3>& nodes = visual.soft >= 0 ? target.soft[visual.soft] : target.cloth[visual.cloth];
      box = soft_visuals[entry.soft].follow(nodes, entry.mesh, *on_device);
    }
    boxes[i] = world_box(instances[i], box);
  }
  const std::vector<BvhNode> top = build_instance_tree(boxes);
  on_device->trees.top.resize(top.size());
  on_device->trees.top.write(top);
  on_device->trees.instances.write(instances);
  if (traces_light) aim_light_paths();
  show_readings(target);
  camera_poses.clear();
  for (const Camera& camera : scene.cameras) camera_poses.push_back(camera_to_world(camera, target));
  state = target;
}

}  // namespace pvg

#include "host/identify/sensing/file_contents.hpp"

#include <span>

#include "host/identify/sensing/prediction_bytes.hpp"

namespace pvg::diagnose {
namespace {

void put_each(std::vector<char>& bytes, const auto&... numbers) { (put(bytes, numbers), ...); }

// values: numbers, or vectors of numbers without gaps
template <class T>
void put_all(std::vector<char>& bytes, const std::vector<T>& values) {
  put(bytes, values.size());
  const char* first = reinterpret_cast<const char*>(values.data());
  bytes.insert(bytes.end(), first, first + sizeof(T) * values.size());
}

void put_pose(std::vector<char>& bytes, const Pose& pose) {
  for (const double x : pose.matrix().reshaped()) put(bytes, x);
}

void put_color(std::vector<char>& bytes, const Vec3f& color) {
  for (const float x : color) put(bytes, x);
}

// a glTF file brings its own
void put_material(std::vector<char>& bytes, const VisualMaterial& m) {
  for (const Vec3f* color : {&m.color, &m.absorption, &m.emission}) put_color(bytes, *color);
  put_each(bytes, m.kind, m.texture, m.roughness, m.index_of_refraction, m.shadow_strength, m.metallic, m.transmission,
           m.is_thin, m.priority, m.metallic_roughness_texture, m.normal_texture, m.emission_texture, m.normal_scale,
           m.on_second_uvs, m.alpha_mode, m.opacity, m.alpha_cutoff);
#define PUT_COLOR(name, ...) put_color(bytes, m.name);
#define PUT_NUMBER(name, ...) put(bytes, m.name);
  PVG_KIND_COLORS(PUT_COLOR)
  PVG_KIND_NUMBERS(PUT_NUMBER)
#undef PUT_COLOR
#undef PUT_NUMBER
}

void put_camera(std::vector<char>& bytes, const Camera& c) {
  put_each(bytes, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.model, c.rigid);
  put_all(bytes, c.distortion);
  put_pose(bytes, c.pose);
}

}  // namespace

void put_meshes(std::vector<char>& bytes, const PhysicalScene& scene) {
  for (const RigidBody& body : scene.rigid_bodies) put_all(bytes, body.collision.triangles);
  for (const SoftBody& body : scene.soft_bodies) {
    put_all(bytes, body.mesh.elements);
    put_all(bytes, body.mesh.surface);
  }
  for (const Cloth& cloth : scene.cloths) put_all(bytes, cloth.mesh.triangles);
}

void put_look(std::vector<char>& bytes, const Appearance& seen) {
  for (const Texture& texture : seen.textures) {
    put_each(bytes, texture.width, texture.height);
    put_all(bytes, texture.rgba);
  }
  for (const VisualMaterial& material : seen.materials) put_material(bytes, material);
  for (const VisualMesh& mesh : seen.visual_meshes) {
    put_all(bytes, mesh.points);
    put_all(bytes, mesh.normals);
    put_all(bytes, mesh.uvs);
    put_all(bytes, mesh.second_uvs);
    put_all(bytes, mesh.colors);
    put_all(bytes, mesh.triangles);
  }
  for (const Visual& visual : seen.visuals) {
    put_each(bytes, visual.mesh, visual.material);
    put_pose(bytes, visual.pose);
  }
  put_each(bytes, seen.environment_map.width, seen.environment_map.height);
  put_all(bytes, seen.environment_map.rgb);
  for (const Camera& camera : seen.cameras) put_camera(bytes, camera);
}

void put_lut(std::vector<char>& bytes, const std::optional<Lut>& lut) {
  put(bytes, lut.has_value());
  if (lut) put(bytes, lut->value);
}

}  // namespace pvg::diagnose

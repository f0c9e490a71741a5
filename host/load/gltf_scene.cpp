// A glTF file as parts with materials, cameras and lights.
#include "host/load/gltf_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "host/base/error.hpp"
#include "host/formats/gltf_nodes.hpp"
#include "host/load/gltf_materials.hpp"
#include "host/load/gltf_views.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

// The texture coordinates that a layout makes of a part's sets; empty where the part has none at all.
std::vector<Vec2f> laid_out(const GltfPrimitive& part, const TextureLayout& layout, const std::string& material,
                            const fs::path& file) {
  const std::vector<Vec2f>& from = layout.set == 0 ? part.mesh.uvs : part.second_uvs;
  if (from.empty() && layout.set == 1)
    throw UsageError(file.string() + ": a texture of material `" + material + "` uses texCoord 1, but its mesh `" +
                     part.name + "` has no TEXCOORD_1.");
  std::vector<Vec2f> to;
  to.reserve(from.size());
  for (const Vec2f& uv : from)
    to.push_back((layout.map.leftCols<2>() * uv.cast<double>() + layout.map.col(2)).cast<float>());
  return to;
}

// the node's name, or the thing's own, or a number
std::string name_of(const GltfPlaced& placed, const std::string& own, const char* otherwise, std::size_t number) {
  if (!placed.name.empty()) return placed.name;
  return own.empty() ? otherwise + std::to_string(number) : own;
}

// cameras and lights, once the parts are known
void add_views(const tinygltf::Model& model, const GltfNodes& nodes, const fs::path& file, GltfScene& scene) {
  Eigen::AlignedBox3f box;
  for (const GltfPart& part : scene.parts)
    for (const Vec3f& point : part.mesh.points)
      if (point.allFinite()) box.extend(point);
  for (const GltfPlaced& placed : nodes.cameras) {
    const tinygltf::Camera& camera = model.cameras[std::size_t(placed.index)];
    std::string name = name_of(placed, camera.name, "camera", scene.cameras.size());
    for (const Camera& other : scene.cameras)
      if (other.name == name) name += "_" + std::to_string(scene.cameras.size());
    std::replace(name.begin(), name.end(), '/', '_');  // pictures are named after it
    if (camera.type == "perspective")
      scene.cameras.push_back(read_gltf_camera(camera, placed.to_world, name, file.string()));
    else
      scene.left_out.push_back(file.string() + ": camera `" + name + "` is not a perspective one and is left out");
  }
  const Vec3 center = box.isEmpty() ? Vec3::Zero() : Vec3(box.center().cast<double>());
  const double size = box.isEmpty() ? 1 : std::max(1e-6, double(box.diagonal().norm()));
  for (const GltfPlaced& placed : nodes.lights) {
    const tinygltf::Light& light = model.lights[std::size_t(placed.index)];
    const std::string name = name_of(placed, light.name, "light", scene.lights.size());
    if (light.intensity == 0) continue;
    scene.lights.push_back(read_gltf_light(light, placed.to_world, center, size, name, file.string()));
  }
}

}  // namespace

GltfScene read_gltf_scene(const fs::path& file) {
  const tinygltf::Model model = load_gltf(file);
  GltfScene scene;
  scene.generator = model.asset.generator;
  GltfMaterialReader reader(model, file, scene.textures);
  std::vector<GltfMaterial> materials;
  for (const tinygltf::Material& material : model.materials) materials.push_back(reader.read(material));
  int plain = -1;  // what parts without a material get
  const GltfNodes nodes = read_gltf_nodes(model, file);
  for (const GltfPrimitive& part : nodes.primitives) {
    if (part.mesh.triangles.empty()) continue;
    GltfPart& added = scene.parts.emplace_back();
    added.name = part.name;
    added.material = part.material;
    if (part.material >= int(model.materials.size()))
      throw UsageError(file.string() + ": a mesh names a material that does not exist.");
    if (part.material < 0) {
      if (plain < 0) {
        plain = int(materials.size());
        materials.push_back(reader.read({}));
      }
      added.material = plain;
    }
    for (const Vec3& p : part.mesh.points) added.mesh.points.push_back(p.cast<float>());
    for (const Vec3& n : part.mesh.normals) added.mesh.normals.push_back(n.cast<float>());
    for (Vec3f& n : added.mesh.normals)
      if (!n.allFinite()) n = Vec3f::Zero();  // one of no length: the true normal is taken
    const GltfMaterial& look = materials[std::size_t(added.material)];
    const std::vector<TextureLayout>& layouts = look.layouts;
    added.mesh.uvs = layouts.empty() ? part.mesh.uvs : laid_out(part, layouts[0], look.material.name, file);
    if (layouts.size() > 1) added.mesh.second_uvs = laid_out(part, layouts[1], look.material.name, file);
    added.mesh.colors = part.colors;
    added.mesh.triangles = part.mesh.triangles;
  }
  if (scene.parts.empty()) throw UsageError(file.string() + ": it holds no triangles.");
  for (GltfMaterial& material : materials) scene.materials.push_back(std::move(material.material));
  add_views(model, nodes, file, scene);
  return scene;
}

}  // namespace pvg

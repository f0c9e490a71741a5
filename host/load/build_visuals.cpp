// What is seen: meshes with materials, glTF scenes, the captured background.
#include "host/base/error.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/formats/textures.hpp"
#include "host/load/build_parts.hpp"
#include "host/load/gltf_scene.hpp"

namespace pvg {

int material_index(const Scene& scene, const std::string& name) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (scene.materials[i].name == name) return int(i);
  }
  throw UsageError("There is no material `" + name + "`; add it to `materials`.");
}

namespace {

// the parts of a glTF file, each with the file's own material
void add_parts(Scene& scene, GltfScene gltf, const std::filesystem::path& file, const Visual& visual) {
  const int first_texture = int(scene.textures.size()), first_material = int(scene.materials.size());
  for (Texture& texture : gltf.textures) scene.textures.push_back(std::move(texture));
  for (VisualMaterial& material : gltf.materials) {
    material.name = file.filename().string() + "/" + material.name;
    for (int* index : {&material.texture, &material.metallic_roughness_texture, &material.normal_texture,
                       &material.emission_texture})
      if (*index >= 0) *index += first_texture;
    scene.materials.push_back(std::move(material));
  }
  for (GltfPart& part : gltf.parts) {
    Visual added = visual;
    added.name += "/" + part.name;
    added.mesh = int(scene.visual_meshes.size());
    added.material = first_material + part.material;
    added.casts_shadow_on_receivers =
        scene.materials[std::size_t(added.material)].kind != VisualMaterial::Kind::shadow_receiver;
    scene.visual_meshes.push_back(std::move(part.mesh));
    scene.visuals.push_back(added);
  }
}

}  // namespace

Scene gltf_as_scene(const std::filesystem::path& file, std::vector<std::string>* left_out) {
  GltfScene gltf = read_gltf_scene(file);
  Scene scene;
  scene.name = file.stem().string();
  scene.cameras = std::move(gltf.cameras);
  scene.sphere_lights = std::move(gltf.lights);
  *left_out = std::move(gltf.left_out);
  Visual visual;
  visual.name = visual.part = scene.name;
  add_parts(scene, std::move(gltf), file, visual);
  return scene;
}

void add_visuals(Scene& scene, const std::vector<VisualSection>& sections, const Visual& body, double size) {
  for (const VisualSection& section : sections) {
    Visual visual = body;
    visual.name += "/" + section.mesh.stem().string();
    if (section.material.empty()) {
      add_parts(scene, read_gltf_scene(section.mesh), section.mesh, visual);
      continue;
    }
    visual.mesh = int(scene.visual_meshes.size());
    visual.material = material_index(scene, section.material);
    scene.visual_meshes.push_back(read_visual_mesh(section.mesh, section.crease_angle));
    for (Vec3f& point : scene.visual_meshes.back().points) point *= float(size);
    scene.visuals.push_back(visual);
  }
}

void add_background(Scene& scene, const BackgroundSection& background) {
  if (background.mesh.empty()) return;
  VisualMaterial material;
  material.name = "background";
  material.kind = VisualMaterial::Kind::shadow_receiver;
  material.color = Vec3f::Ones();
  material.texture = int(scene.textures.size());
  material.shadow_strength = background.shadow_strength;
  scene.textures.push_back(read_texture(background.texture));
  Visual visual;
  visual.name = visual.part = "background";
  visual.mesh = int(scene.visual_meshes.size());
  visual.material = int(scene.materials.size());
  visual.pose = background.pose;
  visual.casts_shadow_on_receivers = false;
  scene.materials.push_back(material);
  scene.visual_meshes.push_back(read_visual_mesh(background.mesh, 0));
  if (scene.visual_meshes.back().uvs.empty()) {
    throw UsageError(background.mesh.string() + ": the background has no texture coordinates; export it with them.");
  }
  scene.visuals.push_back(visual);
}

}  // namespace pvg

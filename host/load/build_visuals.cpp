// What is seen: meshes with materials, glTF scenes, the captured background.
#include <algorithm>

#include "host/base/error.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/formats/textures.hpp"
#include "host/load/build_parts.hpp"
#include "host/load/gltf_scene.hpp"
#include "host/model/display.hpp"

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

void add_plain_visual(Scene& scene, const std::filesystem::path& mesh, const Visual& body, double size) {
  constexpr double CREASE_ANGLE = 0.7;  // as of visuals that name none [rad]
  const std::string PLAIN = "plain";
  const auto is_plain = [&](const VisualMaterial& material) { return material.name == PLAIN; };
  auto material = std::find_if(scene.materials.begin(), scene.materials.end(), is_plain);
  if (material == scene.materials.end()) {
    VisualMaterial grey;
    grey.name = PLAIN;
    grey.kind = VisualMaterial::Kind::diffuse;
    grey.color = Vec3f::Constant(0.5f);
    scene.materials.push_back(grey);
    material = scene.materials.end() - 1;
  }
  Visual visual = body;
  visual.name += "/" + mesh.stem().string();
  visual.mesh = int(scene.visual_meshes.size());
  visual.material = int(material - scene.materials.begin());
  scene.visual_meshes.push_back(read_visual_mesh(mesh, CREASE_ANGLE));
  for (Vec3f& point : scene.visual_meshes.back().points) point *= float(size);
  scene.visuals.push_back(visual);
}

namespace {

// a rectangle of the plane z = 0 that looks along z; the texture upright
VisualMesh face_mesh(double width, double height) {
  const float x = float(width / 2), y = float(height / 2);
  VisualMesh mesh;
  mesh.points = {{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}};
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

}  // namespace

void add_display(Scene& scene, const Display& section, int rigid, double size) {
  Display display = section;
  display.rigid = rigid;
  display.name = scene.rigid_bodies[std::size_t(rigid)].name;
  display.width *= size;
  display.height *= size;
  display.pose.translation() *= size;
  display.texture = int(scene.textures.size());
  VisualMaterial material;
  material.name = display.name + "/display";
  material.kind = VisualMaterial::Kind::metallic_roughness;
  material.color = display.color;
  material.roughness = 0.4f;
  material.emission = display.radiance;
  material.emission_texture = display.texture;
  Visual visual;
  visual.name = display.name + "/display";
  visual.part = display.name;
  visual.rigid = rigid;
  visual.pose = display.pose;
  visual.mesh = int(scene.visual_meshes.size());
  visual.material = int(scene.materials.size());
  scene.textures.push_back(face_picture(display, shown_figures(display, -display.tare)));
  scene.materials.push_back(material);
  scene.visual_meshes.push_back(face_mesh(display.width, display.height));
  scene.visuals.push_back(visual);
  scene.displays.push_back(display);
}

namespace {

void look_captured(VisualMaterial& material, const BackgroundSection& background) {
  using Kind = VisualMaterial::Kind;
  material.shadow_strength = background.shadow_strength;
  material.ambient = background.ambient;
  if (material.kind == Kind::shadow_receiver && background.is_relit) material.kind = Kind::diffuse;
}

}  // namespace

void add_background(Scene& scene, const BackgroundSection& background) {
  if (background.mesh.empty()) return;
  if (background.texture.empty()) {
    Visual visual;
    visual.name = visual.part = "background";
    visual.pose = background.pose;
    const std::size_t first = scene.materials.size();
    add_parts(scene, read_gltf_scene(background.mesh), background.mesh, visual);
    for (std::size_t i = first; i < scene.materials.size(); ++i) look_captured(scene.materials[i], background);
    return;
  }
  VisualMaterial material;
  material.name = "background";
  material.kind = VisualMaterial::Kind::shadow_receiver;
  material.color = Vec3f::Ones();
  material.texture = int(scene.textures.size());
  look_captured(material, background);
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

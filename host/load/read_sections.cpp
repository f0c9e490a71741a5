#include "host/load/read_sections.hpp"

namespace pvg {
namespace {

using Section = YamlSection;

struct TextureKey {
  const char* key;
  std::filesystem::path MaterialSection::*file;
  int VisualMaterial::*index;
};
constexpr TextureKey TEXTURES[] = {
    {"texture", &MaterialSection::texture_file, &VisualMaterial::texture},
    {"normal_texture", &MaterialSection::normal_file, &VisualMaterial::normal_texture},
    {"metallic_roughness_texture", &MaterialSection::metallic_roughness_file,
     &VisualMaterial::metallic_roughness_texture},
    {"emission_texture", &MaterialSection::emission_file, &VisualMaterial::emission_texture}};

}  // namespace

void check_schema(Section& root) {
  if (root.integer("schema", 0, 1000000) != 1) root.fail("schema", "must be 1, the only version this program reads");
}

MaterialSection with_files(const VisualMaterial& material, const std::vector<std::filesystem::path>& textures) {
  MaterialSection section{material, {}, {}, {}, {}};
  for (const TextureKey& texture : TEXTURES)
    if (const int index = material.*texture.index; index >= 0) section.*texture.file = textures[std::size_t(index)];
  return section;
}

void add_materials(Section& root, std::vector<VisualMaterial>& materials,
                   std::vector<std::filesystem::path>* textures) {
  for (Section& section : root.sections("materials")) {
    MaterialSection material = read_all(material_fields(), section);
    for (const VisualMaterial& other : materials) {
      if (other.name == material.name) section.fail("name", "`" + material.name + "` is taken by a material above");
    }
    for (const TextureKey& texture : TEXTURES) {
      if ((material.*texture.file).empty()) continue;
      if (!textures) section.fail(texture.key, "is not possible here: the materials of a gripper have no textures");
      material.*texture.index = int(textures->size());
      textures->push_back(material.*texture.file);
    }
    materials.push_back(material);
  }
}

std::vector<MotionElement> read_motion(Section& root, const std::vector<RobotCell>& robots) {
  const Fields<MotionElement> fields = motion_fields(robots);
  std::vector<MotionElement> motion;
  for (Section& section : root.sections("motion")) {
    if (!section.has("together")) {
      motion.push_back(read_all(fields, section));
      motion.back().place = section.place();
      continue;
    }
    std::vector<Section> parts = section.sections("together");
    for (std::size_t i = 0; i < parts.size(); ++i) {
      motion.push_back(read_all(fields, parts[i]));
      motion.back().place = parts[i].place();
      motion.back().is_with_previous = i > 0;
      for (std::size_t k = 1; k <= i; ++k)
        if (motion[motion.size() - 1 - k].robot == motion.back().robot)
          parts[i].fail("robot", "moves twice in what goes on together; give each robot one element");
    }
    section.done();
  }
  if (motion.empty()) root.fail("", "lacks `motion`: a task has at least one motion element");
  return motion;
}

void read_light(Section& section, Task& task) {
  if (section.choice("kind", {"rectangle", "sphere"}, 0) == 1)
    task.sphere_lights.push_back(read_all(sphere_light_fields(), section));
  else
    task.lights.push_back(read_all(rectangle_light_fields(), section));
}

}  // namespace pvg

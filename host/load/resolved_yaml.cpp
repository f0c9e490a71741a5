// The configuration of an episode as text: what the files said, the defaults they left open, the numbers that were
// drawn. The sections are written by their tables, and read again by the same ones.
#include "host/load/build_scene.hpp"
#include "host/load/read_sections.hpp"
#include "host/load/task_file.hpp"

namespace pvg {
namespace {

template <class T>
void write_list(YamlWriter& w, const char* key, const Fields<T>& fields, const std::vector<T>& list) {
  w.list(key, list, [&](const T& item) { fields.write(w, item); });
}

template <class T>
void write_section(YamlWriter& w, const char* key, const Fields<T>& fields, const T& value) {
  w.begin(key);
  fields.write(w, value);
  w.end();
}

void write_looks(YamlWriter& w, const Task& task) {
  write_section(w, "background", background_fields(), task.background);
  w.list("materials", task.materials,
         [&](const VisualMaterial& material) { material_fields().write(w, with_files(material, task.textures)); });
  write_list(w, "lights", rectangle_light_fields(), task.lights);
  write_list(w, "sphere_lights", sphere_light_fields(), task.sphere_lights);
  environment_fields().write(w, task);
  write_list(w, "cameras", camera_fields(), task.cameras);
  write_section(w, "render", render_fields(), task.render);
  write_section(w, "record", record_fields(), task.record);
}

template <class T>
void read_section(YamlSection& root, const char* key, const Fields<T>& fields, T& value) {
  if (!root.has(key)) return;
  YamlSection section = root.section(key);
  fields.read(section, value);
  section.done();
}

}  // namespace

std::string resolved_yaml(const Task& task, const TaskScene& built) {
  YamlWriter w(task.file.parent_path());
  w.entry("schema", 1);
  root_fields(LARGEST_TASK_TIME_STEP).write(w, task);
  carried_gripper_fields<Task>().write(w, task);
  write_list(w, "robots", robot_cell_fields(), task.more_robots);
  write_list(w, "objects", object_fields(), task.objects);
  write_list(w, "joints", task_joint_fields(), task.joints);
  write_list(w, "cloths", cloth_fields(), task.cloths);
  write_list(w, "pair_friction", pair_friction_fields(), task.pair_friction);
  if (!task.pair_restitution.empty())
    write_list(w, "pair_restitution", pair_restitution_fields(), task.pair_restitution);
  write_list(w, "effects", effect_fields(), task.effects);
  write_section(w, "contact", contact_fields(), task.contact);
  write_section(w, "solver", solver_fields(), task.solver);
  write_list(w, "motion", motion_fields({}), task.motion);
  write_list(w, "success", condition_fields({}, Condition::When::end), task.success);
  write_list(w, "failure", condition_fields({}, Condition::When::some_time), task.failure);
  if (!task.variations.empty()) write_list(w, "vary", variation_fields(), task.variations);
  write_looks(w, task);
  w.begin("drawn");
  for (const SampledValue& drawn : built.sampled) w.entry(drawn.name, drawn.value);
  w.end();
  return w.finish();
}

Task read_resolved(const std::string& text, const std::filesystem::path& file) {
  YamlSection root = YamlSection::resolved(text, file);
  Task task;
  task.file = file;
  root_fields(LARGEST_TASK_TIME_STEP).read(root, task);
  carried_gripper_fields<Task>().read(root, task);
  read_list(root, "robots", robot_cell_fields(), task.more_robots);
  read_list(root, "objects", object_fields(), task.objects);
  read_list(root, "joints", task_joint_fields(), task.joints);
  read_list(root, "cloths", cloth_fields(), task.cloths);
  read_list(root, "pair_friction", pair_friction_fields(), task.pair_friction);
  read_list(root, "pair_restitution", pair_restitution_fields(), task.pair_restitution);
  read_list(root, "effects", effect_fields(), task.effects);
  read_section(root, "contact", contact_fields(), task.contact);
  read_section(root, "solver", solver_fields(), task.solver);
  read_list(root, "motion", motion_fields({}), task.motion);
  read_list(root, "success", condition_fields({}, Condition::When::end), task.success);
  read_list(root, "failure", condition_fields({}, Condition::When::some_time), task.failure);
  read_list(root, "vary", variation_fields(), task.variations);
  read_section(root, "background", background_fields(), task.background);
  add_materials(root, task.materials, &task.textures);
  read_list(root, "lights", rectangle_light_fields(), task.lights);
  read_list(root, "sphere_lights", sphere_light_fields(), task.sphere_lights);
  environment_fields().read(root, task);
  read_list(root, "cameras", camera_fields(), task.cameras);
  read_section(root, "render", render_fields(), task.render);
  read_section(root, "record", record_fields(), task.record);
  for (const char* key : {"schema", "drawn"}) root.skip(key);
  root.done();
  return task;
}

}  // namespace pvg

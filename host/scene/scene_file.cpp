#include "host/scene/scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "host/base/error.hpp"
#include "host/scene/build_scene.hpp"
#include "host/scene/read_bodies.hpp"
#include "host/scene/read_sections.hpp"

namespace pvg {
namespace {

constexpr double LARGEST_TIME_STEP = 1;  // scenes that only look for rest may take large ones [s]

bool has_drive(const Joint& joint) { return joint.drive.stiffness > 0 || joint.drive.damping > 0; }

// `added` behind what the scene has, its indices moved by it
void append(Scene& scene, const Scene& added) {
  const int first_rigid = int(scene.rigid_bodies.size()), first_soft = int(scene.soft_bodies.size());
  const auto append_list = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append_list(scene.rigid_bodies, added.rigid_bodies);
  append_list(scene.soft_bodies, added.soft_bodies);
  for (Joint joint : added.joints) {
    joint.parent += first_rigid;
    joint.child += first_rigid;
    scene.joints.push_back(joint);
  }
  for (Stitch stitch : added.stitches) {
    stitch.rigid += first_rigid;
    if (stitch.soft >= 0) stitch.soft += first_soft;
    scene.stitches.push_back(stitch);
  }
}

}  // namespace

double TargetTable::at(double t) const {
  const std::size_t after = std::size_t(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  if (after == 0) return value.front();
  if (after == time.size()) return value.back();
  const double share = (t - time[after - 1]) / (time[after] - time[after - 1]);
  return value[after - 1] + share * (value[after] - value[after - 1]);
}

SceneFile load_scene_file(const std::filesystem::path& path) {
  YamlSection root = YamlSection::load(path, "scene file");
  SceneFile file;
  file.task = read_scene_sections(root, LARGEST_TIME_STEP);
  file.added.gravity = root.vector("gravity", Unit::acceleration, -1e6, 1e6, file.added.gravity);
  file.duration = root.number("duration", Unit::time, 0, 1e5, 1);
  for (YamlSection& section : root.sections("bodies")) read_body(section, file);
  for (YamlSection& section : root.sections("joints")) read_joint(section, file);
  for (YamlSection& section : root.sections("stitches")) read_stitch(section, file);
  root.done();
  std::vector<std::string> bodies;
  for (const RigidBody& body : file.added.rigid_bodies) bodies.push_back(body.name);
  for (const SoftBody& body : file.added.soft_bodies) bodies.push_back(body.name);
  check_names(root, file.task, bodies);
  return file;
}

std::size_t SceneRun::n_steps() const { return std::size_t(std::llround(duration / scene.solver.time_step)); }

std::vector<double> SceneRun::targets_at(double time) const {
  std::vector<double> values;
  for (const TargetTable& table : targets) values.push_back(table.at(time));
  return values;
}

SceneRun load_scene_run(const std::filesystem::path& path) {
  const SceneFile file = load_scene_file(path);
  SceneRun run;
  run.scene = build_scene_at_middle(file.task).scene;
  for (const Joint& joint : run.scene.joints)
    if (has_drive(joint)) run.targets.push_back({{0}, {joint.initial}});
  append(run.scene, file.added);
  run.scene.gravity = file.added.gravity;
  run.targets.insert(run.targets.end(), file.targets.begin(), file.targets.end());
  run.duration = file.duration;
  std::ifstream in(path, std::ios::binary);
  run.configuration = {std::istreambuf_iterator<char>(in), {}};
  return run;
}

Scene load_scene(const std::filesystem::path& file) { return load_scene_run(file).scene; }

}  // namespace pvg

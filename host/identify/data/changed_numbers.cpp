#include "host/identify/data/changed_numbers.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "host/base/error.hpp"
#include "host/load/build_scene.hpp"
#include "host/load/scene_file.hpp"
#include "host/robot/imported_scene.hpp"

namespace pvg::diagnose {
namespace {

using Keys = std::vector<std::string>;

struct Entry {
  YAML::Node node;  // undefined: there is none
  Keys keys;        // within it
};

Keys split(const std::string& path) {
  Keys keys;
  std::istringstream text(path);
  for (std::string key; std::getline(text, key, '/');) keys.push_back(key);
  return keys;
}

// Names may hold slashes: the longest that fits.
Entry entry_of(const YAML::Node& root, const std::string& key) {
  Entry found{YAML::Node(YAML::NodeType::Undefined), {}};
  if (key.starts_with("contact/")) return {root["contact"], split(key.substr(8))};
  const bool is_body = key.starts_with("body/");
  if (!is_body && !key.starts_with("joint/")) return found;
  const std::string rest = key.substr(is_body ? 5 : 6);
  std::size_t longest = 0;
  for (const auto& entry : root[is_body ? "bodies" : "joints"]) {
    const std::string name = entry["name"] ? entry["name"].Scalar() : "";
    if (name.size() < longest || !rest.starts_with(name + "/") || rest.size() == name.size() + 1) continue;
    longest = name.size();
    found.node.reset(entry);
    found.keys = split(rest.substr(name.size() + 1));
  }
  return found;
}

void set(Entry entry, const StatedNumber& number) {
  YAML::Node node = entry.node;
  const YAML::Node shape = node["shape"];
  if (shape && shape.IsMap() && shape.size() == 1 && !node[entry.keys[0]] && shape.begin()->second.IsMap() &&
      shape.begin()->second[entry.keys[0]])
    node.reset(shape.begin()->second);
  for (std::size_t k = 0; k + 1 < entry.keys.size(); ++k) node.reset(node[entry.keys[k]]);
  YAML::Node value(YAML::NodeType::Sequence);
  for (const std::string& part : number.value) value.push_back(part);
  node[entry.keys.back()] = number.value.size() == 1 ? YAML::Node(number.value[0]) : value;
}

bool is_same(const TriangleMesh& a, const TriangleMesh& b) {
  return a.points == b.points && a.triangles == b.triangles;
}
bool is_same(const TetMesh& a, const TetMesh& b) { return a.points == b.points; }
bool is_same(const Pose& a, const Pose& b) { return a.matrix() == b.matrix(); }
template <class T>
bool is_same(const T& a, const T& b) {
  return a == b;
}

// Takes members that differ between two scenes into a third.
struct Taking {
  bool any = false;
  template <class T, class M>
  void operator()(const T& from, const T& to, T& out, M T::*member) {
    if (is_same(from.*member, to.*member)) return;
    out.*member = to.*member;
    any = true;
  }
};

void take_body(const RigidBody& from, const RigidBody& to, RigidBody& out, Taking& take) {
  for (const auto member :
       {&RigidBody::volume, &RigidBody::affine_modulus, &RigidBody::friction, &RigidBody::contact_offset})
    take(from, to, out, member);
  for (const auto member : {&RigidBody::center_of_mass, &RigidBody::velocity, &RigidBody::angular_velocity})
    take(from, to, out, member);
  take(from, to, out, &RigidBody::collision);
  take(from, to, out, &RigidBody::pose);
  if (to.mass == from.mass && to.inertia == from.inertia) return;
  take.any = true;
  if (!(from.mass > 0) || !(from.inertia.trace() > 0)) return;
  const double inertia_as = out.inertia.trace() / from.inertia.trace();
  out.mass *= to.mass / from.mass;
  out.inertia = inertia_as * to.inertia;
}

void take_joint(const Joint& from, const Joint& to, Joint& out, Taking& take) {
  for (const auto member : {&Joint::lower, &Joint::upper, &Joint::limit_stiffness, &Joint::damping, &Joint::armature,
                            &Joint::velocity_limit, &Joint::stiffness, &Joint::initial})
    take(from, to, out, member);
  take(from, to, out, &Joint::parent_frame);
  take(from, to, out, &Joint::child_frame);
  take(from, to, out, &Joint::axis);
  for (const auto member : {&Drive::stiffness, &Drive::damping, &Drive::effort_limit, &Drive::play, &Drive::gain,
                            &Drive::time_constant, &Drive::delay})
    take(from.drive, to.drive, out.drive, member);
}

void take_soft(const SoftBody& from, const SoftBody& to, SoftBody& out, Taking& take) {
  take(from, to, out, &SoftBody::mesh);
  take(from, to, out, &SoftBody::pose);
  take(from, to, out, &SoftBody::velocity);
  take(from, to, out, &SoftBody::friction);
  take(from, to, out, &SoftBody::contact_offset);
  for (const auto member : {&SolidMaterial::density, &SolidMaterial::youngs_modulus, &SolidMaterial::poisson_ratio})
    take(from.material, to.material, out.material, member);
}

bool has_same_list(const auto& a, const auto& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.name == y.name; });
}

bool take_changes(const PhysicalScene& from, const PhysicalScene& to, PhysicalScene& out) {
  Taking take;
  for (std::size_t b = 0; b < from.rigid_bodies.size(); ++b)
    take_body(from.rigid_bodies[b], to.rigid_bodies[b], out.rigid_bodies[b], take);
  for (std::size_t j = 0; j < from.joints.size(); ++j) take_joint(from.joints[j], to.joints[j], out.joints[j], take);
  for (std::size_t b = 0; b < from.soft_bodies.size(); ++b)
    take_soft(from.soft_bodies[b], to.soft_bodies[b], out.soft_bodies[b], take);
  for (const auto member :
       {&ContactSettings::activation_distance, &ContactSettings::stiffness, &ContactSettings::friction_velocity})
    take(from.contact, to.contact, out.contact, member);
  return take.any;
}

}  // namespace

bool is_of_scene_file(const std::filesystem::path& scene_file, const std::string& key) {
  const Entry entry = entry_of(YAML::Load(scene_text(scene_file)), key);
  return entry.node.IsDefined() && entry.node.IsMap() && !entry.keys.empty();
}

SceneChange change_of_file(const std::filesystem::path& scene_file, const StatedNumbers& stated,
                           const std::string& list) {
  YAML::Node root = YAML::Load(scene_text(scene_file));
  for (const auto& [key, number] : stated) {
    try {
      set(entry_of(root, key), number);
    } catch (const YAML::Exception&) {
      throw UsageError(list + "." + key +
                       " is no key of the scene file; write the keys as they are there, such as "
                       "body/NAME/size or joint/NAME/parent_frame/position");
    }
  }
  std::string keys;
  for (const auto& [key, number] : stated) keys += (keys.empty() ? "" : ", ") + key;
  PhysicalScene from = load_scene_run(scene_file).scene, to;
  try {
    to = load_changed_scene(scene_file, YAML::Dump(root));
  } catch (const UsageError& wrong) {
    throw UsageError(list + ": the scene with " + keys + " as stated cannot be loaded: " + wrong.what());
  }
  if (!has_same_list(from.rigid_bodies, to.rigid_bodies) || !has_same_list(from.joints, to.joints) ||
      !has_same_list(from.soft_bodies, to.soft_bodies))
    throw UsageError(list + ": " + keys + " change which bodies and joints there are; a run changes numbers of them");
  PhysicalScene tried = from;
  if (!take_changes(from, to, tried))
    throw UsageError(list + ": " + keys + " change nothing that the simulation of a run reads of the scene");
  return [from = std::move(from), to = std::move(to)](PhysicalScene& scene) { take_changes(from, to, scene); };
}

}  // namespace pvg::diagnose

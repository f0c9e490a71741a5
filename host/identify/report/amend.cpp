// The scene file with what was found: effects added by name, wrong numbers replaced. What the measurement has wrong
// is written as a comment; only a lens is the scene's, too.
#include <yaml-cpp/yaml.h>

#include "host/identify/report/report.hpp"
#include "host/render/camera.hpp"

namespace pvg::diagnose {
namespace {

namespace fs = std::filesystem;

// Paths in the file are relative to its folder: those that lead to a file become relative to the new one.
void move_paths(YAML::Node node, const fs::path& from, const fs::path& to) {
  if (node.IsMap())
    for (auto entry : node) move_paths(entry.second, from, to);
  if (node.IsSequence())
    for (std::size_t i = 0; i < node.size(); ++i) move_paths(node[i], from, to);
  if (!node.IsScalar() || node.Scalar().find('.') == std::string::npos) return;
  std::error_code ignored;
  const fs::path file = from / node.Scalar();
  if (fs::is_regular_file(file, ignored)) node = fs::relative(file, to, ignored).generic_string();
}

YAML::Node named(YAML::Node list, const std::string& name) {
  for (std::size_t i = 0; list.IsSequence() && i < list.size(); ++i)
    if (list[i]["name"] && list[i]["name"].Scalar() == name) return list[i];
  return YAML::Node(YAML::NodeType::Undefined);
}

// Scales all of these numbers of a section that the file says; false where it says none, or one with a unit.
bool scale_plain(YAML::Node node, const std::string& section, const std::vector<std::string>& keys, double ratio) {
  if (!node.IsDefined() || !node.IsMap() || !node[section]) return false;
  std::vector<std::pair<std::string, double>> said;
  for (const std::string& key : keys) {
    if (!node[section][key]) continue;
    said.emplace_back(key, 0);
    if (!YAML::convert<double>::decode(node[section][key], said.back().second)) return false;
  }
  for (const auto& [key, value] : said) node[section][key] = value * ratio;
  return !said.empty();
}

// ratio: of `value` to what the scene says;  false: the file does not say this number itself
bool set_number(YAML::Node root, const std::string& kind, const std::string& target, double value, double ratio) {
  const auto in = [&](YAML::Node node, const std::string& section, const std::string& key) {
    if (!node.IsDefined() || !node.IsMap()) return false;
    if (section.empty())
      node[key] = value;
    else if (node[section])
      node[section][key] = value;
    else
      return false;
    return true;
  };
  const YAML::Node body = named(root["bodies"], target), joint = named(root["joints"], target),
                   cloth = named(root["cloths"], target);
  if (kind == "retune_mass") {
    YAML::Node owner = body.IsDefined() && body.IsMap() ? body : named(root["objects"], target);
    if (!owner.IsDefined() || !owner.IsMap()) return false;
    owner.remove("density");
    return in(owner, "", "mass");
  }
  if (kind == "retune_gravity") {
    YAML::Node g = root["gravity"];
    if (!g) g = root["gravity"] = std::vector<double>{0, 0, -9.81};
    for (std::size_t k = 0; k < 3; ++k) g[k] = g[k].as<double>() * ratio;
    return true;
  }
  if (kind == "retune_youngs_modulus") return in(body, "material", "youngs_modulus");
  if (kind == "retune_density") return in(body, "material", "density");
  if (kind == "retune_joint_damping") return in(joint, "", "damping");
  if (kind == "retune_drive_stiffness") return in(joint, "drive", "stiffness");
  if (kind == "retune_drive_damping") return in(joint, "drive", "damping");
  if (kind == "retune_effort_limit") return in(joint, "drive", "effort_limit");
  if (kind == "retune_area_density") return in(cloth, "material", "area_density");
  if (kind == "retune_bending_stiffness" || kind == "retune_stretch_stiffness") {
    const std::string key = kind == "retune_bending_stiffness" ? "bending" : "stretch";
    return scale_plain(cloth, "material", {key, key + "_warp", key + "_weft"}, ratio);
  }
  if (kind == "retune_contact_stiffness") {
    root["contact"]["stiffness"] = value;
    return true;
  }
  if (kind == "retune_friction") {
    const std::size_t cut = target.find('/');
    const std::string first = target.substr(0, cut), second = target.substr(cut + 1);
    YAML::Node list(YAML::NodeType::Sequence);
    for (const auto& pair : root["pair_friction"]) {
      const std::string a = pair["first"].Scalar(), b = pair["second"].Scalar();
      if ((a != first || b != second) && (a != second || b != first)) list.push_back(pair);
    }
    YAML::Node pair;
    pair["first"] = first;
    pair["second"] = second;
    pair["coefficient"] = value;
    list.push_back(pair);
    root["pair_friction"] = list;
    return true;
  }
  return false;
}

// false: the file does not say this body, or three moments along its axes do not say all
bool set_inertia(YAML::Node root, const Scene& scene, const std::string& target) {
  YAML::Node body = named(root["bodies"], target);
  if (!body.IsDefined() || !body.IsMap()) return false;
  for (const RigidBody& rigid : scene.rigid_bodies) {
    if (rigid.name != target) continue;
    const Vec3 moments = rigid.inertia.diagonal();
    if (!rigid.inertia.isApprox(Mat3(moments.asDiagonal()), 1e-9)) return false;
    body["inertia"] = std::vector<double>(moments.begin(), moments.end());
    return true;
  }
  return false;
}

YAML::Node node_of(const Effect& added) {
  YAML::Node node;
  node["effect"] = added.name;
  node["target"] = added.target;
  if (is_regressed(effect_kind(added.name))) {
    if (added.formulas.size() == 1) node["formula"] = added.formulas[0];
    if (added.formulas.size() > 1) node["formula"] = added.formulas;
    node["coefficients"] = added.parameters;
    return node;
  }
  for (std::size_t i = 0; i < added.parameters.size(); ++i)
    node[effect_kind(added.name).parameters[i].name] = added.parameters[i];
  return node;
}

// where the file itself says this camera
void set_lens(const Problem& problem, YAML::Node root, const std::string& name, double k1) {
  YAML::Node camera = named(root["cameras"], name);
  if (!camera.IsDefined() || !camera.IsMap()) return;
  for (const Camera& seen : problem.seen.cameras)
    if (seen.name == name) camera["distortion"] = distortion_with(seen, k1);
}

}  // namespace

std::string amended_scene(const Problem& problem, const Diagnosis& diagnosis, const fs::path& folder) {
  YAML::Node root = YAML::LoadFile(problem.recording.scene.string());
  move_paths(root, fs::absolute(problem.recording.scene).parent_path(), fs::absolute(folder));
  std::string head = "# " + problem.recording.scene.filename().string() + ", amended: " + diagnosis.sentence + "\n";
  root["time_step"] = diagnosis.used.solver.time_step;
  if (diagnosis.used.solver.integrator == SolverSettings::Integrator::bdf2) root["solver"]["integrator"] = "bdf2";
  const bool is_named = diagnosis.verdict != Verdict::none && diagnosis.verdict != Verdict::agrees;
  for (const NamedEffect& effect : is_named ? diagnosis.effects : std::vector<NamedEffect>()) {
    const Candidate& candidate = *effect.candidate;
    if (candidate.family == Family::physical) {
      Variant variant{problem.scene.scene, {}};
      std::vector<double> values;
      for (const NamedParameter& p : effect.parameters) values.push_back(p.value);
      candidate.apply(variant, values);
      root["effects"].push_back(node_of(variant.scene.effects.back()));
    } else if (candidate.family == Family::parameter) {
      const double value = effect.parameters[0].value;
      Variant variant{diagnosis.used, {}};
      candidate.apply(variant, std::span(&value, 1));
      const bool is_set = candidate.name == "retune_inertia" ? set_inertia(root, variant.scene, candidate.target)
                                                             : set_number(root, candidate.name, candidate.target, value,
                                                                          value / candidate.parameters[0].off);
      if (!is_set)
        head +=
            "# to set by packet, where the scene's files say it: " + candidate.label() + " = " + shown(value) + "\n";
    } else {
      head += "# the measurement: " + candidate.label();
      for (const NamedParameter& p : effect.parameters) head += ", " + p.name + " " + shown(p.value) + " " + p.unit;
      head += "\n";
      if (candidate.name == "lens_distortion") set_lens(problem, root, candidate.target, effect.parameters[0].value);
    }
  }
  if (diagnosis.regressed) root["effects"].push_back(node_of(diagnosis.regressed->amended));
  YAML::Emitter out;
  out.SetDoublePrecision(17);
  out << root;
  return head + out.c_str() + "\n";
}

}  // namespace pvg::diagnose

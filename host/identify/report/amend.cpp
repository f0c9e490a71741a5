// The scene file with what was found: effects added by name, wrong numbers replaced. Errors of the measurement become
// comments; only that of a lens is also an error of the scene.
#include <yaml-cpp/yaml.h>

#include "host/identify/candidates/candidate.hpp"
#include "host/identify/data/scene_number.hpp"
#include "host/identify/report/report.hpp"
#include "host/robot/imported_scene.hpp"

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

// Values that the recording states before any data hold instead of the file's, as far as the data do not adjust them.
void write_priors(YAML::Node& root, const Problem& problem, const Diagnosis& diagnosis) {
  for (const NumberPrior& prior : problem.priors)
    for (const SceneNumber& number : scene_numbers()) {
      if (prior.number != number.name) continue;
      double value = prior.value;
      for (const AdjustedNumber& adjusted : diagnosis.adjusted)
        if (adjusted.name == prior.number && adjusted.target == prior.target) value = adjusted.value;
      if (value != prior.said) number.write({root, prior.target, value, value / prior.said, diagnosis.used});
    }
}

}  // namespace

YAML::Node scene_file_in(const Problem& problem, const fs::path& folder) {
  YAML::Node root = YAML::Load(scene_text(problem.recording.scene));
  move_paths(root, fs::absolute(problem.recording.scene).parent_path(), fs::absolute(folder));
  return root;
}

std::string amended_scene(const Problem& problem, const Diagnosis& diagnosis, const fs::path& folder) {
  YAML::Node root = scene_file_in(problem, folder);
  std::string head = "# " + problem.recording.scene.filename().string() + ", amended: " + diagnosis.sentence + "\n";
  root["time_step"] = diagnosis.used.solver.time_step;
  if (diagnosis.is_extrapolated)
    head +=
        "# fitted with the error of this time step extrapolated away: a finer one comes nearer to what was measured\n";
  if (diagnosis.used.solver.integrator == SolverSettings::Integrator::bdf2) root["solver"]["integrator"] = "bdf2";
  write_priors(root, problem, diagnosis);
  const bool is_named = diagnosis.verdict != Verdict::none && diagnosis.verdict != Verdict::agrees;
  for (const NamedEffect& effect : is_named ? diagnosis.effects : std::vector<NamedEffect>()) {
    const Candidate& candidate = *effect.candidate;
    Variant variant{diagnosis.used, {}};
    std::vector<double> values;
    for (const NamedParameter& p : effect.parameters) values.push_back(p.value);
    candidate.apply(variant, values);
    const bool is_written = candidate.amend({root, problem, variant.scene}, values);
    if (candidate.family == Family::measurement) {
      head += "# the measurement: " + candidate.label();
      for (const NamedParameter& p : effect.parameters) head += ", " + p.name + " " + shown(p.value) + " " + p.unit;
      head += "\n";
    } else if (!is_written) {
      head +=
          "# to set by hand, where the scene's files say it: " + candidate.label() + " = " + shown(values[0]) + "\n";
    }
  }
  if (diagnosis.regressed) write_effect(root, diagnosis.regressed->amended);
  YAML::Emitter out;
  out.SetDoublePrecision(17);
  out << root;
  return head + out.c_str() + "\n";
}

}  // namespace pvg::diagnose

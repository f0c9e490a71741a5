#include "host/identify/data/stated_numbers.hpp"

#include <optional>
#include <stdexcept>
#include <string_view>

#include "host/base/error.hpp"
#include "host/identify/data/changed_numbers.hpp"
#include "host/identify/data/problem.hpp"
#include "host/identify/data/resolve.hpp"
#include "host/identify/data/scene_number.hpp"

namespace pvg::diagnose {
namespace {

struct Found {
  const SceneNumber* number = nullptr;
  NumberPlace place;
};

// body/NAME/mass is row retune_mass, joint/NAME/damping is retune_joint_damping, pair/A/B/friction is retune_friction
std::optional<Found> find_number(const PhysicalScene& scene, const std::string& key) {
  const std::size_t first = key.find('/'), last = key.rfind('/');
  const bool is_whole = first == std::string::npos;
  const std::string kind = is_whole ? "" : key.substr(0, first), quantity = is_whole ? key : key.substr(last + 1),
                    target = is_whole        ? "scene"
                             : first == last ? ""
                                             : key.substr(first + 1, last - first - 1);
  const bool is_joint = index_named(scene.joints, target) >= 0;
  if (kind == "joint" && !is_joint) return std::nullopt;
  if (kind == "body" && is_joint) return std::nullopt;
  for (const SceneNumber& number : scene_numbers()) {
    if (number.name != "retune_" + quantity && (kind.empty() || number.name != "retune_" + kind + "_" + quantity))
      continue;
    for (const NumberPlace& place : number.places(scene, {is_whole ? "scene/scene" : target}))
      if (place.target == target) return Found{&number, place};
  }
  return std::nullopt;
}

Unit unit_written(const std::string& si) {
  for (int unit = 0; unit <= int(Unit::radiance); ++unit)
    if (si_unit(Unit(unit)) == si) return Unit(unit);
  throw std::logic_error("no unit is called " + si);
}

double number_in(const std::string& text, const Found& found, const PhysicalScene& scene, const std::string& place) {
  try {
    return parse_quantity(text, unit_written(unit_on(scene, found.place.target, found.number->unit)));
  } catch (const std::invalid_argument& wrong) {
    throw UsageError(place + " " + wrong.what());
  }
}

[[noreturn]] void refuse(const PhysicalScene& scene, const std::string& place) {
  std::string known = "gravity, contact_stiffness";
  for (const RigidBody& body : scene.rigid_bodies)
    if (can_move(body)) known += ", body/" + body.name + "/mass";
  for (const Joint& joint : scene.joints) known += ", joint/" + joint.name + "/damping";
  throw UsageError(place + " is no number of the scene that can be stated; there are, among others: " + known +
                   ", and of a run body/NAME/load, body/NAME/center_of_mass, body/NAME/size");
}

// The body that body/NAME/load names; empty: none.
std::string loaded_body(const PhysicalScene& scene, const std::string& key) {
  constexpr std::string_view HEAD = "body/", TAIL = "/load";
  if (!key.starts_with(HEAD) || !key.ends_with(TAIL) || key.size() <= HEAD.size() + TAIL.size()) return "";
  const std::string body = key.substr(HEAD.size(), key.size() - HEAD.size() - TAIL.size());
  const int b = index_named(scene.rigid_bodies, body);
  return b >= 0 && can_move(scene.rigid_bodies[std::size_t(b)]) ? body : "";
}

double load_in(const std::string& text, const std::string& place) {
  try {
    const double load = parse_quantity(text, Unit::mass), most = effect_kind("payload_mass").parameters[0].high;
    if (!(load >= 0 && load <= most)) throw UsageError(place + " must be 0 to " + std::to_string(int(most)) + " kg");
    return load;
  } catch (const std::invalid_argument& wrong) {
    throw UsageError(place + " " + wrong.what());
  }
}

Found needed(const PhysicalScene& scene, const std::string& key, const std::string& place) {
  std::optional<Found> found = find_number(scene, key);
  if (!found) refuse(scene, place);
  return *found;
}

Vec3 vector_in(const std::vector<std::string>& texts, Unit unit, const std::string& place) {
  Vec3 vector = Vec3::Zero();
  if (texts.size() != 3) throw UsageError(place + " must be a list of three numbers, x y z");
  try {
    for (Eigen::Index k = 0; k < 3; ++k) vector[k] = parse_quantity(texts[std::size_t(k)], unit);
  } catch (const std::invalid_argument& wrong) {
    throw UsageError(place + " " + wrong.what());
  }
  return vector;
}

void demand_one(const StatedNumber& stated, const std::string& place) {
  if (stated.value.size() != 1) throw UsageError(place + " must be one number");
}

}  // namespace

SceneChange load_on(const std::string& body, double mass) {
  return [load = Effect{"payload_mass", body, {mass}}](PhysicalScene& s) { s.effects.push_back(load); };
}

std::vector<SceneChange> scene_changes(const PhysicalScene& scene, const std::filesystem::path& scene_file,
                                       const StatedNumbers& stated, const std::string& list) {
  std::vector<SceneChange> changes;
  StatedNumbers of_file;
  for (const auto& [key, number] : stated) {
    const std::string place = list + "." + key;
    if (!number.sigma.empty())
      throw UsageError(place + " holds for this run and has no `sigma`; what is not known exactly belongs to `priors`");
    if (key == "gravity" && number.value.size() != 1) {
      changes.push_back([g = vector_in(number.value, Unit::acceleration, place)](PhysicalScene& s) { s.gravity = g; });
      continue;
    }
    if (const std::string body = loaded_body(scene, key); !body.empty()) {
      demand_one(number, place);
      changes.push_back(load_on(body, load_in(number.value[0], place)));
      continue;
    }
    const std::optional<Found> sought = find_number(scene, key);
    if (!sought && is_of_scene_file(scene_file, key)) {
      of_file[key] = number;
      continue;
    }
    if (!sought) refuse(scene, place);
    const Found& found = *sought;
    demand_one(number, place);
    const double value = number_in(number.value[0], found, scene, place);
    if (!(value >= 0)) throw UsageError(place + " must not be below 0");
    changes.push_back([set = found.place.set, value](PhysicalScene& s) { set(s, value); });
  }
  // numbers that are stated by themselves hold of what the file says
  if (!of_file.empty()) changes.insert(changes.begin(), change_of_file(scene_file, of_file, list));
  return changes;
}

void apply_priors(Problem& problem) {
  PhysicalScene& scene = problem.scene.scene;
  for (const auto& [key, stated] : problem.recording.priors) {
    const std::string place = problem.recording.file.string() + ": priors." + key;
    const Found found = needed(scene, key, place);
    double value = found.place.value;
    if (!stated.value.empty()) {
      demand_one(stated, place);
      value = number_in(stated.value[0], found, scene, place);
      if (!(value > 0)) throw UsageError(place + ": `value` must be above 0");
      found.place.set(scene, value);
    }
    if (stated.sigma.empty()) throw UsageError(place + " needs `sigma`, one standard deviation");
    const double sigma = number_in(stated.sigma, found, scene, place + ": `sigma`");
    if (!(sigma > 0)) throw UsageError(place + ": `sigma` must be above 0");
    problem.priors.push_back({found.number->name, found.place.target, sigma, value, found.place.value});
  }
}

}  // namespace pvg::diagnose

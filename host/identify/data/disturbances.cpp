#include "host/identify/data/disturbances.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/identify/channels/resolve.hpp"
#include "host/identify/data/problem.hpp"

namespace pvg::diagnose {
namespace {

// A push by the list of its kind.
Effect push_on(const std::string& body, const Vec3& point, const Vec3& force, const Vec3& torque) {
  Effect effect{"push", body, {}};
  const EffectKind& kind = effect_kind("push");
  effect.parameters.resize(kind.parameters.size());
  const auto set = [&](const std::string& name, double value) {
    for (std::size_t i = 0; i < kind.parameters.size(); ++i)
      if (kind.parameters[i].name == name) effect.parameters[i] = value;
  };
  constexpr const char* AXES[] = {"x", "y", "z"};
  for (Eigen::Index k = 0; k < 3; ++k) {
    set(AXES[k], force[k]);
    set(std::string("torque_") + AXES[k], torque[k]);
    set(std::string("point_") + AXES[k], point[k]);
  }
  return effect;
}

void check_body(const PhysicalScene& scene, const std::string& name, const std::string& place) {
  const int b = index_named(scene.rigid_bodies, name);
  if (b < 0)
    throw UsageError(place + " names the body `" + name +
                     "`, which is no rigid body of the scene; what pushes a soft body is a body of the kind `moving`");
  if (!can_move(scene.rigid_bodies[std::size_t(b)]))
    throw UsageError(place + " pushes the body `" + name + "`, which no force can move");
}

}  // namespace

std::vector<KnownPush> known_pushes(const PhysicalScene& scene, const RecordedRun& run, const std::string& list) {
  std::vector<KnownPush> pushes;
  for (std::size_t i = 0; i < run.disturbances.size(); ++i) {
    const RecordedDisturbance& known = run.disturbances[i];
    const std::string place = list + "[" + std::to_string(i) + "]";
    check_body(scene, known.body, place);
    const auto add = [&](double from, double to, const Vec3& value) {
      const Vec3 none = Vec3::Zero();
      if (value != none)
        pushes.push_back(
            {from, to,
             push_on(known.body, known.point, known.is_torque ? none : value, known.is_torque ? value : none)});
    };
    const std::vector<double>& t = run.table["t"];
    if (known.columns.empty()) {
      if (known.to <= t.front() || known.from >= t.back())
        throw UsageError(place + " acts from " + std::to_string(known.from) + " to " + std::to_string(known.to) +
                         " s, when the run, whose times are " + std::to_string(t.front()) + " to " +
                         std::to_string(t.back()) + " s, is not recorded; times are those of its column of times");
      add(known.from, known.to, known.value);
      continue;
    }
    const double to_si = factor_of(known.unit, known.is_torque ? Unit::torque : Unit::force, place);
    const auto row = [&](std::size_t r) {
      Vec3 value;
      for (Eigen::Index k = 0; k < 3; ++k) value[k] = to_si * run.table[known.columns[std::size_t(k)]][r];
      return value;
    };
    std::size_t last = t.size();  // row with numbers
    for (std::size_t r = 0; r < t.size(); ++r) {
      if (!row(r).allFinite()) continue;
      if (last < t.size()) add(t[last], t[r], 0.5 * (row(last) + row(r)));
      last = r;
    }
    if (last == t.size()) throw UsageError(place + ": its columns hold no number at all");
  }
  return pushes;
}

void add_pushes(const std::vector<KnownPush>& pushes, double start, double end, PhysicalScene& scene) {
  for (const KnownPush& push : pushes) {
    if (push.to <= start || push.from >= end) continue;
    Effect effect = push.effect;
    effect.parameters[0] = std::max(push.from - start, 0.0);  // from, to: the first of its kind
    effect.parameters[1] = push.to - start;
    scene.effects.push_back(std::move(effect));
  }
}

}  // namespace pvg::diagnose

#include "host/physics/contact/slip_effects.hpp"

#include <algorithm>
#include <cmath>

namespace pvg {
namespace {

Vec3 at(std::span<const double> x, u32 site) { return Eigen::Map<const Vec3>(&x[3 * std::size_t(site)]); }

bool is_of_pair(const ContactEffect& effect, const Friction& row) {
  return std::minmax(effect.first, effect.second) == std::minmax(row.body[0], row.body[1]);
}

double factor(const ContactEffect& effect, const Vec3& normal, const Vec3& slip, std::span<const double> x1) {
  double by = 1 + effect.slip_change * (1 - std::exp(-slip.norm() / effect.slip_velocity));
  if (effect.across_change == 0 || !(slip.norm() > 0)) return by;
  Vec3 direction = effect.has_direction ? at(x1, effect.direction_site) : Vec3::UnitX();
  direction -= direction.dot(normal) * normal;
  if (!(direction.norm() > 1e-9)) return by;
  const double cosine = slip.normalized().dot(direction.normalized()), across = 1 + effect.across_change;
  return by * std::sqrt(cosine * cosine + across * across * std::max(0.0, 1 - cosine * cosine));
}

}  // namespace

bool changes_friction(const ContactEffect& effect) {
  return effect.dissipation != 0 || effect.slip_change != 0 || effect.across_change != 0;
}

void apply_slip_effects(std::span<const ContactEffect> effects, std::span<const double> x0, std::span<const double> x1,
                        double h, std::span<Friction> rows) {
  for (Friction& row : rows)
    for (const ContactEffect& effect : effects) {
      if (!is_of_pair(effect, row)) continue;
      const Eigen::Map<const Vec3> normal(row.normal);
      Vec3 slip = Vec3::Zero();
      for (int i = 0; i < 4; ++i) slip += row.coefficient[i] * (at(x1, row.site[i]) - at(x0, row.site[i])) / h;
      slip -= slip.dot(normal) * normal;
      row.friction *= factor(effect, normal, slip, x1);
      row.dissipation += effect.dissipation;
    }
}

}  // namespace pvg

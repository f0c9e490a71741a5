// Friction and weight against Coulomb's law.
#include <algorithm>
#include <cmath>

#include "pipeline/validation/cases.hpp"

namespace pvg {
namespace {

constexpr double G = 9.80665;  // [m/s^2]
constexpr double CUBE_HALF = 0.05;

Vec3 position(const WorldState& state, int body) { return state.rigid[body].col(3); }

// What a cube does on the slope with one coefficient.
struct Slide {
  std::vector<double> time, speed;  // along the slope, from differences of positions
  double newton_per_step = 0;
  int most_newton = 0;
};

Slide slide(const Validation& v, double coefficient) {
  SceneRun run = v.load("slope");
  run.scene.pair_friction.at(0).coefficient = coefficient;
  const int cube = rigid_index(run.scene, "cube");
  const Vec3 downhill = run.scene.rigid_bodies[cube].pose.linear().col(0);
  Vec3 last = run.scene.rigid_bodies[cube].pose.translation();
  Slide result;
  v.run(run, [&](const WorldState& state, const StepReport& report) {
    result.time.push_back(state.time);
    result.speed.push_back((position(state, cube) - last).dot(downhill) / run.scene.solver.time_step);
    last = position(state, cube);
    result.newton_per_step += double(report.newton) / double(run.n_steps());
    result.most_newton = std::max(result.most_newton, report.newton);
    return true;
  });
  return result;
}

// mean from 40 % of the time on: the landing is over
double acceleration(const Slide& slide) {
  const std::size_t first = slide.time.size() * 2 / 5;
  return (slide.speed.back() - slide.speed[first]) / (slide.time.back() - slide.time[first]);
}

// Sum of the contact forces on a body [N]
Vec3 contact_force(const WorldState& state, int body) {
  Vec3 sum = Vec3::Zero();
  for (const ContactForce& contact : state.contacts) {
    const Vec3 force = contact.normal_force * contact.normal + contact.friction_force;
    if (contact.first == body) sum += force;
    if (contact.second == body) sum -= force;
  }
  return sum;
}

}  // namespace

void validate_slope(Validation& v) {
  const double angle = std::atan(0.5);
  Plot plot{"slope", "Cube on a slope, tan = 0.5", "time [s]", "speed down the slope [m/s]", {}};
  double newton = 0;
  for (const double coefficient : {0.51, 0.50, 0.49}) {
    const Slide result = slide(v, coefficient);
    plot.curves.push_back({"mu = " + std::to_string(coefficient).substr(0, 4), result.time, result.speed});
    newton = std::max(newton, result.newton_per_step);
    if (coefficient == 0.51) v.check_at_most("mu 0.51: creep", "m/s", std::abs(result.speed.back()), 1e-6, "sticks");
    if (coefficient == 0.50) v.check("mu 0.50: acceleration", "m/s^2", 0, acceleration(result), 1e-5, "equilibrium");
    if (coefficient == 0.49)
      v.check_relative("mu 0.49: acceleration", "m/s^2", G * (std::sin(angle) - 0.49 * std::cos(angle)),
                       acceleration(result), 1e-3, "g (sin - mu cos)");
    v.report("mu " + std::to_string(coefficient).substr(0, 4) + ": most Newton iterations of a step", "1", 0,
             result.most_newton, "as it is");
  }
  v.check_at_most("Newton iterations per step, the worst of three means", "1", newton, 12, "bound");
  v.plot(std::move(plot));
}

void validate_ramp(Validation& v) {
  const SceneRun run = v.load("ramp");
  const double angle = std::acos(-1.0) / 6;
  WorldState last;
  v.run(run, [&](const WorldState& state, const StepReport&) {
    last = state;
    return true;
  });
  for (int k = 0; k < 8; ++k) {
    const int cube = rigid_index(run.scene, "cube_" + std::to_string(k));
    const double moved = (position(last, cube) - run.scene.rigid_bodies[cube].pose.translation()).norm();
    const double a = std::max(0.0, G * (std::sin(angle) - k / 7.0 * std::cos(angle)));
    const double expected = a * last.time * (last.time + run.scene.solver.time_step) / 2;
    const std::string name = "mu " + std::to_string(k) + "/7: way in 1 s";
    if (k <= 4)
      v.check_relative(name, "m", expected, moved, 0.05, "slides: a t (t + h) / 2");
    else
      v.check_at_most(name, "m", moved, 1e-3, "sticks");
  }
}

void validate_stopping(Validation& v) {
  const SceneRun run = v.load("stopping");
  WorldState last;
  Plot plot{"stopping", "Sliding to a stop from 2 m/s", "time [s]", "way [m]", std::vector<Curve>(3)};
  v.run(run, [&](const WorldState& state, const StepReport&) {
    last = state;
    for (int i = 0; i < 3; ++i) {
      plot.curves[i].x.push_back(state.time);
      plot.curves[i].y.push_back(position(state, rigid_index(run.scene, "cube_" + std::to_string(i))).x());
    }
    return true;
  });
  const double coefficients[] = {0.2, 0.4, 0.7};
  for (int i = 0; i < 3; ++i) {
    const std::string mu = "mu " + std::to_string(coefficients[i]).substr(0, 3);
    plot.curves[i].label = mu;
    v.check_relative(mu + ": way", "m", 4 / (2 * coefficients[i] * 9.81), plot.curves[i].y.back(), 0.01,
                     "v^2 / (2 mu g)");
  }
  v.plot(std::move(plot));
}

namespace {

// Height of the grasped cube over time, until it has fallen by `enough` below its start [m]
Curve height_in_grasp(const Validation& v, double coefficient, double enough) {
  SceneRun run = v.load("grasp");
  for (PairFriction& pair : run.scene.pair_friction) pair.coefficient = coefficient;
  const int cube = rigid_index(run.scene, "cube");
  Curve height{"mu = " + std::to_string(coefficient).substr(0, 5), {}, {}};
  v.run(run, [&](const WorldState& state, const StepReport&) {
    height.x.push_back(state.time);
    height.y.push_back(position(state, cube).z());
    return height.y.back() > -enough;
  });
  return height;
}

// how far the cube sinks from `first` on to the end [m]
double sinking(const Curve& height, double first) {
  const auto from = std::lower_bound(height.x.begin(), height.x.end(), first) - height.x.begin();
  return height.y.at(std::size_t(from)) - height.y.back();
}

}  // namespace

void validate_grasp(Validation& v) {
  constexpr double WEIGHT = 0.1 * G, SQUEEZE = 1, HELD_FROM = 1.5;  // [N], [N], [s]
  const double critical = WEIGHT / (2 * SQUEEZE);
  Plot plot{"grasp", "Cube between soft pads", "time [s]", "height [m]", {}};
  for (const double coefficient : {0.8, 1.1 * critical}) {
    plot.curves.push_back(height_in_grasp(v, coefficient, 0.02));
    const Curve& height = plot.curves.back();
    v.check_at_most(height.label + ": slip in 6 s", "m", std::abs(sinking(height, HELD_FROM)), 5e-5, "is held");
  }
  plot.curves.push_back(height_in_grasp(v, 0.9 * critical, 0.02));
  v.check_true(plot.curves.back().label + ": falls by more than 20 mm", plot.curves.back().y.back() < -0.02,
               "weight / (2 normal force) is more");
  v.plot(std::move(plot));
}

void validate_weight(Validation& v) {
  const SceneRun run = v.load("weight");
  WorldState last;
  v.run(run, [&](const WorldState& state, const StepReport&) {
    last = state;
    return true;
  });
  const int box = rigid_index(run.scene, "box");
  const int block = int(run.scene.rigid_bodies.size()) + soft_index(run.scene, "block");
  v.check_relative("rigid box: contact force", "N", 1000 * std::pow(2 * CUBE_HALF, 3) * G, contact_force(last, box).z(),
                   1e-3, "m g");
  v.check_relative("soft block: contact force", "N", 1000 * 64e-6 * G, contact_force(last, block).z(), 1e-3, "m g");
}

}  // namespace pvg

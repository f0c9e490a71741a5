// Motion without friction against what the integrator itself must give, and against the continuous answer as the step
// shrinks.
#include <Eigen/Geometry>
#include <cmath>
#include <complex>
#include <numbers>

#include "host/geometry/tet_mesh.hpp"
#include "host/physics/energies/system.hpp"
#include "pipeline/validation/cases.hpp"

namespace pvg {
namespace {

using Complex = std::complex<double>;
constexpr double PI = std::numbers::pi;

// states at all steps, the start not among them
std::vector<WorldState> states_of(const Validation& v, const SceneRun& run) {
  std::vector<WorldState> states;
  v.run(run, [&](const WorldState& state, const StepReport&) {
    states.push_back(state);
    return true;
  });
  return states;
}

SceneRun with_step(SceneRun run, double factor) {
  run.scene.solver.time_step *= factor;
  return run;
}

// Time between the first two zeros of q, straight lines in between [s]
double half_period(const std::vector<WorldState>& states, double h) {
  std::vector<double> zeros;
  for (std::size_t i = 1; i < states.size(); ++i) {
    const double a = states[i - 1].joint_position[0], b = states[i].joint_position[0];
    if (a * b < 0) zeros.push_back(states[i - 1].time + h * a / (a - b));
  }
  return zeros.size() >= 2 ? zeros[1] - zeros[0] : std::nan("");
}

// dR/dt = R [w]x, I dw/dt = I w x w in the body's frame, by Runge and Kutta's method of order 4 [attitude at the end]
Mat3 tumble(const Mat3& inertia, const Vec3& start, double time) {
  const int n = 20000;
  const double h = time / n;
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Vec3 w = start;
  const auto spin = [&](const Vec3& u) -> Vec3 { return inertia.inverse() * (inertia * u).cross(u); };
  for (int i = 0; i < n; ++i) {
    const Vec3 k1 = spin(w), k2 = spin(w + h / 2 * k1), k3 = spin(w + h / 2 * k2), k4 = spin(w + h * k3);
    const Vec3 next = w + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), middle = w + h / 4 * (k1 + k2);
    const Vec3 turn = h / 6 * (w + 4 * middle + next);  // Magnus' series to second order
    q = q * Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    w = next;
  }
  return q.toRotationMatrix();
}

Mat3 rotation(const AffineMap& map) { return map.leftCols<3>(); }

}  // namespace

void validate_free_fall(Validation& v) {
  const SceneRun run = v.load("free_fall");
  const double h = run.scene.solver.time_step, n = double(run.n_steps()), g = -run.scene.gravity.z();
  const double fallen = -states_of(v, run).back().rigid[0](2, 3);
  v.check_relative("way", "m", g * h * h * n * (n + 1) / 2, fallen, 1e-6, "implicit Euler: g h^2 n (n + 1) / 2");
  const double finer = -states_of(v, with_step(run, 0.5)).back().rigid[0](2, 3);
  const double exact = g * run.duration * run.duration / 2;
  v.check("error at h by error at h / 2", "1", 2, (fallen - exact) / (finer - exact), 1e-4,
          "order 1, against g t^2 / 2");
}

void validate_oscillator(Validation& v) {
  const SceneRun run = v.load("oscillator");
  const double h = run.scene.solver.time_step, omega = 10;
  const std::vector<WorldState> states = states_of(v, run);
  double q = 0.1, last = q, worst = 0;  // q(-1) = q(0): starts at rest
  Plot plot{"oscillator", "Mass on a spring", "time [s]", "position [m]", std::vector<Curve>(2)};
  plot.curves[0].label = "simulated";
  plot.curves[1].label = "implicit Euler, by its recurrence";
  plot.curves[1].is_reference = true;
  for (const WorldState& state : states) {
    const double next = (2 * q - last) / (1 + omega * omega * h * h);
    last = q;
    q = next;
    worst = std::max(worst, std::abs(state.joint_position[0] - q) / 0.1);
    for (Curve& curve : plot.curves) curve.x.push_back(state.time);
    plot.curves[0].y.push_back(state.joint_position[0]);
    plot.curves[1].y.push_back(q);
  }
  v.check_at_most("largest deviation, share of the amplitude", "1", worst, 1e-6, "implicit Euler's recurrence");
  // x_n = Re(c l^n): the determinant x_n x_(n-2) - x_(n-1)^2 falls by |l|^2 per step
  const auto x = [&](std::size_t i) { return states[i].joint_position[0]; };
  const auto determinant = [&](std::size_t i) { return x(i) * x(i - 2) - x(i - 1) * x(i - 1); };
  const std::size_t n = states.size() - 1;
  v.check_relative("amplitude per step", "1", 1 / std::sqrt(1 + omega * omega * h * h),
                   std::pow(determinant(n) / determinant(2), 0.5 / double(n - 2)), 1e-6, "1 / sqrt(1 + w^2 h^2)");
  v.plot(std::move(plot));
}

void validate_pendulum(Validation& v) {
  const SceneRun run = v.load("pendulum");
  const double h = run.scene.solver.time_step, start = 0.02, l = 0.2, g = 9.81;
  const double inertia = 0.01 / 6 + l * l;  // about the hinge, per mass [m^2]
  const std::vector<WorldState> states = states_of(v, run);
  double q = start, last = q, worst = 0;
  for (const WorldState& state : states) {
    // the rotation nearest to what inertia and weight lead to
    const double next = std::arg(inertia * (2.0 * std::polar(1.0, q) - std::polar(1.0, last)) + h * h * g * l);
    last = q;
    q = next;
    worst = std::max(worst, std::abs(state.joint_position[0] - q) / start);
  }
  v.check_at_most("largest deviation, share of the amplitude", "1", worst, 1e-6, "implicit Euler's recurrence");
  const double coarse = 2 * half_period(states, h);
  const SceneRun finer = with_step(run, 0.5);
  const double fine = 2 * half_period(states_of(v, finer), h / 2);
  const double exact = 2 * PI * std::sqrt(inertia / (g * l)), omega = 2 * PI / exact;
  v.check_relative("period", "s", 2 * PI * h / std::atan(omega * h), coarse, 1e-4, "2 pi h / arctan(w h)");
  v.check_relative("period, h to 0", "s", exact, (4 * fine - coarse) / 3, 1e-4, "2 pi sqrt(I / (m g l)) = 0.91564 s");
}

void validate_spin(Validation& v) {
  const SceneRun run = v.load("spin");
  const double h = run.scene.solver.time_step, omega = run.scene.rigid_bodies[0].angular_velocity.z();
  double turn = std::atan(h * omega), angle = 0;  // the first step starts from the velocity, not from a turn
  const std::vector<WorldState> states = states_of(v, run);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (i > 0) turn = std::arg(2.0 - std::polar(1.0, -turn));
    angle += turn;
  }
  const Mat3 last = rotation(states.back().rigid[0]);
  const double measured = std::atan2(last(1, 0), last(0, 0));
  v.check("angle about z, whole turns left out", "rad", std::remainder(angle, 2 * PI), measured, 1e-6 * angle,
          "turn = arg(2 - exp(-i turn)) per step");

  SceneRun tumbling = run;
  tumbling.scene.rigid_bodies[0].angular_velocity = Vec3(0.4, 6, 0.3);
  const Mat3 exact = tumble(run.scene.rigid_bodies[0].inertia, Vec3(0.4, 6, 0.3), run.duration);
  double error[2];
  for (int i = 0; i < 2; ++i) {
    const Mat3 end = rotation(states_of(v, with_step(tumbling, i == 0 ? 0.5 : 0.25)).back().rigid[0]);
    error[i] = Eigen::AngleAxisd(Mat3(exact.transpose() * end)).angle();
  }
  v.report("tumbling: error of the attitude at h / 4", "rad", 0, error[1], "Euler's equations by Runge-Kutta");
  v.check("tumbling: error at h / 2 by error at h / 4", "1", 2, error[0] / error[1], 0.3, "order 1");
}

void validate_momentum(Validation& v) {
  double drift[3], way[3] = {}, worst = 0;
  for (int i = 0; i < 3; ++i) {
    const SceneRun run = with_step(v.load("momentum"), std::ldexp(1, -i));
    const Scene& scene = run.scene;
    const double h = scene.solver.time_step;
    const std::vector<double> soft_mass = node_masses(scene.soft_bodies[0].mesh, scene.soft_bodies[0].material.density);
    std::vector<Eigen::Matrix4d> mass;
    for (const RigidBody& body : scene.rigid_bodies) mass.push_back(affine_mass_matrix(body));
    const auto columns = [](const AffineMap& map) {  // p, a1, a2, a3
      AffineMap q;
      q << map.col(3), map.leftCols<3>();
      return q;
    };
    const auto momenta = [&](const SceneState& now, const SceneState& before, Vec3& linear, Vec3& angular) {
      linear = angular = Vec3::Zero();
      for (std::size_t b = 0; b < mass.size(); ++b) {
        const AffineMap x = columns(now.rigid[b]), p = (x - columns(before.rigid[b])) / h * mass[b];
        linear += p.col(0);
        for (int k = 0; k < 4; ++k) angular += Vec3(x.col(k)).cross(Vec3(p.col(k)));
      }
      for (std::size_t n = 0; n < soft_mass.size(); ++n) {
        const Vec3 p = soft_mass[n] / h * (now.soft[0][n] - before.soft[0][n]);
        linear += p;
        angular += now.soft[0][n].cross(p);
      }
    };
    const std::vector<WorldState> states = states_of(v, run);
    Vec3 linear0, angular0, linear = Vec3::Zero(), angular = Vec3::Zero();
    momenta(states[1], states[0], linear0, angular0);
    Vec3 before = angular0;
    for (std::size_t n = 2; n < states.size(); ++n) {
      momenta(states[n], states[n - 1], linear, angular);
      worst = std::max(worst, (linear - linear0).norm() / linear0.norm());
      way[i] += (angular - before).norm() / angular0.norm();
      before = angular;
    }
    drift[i] = (angular - angular0).norm() / angular0.norm();
  }
  v.check_at_most("linear momentum: largest change, share of it", "1", worst, 1e-6, "conserved");
  v.report("angular momentum: drift at h, share of it", "1", 0, drift[0], "conserved as h goes to 0");
  v.report("angular momentum: drift at h / 4, share of it", "1", 0, drift[2], "conserved as h goes to 0");
  // summed over the steps: drifts of opposite sign must not hide each other
  v.report("angular momentum: sum of its changes at h, share of it", "1", 0, way[0], "conserved as h goes to 0");
  v.check("angular momentum: sum of its changes at h by that at h / 4", "1", 4, way[0] / way[2], 1.5, "order 1");
}

}  // namespace pvg

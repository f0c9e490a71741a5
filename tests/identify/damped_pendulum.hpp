// A recorded pendulum whose joint has a spring and viscous friction that the scene does not have: for small swings a
// center of mass farther from the joint would do instead of the spring.
#pragma once
#include <cmath>
#include <random>
#include <string>

#include "host/identify/search/workflow.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {

struct DampedPendulum {
  static constexpr double SPRING = 0.05, DAMPING = 0.01;  // [N m/rad], [N m s/rad]
  static constexpr double NOISE = 2e-3;                   // [rad]

  // I q'' = -m g l sin(q) - k q - c q' with m = 0.7 kg, l = 0.15 m, released from rest, by Runge and Kutta's fourth
  // order.
  static std::string released(double q, double duration, unsigned seed) {
    constexpr double M = 0.7, L = 0.15, INERTIA = M * (0.05 * 0.05 + 0.3 * 0.3) / 12 + M * L * L, H = 1e-3;
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise(0, NOISE);
    const auto acceleration = [&](double at, double w) {
      return (-M * 9.81 * L * std::sin(at) - SPRING * at - DAMPING * w) / INERTIA;
    };
    std::string table = "t,q\n";
    double w = 0;
    for (int i = 0; i <= int(duration / H); ++i) {
      if (i % 5 == 0) table += std::to_string(H * i) + "," + std::to_string(q + noise(engine)) + "\n";
      const double a1 = acceleration(q, w), a2 = acceleration(q + H / 2 * w, w + H / 2 * a1),
                   a3 = acceleration(q + H / 2 * (w + H / 2 * a1), w + H / 2 * a2),
                   a4 = acceleration(q + H * (w + H / 2 * a2), w + H * a3);
      q += H * w + H * H / 6 * (a1 + a2 + a3);
      w += H / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    return table;
  }

  Problem recorded() const {
    folder.write("scene.yaml", R"(schema: 1
name: damped
time_step: 5 ms
solver: {integrator: bdf2}
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: bar, kind: rigid, shape: {box: {size: [0.05, 0.05, 0.3]}}, mass: 0.7, pose: {position: [0, 0, -0.15]}, collides: false}
joints:
  - {name: hinge, type: revolute, parent: base, child: bar, axis: [0, 1, 0]}
)");
    folder.write("a.csv", released(0.8, 2, 1));
    folder.write("b.csv", released(-1.0, 2, 2));
    folder.write("c.csv", released(1.8, 2, 3));
    folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
  - {file: b.csv, role: fit}
  - {file: c.csv, role: held_out}
channels:
  - {column: q, kind: position, joint: hinge, unit: rad, noise: 0.002}
)");
    return make_problem(folder.path / "recording.yaml");
  }

  const Candidate& candidate(const std::string& name) const {
    for (const Candidate& one : candidates)
      if (one.name == name) return one;
    throw std::out_of_range(name);
  }

  // The model of these effects, fitted from where they are off to the windows in `data`.
  Fit fitted(const std::vector<std::string>& names) {
    std::vector<const Candidate*> parts;
    for (const std::string& name : names) parts.push_back(&candidate(name));
    return flow.fitter.fit(data, {model_of(parts)}, 10).front();
  }

  TestFolder folder;
  Problem problem = recorded();
  Device device;
  Settings settings;
  Workflow flow{device, problem, settings};
  std::vector<Candidate> candidates = make_candidates(problem, {});
  FitData data = prepared();

 private:
  FitData prepared() {
    flow.base.scene = problem.scene.scene;
    return flow.fitter.prepare(make_windows(problem, false, 0, 2), Model{});
  }
};

}  // namespace pvg::diagnose

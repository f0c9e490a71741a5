// A recorded plate on a spindle with a spring that the scene does not have: without it the plate stands still or turns
// on, and no window but the shortest is followed.
#pragma once
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "host/identify/search/workflow.hpp"
#include "tests/identify/spindle.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {

struct SwingingPlate {
  static constexpr double SPRING = 2.0;  // [N m/rad]

  // A plate of I = 2 / 300 kg m^2 that swings from 0.1 rad for 2 s:
  //   q(t) = 0.1 cos(w t),  w = sqrt(SPRING / I) = 17 rad/s
  Problem recorded() const {
    folder.write("scene.yaml", plate_on_a_spindle("5 ms"));
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 0.001);
    std::string run = "t,q\n";
    for (int i = 0; i <= 200; ++i) {
      const double t = 0.01 * i;
      run +=
          std::to_string(t) + "," + std::to_string(0.1 * std::cos(std::sqrt(SPRING * 150) * t) + noise(random)) + "\n";
    }
    folder.write("a.csv", run);
    folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {column: q, kind: position, joint: spindle, unit: rad, noise: 0.001}
)");
    return make_problem(folder.path / "recording.yaml");
  }

  Model model(const std::string& name, double value) const {
    for (const Candidate& one : candidates) {
      if (one.name != name) continue;
      Model found = model_of({&one});
      found.x[0] = value;
      return found;
    }
    throw std::out_of_range(name);
  }

  FitData short_windows(const Model& at) {
    return flow.fitter.prepare(make_windows(problem, false, criteria().window_lengths.back(), 8), at);
  }

  // in eight windows, from a spring that is a little wrong
  Fit spring_in_windows() {
    const Model near = model("joint_spring", 0.98 * SPRING);
    return flow.fitter.fit(short_windows(near), {near}, 6).front();
  }

  TestFolder folder;
  Problem problem = recorded();
  Device device;
  Settings settings;
  Workflow flow{device, problem, settings};
  std::vector<Candidate> candidates = make_candidates(problem, {});

  SwingingPlate() { flow.base.scene = problem.scene.scene; }
};

}  // namespace pvg::diagnose

// A plate of 1 kg and 2 / 300 kg m^2 about a spindle, which 0.2 N m turn by 15 t^2 rad, measured for a second; beside it
// runs in which a hundredth of that turns it.
#pragma once
#include <string>

#include "host/identify/data/problem.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {

inline Problem spinning_plate(const TestFolder& folder, int n_slow = 0) {
  folder.write("scene.yaml", R"(schema: 1
name: flywheel
time_step: 5 ms
gravity: [0, 0, 0]
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false}
  - {name: plate, kind: rigid, shape: {box: {size: [0.2, 0.2, 0.02]}}, mass: 1, collides: false}
joints:
  - {name: spindle, type: revolute, parent: base, child: plate, axis: [0, 0, 1]}
)");
  std::string runs;
  for (int i = 0; i <= n_slow; ++i) {
    const double share = i == 0 ? 1 : 0.01;
    std::string run = "t,push,q\n";
    for (int k = 0; k <= 200; ++k) {
      const double t = 0.005 * k;
      run += std::to_string(t) + "," + std::to_string(share * 0.2) + "," + std::to_string(share * 15 * t * t) + "\n";
    }
    const std::string file = "run_" + std::to_string(i) + ".csv";
    folder.write(file, run);
    runs += "  - {file: " + file + ", role: fit, initial: {joint/spindle/position: 0, joint/spindle/velocity: 0}}\n";
  }
  folder.write("recording.yaml", std::string(R"(schema: 1
scene: scene.yaml
runs:
)") + runs + R"(inputs:
  - {column: push, target: joint/spindle/torque, unit: N m}
channels:
  - {column: q, kind: position, joint: spindle, unit: rad, noise: 0.001}
)");
  return make_problem(folder.path / "recording.yaml");
}

}  // namespace pvg::diagnose

// A plate of 1 kg and 2 / 300 kg m^2 about a spindle, which 0.2 N m turn by 15 t^2 rad, measured for a second.
#pragma once
#include <string>

#include "host/identify/data/problem.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {

inline Problem spinning_plate(const TestFolder& folder) {
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
  std::string run = "t,push,q\n";
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.005 * i;
    run += std::to_string(t) + ",0.2," + std::to_string(15 * t * t) + "\n";
  }
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit, initial: {joint/spindle/position: 0, joint/spindle/velocity: 0}}
inputs:
  - {column: push, target: joint/spindle/torque, unit: N m}
channels:
  - {column: q, kind: position, joint: spindle, unit: rad, noise: 0.001}
)");
  return make_problem(folder.path / "recording.yaml");
}

}  // namespace pvg::diagnose

// The files of a recording: an arm of 1 kg on a drive, without gravity, that follows commands in one run.
#pragma once
#include <string>

#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {

// solver: further lines of the scene; drive: as a mapping.
inline std::string driven_arm(const std::string& time_step, const std::string& drive, const std::string& solver = "") {
  return R"(schema: 1
name: driven
gravity: [0, 0, 0]
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: arm, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, pose: {position: [0.15, 0, 0]}, collides: false}
joints:
  - {name: shoulder, type: revolute, parent: base, child: arm, axis: [0, 0, 1], drive: )" +
         drive + "}\ntime_step: " + time_step + "\n" + solver;
}

// run: a table with the columns t, command and q; initial: a line, or nothing.
inline void write_driven_recording(const TestFolder& folder, const std::string& run, const std::string& initial = "") {
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
inputs:
  - {column: command, target: joint/shoulder/position}
channels:
  - {column: q, kind: position, joint: shoulder, unit: rad, noise: 0.001}
)" + initial);
}

}  // namespace pvg::diagnose

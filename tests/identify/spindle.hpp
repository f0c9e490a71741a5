// The scene of a plate of 1 kg and 2 / 300 kg m^2 about the spindle that carries it, without gravity.
#pragma once
#include <string>

namespace pvg::diagnose {

inline std::string plate_on_a_spindle(const std::string& time_step) {
  return "schema: 1\nname: plate\ntime_step: " + time_step + R"(
gravity: [0, 0, 0]
solver: {integrator: bdf2}
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false}
  - {name: plate, kind: rigid, shape: {box: {size: [0.2, 0.2, 0.02]}}, mass: 1, collides: false}
joints:
  - {name: spindle, type: revolute, parent: base, child: plate, axis: [0, 0, 1]}
)";
}

}  // namespace pvg::diagnose

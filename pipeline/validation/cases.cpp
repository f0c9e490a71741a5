#include "pipeline/validation/cases.hpp"

namespace pvg {

const std::vector<ValidationCase>& validation_cases() {
  static const std::vector<ValidationCase> CASES = {
      {"free_fall", "a box falls: the integrator's own parabola", validate_free_fall, true},
      {"oscillator", "a mass on a drive's spring: the integrator's own damping", validate_oscillator, true},
      {"pendulum", "a cube on a hinge: its period", validate_pendulum, true},
      {"spin", "a box turning freely, about one axis and tumbling", validate_spin, true},
      {"momentum", "bodies collide in empty space", validate_momentum, true},
      {"weight", "a resting body's contact force", validate_weight, true},
      {"contact_law", "pressure of a box on a floor by the gap between them", validate_contact_law, true},
      {"grasp", "a cube between soft pads just above and below the critical friction", validate_grasp, false},
      {"slope", "a cube on a slope of tan 0.5 just above, at and below the critical friction", validate_slope, true},
      {"ramp", "eight cubes of different friction on a ramp of 30 degrees", validate_ramp, true},
      {"stopping", "cubes slide to a stop from 2 m/s", validate_stopping, true},
      {"joint_signs", "each joint type turns and moves the way its axis says", validate_joint_signs, true},
      {"drive", "a drive's deflection under a load", validate_drive, true},
      {"four_bar", "a closed loop of four hinges", validate_four_bar, true},
      {"tensile", "a bar on rollers, pulled", validate_tensile, true},
      {"rib", "a thin rib, one layer of elements, bent", validate_rib, true},
      {"elastica", "a beam bent far by a load at its tip", validate_elastica, false},
      {"finger", "a fin-ray finger pressed on its pad: its mesh against a finer one", validate_finger, false},
      {"heavy_cantilever", "a beam bent far by its own weight", validate_heavy_cantilever, false},
      {"heavy_cantilever_cloth", "a strip of cloth bent far by its own weight", validate_heavy_cantilever_cloth, true},
      {"drape", "round fabrics on a round plate: Cusick's test", validate_drape, false},
      {"stack", "ten boxes on each other, the heaviest on top", validate_stack, false},
      {"arch", "a round arch of 25 blocks", validate_arch, false},
      {"card_house", "seven cards", validate_card_house, false},
      {"hertz", "an elastic sphere squeezed between two planes", validate_hertz, false},
      {"squeeze_out", "soft blocks pressed through a slot", validate_squeeze_out, false},
      {"knives", "a soft mat falls on blades", validate_knives, false},
      {"slots", "keys fall through tight slots", validate_slots, false},
      {"twist", "a soft mat twisted by four turns", validate_twist, false},
      {"touching", "aligned and degenerate touching", validate_touching, false},
      {"silicone_beam", "measured: a silicone beam under its weight and a load", validate_silicone_beam, false},
      {"cube_toss", "measured: tosses of a cube", validate_cube_toss, false},
  };
  return CASES;
}

}  // namespace pvg

// Laws that a scene gives by formulas (regressed_effort, regressed_force), as text for their kernels.
//   joints: terms revolute_law and prismatic_law       bodies: force_law, which writes the force of rows of
//   `point_force`
#pragma once
#include <string>

#include "host/physics/energies/system.hpp"

namespace pvg {

// The number of this law among `laws`, where it is added if it is new.
u32 number_of(LawTexts& laws, const std::string& law);

// "#define NAME case 0: return LAW; case 1: return LAW;" and an end of line: a switch's cases over all laws
std::string law_cases(const std::string& name, const LawTexts& laws);

class ForceLaws {
 public:
  ForceLaws(Device& device, const System& system);
  // This step's forces into the elements of `point_force`. x, v: sites at its start [n_sites x 3] [m], [m/s]; h: its
  // length [s]
  void write(Buffer<unsigned char>& forces, const Buffer<f64>& x, const Buffer<f64>& v, double h);

 private:
  Program program_;
  Kernel force_law_;
  Buffer<ForceLaw> laws_;
};

}  // namespace pvg

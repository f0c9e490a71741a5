// Every term of kernels/energies whose elements never change, as members that are named after their kernels.
#pragma once
#include <vector>

#include "host/physics/energies/laws.hpp"
#include "host/physics/energies/small_terms.hpp"
#include "host/physics/linear/term.hpp"

namespace pvg {

class Terms {
 public:
  // With the elements of all worlds.
  Terms(Device& device, const System& system);
  Terms(const Terms&) = delete;

#define MEMBER(folder, name, Struct, stencil) Term name;
  ENERGY_TERMS(MEMBER)
#undef MEMBER

  const std::vector<Term*>& all() const { return all_; }  // in the order of sums
  // Those that are launched together: where the device is a CPU those of few elements, elsewhere all but those whose
  // elements kernels write. Their rows, blocks and energies must have their places. first_energy: of each of all()
  std::vector<SmallTermSource> small(const Device& device, const System& system, std::span<const u32> first_energy);

 private:
  std::vector<Term*> all_;
};

}  // namespace pvg

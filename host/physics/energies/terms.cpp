#include "host/physics/energies/terms.hpp"

#include <type_traits>

namespace pvg {
namespace {

// what has to stand before the kernel file of a term: the laws that this scene gives by formulas
template <class Params>
std::string front(const System& system) {
  if constexpr (std::is_same_v<Params, RevoluteLaw> || std::is_same_v<Params, PrismaticLaw>)
    return law_cases("JOINT_LAWS", system.joint_laws);
  return "";
}

}  // namespace

#define MAKE(folder, name, Struct, stencil) name(device, #folder, #name, stencil, front<Struct>(system)),
Terms::Terms(Device& device, const System& system)
    : ENERGY_TERMS(MAKE)
#undef MAKE
#define POINTER(folder, name, Struct, stencil) &name,
          all_{ENERGY_TERMS(POINTER)} {
#undef POINTER
#define SET(folder, name, Struct, stencil) name.set(system.name.rows, system.name.world_first);
  ENERGY_TERMS(SET)
#undef SET
}

}  // namespace pvg

#include "host/physics/energies/terms.hpp"

#include <type_traits>

namespace pvg {
namespace {

// elements: of more, a kernel of their own runs faster on a CPU, in vectors
constexpr std::size_t MOST_FEW = 512;

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

std::vector<SmallTermSource> Terms::small(const Device& device, const System& system,
                                          std::span<const u32> first_energy) {
  const bool is_cpu = device.info().runs_host_functions;
  const bool flows = !system.plastic_flow_4.empty() || !system.plastic_flow_10.empty();
  std::vector<SmallTermSource> sources;
  std::size_t place = 0;
  const auto add = [&](Term& term, const std::string& folder, const std::string& name, const std::string& params) {
    const u32 energy = first_energy[place++];
    if (term.size() == 0) return;
    if (is_cpu && (term.size() > MOST_FEW || folder == "elastic")) return;
    if (flows && folder == "elastic") return;  // the elements are changed where the term itself keeps them
    if (&term == &point_force && !system.force_law.empty()) return;
    const bool is_inertia = &term == &point_inertia || &term == &affine_inertia;
    sources.push_back({&term, "energies/" + folder + "/" + name + ".cl", name, params, is_inertia, energy});
  };
#define ADD(folder, name, Struct, stencil) add(name, #folder, #name, #Struct);
  ENERGY_TERMS(ADD)
#undef ADD
  return sources;
}

}  // namespace pvg

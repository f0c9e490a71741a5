#include "host/physics/energies/laws.hpp"

#include <algorithm>

namespace pvg {

u32 number_of(LawTexts& laws, const std::string& law) {
  const auto at = std::find(laws.begin(), laws.end(), law);
  const u32 number = u32(at - laws.begin());
  if (at == laws.end()) laws.push_back(law);
  return number;
}

std::string law_cases(const std::string& name, const LawTexts& laws) {
  std::string text = "#define " + name;
  for (std::size_t i = 0; i < laws.size(); ++i) text += " case " + std::to_string(i) + ": return " + laws[i] + ";";
  return text + "\n";
}

ForceLaws::ForceLaws(Device& device, const System& system)
    : program_(
          Program::from_text(device, "force_law of this scene",
                             law_cases("FORCE_LAWS", system.force_laws) + "#include \"energies/body/force_law.cl\"\n")),
      force_law_(program_.kernel("force_law")),
      laws_(device, system.force_law, "force_law") {}

void ForceLaws::write(Buffer<unsigned char>& forces, const Buffer<f64>& x, const Buffer<f64>& v, double h) {
  force_law_(laws_.size(), u32(laws_.size()), laws_, forces, x, v, h);
}

}  // namespace pvg

#include "host/physics/energies/small_terms.hpp"

namespace pvg {
namespace {

// The functions of each term, then two kernels in which a work-item finds its term and does what belongs to one
// element.
std::string text_of(const std::vector<SmallTermSource>& sources, const std::string& front) {
  std::string text = front + "#define TERM_FUNCTIONS_ONLY\n#include \"energies/small_terms.h\"\n";
  for (const SmallTermSource& source : sources) text += "#include \"" + source.file + "\"\n";
  const auto kernel = [&](const std::string& name, const std::string& outputs, const auto& work) {
    text +=
        "kernel void small_" + name +
        "(const uint n, global const SmallTerm* restrict terms, global const uchar* restrict params,\n"
        "    global const real* restrict x, global const real* restrict start, global const real* restrict predicted,\n"
        "    const real h, const real inertia_h, " +
        outputs + ") {\n  const uint i = get_global_id(0);\n  if (i >= n) return;\n  uint e;\n";
    for (std::size_t k = 0; k < sources.size(); ++k) {
      const SmallTermSource& source = sources[k];
      const std::string term = "terms[" + std::to_string(k) + "]";
      const std::string arguments = "(e, (global const " + source.params + "*)(params + " + term + ".first_byte), x, " +
                                    (source.is_inertia ? "predicted, inertia_h, " : "start, h, ");
      text += "  e = i - " + term + ".first_item;\n  if (e < " + term + ".n) {\n" + work(source.name, term, arguments) +
              "    return;\n  }\n";
    }
    text += "}\n";
  };
  kernel("energy", "global real* restrict energy",
         [](const std::string& name, const std::string& term, const std::string& arguments) {
           return "    " + name + "_energy_of" + arguments + term + ".first_energy, energy);\n";
         });
  kernel("derivatives", "global real* restrict rows, global real* restrict blocks",
         [](const std::string& name, const std::string& term, const std::string& arguments) {
           return "    " + name + "_gradient_of" + arguments + term + ".first_row, rows);\n    " + name +
                  "_hessian_of" + arguments + term + ".first_block, blocks);\n";
         });
  return text;
}

}  // namespace

SmallTerms::Kernels::Kernels(Device& device, const std::string& text)
    : program(Program::from_text(device, "small terms of this scene", text)),
      energy(program.kernel("small_energy")),
      derivatives(program.kernel("small_derivatives")) {}

SmallTerms::SmallTerms(Device& device, std::vector<SmallTermSource> sources, std::string front)
    : device_(&device),
      sources_(std::move(sources)),
      front_(std::move(front)),
      terms_(device, sources_.size(), "terms"),
      params_(device, 0, "params") {
  std::size_t n_bytes = 0;
  for (const SmallTermSource& source : sources_) n_bytes += source.term->n_param_bytes();
  params_.resize(n_bytes);
  std::vector<SmallTerm> terms;
  u32 first_byte = 0;
  for (const SmallTermSource& source : sources_) {
    Term& term = *source.term;
    term.move_params(params_, first_byte);
    terms.push_back(
        {n_items_, u32(term.size()), first_byte, source.first_energy, term.first_row, term.first_block(), {}});
    first_byte += u32(term.n_param_bytes());
    n_items_ += u32((term.size() + GROUP_SIZE - 1) / GROUP_SIZE * GROUP_SIZE);
  }
  terms_.write(terms);
}

SmallTerms::Kernels& SmallTerms::kernels() {
  if (!kernels_) kernels_.emplace(*device_, text_of(sources_, front_));
  return *kernels_;
}

void SmallTerms::energy(const Buffer<f64>& x, const Buffer<f64>& start, const Buffer<f64>& predicted, double h,
                        double inertia_h, Buffer<f64>& energy) {
  if (n_items_ > 0) kernels().energy(n_items_, n_items_, terms_, params_, x, start, predicted, h, inertia_h, energy);
}

void SmallTerms::differentiate(const Buffer<f64>& x, const Buffer<f64>& start, const Buffer<f64>& predicted, double h,
                               double inertia_h, Buffer<f64>& rows, Buffer<f64>& blocks) {
  if (n_items_ > 0)
    kernels().derivatives(n_items_, n_items_, terms_, params_, x, start, predicted, h, inertia_h, rows, blocks);
}

}  // namespace pvg

#include "host/physics/energies/small_terms.hpp"

namespace pvg {
namespace {

// arguments of the kernels
const std::string INPUTS =
    "global const SmallTerm* restrict terms, global const uchar* restrict params,\n"
    "    global const real* restrict x, global const real* restrict start, global const real* restrict predicted,\n"
    "    const real h, const real inertia_h";
const std::string ENERGY = "global real* restrict energy";
const std::string DERIVATIVES = "global real* restrict rows, global real* restrict blocks";

// The functions of each term, and two in which a work-item finds its term and does what belongs to one element.
std::string functions_of(const std::vector<SmallTermSource>& sources, const std::string& front) {
  std::string text = front + "#define TERM_FUNCTIONS_ONLY\n#include \"energies/small_terms.h\"\n";
  for (const SmallTermSource& source : sources) text += "#include \"" + source.file + "\"\n";
  const auto function = [&](const std::string& name, const std::string& outputs, const auto& work) {
    text +=
        "static inline void small_" + name + "_of_item(const uint i, " + INPUTS + ", " + outputs + ") {\n  uint e;\n";
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
  function("energy", ENERGY, [](const std::string& name, const std::string& term, const std::string& arguments) {
    return "    " + name + "_energy_of" + arguments + term + ".first_energy, energy);\n";
  });
  function("derivatives", DERIVATIVES,
           [](const std::string& name, const std::string& term, const std::string& arguments) {
             return "    " + name + "_gradient_of" + arguments + term + ".first_row, rows);\n    " + name +
                    "_hessian_of" + arguments + term + ".first_block, blocks);\n";
           });
  return text;
}

// These alone, and in one launch with contact: small terms come first, in whole work-groups.
std::string text_of(const std::vector<SmallTermSource>& sources, const std::string& front, bool with_contact) {
  const std::string item = "  const uint i = get_global_id(0);\n",
                    given = "(i, terms, params, x, start, predicted, h, inertia_h, ";
  if (!with_contact)
    return functions_of(sources, front) + "kernel void small_energy(const uint n, " + INPUTS + ", " + ENERGY + ") {\n" +
           item + "  if (i < n) small_energy_of_item" + given + "energy);\n}\n" +
           "kernel void small_derivatives(const uint n, " + INPUTS + ", " + DERIVATIVES + ") {\n" + item +
           "  if (i < n) small_derivatives_of_item" + given + "rows, blocks);\n}\n";
  const std::string friction =
      ", const uint n_small, const uint n_friction, global const Friction* restrict friction, ";
  return functions_of(sources, front) + "#include \"energies/contact/contact_items.cl\"\n" +
         "kernel __attribute__((reqd_work_group_size(64, 1, 1))) void all_energy(const uint n, " + INPUTS + friction +
         "global const Barrier* restrict candidates,\n    const uint first_friction, " + ENERGY +
         ", global uint* restrict is_active, global uint* restrict counts) {\n  local uint count;\n" + item +
         "  const uint n_before = n_small + whole_groups(n_friction);\n  bool exerts_force = false;\n"
         "  if (i < n_small)\n    small_energy_of_item" +
         given +
         "energy);\n  else\n    exerts_force = contact_energy_of_item(i - n_small, n - n_small, n_friction, friction, "
         "candidates, x,\n        start, h, first_friction, energy, is_active);\n"
         "  const uint n_active = count_active(exerts_force, &count);\n"
         "  if (get_local_id(0) == 0 && i >= n_before) counts[(i - n_before) / 64] = n_active;\n}\n" +
         "kernel void all_derivatives(const uint n, " + INPUTS + friction +
         "const uint n_contacts, const uint n_worlds,\n    global const uint* restrict first_contact, global const "
         "Barrier* "
         "restrict contacts, const uint first_row, " +
         DERIVATIVES +
         ",\n    global real* restrict contact_blocks, global real* restrict friction_blocks, const uint begins, "
         "global FrictionDual* restrict dual) {\n" +
         item + "  if (i < n_small)\n    small_derivatives_of_item" + given +
         "rows, blocks);\n  else\n    contact_derivatives_of_item(i - n_small, n - n_small, n_friction, n_contacts, "
         "friction, n_worlds, first_contact, contacts, x,\n        start, h, first_row, rows, contact_blocks, "
         "friction_blocks, begins, "
         "dual);\n}\n";
}

}  // namespace

SmallTerms::Kernels::Kernels(Device& device, const std::string& text, const std::string& kind)
    : program(Program::from_text(device, kind + " terms of this scene", text)),
      energy(program.kernel(kind + "_energy")),
      derivatives(program.kernel(kind + "_derivatives")) {}

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
  if (!kernels_) kernels_.emplace(*device_, text_of(sources_, front_, false), "small");
  return *kernels_;
}

SmallTerms::Kernels& SmallTerms::kernels_with_contact() {
  if (!kernels_with_contact_) kernels_with_contact_.emplace(*device_, text_of(sources_, front_, true), "all");
  return *kernels_with_contact_;
}

void SmallTerms::energy(const At& at, Buffer<f64>& energy) {
  if (n_items_ > 0)
    kernels().energy(n_items_, n_items_, terms_, params_, at.x, at.start, at.predicted, at.h, at.inertia_h, energy);
}

void SmallTerms::energy(const At& at, Buffer<f64>& energy, u32 n_contact_items, u32 n_friction, u32 first_friction,
                        ContactSet& contacts) {
  const u32 n = n_items_ + n_contact_items;
  kernels_with_contact().energy(n, n, terms_, params_, at.x, at.start, at.predicted, at.h, at.inertia_h, n_items_,
                                n_friction, contacts.friction().rows, contacts.candidates().rows, first_friction,
                                energy, contacts.activity(), contacts.activity_counts());
}

void SmallTerms::differentiate(const At& at, Buffer<f64>& rows, Buffer<f64>& blocks) {
  if (n_items_ > 0)
    kernels().derivatives(n_items_, n_items_, terms_, params_, at.x, at.start, at.predicted, at.h, at.inertia_h, rows,
                          blocks);
}

void SmallTerms::differentiate(const At& at, Buffer<f64>& rows, Buffer<f64>& blocks, u32 n_contact_items,
                               const ContactSet& contacts, Term& barrier, Term& friction, bool begins,
                               Buffer<FrictionDual>& dual) {
  const u32 n = n_items_ + n_contact_items;
  kernels_with_contact().derivatives(n, n, terms_, params_, at.x, at.start, at.predicted, at.h, at.inertia_h, n_items_,
                                     u32(friction.size()), contacts.friction().rows, u32(barrier.size()),
                                     contacts.n_worlds(), contacts.first_contact(), contacts.contacts().rows,
                                     barrier.first_row, rows, blocks, barrier.own_blocks(), friction.own_blocks(),
                                     u32(begins), dual);
}

}  // namespace pvg

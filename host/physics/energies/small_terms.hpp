// Energy terms of few elements each, such as joints, drives and inertia, in one launch: their kernels take less time
// than it takes to start them; on a device apart from the host that goes for all terms. What is computed for each
// element is what its own kernels compute.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "energies/small_terms.h"
#include "host/physics/contact/contact.hpp"
#include "host/physics/linear/term.hpp"

namespace pvg {

// A term and what its kernels are made from.
struct SmallTermSource {
  Term* term;
  std::string file, name, params;  // of the kernels, its functions' prefix, its struct
  bool is_inertia;                 // goes by predicted positions and the integrator's step
  u32 first_energy;                // in the buffer of energies
};

class SmallTerms {
 public:
  // Moves the terms' elements into one buffer. first_row and the blocks of each term are where they are to be.
  // front: what stands before the kernels, as for a Term. Nothing is compiled before it is used.
  SmallTerms(Device& device, std::vector<SmallTermSource> sources, std::string front);
  SmallTerms(const SmallTerms&) = delete;

  // As Term's. x, start, predicted: sites [n_sites x 3, m]; h, inertia_h [s]
  struct At {
    const Buffer<f64>&x, &start, &predicted;
    double h, inertia_h;
  };
  void energy(const At& at, Buffer<f64>& energy);
  // Gradient and Hessian blocks.
  void differentiate(const At& at, Buffer<f64>& rows, Buffer<f64>& blocks);
  // The same, and in the same launch contact and friction, whose arguments are those of
  // kernels/energies/contact/contact_items.cl. n_contact_items: of them
  bool is_empty() const { return n_items_ == 0; }
  void energy(const At& at, Buffer<f64>& energy, u32 n_contact_items, u32 n_friction, u32 first_friction,
              ContactSet& contacts);
  void differentiate(const At& at, Buffer<f64>& rows, Buffer<f64>& blocks, u32 n_contact_items,
                     const ContactSet& contacts, Term& barrier, Term& friction, bool begins,
                     Buffer<FrictionDual>& dual);

 private:
  struct Kernels {
    Kernels(Device& device, const std::string& text, const std::string& kind);
    Program program;
    Kernel energy, derivatives;
  };
  Kernels& kernels();
  Kernels& kernels_with_contact();

  Device* device_;
  std::vector<SmallTermSource> sources_;
  std::string front_;
  std::optional<Kernels> kernels_, kernels_with_contact_;
  Buffer<SmallTerm> terms_;
  Buffer<unsigned char> params_;
  u32 n_items_ = 0;
};

}  // namespace pvg

// What is not assembled into the matrix: contacts and friction, elements of four sites.
#pragma once
#include <span>

#include "host/device/device.hpp"
#include "host/physics/linear/gather.hpp"
#include "host/physics/linear/term.hpp"
#include "solve/site.h"

namespace pvg {

struct ContactElements {
  std::span<const Term* const> terms;  // at most two, sorted by world each; their rows follow each other
  u32 first_row = 0;
  // what the device needs besides
  const Gather* gather = nullptr;              // from these rows to nodes
  const Buffer<u32>* element_sites = nullptr;  // [n_elements x 4] of all terms
  const Buffer<Site>* sites = nullptr;
  Buffer<f64>* rows = nullptr;

  u32 n_of(std::size_t term) const { return term < terms.size() ? u32(terms[term]->size()) : 0; }
  u32 n() const { return n_of(0) + n_of(1); }
};

}  // namespace pvg

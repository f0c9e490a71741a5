// What sticking contacts remember from step to step, so that they hold without creeping. Friction of a contact acts on
//   u = sliding within the step + e,      |e| <= epsilon_v h      (kernels/energies/contact/friction.cl)
// Without e a tangential load would need u > 0, and so some sliding, in every step. With e = u of the step before, cut
// to epsilon_v h where friction is fully developed, a contact under a constant load comes to rest; the largest force
// stays mu lambda. Kept as the strain s = e / (epsilon_v h), which means the same force whatever the length of the
// step.
#pragma once
#include <span>
#include <vector>

#include "energies/contact/friction.h"
#include "host/model/checkpoint.hpp"

namespace pvg {

template <class Row>
PairKey pair_key(const Row& row) {
  return {row.kind, row.site[0], row.site[1], row.site[2], row.site[3]};
}

// Sets each row's anchor, for a step of length h [s]: the strain of its pair, laid into its tangent plane; zero for a
// pair that was not in contact, which begins unloaded as its normal force does. anchors: sorted by pair
void attach_anchors(std::span<const FrictionAnchor> anchors, double h, std::span<Friction> rows);
// Those of these rows, sorted by pair. strain: of each row at the end of the step [n x 3]
std::vector<FrictionAnchor> anchors_of(std::span<const Friction> rows, std::span<const double> strain);

}  // namespace pvg

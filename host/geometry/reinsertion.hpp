// A better tree for meshes that stay as they are: subtrees are taken out and put back where the tree's boxes grow least
// (Bittner, Hapala, Havran 2013, "Fast Insertion-Based Optimization of Bounding Volume Hierarchies"; the search goes
// up from the old place as in Meister, Bittner 2018, "Parallel Reinsertion for Bounding Volume Hierarchy
// Optimization").
#pragma once
#include "host/geometry/binary_tree.hpp"

namespace pvg {

// Sum of the half areas of all inner nodes, what a traversal pays for boxes [m^2].
double inner_area(const BinaryTree& tree);

// Never makes inner_area larger; the tree is one part afterwards, each node before its children.
void reinsert_subtrees(BinaryTree& tree);

}  // namespace pvg

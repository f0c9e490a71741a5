// Which pairs of nodes that contacts couple the factors of the preconditioner hold.
#include <algorithm>
#include <iterator>
#include <utility>

#include "host/physics/step/potential.hpp"

namespace pvg {
namespace {

constexpr std::size_t LARGEST_SURPLUS = 2;  // pairs held for each one in contact: the rest costs fill in vain
constexpr double FEW = 0.02;                // of the pairs in contact are left to conjugate gradients within a step

}  // namespace

void Potential::couple_contacts(std::span<const char> worlds, Coupling when) {
  std::vector<std::vector<NodePair>> next = next_couplings(worlds, when);
  if (next != couplings_) restore_couplings(next);
}

std::vector<std::vector<NodePair>> Potential::next_couplings(std::span<const char> worlds, Coupling when) {
  std::vector<std::vector<NodePair>> next = couplings_;
  if (!preconditioner_->takes_contacts() || std::none_of(worlds.begin(), worlds.end(), [](char in) { return in; }))
    return next;
  if (const std::size_t n = 4 * std::size_t(barrier_.world_first().back()); barrier_.sites().size() < n)
    barrier_.know(contact_sites_.read(0, n), std::vector<u32>(barrier_.world_first()));  // the device alone has them
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    if (!worlds[w]) continue;
    std::vector<NodePair> pairs;
    for (const Term* term : {&barrier_, &friction_})
      for (u32 e = term->world_first()[w]; e < term->world_first()[w + 1]; ++e)
        append_coupled(std::span(term->sites()).subspan(4 * std::size_t(e), 4), pairs);
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    std::vector<NodePair> all;
    std::set_union(next[w].begin(), next[w].end(), pairs.begin(), pairs.end(), std::back_inserter(all));
    if (when == Coupling::step_begins && all.size() > LARGEST_SURPLUS * pairs.size()) all = std::move(pairs);
    if (when == Coupling::before_solve && double(all.size() - next[w].size()) <= FEW * double(pairs.size())) continue;
    next[w] = std::move(all);
  }
  return next;
}

// The pairs of moving nodes that carry these sites, without those that the matrix couples already.
void Potential::append_coupled(std::span<const u32> sites, std::vector<NodePair>& pairs) const {
  std::vector<u32> nodes;
  for (const u32 site : sites)
    for (int k = 0; k < 4; ++k)
      if (const u32 node = system_.sites[site].node[k];
          system_.sites[site].weight[k] != 0 && system_.node_group[node] != NO_GROUP)
        nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = i + 1; j < nodes.size(); ++j)
      if (matrix_->pattern().find(nodes[i], nodes[j]) == NO_BLOCK) pairs.push_back({nodes[i], nodes[j]});
}

void Potential::restore_couplings(const std::vector<std::vector<NodePair>>& couplings) {
  couplings_ = couplings;
  std::vector<NodePair> all;
  for (const std::vector<NodePair>& pairs : couplings_) all.insert(all.end(), pairs.begin(), pairs.end());
  preconditioner_->couple(all);
}

}  // namespace pvg

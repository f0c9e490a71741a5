#include "host/physics/linear/block_matrix.hpp"

#include <algorithm>
#include <stdexcept>

namespace pvg {
namespace {

// Calls found(row node, column node, row slot, column slot, weight) for every pair of moving nodes of one element.
template <class Found>
void for_each_pair(std::span<const Site> sites, std::span<const u32> node_is_fixed, std::span<const u32> element_sites,
                   const Found& found) {
  for (std::size_t a = 0; a < element_sites.size(); ++a)
    for (std::size_t b = 0; b < element_sites.size(); ++b) {
      const Site &row = sites[element_sites[a]], &column = sites[element_sites[b]];
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
          const double weight = row.weight[i] * column.weight[j];
          if (weight != 0 && !node_is_fixed[row.node[i]] && !node_is_fixed[column.node[j]])
            found(row.node[i], column.node[j], a, b, weight);
        }
    }
}

template <class Found>
void for_each_pair(std::span<const Site> sites, std::span<const u32> node_is_fixed, const Term& term,
                   const Found& found) {
  const std::size_t stencil = term.stencil();
  for (std::size_t e = 0; e < term.size(); ++e)
    for_each_pair(sites, node_is_fixed, std::span(term.sites()).subspan(e * stencil, stencil),
                  [&](u32 row, u32 column, std::size_t a, std::size_t b, double weight) {
                    found(row, column, e * 9 * stencil * stencil + 9 * a * stencil + 3 * b, weight);
                  });
}

MatrixPattern find_pattern(std::span<const Site> sites, std::span<const u32> node_is_fixed,
                           std::span<Term* const> terms) {
  std::vector<std::vector<u32>> columns(node_is_fixed.size());
  for (u32 node = 0; node < columns.size(); ++node)
    if (!node_is_fixed[node]) columns[node].push_back(node);
  for (const Term* term : terms)
    for_each_pair(sites, node_is_fixed, *term,
                  [&](u32 row, u32 column, std::size_t, double) { columns[row].push_back(column); });
  MatrixPattern pattern{{0}, {}};
  for (std::vector<u32>& row : columns) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    pattern.column.insert(pattern.column.end(), row.begin(), row.end());
    pattern.first.push_back(u32(pattern.column.size()));
  }
  return pattern;
}

}  // namespace

u32 MatrixPattern::find(u32 row, u32 wanted) const {
  const auto begin = column.begin() + first[row], end = column.begin() + first[row + 1];
  const auto found = std::lower_bound(begin, end, wanted);
  return found != end && *found == wanted ? u32(found - column.begin()) : NO_BLOCK;
}

BlockMatrix::BlockMatrix(Device& device, std::span<const Site> sites, std::span<const u32> node_is_fixed,
                         std::span<Term* const> terms)
    : pattern_(find_pattern(sites, node_is_fixed, terms)),
      program_(device, "solve/block_matrix.cl"),
      block_product_(program_.kernel("block_product")),
      add_element_blocks_(program_.kernel("add_element_blocks")),
      first_(device, pattern_.first, "first block of row"),
      column_(device, pattern_.column, "column"),
      blocks_(device, 9 * pattern_.n_blocks(), "matrix blocks") {
  for (const Term* term : terms) parts_.push_back(find_parts(device, sites, node_is_fixed, *term));
}

// A counting sort by block: parts of one block stay in the order of the elements.
BlockMatrix::Parts BlockMatrix::find_parts(Device& device, std::span<const Site> sites,
                                           std::span<const u32> node_is_fixed, const Term& term) const {
  if (term.size() * 9 * term.stencil() * term.stencil() > ~0u)
    throw UsageError("term " + term.name() + " has too many elements for one device; divide the scene");
  std::vector<u32> next(pattern_.n_blocks() + 1, 0);
  for_each_pair(sites, node_is_fixed, term,
                [&](u32 row, u32 column, std::size_t, double) { ++next[pattern_.find(row, column) + 1]; });
  std::vector<u32> touched, first = {0};
  for (std::size_t block = 0; block < pattern_.n_blocks(); ++block) {
    if (next[block + 1] > 0) {
      touched.push_back(u32(block));
      first.push_back(first.back() + next[block + 1]);
    }
    next[block + 1] += next[block];
  }
  std::vector<u32> source(first.back());
  std::vector<double> weight(first.back());
  for_each_pair(sites, node_is_fixed, term, [&](u32 row, u32 column, std::size_t from, double w) {
    const u32 place = next[pattern_.find(row, column)]++;
    source[place] = u32(from);
    weight[place] = w;
  });
  return {Buffer<u32>(device, touched, "touched blocks"), Buffer<u32>(device, first, "first part of block"),
          Buffer<u32>(device, source, "source of part"), Buffer<f64>(device, weight, "weight of part")};
}

void BlockMatrix::assemble(std::span<Term* const> terms) {
  blocks_.zero();
  for (std::size_t t = 0; t < terms.size(); ++t) {
    const Parts& parts = parts_.at(t);
    const u32 n = u32(parts.touched.size());
    add_element_blocks_(n, n, u32(3 * terms[t]->stencil()), parts.touched, parts.first, parts.source, parts.weight,
                        terms[t]->blocks(), blocks_);
  }
}

void BlockMatrix::multiply(const Buffer<f64>& x, Buffer<f64>& y) {
  const u32 n = u32(pattern_.n_nodes());
  block_product_(n, n, first_, column_, blocks_, x, y);
}

}  // namespace pvg

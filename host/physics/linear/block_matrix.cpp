#include "host/physics/linear/block_matrix.hpp"

#include <algorithm>
#include <stdexcept>

#include "host/physics/linear/world_rows.hpp"

namespace pvg {
namespace {

constexpr u32 NEW_TERM = 1u << 31, TRANSPOSED = 1u << 30, PARTS_AHEAD = 16;  // as in solve/assemble_block.cl

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

// The number of block (i, j), i <= j, among those that an element keeps (kernels/energies/upper_blocks.cl).
std::size_t upper_block(std::size_t stencil, const std::pair<std::size_t, std::size_t>& ij) {
  const auto [i, j] = ij;
  return i * stencil - i * (i - 1) / 2 + j - i;
}

// The same for all elements of a term: found(row node, column node, number of the block, is transposed, weight).
template <class Found>
void for_each_pair(std::span<const Site> sites, std::span<const u32> node_is_fixed, const Term& term,
                   const Found& found) {
  const std::size_t stencil = term.stencil();
  for (std::size_t e = 0; e < term.size(); ++e)
    for_each_pair(sites, node_is_fixed, std::span(term.sites()).subspan(e * stencil, stencil),
                  [&](u32 row, u32 column, std::size_t a, std::size_t b, double weight) {
                    found(row, column, e * term.n_element_numbers() / 9 + upper_block(stencil, std::minmax(a, b)),
                          a > b, weight);
                  });
}

MatrixPattern find_pattern(std::span<const Site> sites, std::span<const u32> node_is_fixed,
                           std::span<Term* const> terms) {
  std::vector<std::vector<u32>> columns(node_is_fixed.size());
  for (u32 node = 0; node < columns.size(); ++node)
    if (!node_is_fixed[node]) columns[node].push_back(node);
  for (const Term* term : terms)
    for_each_pair(sites, node_is_fixed, *term,
                  [&](u32 row, u32 column, std::size_t, bool, double) { columns[row].push_back(column); });
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
                         std::span<Term* const> terms, std::span<const WorldRange> nodes)
    : pattern_(find_pattern(sites, node_is_fixed, terms)),
      program_(device, "solve/block_matrix.cl"),
      block_product_(program_.kernel("block_product")),
      block_product_and_dot_(program_.kernel("block_product_and_dot")),
      assemble_blocks_(program_.kernel("assemble_blocks")),
      first_(device, pattern_.first, "first block of row"),
      column_(device, pattern_.column, "column"),
      blocks_(device, 9 * pattern_.n_blocks(), "matrix blocks"),
      element_blocks_(device, 0, "element blocks"),
      place_(device, 0, "place of block"),
      part_first_(device, 0, "first part of block"),
      part_source_(device, 0, "source of part"),
      part_weight_(device, 0, "weight of part") {
  std::size_t n_numbers = 0;
  for (const Term* term : terms) n_numbers += term->n_block_numbers();
  if (n_numbers > ~0u) throw UsageError("the scene has too many elements for one device; divide it");
  element_blocks_.resize(n_numbers);
  n_numbers = 0;
  for (Term* term : terms) {
    term->move_blocks(element_blocks_, n_numbers);
    n_numbers += term->n_block_numbers();
  }
  find_parts(sites, node_is_fixed, terms, nodes);
}

// A counting sort by block on and above the diagonal: parts of one block stay in the order of the terms and their
// elements.
void BlockMatrix::find_parts(std::span<const Site> sites, std::span<const u32> node_is_fixed,
                             std::span<Term* const> terms, std::span<const WorldRange> nodes) {
  std::vector<u32> place, number(pattern_.n_blocks());  // of the upper blocks; among them, of each block
  world_first_.assign(1, 0);
  for (u32 row = 0; row < pattern_.n_nodes(); ++row) {
    while (world_first_.size() < nodes.size() && row >= nodes[world_first_.size()].begin)
      world_first_.push_back(u32(place.size() / 2));
    for (u32 block = pattern_.first[row]; block < pattern_.first[row + 1]; ++block) {
      if (pattern_.column[block] < row) continue;
      number[block] = u32(place.size() / 2);
      place.insert(place.end(), {block, pattern_.find(pattern_.column[block], row)});
    }
  }
  const auto for_each_part = [&](const auto& found) {
    for (const Term* term : terms)
      for_each_pair(sites, node_is_fixed, *term,
                    [&](u32 row, u32 column, std::size_t from, bool is_transposed, double weight) {
                      if (row <= column) found(number[pattern_.find(row, column)], *term, from, is_transposed, weight);
                    });
  };
  const u32 n_upper_blocks = u32(place.size() / 2);
  world_first_.resize(std::max<std::size_t>(1, nodes.size()) + 1, n_upper_blocks);
  std::vector<u32> first(n_upper_blocks + 1, 0);
  for_each_part([&](u32 block, const Term&, std::size_t, bool, double) { ++first[block + 1]; });
  for (std::size_t block = 0; block < n_upper_blocks; ++block) first[block + 1] += first[block];
  std::vector<u32> next(first.begin(), first.end() - 1), source(first.back() + PARTS_AHEAD, 0);
  std::vector<double> weights(first.back());
  std::vector<const Term*> last(n_upper_blocks, nullptr);
  for_each_part([&](u32 block, const Term& term, std::size_t from, bool is_transposed, double weight) {
    const u32 part = next[block]++;
    source[part] =
        u32(term.first_block() / 9 + from) | (last[block] == &term ? 0 : NEW_TERM) | (is_transposed ? TRANSPOSED : 0);
    weights[part] = weight;
    last[block] = &term;
  });
  const auto upload = [](auto& buffer, const auto& values) {
    buffer.resize(values.size());
    buffer.write(values);
  };
  upload(place_, place);
  upload(part_first_, first);
  upload(part_source_, source);
  upload(part_weight_, weights);
}

void BlockMatrix::assemble(std::span<const char> worlds) {
  for (const auto& [begin, end] : pieces_of(world_first_, worlds))
    assemble_blocks_(end - begin, end - begin, begin, place_, part_first_, part_source_, part_weight_, element_blocks_,
                     blocks_);
}

void BlockMatrix::assemble_and_gather(const Gather& first, const Gather& second, const Buffer<u32>& node_is_fixed,
                                      const Buffer<f64>& rows, Buffer<f64>& node, Buffer<f64>& dx,
                                      Buffer<f64>& residual) {
  if (!gather_and_assemble_) {
    Program program(blocks_.memory().device(), "solve/gather_and_assemble.cl");
    gather_and_assemble_.emplace(program.kernel("gather_and_assemble"));
  }
  const u32 n_nodes = u32(pattern_.n_nodes()), group = u32(GROUP_SIZE);
  const u32 n = (n_nodes + group - 1) / group * group + world_first_.back();
  (*gather_and_assemble_)(n, n, n_nodes, first.offset(), first.row(), first.weight(), second.offset(), second.row(),
                          second.weight(), node_is_fixed, rows, node, dx, residual, place_, part_first_, part_source_,
                          part_weight_, element_blocks_, blocks_);
}

void BlockMatrix::multiply_and_dot(const Buffer<f64>& x, const Gather* gather, const Buffer<u32>& node_is_fixed,
                                   const Buffer<f64>& rows, Buffer<f64>& y, WorldChunks& chunks) {
  const u32 n = u32(GROUP_SIZE * chunks.n_chunks());
  block_product_and_dot_(n, n, chunks.chunks(), first_, column_, blocks_, u32(gather != nullptr),
                         gather ? gather->offset() : first_, gather ? gather->row() : column_,
                         gather ? gather->weight() : blocks_, node_is_fixed, rows, x, y, chunks.partial());
}

void BlockMatrix::multiply(const Buffer<f64>& x, Buffer<f64>& y) {
  const u32 n = u32(pattern_.n_nodes());
  block_product_(n, n, first_, column_, blocks_, x, y);
}

}  // namespace pvg

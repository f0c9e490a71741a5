// Cholesky factor of a symmetric positive definite sparse matrix of 3 x 3 blocks, made again for new numbers with the
// same pattern. Multifrontal (Duff, Reid 1983; Liu 1992): each supernode of the elimination tree assembles its rows
// of the matrix and its children's updates into a dense front, factors its pivots and passes an update to its parent.
// Subtrees are independent and may run on several threads; sums have one order, so the bits do not depend on them.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "host/base/workers.hpp"
#include "host/physics/linear/elimination_tree.hpp"
#include "host/physics/linear/front_kernels.hpp"

namespace pvg {

// Real: the precision of the factor and of solves. In single precision a factor is taken only where each pivot is at
// least a ten thousandth of what stood on the diagonal: then it has three digits or more, and conjugate gradients need
// hardly more iterations with it, at half the memory. What rounding leaves of a pivot that is lost altogether is less.
template <class Real>
class BlockCholesky {
 public:
  // orders and allocates; everything after it allocates nothing. position: of each node [m], or nothing; order: the
  // cheapest where none is asked for
  explicit BlockCholesky(const BlockPattern& pattern, std::span<const Vec3> position = {},
                         std::optional<NodeOrder> order = {});
  BlockCholesky(const BlockPattern& pattern, EliminationTree tree);  // of this pattern

  // blocks: one 3 x 3 block for each of the pattern, row-major [n_blocks x 9]; of a diagonal block the lower triangle
  // is read. False where the matrix is not positive definite or not finite, or too much is lost to single precision;
  // then solve() must not be called.
  bool factorize(std::span<const double> blocks, Workers* workers = nullptr);
  // the same of blocks wherever they are [n_blocks]
  bool factorize(std::span<const double* const> blocks, Workers* workers = nullptr);
  // x = A^-1 x in place [n_nodes x 3]; not from several threads at once, it needs the fronts' memory
  void solve(std::span<double> x, Workers* workers = nullptr) const;

  const EliminationTree& tree() const { return tree_; }  // its cost: of one factorisation
  bool uses_threads() const { return subtrees_.size() > 1; }
  std::size_t n_bytes() const { return sizeof(CacheLine) * n_panel_lines_; }  // stored in the factor

 private:
  static constexpr int IN_LINE = 64 / sizeof(Real);
  struct alignas(64) CacheLine {
    Real values[IN_LINE];
  };
  struct Entry {
    u32 block;  // of the matrix
    int first;  // index of its first number in the panel
    bool is_transposed;
  };
  struct Front {
    Panel<Real> panel;
    Real* update = nullptr;  // [panel.n_rows x panel.n_rows], lower triangle, passed to the parent
    int update_stride = 0;
    Real* x = nullptr;           // [panel.stride] of solve()
    Real* least = nullptr;       // [panel.n_pivots] that each pivot may be
    std::vector<Run> to_parent;  // from the rows below its pivots to rows of the parent's panel
    std::vector<Entry> entries;
  };

  void lay_out_panels();
  void choose_subtrees();
  void lay_out_updates();
  void map_to_parents();
  void map_entries(const BlockPattern& pattern);

  bool factor(u32 front, std::span<const double* const> blocks) const;
  static void assemble(const Front& front, std::span<const double* const> blocks);
  enum class Part { PIVOTS, REST };  // columns of the parent
  static void add_update(const Front& child, const Front& parent, Part part);
  void forward(u32 front, std::span<const double> x) const;
  void backward(u32 front, std::span<double> x) const;
  template <class Task>
  void for_each_subtree(Workers* workers, double least_cost, const Task& task) const;

  // supernodes [first, last), the last of them the root
  struct Subtree {
    u32 first, last;
    double cost;
  };
  EliminationTree tree_;
  std::vector<Front> fronts_;                      // of each supernode
  std::vector<Subtree> subtrees_;                  // independent of each other, the costliest first
  std::vector<u32> top_;                           // supernodes above them, children before parents
  std::vector<char> has_failed_;                   // of each subtree
  std::unique_ptr<CacheLine[]> panels_, updates_;  // not cleared: what is used is written first
  std::size_t n_panel_lines_ = 0;
  std::vector<CacheLine> x_;
  std::vector<Real> least_;
};

}  // namespace pvg

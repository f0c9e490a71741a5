#include "host/physics/linear/device_factor.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <numeric>

#include "host/physics/linear/group_preconditioner.hpp"
#include "spring_matrices.hpp"

namespace pvg {
namespace {

// Matrices of groups that lie one behind the other, each with nodes, blocks and a world of its own.
struct Groups {
  void add(const Matrix& matrix) {
    const u32 first_node = u32(n_nodes), first_block = u32(blocks.size() / 9);
    trees.push_back(eliminate(matrix.pattern));
    patterns.push_back(matrix.pattern);
    nodes.emplace_back(matrix.pattern.n_nodes());
    std::iota(nodes.back().begin(), nodes.back().end(), first_node);
    sources.emplace_back(matrix.pattern.row.size());
    std::iota(sources.back().begin(), sources.back().end(), first_block);
    blocks.insert(blocks.end(), matrix.blocks.begin(), matrix.blocks.end());
    n_nodes += matrix.pattern.n_nodes();
  }
  std::vector<FactorGroup> list() const {
    std::vector<FactorGroup> groups;
    for (u32 g = 0; g < trees.size(); ++g) groups.push_back({&trees[g], &patterns[g], nodes[g], sources[g], g});
    return groups;
  }
  std::vector<EliminationTree> trees;
  std::vector<BlockPattern> patterns;
  std::vector<std::vector<u32>> nodes, sources;
  std::vector<double> blocks;
  std::size_t n_nodes = 0;
};

// Factors in the active worlds, then solves; NaN where nothing was written.
struct Solved {
  std::optional<u32> failed;
  Eigen::VectorXd x;
  std::vector<double> factor;  // of the first group, dense
};
Solved solve(Device& device, const Groups& groups, const Eigen::VectorXd& b, std::vector<char> active = {},
             bool adds = false) {
  if (active.empty()) active.assign(groups.trees.size(), true);
  DeviceFactor factor(device, groups.n_nodes);
  factor.set(groups.list());
  const Buffer<f64> blocks(device, groups.blocks, "blocks"),
      residual(device, std::vector<double>(b.begin(), b.end()), "residual");
  const double before = adds ? 1 : std::numeric_limits<double>::quiet_NaN();
  Buffer<f64> z(device, std::vector<double>(std::size_t(b.size()), before), "z");
  factor.start_factorize(blocks, {}, active);
  factor.start_apply(residual, adds, z);
  const std::vector<double> x = z.read();
  // solved half in the launches that factor: the same bits
  const Eigen::VectorXd minus_b = -b;
  const Buffer<f64> gradient(device, std::vector<double>(minus_b.begin(), minus_b.end()), "gradient");
  Buffer<f64> again(device, std::vector<double>(std::size_t(b.size()), before), "z");
  factor.start_factorize(blocks, {}, active, &gradient);
  factor.start_apply(residual, adds, again);
  const std::vector<double> again_x = again.read();
  EXPECT_EQ(std::memcmp(x.data(), again_x.data(), sizeof(double) * x.size()), 0);
  return {factor.failed(), Eigen::Map<const Eigen::VectorXd>(x.data(), b.size()), factor.dense(0)};
}

Eigen::SparseMatrix<double> in_order_of_elimination(const Matrix& matrix, const EliminationTree& tree) {
  Eigen::PermutationMatrix<Eigen::Dynamic> place(3 * Eigen::Index(tree.order.size()));  // of each unknown
  for (u32 node = 0; node < tree.order.size(); ++node)
    for (u32 c = 0; c < 3; ++c) place.indices()[3 * node + c] = int(3 * tree.position[node] + c);
  const Eigen::SparseMatrix<double> all = lower_triangle(matrix).selfadjointView<Eigen::Lower>();
  Eigen::SparseMatrix<double> ordered;
  ordered = all.twistedBy(place);
  return ordered;
}

TEST(DeviceFactor, TimesItsTransposeIsTheMatrix) {
  Device device;
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Matrix matrix = masses_and_springs(c.n_nodes, c.edges, 1.0, 3.0, 5);
    Groups groups;
    groups.add(matrix);
    const Solved solved = solve(device, groups, right_hand_side(matrix));
    ASSERT_EQ(solved.failed, std::nullopt);
    const Eigen::Index n = 3 * Eigen::Index(c.n_nodes);
    const Eigen::Map<const Eigen::MatrixXd> dense(solved.factor.data(), n, n);
    EXPECT_TRUE(dense.isLowerTriangular(0));
    const Eigen::SparseMatrix<double> L = dense.sparseView(), product = L * L.transpose(),
                                      expected = in_order_of_elimination(matrix, groups.trees[0]);
    const Eigen::SparseMatrix<double> difference = product - expected;
    EXPECT_LE(difference.coeffs().cwiseAbs().maxCoeff(), 1e-12 * expected.coeffs().cwiseAbs().maxCoeff());
  }
}

TEST(DeviceFactor, SolvesBackwardStablyForStiffSpringsBesideSmallMasses) {
  Device device;
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const Matrix matrix = masses_and_springs(c.n_nodes, c.edges, 1e-3, 1e9, 6);
    Groups groups;
    groups.add(matrix);
    const Solved solved = solve(device, groups, right_hand_side(matrix));
    ASSERT_EQ(solved.failed, std::nullopt);
    EXPECT_LE(backward_error(matrix, solved.x), 1e-14);
  }
}

Groups three_worlds() {
  Groups groups;
  groups.add(masses_and_springs(400, random_edges(400, 3000, 15, 4), 1.0, 3.0, 7));
  groups.add(masses_and_springs(257, chain(257), 1.0, 3.0, 8));
  groups.add(masses_and_springs(61, complete(61), 1.0, 3.0, 9));
  return groups;
}

Eigen::VectorXd any_vector(std::size_t n_nodes) {
  Eigen::VectorXd b(3 * n_nodes);
  for (Eigen::Index i = 0; i < b.size(); ++i) b[i] = std::sin(1 + 7.3 * double(i));
  return b;
}

TEST(DeviceFactor, GivesAWorldTheSameBitsBesideOthersAsAlone) {
  Device device;
  const Groups together = three_worlds();
  const Eigen::VectorXd b = any_vector(together.n_nodes), all = solve(device, together, b).x;
  Groups alone;
  alone.add(masses_and_springs(400, random_edges(400, 3000, 15, 4), 1.0, 3.0, 7));
  EXPECT_EQ(all.head(1200), solve(device, alone, b.head(1200)).x);
}

TEST(DeviceFactor, LeavesWorldsThatAreNotActiveAtZero) {
  Device device;
  const Groups groups = three_worlds();
  const Eigen::VectorXd b = any_vector(groups.n_nodes), all = solve(device, groups, b).x;
  const Eigen::VectorXd some = solve(device, groups, b, {true, false, true}).x;
  EXPECT_EQ(some.head(1200), all.head(1200));
  EXPECT_EQ(some.segment(1200, 771), Eigen::VectorXd::Zero(771));
  EXPECT_EQ(some.tail(183), all.tail(183));
}

TEST(DeviceFactor, AddsToWhatIsThere) {
  Device device;
  const Groups groups = three_worlds();
  const Eigen::VectorXd b = any_vector(groups.n_nodes), x = solve(device, groups, b).x,
                        added = solve(device, groups, b, {true, false, true}, true).x;
  EXPECT_EQ(added.head(1200), (x.head(1200).array() + 1).matrix());
  EXPECT_EQ(added.segment(1200, 771), Eigen::VectorXd::Ones(771));
}

TEST(DeviceFactor, NamesTheGroupThatIsNotPositiveDefiniteAndSolvesTheOthers) {
  Device device;
  const Groups groups = three_worlds();
  const Eigen::VectorXd b = any_vector(groups.n_nodes), all = solve(device, groups, b).x;
  const u32 first = groups.sources[1][0];
  for (const double spoiled :
       {-1e-3, 0.0, -1e9, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    for (const u32 node : {0u, 128u, 256u}) {
      Groups broken = groups;
      broken.blocks[9 * (first + groups.patterns[1].column_first[node]) + 4] = spoiled;
      const Solved solved = solve(device, broken, b);
      EXPECT_EQ(solved.failed, std::optional(1u)) << spoiled << " at node " << node;
      EXPECT_EQ(solved.x.head(1200), all.head(1200));
      EXPECT_EQ(solved.x.segment(1200, 771), Eigen::VectorXd::Zero(771));
      EXPECT_EQ(solved.x.tail(183), all.tail(183));
    }
}

// Random positive semidefinite blocks between sites of two nodes each, some within the pattern, some not, some across
// groups: the host's factor of the same is the reference.
TEST(DeviceFactor, TakesContactsAsTheHostDoes) {
  Device device;
  constexpr u32 N = 90, N_SITES = 60, N_FIRST = 17, N_SECOND = 9;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Site> sites;
  for (u32 i = 0; i < N_SITES; ++i) sites.push_back({{u32(random() % N), u32(random() % N), 0, 0}, {0.3, 0.7, 0, 0}});
  for (Site& site : sites)
    if (site.node[0] == site.node[1]) site.weight[0] = 1, site.weight[1] = 0;
  const Matrix matrix = masses_and_springs(N, chain(N), 1.0, 3.0, 12);
  MatrixPattern pattern{{0}, {}};  // both halves, by rows
  std::vector<double> blocks;
  for (u32 r = 0; r < N; ++r) {
    for (u32 c = r == 0 ? 0 : r - 1; c <= std::min(N - 1, r + 1); ++c) {
      pattern.column.push_back(c);
      u32 k = matrix.pattern.column_first[std::min(r, c)] + (r != c);
      for (u32 e = 0; e < 9; ++e) {
        const u32 at = r >= c ? e : 3 * (e % 3) + e / 3;
        blocks.push_back(matrix.blocks[9 * k + at]);
      }
    }
    pattern.first.push_back(u32(pattern.column.size()));
  }
  Term first(device, "contact", "barrier", 4), second(device, "contact", "friction", 4);
  std::vector<u32> element_sites;
  const auto set = [&](Term& term, u32 n) {
    std::vector<u32> own;
    for (u32 i = 0; i < 4 * n; ++i) own.push_back(u32(random() % N_SITES));
    std::vector<double> numbers;
    for (u32 e = 0; e < n; ++e) {
      Eigen::Matrix<double, 3, 12> root;
      for (double& number : root.reshaped()) number = normal(random);
      const Eigen::Matrix<double, 12, 12> block = 5 * root.transpose() * root;
      numbers.insert(numbers.end(), block.data(), block.data() + 144);
    }
    term.set_sites(own, {0, n});
    term.own_blocks().resize(numbers.size());
    term.own_blocks().write(numbers);
    element_sites.insert(element_sites.end(), own.begin(), own.end());
  };
  set(first, N_FIRST);
  set(second, N_SECOND);
  const Buffer<Site> device_sites(device, sites, "sites");
  const Buffer<u32> device_element_sites(device, element_sites, "element sites");
  const u32 first_row = 7;
  Gather gather(device, sites, N);
  const RowBlock rows[] = {{first.sites(), first_row}, {second.sites(), first_row + 4 * N_FIRST}};
  gather.set(rows);
  const Term* const terms[] = {&first, &second};
  const ContactElements contacts{terms, first_row, &gather, &device_element_sites, &device_sites};

  std::vector<u32> group(N);
  for (u32 i = 0; i < N; ++i) group[i] = i < 60 ? 0 : 1;
  const std::vector<double> position(3 * N, 0.0);
  for (const bool couples : {false, true}) {
    std::vector<NodePair> pairs;
    for (u32 i = 0; couples && i < 60; i += 2) pairs.push_back({i, (7 * i + 3) % 60});
    std::erase_if(pairs, [](const NodePair& pair) { return pair[0] == pair[1]; });
    std::vector<std::vector<double>> solved;
    for (Device* where : {static_cast<Device*>(nullptr), &device}) {
      GroupPreconditioner preconditioner(pattern, sites, position, group, std::vector<u32>{0, 0}, pairs, where);
      Buffer<f64> values(device, blocks, "matrix blocks");
      preconditioner.start_factorize(values, contacts, std::vector<char>{true});
      const Buffer<f64> residual(device, std::vector<double>(3 * N, 1.0), "residual");
      Buffer<f64> z(device, 3 * N, "z");
      preconditioner.start_apply(residual, false, z);
      solved.push_back(z.read());
      ASSERT_EQ(preconditioner.failed(), std::nullopt);
    }
    double largest = 0, difference = 0;
    for (u32 i = 0; i < 3 * N; ++i) {
      largest = std::max(largest, std::abs(solved[0][i]));
      difference = std::max(difference, std::abs(solved[0][i] - solved[1][i]));
    }
    EXPECT_LE(difference, 1e-12 * largest);
  }
}

TEST(FactorSchedule, TakesEachFrontOnceAfterItsChildren) {
  const EliminationTree tree = eliminate(pattern_of(600, solid(4, 5, 30)));
  std::vector<u32> parent;
  for (const Supernode& node : tree.supernodes) parent.push_back(node.parent);
  for (const double launch : {0.0, 3.0, 1e9}) {
    const FactorSchedule schedule = make_schedule(parent, std::vector<double>(parent.size(), 1.0), launch, 8);
    std::vector<std::array<u32, 3>> place(parent.size(), {~0u, 0, 0});  // stage, task, place in it
    for (u32 stage = 0; stage < schedule.n_stages(); ++stage)
      for (u32 task = schedule.stage_first[stage]; task < schedule.stage_first[stage + 1]; ++task)
        for (u32 k = schedule.task_first[task]; k < schedule.task_first[task + 1]; ++k) {
          EXPECT_EQ(place[schedule.front[k]][0], ~0u);
          place[schedule.front[k]] = {stage, task, k};
        }
    for (u32 s = 0; s < parent.size(); ++s) {
      ASSERT_NE(place[s][0], ~0u);
      if (parent[s] == NO_PARENT) continue;
      const auto &child = place[s], &above = place[parent[s]];
      EXPECT_TRUE(child[0] < above[0] || (child[1] == above[1] && child[2] < above[2]));
    }
    EXPECT_EQ(schedule.n_stages() == 1, launch == 1e9);  // where nothing is worth a second one
  }
}

}  // namespace
}  // namespace pvg

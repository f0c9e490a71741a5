// The multilevel Schwarz preconditioner: its coarse functions carry affine motions exactly, one cluster is an exact
// inverse, it is symmetric, and iterations hardly grow with the mesh.
#include "host/physics/linear/multilevel_schwarz.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <cmath>

#include "host/geometry/primitive_shapes.hpp"
#include "host/physics/linear/conjugate_gradients.hpp"
#include "host/physics/step/potential.hpp"
#include "host/physics/step/simulation.hpp"
#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

using Kind = SolverSettings::Preconditioner;

SoftBody soft_block(const std::string& name, int divisions, const Vec3& at) {
  SoftBody body;
  body.name = name;
  body.mesh = box_solid(Vec3::Constant(0.1), {divisions, divisions, divisions}, 4);
  body.material.density = 1000;
  body.material.youngs_modulus = 1e5;
  body.material.poisson_ratio = 0.45;
  body.contact_offset = 1e-4;
  body.pose.translation() = at;
  return body;
}

PhysicalScene blocks_and_box(int divisions, Kind kind) {
  PhysicalScene scene = empty_scene("blocks", 0.01);
  scene.solver.preconditioner = kind;
  scene.soft_bodies = {soft_block("one", divisions, Vec3(0, 0, 0)), soft_block("two", 2, Vec3(0.3, 0, 0))};
  scene.rigid_bodies = {box_body("box", Vec3::Constant(0.02), 500, Vec3(0, 0.3, 0)),
                        fixed_box("table", Vec3(1, 1, 0.01), Vec3(0, 0, -1))};
  return scene;
}

// The potential of a scene at its start, differentiated there.
struct AtStart {
  AtStart(Device& device, const PhysicalScene& scene)
      : system(make_system(std::span(&scene, 1))),
        potential(device, system),
        x(device, system.n_nodes(), system.sites.size(), "x"),
        gradient(device, system.x.size(), "gradient") {
    x.node.write(system.x);
    potential.update_sites(x);
    potential.begin_step(x, x, scene.solver.time_step, scene.solver.time_step);
    potential.differentiate(x, gradient);
    EXPECT_EQ(potential.factorize(std::vector<char>(1, true)), std::nullopt);
  }
  int iterations(Device& device) {
    std::vector<double> force(system.x.size(), 0.0);
    for (std::size_t node = 0; node < system.n_nodes(); ++node)
      if (!system.node_is_fixed[node]) force[3 * node + 2] = std::sin(1.0 + double(node));
    Buffer<f64> load(device, force, "load"), dx(device, force.size(), "dx");
    ConjugateGradients cg(device, system.node_world, 1, system.node_ranges);
    const CgReport report = cg.solve([&](const Buffer<f64>& p, Buffer<f64>& out) { potential.product(p, out); },
                                     [&](const Buffer<f64>& r, Buffer<f64>& out) { potential.precondition(r, out); },
                                     load, {true}, 1e-4, 2000, dx);
    EXPECT_TRUE(report.has_converged[0]);
    return report.iterations[0];
  }
  System system;
  Potential potential;
  Positions x;
  Buffer<f64> gradient;
};

MatrixPattern chain_pattern(u32 n) {
  MatrixPattern pattern{{0}, {}};
  for (u32 i = 0; i < n; ++i) {
    for (u32 j = i ? i - 1 : 0; j <= std::min(i + 1, n - 1); ++j) pattern.column.push_back(j);
    pattern.first.push_back(u32(pattern.column.size()));
  }
  return pattern;
}

TEST(SchwarzHierarchy, EveryMovingNodeHasOneSlotAndTheCoarseFunctionsCarryAffineFields) {
  const PhysicalScene scene = blocks_and_box(5, Kind::schwarz);
  const System system = make_system(std::span(&scene, 1));
  Device device;
  Potential potential(device, system);
  const u32 frames[] = {system.rigid_first_node[0][0], system.rigid_first_node[0][1]};
  // a chain is pattern enough for the soft nodes here; frames hang on their neighbours in it
  const SchwarzHierarchy hierarchy = make_schwarz_hierarchy(
      chain_pattern(u32(system.n_nodes())), {system.x, system.node_world, system.node_is_fixed, frames}, 32, 12);
  ASSERT_GE(hierarchy.levels.size(), 2u);
  EXPECT_EQ(hierarchy.levels.back().n_clusters(), 1u);
  std::vector<char> is_taken(hierarchy.levels[0].n_slots(), false);
  for (std::size_t node = 0; node < system.n_nodes(); ++node) {
    const u32 slot = hierarchy.slot_of_node[node];
    EXPECT_EQ(slot == NO_SLOT, bool(system.node_is_fixed[node]));
    if (slot == NO_SLOT) continue;
    EXPECT_FALSE(is_taken[slot]);
    is_taken[slot] = true;
  }
  for (u32 k = 1; k < 4; ++k) EXPECT_EQ(hierarchy.slot_of_node[frames[0] + k], hierarchy.slot_of_node[frames[0]] + k);

  // the field 2 + x - 3 y + z/2 of points, and of axes its linear part, projected onto each level and back
  Eigen::VectorXd field = Eigen::VectorXd::Zero(Eigen::Index(hierarchy.levels[0].n_slots()));
  for (std::size_t node = 0; node < system.n_nodes(); ++node) {
    const u32 slot = hierarchy.slot_of_node[node];
    if (slot == NO_SLOT) continue;
    const bool is_axis = node > frames[0] && node < frames[0] + 4;
    field[slot] = (is_axis ? 0 : 2) + system.x[3 * node] - 3 * system.x[3 * node + 1] + 0.5 * system.x[3 * node + 2];
  }
  for (std::size_t l = 0; l + 1 < hierarchy.levels.size(); ++l) {
    const SchwarzLevel& level = hierarchy.levels[l];
    Eigen::VectorXd coarse = Eigen::VectorXd::Zero(Eigen::Index(hierarchy.levels[l + 1].n_slots())), back = 0 * field;
    for (u32 s = 0; s < level.n_slots(); ++s)
      for (u32 a = 0; a < 4; ++a) coarse[level.parent[s / level.width] + a] += level.weights[s][a] * field[s];
    for (u32 s = 0; s < level.n_slots(); ++s)
      for (u32 a = 0; a < 4; ++a) back[s] += level.weights[s][a] * coarse[level.parent[s / level.width] + a];
    EXPECT_LT((back - field).norm(), 1e-9 * field.norm()) << "level " << l;
    field = coarse;
  }
}

TEST(SchwarzHierarchy, PartsThatNothingConnectsAreNotInOneClusterAtFirst) {
  // two chains of 20 nodes side by side, 1 mm apart: by position alone they would share clusters
  MatrixPattern pattern = chain_pattern(40);
  pattern.column.erase(pattern.column.begin() + pattern.first[20] - 1);  // 19 -> 20
  for (u32 i = 20; i <= 40; ++i) --pattern.first[i];
  pattern.column.erase(pattern.column.begin() + pattern.first[20]);  // 20 -> 19
  for (u32 i = 21; i <= 40; ++i) --pattern.first[i];
  std::vector<double> position;
  for (int i = 0; i < 40; ++i) position.insert(position.end(), {0.01 * (i % 20), i < 20 ? 0 : 0.001, 0});
  const std::vector<u32> zero(40, 0);
  const SchwarzHierarchy hierarchy = make_schwarz_hierarchy(pattern, {position, zero, zero, {}}, 8, 12);
  for (int i = 0; i < 20; ++i)
    for (int j = 20; j < 40; ++j) EXPECT_NE(hierarchy.slot_of_node[i] / 8, hierarchy.slot_of_node[j] / 8);
}

TEST(MultilevelSchwarz, OneClusterIsTheExactInverse) {
  Device device;
  PhysicalScene scene = empty_scene("small", 0.01);
  scene.solver.preconditioner = Kind::schwarz;
  scene.soft_bodies = {soft_block("one", 2, Vec3::Zero())};  // 27 nodes, one cluster of at most 32
  AtStart problem(device, scene);
  std::vector<double> wanted(problem.system.x.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = std::cos(0.3 * double(i * i));
  Buffer<f64> x(device, wanted, "x"), ax(device, wanted.size(), "Ax"), back(device, wanted.size(), "M^-1 A x");
  problem.potential.product(x, ax);
  problem.potential.precondition(ax, back);
  const std::vector<double> found = back.read();
  for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 2e-4);  // single precision
}

using Sparse = Eigen::SparseMatrix<double>;

// W of one level as a matrix, each weight three times
Sparse coarse_functions(const SchwarzLevel& level, std::size_t n_coarse_slots) {
  std::vector<Eigen::Triplet<double>> entries;
  for (u32 s = 0; s < level.n_slots(); ++s)
    for (u32 a = 0; a < 4; ++a)
      for (u32 c = 0; c < 3; ++c)
        entries.emplace_back(3 * s + c, 3 * (level.parent[s / level.width] + a) + c, level.weights[s][a]);
  Sparse w(Eigen::Index(3 * level.n_slots()), Eigen::Index(3 * n_coarse_slots));
  w.setFromTriplets(entries.begin(), entries.end());
  return w;
}

// sum_k P_k B_k^-1 P_k^T r over the levels from l on, in double precision: z_l = B_l^-1 r + W_l z_l+1(W_l^T r)
Eigen::VectorXd sum_over_levels(const SchwarzHierarchy& hierarchy, std::size_t l, const Sparse& A,
                                const Eigen::VectorXd& r) {
  const SchwarzLevel& level = hierarchy.levels[l];
  const Eigen::Index n = Eigen::Index(3 * level.width);
  Eigen::VectorXd z(r.size());
  for (Eigen::Index c = 0; c < Eigen::Index(level.n_clusters()); ++c) {
    Eigen::MatrixXd block(A.block(n * c, n * c, n, n));
    for (Eigen::Index i = 0; i < n; ++i)
      if (block(i, i) == 0) block(i, i) = 1;
    z.segment(n * c, n) = block.ldlt().solve(r.segment(n * c, n));
  }
  if (l + 1 == hierarchy.levels.size()) return z;
  const Sparse w = coarse_functions(level, hierarchy.levels[l + 1].n_slots());
  const Sparse coarse = w.transpose() * A * w;
  return z + w * sum_over_levels(hierarchy, l + 1, coarse, w.transpose() * r);
}

TEST(MultilevelSchwarz, IsTheSumOfExactSolvesOnAllLevels) {
  Device device;
  PhysicalScene scene = empty_scene("block", 0.01);
  scene.solver.preconditioner = Kind::schwarz;
  scene.soft_bodies = {soft_block("one", 6, Vec3::Zero())};
  AtStart problem(device, scene);
  const System& system = problem.system;
  const MatrixPattern& pattern = problem.potential.matrix().pattern();
  const SchwarzHierarchy hierarchy =
      make_schwarz_hierarchy(pattern, {system.x, system.node_world, system.node_is_fixed, {}}, 32, 12);
  ASSERT_GE(hierarchy.levels.size(), 3u);
  std::vector<double> residual(system.x.size());
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = std::cos(0.7 * double(i));
  const Buffer<f64> r(device, residual, "residual");
  Buffer<f64> z(device, residual.size(), "M^-1 r");
  problem.potential.precondition(r, z);

  const std::vector<double> blocks = problem.potential.matrix().blocks().read();
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd of_slots = Eigen::VectorXd::Zero(Eigen::Index(3 * hierarchy.levels[0].n_slots()));
  for (u32 node = 0; node < system.n_nodes(); ++node) {
    const u32 slot = hierarchy.slot_of_node[node];
    for (u32 c = 0; c < 3; ++c) of_slots[3 * slot + c] = residual[3 * node + c];
    for (u32 k = pattern.first[node]; k < pattern.first[node + 1]; ++k)
      for (u32 e = 0; e < 9; ++e)
        entries.emplace_back(3 * slot + e / 3, 3 * hierarchy.slot_of_node[pattern.column[k]] + e % 3,
                             blocks[9 * k + e]);
  }
  Sparse A(of_slots.size(), of_slots.size());
  A.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd expected = sum_over_levels(hierarchy, 0, A, of_slots);
  const std::vector<double> found = z.read();
  double error = 0;
  for (u32 node = 0; node < system.n_nodes(); ++node)
    for (u32 c = 0; c < 3; ++c)
      error = std::max(error, std::abs(found[3 * node + c] - expected[3 * hierarchy.slot_of_node[node] + c]));
  EXPECT_LT(error, 1e-5 * expected.cwiseAbs().maxCoeff());  // inverses in single precision
}

TEST(MultilevelSchwarz, IsSymmetricWithRigidBodiesInIt) {
  Device device;
  AtStart problem(device, blocks_and_box(5, Kind::schwarz));
  std::vector<double> u(problem.system.x.size(), 0.0), v = u;
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (problem.system.node_is_fixed[i / 3]) continue;
    u[i] = std::sin(1.0 + double(i));
    v[i] = std::cos(2.0 * double(i));
  }
  Buffer<f64> from(device, u, "u"), to(device, u.size(), "M^-1 u");
  problem.potential.precondition(from, to);
  const std::vector<double> mu = to.read();
  from.write(v);
  problem.potential.precondition(from, to);
  const std::vector<double> mv = to.read();
  double umv = 0, vmu = 0, umu = 0, vmv = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    umv += u[i] * mv[i];
    vmu += v[i] * mu[i];
    umu += u[i] * mu[i];
    vmv += v[i] * mv[i];
  }
  EXPECT_GT(umu, 0);
  EXPECT_GT(vmv, 0);
  EXPECT_NEAR(umv, vmu, 1e-6 * std::sqrt(umu * vmv));
}

// The coarsest level corrects a translation u exactly and no level takes away: (A u) . M^-1 (A u) >= u . A u.
TEST(MultilevelSchwarz, TheCoarsestLevelCorrectsATranslation) {
  Device device;
  PhysicalScene scene = empty_scene("block", 0.01);
  scene.solver.preconditioner = Kind::schwarz;
  scene.soft_bodies = {soft_block("one", 8, Vec3::Zero())};
  AtStart problem(device, scene);
  std::vector<double> along(problem.system.x.size(), 0.0);
  for (std::size_t i = 0; i < along.size(); i += 3) along[i] = 1;
  Buffer<f64> u(device, along, "u"), au(device, along.size(), "A u"), z(device, along.size(), "M^-1 A u");
  problem.potential.product(u, au);
  problem.potential.precondition(au, z);
  const std::vector<double> force = au.read(), corrected = z.read();
  double uau = 0, found = 0;
  for (std::size_t i = 0; i < along.size(); ++i) {
    uau += along[i] * force[i];
    found += force[i] * corrected[i];
  }
  EXPECT_GE(found, (1 - 1e-4) * uau);
  EXPECT_LE(found, 5 * uau);  // each of the levels adds at most as much again
}

TEST(MultilevelSchwarz, IterationsHardlyGrowWithTheMesh) {
  Device device;
  const auto iterations = [&](int divisions, Kind kind) {
    PhysicalScene scene = empty_scene("block", 0.01);
    scene.solver.preconditioner = kind;
    scene.soft_bodies = {soft_block("one", divisions, Vec3::Zero())};
    return AtStart(device, scene).iterations(device);
  };
  const int coarse = iterations(4, Kind::schwarz), fine = iterations(12, Kind::schwarz);
  EXPECT_LE(fine, 2 * coarse) << coarse << " iterations with 125 nodes, " << fine << " with 2,197";
  EXPECT_GE(iterations(12, Kind::block_jacobi), 3 * fine);
  EXPECT_LE(iterations(12, Kind::factor), 2);
}

// A soft block lands on a table and a rigid box on it: the same motion with every preconditioner.
TEST(MultilevelSchwarz, MotionDoesNotDependOnThePreconditioner) {
  Device device;
  const auto run = [&](Kind kind) {
    PhysicalScene scene = empty_scene("landing", 0.01);
    scene.solver.preconditioner = kind;
    scene.soft_bodies = {soft_block("soft", 3, Vec3(0, 0, 0.052))};
    scene.rigid_bodies = {fixed_box("table", Vec3(0.2, 0.2, 0.01), Vec3(0, 0, -0.01)),
                          box_body("box", Vec3::Constant(0.02), 500, Vec3(0, 0, 0.125))};
    Simulation simulation(device, std::span(&scene, 1));
    for (int step = 0; step < 8; ++step) simulation.step(std::vector<std::vector<double>>{{}});
    return simulation.state(0);
  };
  const WorldState exact = run(Kind::factor);
  for (const Kind kind : {Kind::schwarz, Kind::block_jacobi}) {
    const WorldState state = run(kind);
    EXPECT_NEAR((state.rigid[1].col(3) - exact.rigid[1].col(3)).norm(), 0, 1e-6);
    for (std::size_t i = 0; i < exact.soft[0].size(); ++i)
      EXPECT_NEAR((state.soft[0][i] - exact.soft[0][i]).norm(), 0, 1e-6);
  }
}

// Groups whose factor is too costly go to Schwarz, the others keep theirs: with 10,648 nodes that is so.
TEST(MultilevelSchwarz, AutomaticDividesByTheCostOfTheFactor) {
  Device device;
  PhysicalScene scene = blocks_and_box(21, Kind::automatic);
  AtStart mixed(device, scene);
  scene.solver.preconditioner = Kind::factor;
  AtStart exact(device, scene);
  EXPECT_LT(mixed.potential.preconditioner_bytes(), exact.potential.preconditioner_bytes() / 2);  // of single precision
  EXPECT_LE(exact.iterations(device), 2);
  EXPECT_GT(mixed.iterations(device), 5);
  EXPECT_LE(mixed.iterations(device), 60);
}

TEST(MultilevelSchwarz, AWorldHasTheSameBitsAsAlone) {
  Device device;
  const auto scene = [](double height) {
    PhysicalScene world = empty_scene("world", 0.01);
    world.solver.preconditioner = Kind::schwarz;
    world.soft_bodies = {soft_block("soft", 3, Vec3(0, 0, 0.05 + height))};
    world.rigid_bodies = {fixed_box("table", Vec3(0.2, 0.2, 0.01), Vec3(0, 0, -0.01))};
    return world;
  };
  const PhysicalScene both[] = {scene(0.03), scene(0.002)};
  Simulation together(device, both), alone(device, std::span(&both[1], 1));
  for (int step = 0; step < 5; ++step) {
    together.step(std::vector<std::vector<double>>{{}, {}});
    alone.step(std::vector<std::vector<double>>{{}});
  }
  const WorldState in_company = together.state(1), by_itself = alone.state(0);
  for (std::size_t i = 0; i < by_itself.soft[0].size(); ++i) EXPECT_EQ(in_company.soft[0][i], by_itself.soft[0][i]);
}

}  // namespace
}  // namespace pvg

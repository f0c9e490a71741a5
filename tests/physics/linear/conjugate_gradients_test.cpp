// Conjugate gradients on a chain of springs, preconditioned in groups, against a dense direct solve.
#include "host/physics/linear/conjugate_gradients.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdlib>

#include "energies/body/inertia.h"
#include "energies/joint/zero_length_spring.h"
#include "host/physics/linear/block_matrix.hpp"
#include "host/physics/linear/gather.hpp"
#include "host/physics/linear/group_preconditioner.hpp"
#include "host/physics/linear/term.hpp"

namespace pvg {
namespace {

// n nodes of 1 kg in a row, springs of stiffness k between neighbours; groups of `group_length` nodes
struct Chain {
  Chain(Device& device, u32 n, u32 group_length, double k, bool couples = false)
      : nodes(device, "solve/nodes.cl"),
        to_sites(nodes.kernel("nodes_to_sites")),
        gather_rows(nodes.kernel("gather_rows")),
        mass(device, "body", "point_inertia", 1),
        inner(device, "joint", "zero_length_spring", 2),
        outer(device, "joint", "zero_length_spring", 2),
        contacts(device, "contact", "springs that come and go", 2),
        rows(device, 0, "rows"),
        is_fixed(device, std::vector<u32>(n, 0), "is_fixed"),
        gather(device, make_sites(n), n),
        n(n) {
    std::vector<PointInertia> masses;
    std::vector<ZeroLengthSpring> within, across;
    std::vector<u32> group;
    for (u32 i = 0; i < n; ++i) {
      masses.push_back({{i}, 0, 1.0});
      group.push_back(i / group_length);
      if (i + 1 < n) (i / group_length == (i + 1) / group_length ? within : across).push_back({{i, i + 1}, k});
    }
    mass.set(masses, {0, n});
    inner.set(within, {0, u32(within.size())});
    outer.set(across, {0, u32(across.size())});
    // the same springs as contacts are kept: whole matrices
    contacts.set_sites(outer.sites(), {0, u32(across.size())});
    std::vector<double> hessians;
    for (std::size_t e = 0; e < across.size(); ++e)
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) hessians.push_back(i % 3 != j % 3 ? 0 : i == j ? k : -k);
    contacts.own_blocks().write(hessians);
    inner.first_row = n;
    outer.first_row = u32(n + 2 * within.size());
    rows.resize(3 * (outer.first_row + 2 * across.size()));
    const RowBlock blocks[] = {{mass.sites(), 0}, {inner.sites(), inner.first_row}, {outer.sites(), outer.first_row}};
    gather.set(blocks);
    Buffer<f64> x(device, std::vector<double>(3 * n, 0.0), "x");
    Term* const constant[] = {&mass, &inner};
    matrix = std::make_unique<BlockMatrix>(device, make_sites(n), std::vector<u32>(n, 0), constant);
    for (Term* term : {&mass, &inner, &outer}) term->hessian(x, x, 1.0);
    matrix->assemble();
    std::vector<double> position(3 * n, 0.0);
    for (u32 i = 0; i < n; ++i) position[3 * i] = i;
    preconditioner = std::make_unique<GroupPreconditioner>(matrix->pattern(), make_sites(n), position, group,
                                                           std::vector<u32>(group.back() + 1, 0));
    const Term* const given[] = {&contacts};
    if (couples) {
      std::vector<NodePair> pairs;
      for (std::size_t e = 0; e < across.size(); ++e) pairs.push_back({outer.sites()[2 * e], outer.sites()[2 * e + 1]});
      preconditioner->couple(pairs);
    }
    EXPECT_EQ(preconditioner->factorize(matrix->blocks(), {given}, std::vector<char>(1, true)), std::nullopt);
  }
  static std::vector<Site> make_sites(u32 n) {
    std::vector<Site> sites;
    for (u32 i = 0; i < n; ++i) sites.push_back({{i, 0, 0, 0}, {1, 0, 0, 0}});
    return sites;
  }
  void product(const Buffer<f64>& p, Buffer<f64>& out) {
    for (Term* term : {&mass, &inner, &outer}) term->product(p, rows);
    gather.apply(gather_rows, is_fixed, rows, false, out);
  }

  void precondition(const Buffer<f64>& residual, Buffer<f64>& out) const {
    std::vector<double> z(residual.size());
    preconditioner->apply(residual.read(), z);
    out.write(z);
  }

  Program nodes;
  Kernel to_sites, gather_rows;
  Term mass, inner, outer, contacts;
  Buffer<f64> rows;
  Buffer<u32> is_fixed;
  Gather gather;
  std::unique_ptr<BlockMatrix> matrix;
  std::unique_ptr<GroupPreconditioner> preconditioner;
  u32 n;
};

Eigen::VectorXd solve_densely(u32 n, double k, const std::vector<double>& gradient) {
  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(3 * n, 3 * n);
  for (u32 i = 0; i + 1 < n; ++i)
    for (int c = 0; c < 3; ++c) {
      H(3 * i + c, 3 * i + c) += k;
      H(3 * i + 3 + c, 3 * i + 3 + c) += k;
      H(3 * i + c, 3 * i + 3 + c) -= k;
      H(3 * i + 3 + c, 3 * i + c) -= k;
    }
  return H.ldlt().solve(-Eigen::Map<const Eigen::VectorXd>(gradient.data(), 3 * n));
}

void expect_solves_chains(Device& device) {
  for (const u32 n : {1u, 3u, 257u}) {
    Chain chain(device, n, 40, 1e4);
    std::vector<double> g(3 * n);
    for (u32 i = 0; i < 3 * n; ++i) g[i] = std::sin(1.0 + 3.7 * i);
    Buffer<f64> gradient(device, g, "gradient"), dx(device, 3 * n, "dx");
    ConjugateGradients cg(device, std::vector<u32>(n, 0), 1, {{0, 0, n}});
    const CgReport report = cg.solve([&](const Buffer<f64>& p, Buffer<f64>& out) { chain.product(p, out); },
                                     [&](const Buffer<f64>& r, Buffer<f64>& z) { chain.precondition(r, z); }, gradient,
                                     {true}, 1e-10, 200, dx);
    EXPECT_TRUE(report.has_converged[0]);
    // each of the cut springs couples two groups in three directions: exact groups leave at most that many errors
    EXPECT_LE(report.iterations[0], int(1 + 6 * ((n - 1) / 40) + 2));
    const Eigen::VectorXd exact = solve_densely(n, 1e4, g);
    const std::vector<double> solved = dx.read();
    for (u32 i = 0; i < 3 * n; ++i) EXPECT_NEAR(solved[i], exact[i], 1e-7 * exact.cwiseAbs().maxCoeff());
  }
}

TEST(ConjugateGradients, SolvesAChainAcrossGroups) {
  Device device;
  expect_solves_chains(device);
}

// where the residual is tested before the preconditioner is applied again
TEST(ConjugateGradients, SolvesAChainOnADeviceApartFromTheHost) {
  setenv("PVG_HOST_FUNCTIONS", "0", 1);
  Device device;
  unsetenv("PVG_HOST_FUNCTIONS");
  expect_solves_chains(device);
}

TEST(ConjugateGradients, OneGroupIsSolvedInOneIteration) {
  Device device;
  Chain chain(device, 30, 30, 1e6);
  Buffer<f64> gradient(device, std::vector<double>(90, 1.0), "gradient"), dx(device, 90, "dx");
  ConjugateGradients cg(device, std::vector<u32>(30, 0), 1, {{0, 0, 30}});
  const CgReport report =
      cg.solve([&](const Buffer<f64>& p, Buffer<f64>& out) { chain.product(p, out); },
               [&](const Buffer<f64>& r, Buffer<f64>& z) { chain.precondition(r, z); }, gradient, {true}, 1e-8, 10, dx);
  EXPECT_TRUE(report.has_converged[0]);
  EXPECT_EQ(report.iterations[0], 1);
  for (const double value : dx.read()) EXPECT_NEAR(value, -1.0, 1e-9);  // a uniform force moves 1 kg masses by -g
}

// Pairs of nodes that the preconditioner is told of join their groups into one exact factor.
TEST(ConjugateGradients, CoupledGroupsAreSolvedInOneIteration) {
  Device device;
  Chain chain(device, 257, 40, 1e4, true);
  EXPECT_EQ(chain.preconditioner->n_groups(), 1u);
  Buffer<f64> gradient(device, std::vector<double>(3 * 257, 1.0), "gradient"), dx(device, 3 * 257, "dx");
  ConjugateGradients cg(device, std::vector<u32>(257, 0), 1, {{0, 0, 257}});
  const CgReport report =
      cg.solve([&](const Buffer<f64>& p, Buffer<f64>& out) { chain.product(p, out); },
               [&](const Buffer<f64>& r, Buffer<f64>& z) { chain.precondition(r, z); }, gradient, {true}, 1e-8, 10, dx);
  EXPECT_TRUE(report.has_converged[0]);
  EXPECT_EQ(report.iterations[0], 1);
  chain.preconditioner->couple({});
  EXPECT_EQ(chain.preconditioner->n_groups(), 7u);
}

TEST(ConjugateGradients, WorldsThatAreNotActiveStay) {
  Device device;
  Chain chain(device, 4, 2, 0.0);
  Buffer<f64> gradient(device, std::vector<double>(12, 2.0), "gradient"), dx(device, 12, "dx");
  ConjugateGradients cg(device, {0, 0, 1, 1}, 2, {{0, 0, 2}, {1, 2, 4}});
  cg.solve([&](const Buffer<f64>& p, Buffer<f64>& out) { chain.product(p, out); },
           [&](const Buffer<f64>& r, Buffer<f64>& z) { chain.precondition(r, z); }, gradient, {false, true}, 1e-8, 10,
           dx);
  const std::vector<double> solved = dx.read();
  for (int i = 0; i < 6; ++i) EXPECT_EQ(solved[i], 0.0);
  for (int i = 6; i < 12; ++i) EXPECT_NEAR(solved[i], -2.0, 1e-12);
}

}  // namespace
}  // namespace pvg

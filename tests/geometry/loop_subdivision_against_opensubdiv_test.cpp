// The weights of our Loop subdivision against OpenSubdiv's stencil tables: the same rows, in whatever order.
#include <gtest/gtest.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <Eigen/Dense>
#include <memory>
#include <random>

#include "host/geometry/loop_subdivision.hpp"

namespace pvg {
namespace {

namespace Far = OpenSubdiv::Far;

struct Case {
  std::uint32_t n_points;
  std::vector<Triangle> triangles;
  std::vector<Edge> creases;
};

Eigen::MatrixXd rows_of_opensubdiv(const Case& mesh, int levels) {
  std::vector<int> sizes(mesh.triangles.size(), 3), indices, crease_ends;
  for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  for (const Edge& e : mesh.creases) crease_ends.insert(crease_ends.end(), e.begin(), e.end());
  std::vector<float> sharpness(mesh.creases.size(), OpenSubdiv::Sdc::Crease::SHARPNESS_INFINITE);
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = int(mesh.n_points);
  descriptor.numFaces = int(mesh.triangles.size());
  descriptor.numVertsPerFace = sizes.data();
  descriptor.vertIndicesPerFace = indices.data();
  descriptor.numCreases = int(mesh.creases.size());
  descriptor.creaseVertexIndexPairs = crease_ends.data();
  descriptor.creaseWeights = sharpness.data();
  OpenSubdiv::Sdc::Options options;
  options.SetVtxBoundaryInterpolation(OpenSubdiv::Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  const std::unique_ptr<Far::TopologyRefiner> refiner(
      Factory::Create(descriptor, Factory::Options(OpenSubdiv::Sdc::SCHEME_LOOP, options)));
  refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(levels));
  using StencilFactory = Far::StencilTableFactoryReal<double>;
  StencilFactory::Options stencil_options;
  stencil_options.generateIntermediateLevels = false;
  const std::unique_ptr<const Far::StencilTableReal<double>> table(StencilFactory::Create(*refiner, stencil_options));
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(table->GetNumStencils(), mesh.n_points);
  for (int i = 0; i < table->GetNumStencils(); ++i) {
    const Far::StencilReal<double> stencil = table->GetStencil(i);
    for (int k = 0; k < stencil.GetSize(); ++k) rows(i, stencil.GetVertexIndices()[k]) += stencil.GetWeights()[k];
  }
  return rows;
}

Eigen::MatrixXd our_rows(const Case& mesh, int levels) {
  const SparseRows w = subdivide_loop(mesh.n_points, mesh.triangles, levels, mesh.creases).weights;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(w.n_rows(), w.n_columns);
  for (std::size_t i = 0; i < w.n_rows(); ++i)
    for (std::uint32_t k = w.row_start[i]; k < w.row_start[i + 1]; ++k) rows(i, w.column[k]) = w.weight[k];
  return rows;
}

void expect_same_rows(const Case& mesh) {
  for (int levels = 1; levels <= 3; ++levels) {
    const Eigen::MatrixXd ours = our_rows(mesh, levels), theirs = rows_of_opensubdiv(mesh, levels);
    ASSERT_EQ(ours.rows(), theirs.rows());
    std::vector<bool> taken(theirs.rows(), false);
    for (Eigen::Index i = 0; i < ours.rows(); ++i) {
      Eigen::Index nearest = 0;
      const double distance = (theirs.rowwise() - ours.row(i)).rowwise().squaredNorm().minCoeff(&nearest);
      // OpenSubdiv keeps some of its constants in single precision
      ASSERT_LE(std::sqrt(distance), 1e-6) << "row " << i << " at level " << levels;
      ASSERT_FALSE(taken[nearest]) << "row " << i << " at level " << levels;
      taken[nearest] = true;
    }
  }
}

// grid of n x n squares, closed to a torus or open
Case grid(int n, bool is_closed) {
  Case mesh;
  const int width = is_closed ? n : n + 1;
  mesh.n_points = std::uint32_t(width * width);
  const auto at = [&](int i, int j) { return std::uint32_t(j % width * width + i % width); };
  std::mt19937 random(3);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      // diagonals at random, so that valences differ
      if (random() % 2) {
        mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      } else {
        mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        mesh.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  return mesh;
}

TEST(LoopSubdivisionAgainstOpenSubdiv, ClosedSurface) { expect_same_rows(grid(5, true)); }

TEST(LoopSubdivisionAgainstOpenSubdiv, OpenSurface) { expect_same_rows(grid(4, false)); }

TEST(LoopSubdivisionAgainstOpenSubdiv, SmallValences) {
  expect_same_rows({4, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}, {}});
}

// creases that end, pass and meet: points with one, two and three of them
TEST(LoopSubdivisionAgainstOpenSubdiv, Creases) {
  Case mesh = grid(5, true);
  mesh.creases = {{0, 1}, {1, 2}, {2, 3}, {2, 7}, {7, 12}};
  expect_same_rows(mesh);
}

}  // namespace
}  // namespace pvg

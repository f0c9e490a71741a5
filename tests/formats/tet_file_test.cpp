#include "host/formats/tet_file.hpp"

#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "host/geometry/tet_mesh.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

TEST(TetFile, WhatIsWrittenIsReadBack) {
  const TestFolder folder;
  const TetMesh mesh = box_solid(Vec3(0.1, 0.2, 1 / 3.0), {1, 2, 3}, 4);
  const TetMesh read = read_tetrahedra(folder.write("box.msh", tetrahedra_text(mesh)));
  ASSERT_EQ(read.n_elements(), mesh.n_elements());
  double volume = 0;
  for (const double v : element_volumes(read)) volume += v;
  EXPECT_NEAR(volume, 0.1 * 0.2 / 3, 1e-15);
  EXPECT_EQ(read.surface.size(), mesh.surface.size());
  for (std::size_t i = 0; i < mesh.elements.size(); ++i)
    EXPECT_EQ(read.points[read.elements[i]], mesh.points[mesh.elements[i]]);
}

// numbers with gaps, an unused node, a triangle of the boundary, and a tetrahedron that is turned inside out
TEST(TetFile, OtherElementsArePassedOver) {
  const TestFolder folder;
  const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  const std::string nodes = "$Nodes\n5\n7 0 0 0\n8 1 0 0\n9 0 1 0\n20 0 0 1\n21 5 5 5\n$EndNodes\n";
  const TetMesh mesh = read_tetrahedra(
      folder.write("a.msh", head + nodes + "$Elements\n2\n1 2 2 1 1 7 8 9\n2 4 2 1 1 7 9 8 20\n$EndElements\n"));
  EXPECT_EQ(mesh.points.size(), 4u);
  ASSERT_EQ(mesh.n_elements(), 1u);
  EXPECT_NEAR(element_volumes(mesh)[0], 1 / 6.0, 1e-15);
  const auto refuses = [&](const std::string& text, const char* word) {
    expect_error<UsageError>([&] { read_tetrahedra(folder.write("b.msh", text)); }, {"b.msh", word});
  };
  refuses(head + nodes, "$Elements");
  refuses("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" + nodes, "version");
  refuses(head + nodes + "$Elements\n1\n1 4 2 1 1 7 8 9 10\n", "not there");
  refuses(head + nodes + "$Elements\n1\n1 4 2 1 1 7 8 9 9\n", "no volume");
  refuses(head + nodes + "$Elements\n3\n1 2 2 1 1 7 8 9\n", "too early");
  refuses(head + nodes + "$Elements\n1\n1 2 2 1 1 7 8 9\n", "no tetrahedra");
}

}  // namespace
}  // namespace pvg

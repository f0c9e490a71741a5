// A blob, simplified and filled with tetrahedra.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/base/files.hpp"
#include "host/capture/objects/object.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/formats/tet_file.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "host/geometry/tet_mesh.hpp"
#include "host/geometry/tet_quality.hpp"
#include "host/load/build_scene.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

TEST(SoftObject, ItsTetrahedraFillItWithoutSlivers) {
  ObjectSource source{"blob", sphere_surface(0.05, 4), {}};
  for (Vec3& p : source.mesh.points) p.z() *= 0.5 + 0.2 * std::sin(60 * p.x());
  source.visual = visual_of(source.mesh);
  ObjectSettings settings;
  settings.triangles = 600;
  settings.density = 80;
  settings.is_soft = true;
  const CapturedObject object = capture_object(source, settings);
  ASSERT_TRUE(object.tetrahedra);
  const TetQuality quality = tet_quality(*object.tetrahedra);
  std::printf("%zu elements, %.1f degrees, ratio %.2f\n", object.tetrahedra->n_elements(),
              quality.least_dihedral * 180 / M_PI, quality.largest_radius_edge);
  // five below 5 degrees, the least 3.3, without the optimisation for the largest dihedral angle
  EXPECT_EQ(quality.n_slivers, 0u);
  EXPECT_GE(quality.least_dihedral, 5 * M_PI / 180);
  // the surface has no needles: the blob's own triangles are better shaped than what is asked for
  for (const Triangle& t : object.simulation.triangles) {
    const Vec3 &a = object.simulation.points[t[0]], &b = object.simulation.points[t[1]],
               &c = object.simulation.points[t[2]];
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    EXPECT_GE((b - a).cross(c - a).norm(), 0.2 * longest);
  }
  double volume = 0;
  for (const double v : element_volumes(*object.tetrahedra)) volume += v;
  EXPECT_NEAR(volume, enclosed_volume(object.simulation),
              1e-6 * volume);  // TetGen puts its points on the planes of facets
  const nlohmann::ordered_json report = object_report(object, settings, 0)["tetrahedra"];
  EXPECT_EQ(report["slivers"], quality.n_slivers);
  EXPECT_NEAR(report["least_dihedral_degrees"], quality.least_dihedral * 180 / M_PI, 1e-9);
  // what is written is a body of a scene
  const TestFolder folder;
  write_object(folder.path, object, settings, 0);
  const std::string yaml = read_whole_file(folder.path / "object.yaml").value();
  const Scene scene = load_scene(folder.write("scene.yaml", "schema: 1\nname: soft\ntime_step: 10 ms\n" + yaml));
  ASSERT_EQ(scene.soft_bodies.size(), 1u);
  EXPECT_EQ(scene.soft_bodies[0].mesh.n_elements(), object.tetrahedra->n_elements());
  EXPECT_EQ(scene.soft_bodies[0].mesh.nodes_per_element, 10);
  EXPECT_EQ(scene.soft_bodies[0].material.density, 80);
}

}  // namespace
}  // namespace pvg

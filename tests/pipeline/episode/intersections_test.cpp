// The count of intersected steps of a small recording by hand: two boxes, apart in one step and one inside the other's
// wall in the next. Of several robots the bodies' names hold a slash.
#include "pipeline/episode/intersections.hpp"

#include <gtest/gtest.h>

#include "host/geometry/primitive_shapes.hpp"
#include "host/hdf5/file.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

void write_box(hdf5::File& file, const std::string& name, std::int64_t body) {
  const TriangleMesh box = box_surface(Vec3(0.1, 0.1, 0.1));
  std::vector<double> rest;
  for (const Vec3& p : box.points) rest.insert(rest.end(), p.begin(), p.end());
  std::vector<std::uint32_t> corners;
  for (const Triangle& t : box.triangles) corners.insert(corners.end(), t.begin(), t.end());
  file.write<double>("/mesh/" + name + "/rest", {box.points.size(), 3}, rest);
  file.write<std::uint32_t>("/mesh/" + name + "/triangles", {box.triangles.size(), 3}, corners);
  file.write<std::int64_t>("/mesh/" + name + "/body", {}, std::vector<std::int64_t>{body});
}

// the second box stands at x = distances[step] [m]
void write_recording(const std::filesystem::path& path, const std::vector<double>& distances) {
  hdf5::File file = hdf5::File::create(path);
  std::vector<double> time, maps;
  for (const double distance : distances) {
    time.push_back(0.02 * double(time.size()));
    for (const double x : {0.0, distance}) maps.insert(maps.end(), {1, 0, 0, x, 0, 1, 0, 0, 0, 0, 1, 0});
  }
  const std::uint64_t n = distances.size();
  file.write<double>("/time", {n}, time);
  file.write<double>("/T_link", {n, 0, 3, 4}, std::vector<double>{});
  file.write<double>("/T_rigid", {n, 2, 3, 4}, maps);
  file.write<std::int64_t>("/bodies/source", {2}, std::vector<std::int64_t>{1, 1});
  file.write<std::int64_t>("/bodies/row", {2}, std::vector<std::int64_t>{0, 1});
  file.write<std::int64_t>("/bodies/is_fixed", {2}, std::vector<std::int64_t>{0, 0});
  file.write<std::int64_t>("/bodies/noncolliding", {0, 2}, std::vector<std::int64_t>{});
  file.attribute("/bodies", "names", std::vector<std::string>{"left/pad", "right/pad"});
  file.attribute("/bodies", "data_sets", std::vector<std::string>{"/T_link", "/T_rigid"});
  write_box(file, "left/pad", 0);
  write_box(file, "right/pad", 1);
  file.close();
}

TEST(IntersectedSteps, OfTwoRobotsAreFoundWhereTheirBodiesMeet) {
  const TestFolder folder;
  write_recording(folder.path / "states.h5", {0.11, 0.095, 0.2});
  const IntersectedSteps found = count_intersected_steps(folder.path / "states.h5");
  EXPECT_EQ(found.steps, 3u);
  EXPECT_EQ(found.intersected, 1u);
  EXPECT_NE(found.first.find("left/pad"), std::string::npos) << found.first;
  EXPECT_NE(found.first.find("right/pad"), std::string::npos) << found.first;
}

TEST(IntersectedSteps, AreNoneWhereBodiesStayApart) {
  const TestFolder folder;
  write_recording(folder.path / "states.h5", {0.11, 0.101});
  EXPECT_EQ(count_intersected_steps(folder.path / "states.h5").intersected, 0u);
}

}  // namespace
}  // namespace pvg

// A record that is damaged is refused with the file and the data set; a sound one is read.
#include "host/dataset/states_record.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

using hdf5::File;
using Numbers = std::vector<double>;
using Wholes = std::vector<std::int64_t>;

// two steps of one rigid body; a test replaces a part
struct Parts {
  Numbers time = {0.1, 0.2};
  Wholes frame_step = {1}, source = {0}, row = {0}, offset = {0, 1, 1};
  std::vector<std::uint32_t> triangles = {0, 1, 2};
  hdf5::Shape q = {2, 1};
};

std::filesystem::path write(const TestFolder& folder, const Parts& parts) {
  const std::filesystem::path path = folder.path / "states.h5";
  File file = File::create(path);
  file.write<double>("/time", {parts.time.size()}, parts.time);
  file.write<std::int64_t>("/frame_step", {parts.frame_step.size()}, parts.frame_step);
  file.write<double>("/q", parts.q, Numbers(hdf5::n_values(parts.q), 1));
  file.attribute("/q", "names", std::vector<std::string>{"hinge"});
  file.write<double>("/T_link", {2, 1, 3, 4}, Numbers(24, 0.5));
  file.write<std::int64_t>("/bodies/source", {parts.source.size()}, parts.source);
  file.write<std::int64_t>("/bodies/row", {parts.row.size()}, parts.row);
  file.write<std::int64_t>("/bodies/is_fixed", {1}, Wholes{0});
  file.attribute("/bodies", "names", std::vector<std::string>{"hand"});
  file.attribute("/bodies", "data_sets", std::vector<std::string>{"/T_link"});
  file.write<double>("/mesh/hand/rest", {3, 3}, Numbers(9, 0));
  file.write<std::uint32_t>("/mesh/hand/triangles", {parts.triangles.size() / 3, 3}, parts.triangles);
  file.write<std::int64_t>("/mesh/hand/body", {}, Wholes{0});
  file.write<double>("/pair_force/normal", {1, 3}, Numbers(3, 1));
  file.write<std::int64_t>("/pair_force/bodies", {1, 2}, Wholes{0, -1});
  file.write<std::int64_t>("/pair_force/offset", {parts.offset.size()}, parts.offset);
  file.close();
  return path;
}

void read_all(const std::filesystem::path& path) {
  const StatesRecord record(path);
  record.filmed_steps();
  record.series("/q");
  for (const StatesRecord::Body& body : record.bodies()) record.mesh(body);
  record.pair_forces();
}

void expect_refused(const Parts& parts, const std::string& object) {
  const TestFolder folder;
  const std::filesystem::path path = write(folder, parts);
  try {
    read_all(path);
    FAIL() << object << ": nothing was thrown";
  } catch (const UsageError& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find(path.string()), std::string::npos) << said;
    EXPECT_NE(said.find(object), std::string::npos) << said;
  }
}

TEST(StatesRecord, ASoundRecordIsRead) {
  const TestFolder folder;
  const StatesRecord record(write(folder, {}));
  EXPECT_EQ(record.n_steps(), 2u);
  EXPECT_EQ(record.filmed_steps(), std::vector<std::size_t>{1});
  EXPECT_EQ(record.bodies().at(0).name, "hand");
  EXPECT_EQ(record.series("/q").names.at(0), "hinge");
  read_all(record.path());
}

TEST(StatesRecord, IndicesAndRangesThatLeadNowhereAreRefused) {
  expect_refused({.frame_step = {1000000000000}}, "/frame_step");
  expect_refused({.frame_step = {-1}}, "/frame_step");
  expect_refused({.source = {99}}, "/bodies/source");
  expect_refused({.source = {-1}}, "/bodies/source");
  expect_refused({.row = {1000000}}, "/bodies/row");
  expect_refused({.triangles = {0, 1, 4000000000}}, "/mesh/hand/triangles");
  expect_refused({.offset = {0, 7, 7}}, "/pair_force/offset");
  expect_refused({.offset = {0, 1, 0}}, "/pair_force/offset");
}

TEST(StatesRecord, ShapesThatDoNotFitTheStepsAreRefused) {
  expect_refused({.q = {0, 1}}, "/q");
  expect_refused({.q = {2, 3}}, "/q");
  expect_refused({.source = {0, 0}}, "/bodies/source");
  expect_refused({.offset = {0, 1}}, "/pair_force/offset");
  expect_refused({.time = {0.2, 0.1}}, "/time");
}

}  // namespace
}  // namespace pvg

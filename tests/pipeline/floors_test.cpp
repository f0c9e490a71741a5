// scripts/check_floors.sh: the house itself is clean, and each kind of forbidden include is found.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace {

namespace fs = std::filesystem;

const fs::path SOURCE = fs::path(PVG_DATA_FOLDER).parent_path();

int check(const fs::path& root) {
  const std::string script = (SOURCE / "scripts/check_floors.sh").string();
  return std::system((script + " " + root.string() + " >/dev/null 2>&1").c_str());
}

TEST(Floors, TheHouseKeepsItsRules) { EXPECT_EQ(check(SOURCE), 0); }

TEST(Floors, EveryKindOfForbiddenIncludeIsFound) {
  const fs::path root = fs::temp_directory_path() / ("pvg_floors_" + std::to_string(getpid()));
  for (const char* folder : {"kernels", "host/base", "host/device", "host/geometry", "host/physics", "host/render",
                             "host/robot", "host/io", "host/scene", "pipeline", "tests"})
    fs::create_directories(root / folder);
  std::ofstream(root / "host/device/device.cpp") << "#include <CL/cl.h>\n";
  EXPECT_EQ(check(root), 0) << "the clean tree";
  const std::pair<const char*, const char*> wrong[] = {
      {"kernels/a.h", "\"host/base/error.hpp\""},    {"host/io/a.cpp", "\"pipeline/graph.hpp\""},
      {"pipeline/a.cpp", "\"tests/fake.hpp\""},      {"host/physics/a.cpp", "<CL/cl.h>"},
      {"host/render/a.cpp", "\"host/io/hdf5.hpp\""}, {"host/physics/b.hpp", "\"host/scene/task.hpp\""},
      {"host/geometry/a.cpp", "<yaml-cpp/yaml.h>"},  {"host/physics/c.cpp", "\"host/robot/robot.hpp\""}};
  for (const auto& [file, include] : wrong) {
    std::ofstream(root / file) << "  #include " << include << "\n";
    EXPECT_NE(check(root), 0) << file << " includes " << include;
    fs::remove(root / file);
  }
  EXPECT_EQ(check(root), 0) << "the tree with all removed";
  fs::remove_all(root);
}

}  // namespace

// scripts/check_layers.py: the tree itself is clean, and each kind of forbidden include is found, as is a folder
// that the README does not list.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

const fs::path SOURCE = fs::path(PVG_DATA_FOLDER).parent_path();

int check(const fs::path& root) {
  const std::string script = (SOURCE / "scripts/check_layers.py").string();
  return std::system((script + " " + root.string() + " >/dev/null 2>&1").c_str());
}

TEST(Layers, TheTreeKeepsItsTable) { EXPECT_EQ(check(SOURCE), 0); }

TEST(Layers, EveryKindOfForbiddenIncludeIsFound) {
  const TestFolder folder;
  const fs::path& root = folder.path;
  for (const char* name :
       {"kernels", "host/base", "host/device", "host/geometry", "host/physics/step", "host/render", "host/robot",
        "host/formats", "host/load", "pipeline/graph", "pipeline/episode", "data", "tests"})
    fs::create_directories(root / name);
  fs::copy(SOURCE / "host/libraries.cmake", root / "host/libraries.cmake");
  std::ofstream(root / "README.md") << "## Folders\n\n    host/ base, device, geometry, physics, render, robot,\n"
                                       "          formats, load, unknown\n    pipeline/ graph, episode\n";
  std::ofstream(root / "host/device/device.cpp") << "#include <CL/cl.h>\n";
  ASSERT_EQ(check(root), 0) << "the clean tree";
  const std::pair<const char*, const char*> wrong[] = {{"kernels/a.h", "\"host/base/error.hpp\""},
                                                       {"host/formats/a.cpp", "\"host/load/scene_file.hpp\""},
                                                       {"host/load/a.cpp", "\"pipeline/graph/graph.hpp\""},
                                                       {"pipeline/episode/a.cpp", "\"tests/fake.hpp\""},
                                                       {"host/physics/step/a.cpp", "<CL/cl.h>"},
                                                       {"host/physics/step/b.hpp", "\"host/model/scene.hpp\""},
                                                       {"host/render/a.cpp", "\"host/hdf5/file.hpp\""},
                                                       {"host/base/b.hpp", "\"host/model/task.hpp\""},
                                                       {"host/geometry/a.cpp", "<yaml-cpp/yaml.h>"},
                                                       {"host/unknown/c.cpp", "\"host/base/error.hpp\""}};
  for (const auto& [file, include] : wrong) {
    fs::create_directories((root / file).parent_path());
    std::ofstream(root / file) << "  #include " << include << "\n";
    EXPECT_NE(check(root), 0) << file << " includes " << include;
    fs::remove(root / file);
  }
  fs::create_directories(root / "data/puzzles");
  EXPECT_NE(check(root), 0) << "a folder that the README does not list";
  fs::remove(root / "data/puzzles");
  ASSERT_EQ(check(root), 0) << "the clean tree again";
  for (int i = 0; i < 41; ++i) std::ofstream(root / "host/base" / ("file_" + std::to_string(i) + ".cpp")) << "\n";
  EXPECT_NE(check(root), 0) << "a folder with 41 files";
}

}  // namespace
}  // namespace pvg

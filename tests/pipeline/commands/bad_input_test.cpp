// Bad input through the real program: each ends with exit code 1 or 2 and one clear sentence that names what is wrong,
// and leaves no half-written episode. Every case is a copy of data/ with one thing broken.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Outcome {
  int code = -1;
  std::string message;  // what stands on stderr
};

struct BadInput : testing::Test {
  BadInput() {
    fs::create_directories(root);
    fs::copy(PVG_DATA_FOLDER, root / "data", fs::copy_options::recursive);
  }
  ~BadInput() override { fs::remove_all(root); }

  // Replaces a text that must be there, once.
  void edit(const std::string& file, const std::string& from, const std::string& to) {
    const fs::path path = root / "data" / file;
    std::string text = text_of(path);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << file << " has no '" << from << "': the test is out of date";
    text.replace(at, from.size(), to);
    std::ofstream(path) << text;
  }

  // environment: assignments that stand before the command
  Outcome generate(const std::string& environment = "", const std::string& options = "") {
    const fs::path err = root / "stderr";
    const std::string command = environment + " " + std::string(PVG_PROGRAM) + " generate " +
                                (root / "data/tasks/weigh_beaker.yaml").string() + " -o " + (root / "out").string() +
                                " --no-render " + options + " >/dev/null 2>" + err.string();
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(err)};
  }

  void expect_sentence(const Outcome& outcome, int code, const std::vector<std::string>& names) {
    EXPECT_EQ(outcome.code, code) << outcome.message;
    EXPECT_EQ(outcome.message.rfind("phyvisgen: ", 0), 0u) << outcome.message;
    EXPECT_EQ(std::count(outcome.message.begin(), outcome.message.end(), '\n'), 1) << outcome.message;
    for (const std::string& name : names)
      EXPECT_NE(outcome.message.find(name), std::string::npos) << "'" << name << "' is not in: " << outcome.message;
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(root / "out", ignored)) {
      const std::string name = entry.path().filename().string();
      EXPECT_TRUE(name == "set.json" || name == "failed") << name << " was left behind";
    }
  }

  // A folder with links to some programs, to be all of PATH.
  std::string path_with(const std::vector<std::string>& programs) {
    fs::create_directories(root / "bin");
    for (const std::string& program : programs)
      if (!fs::exists(root / "bin" / program)) fs::create_symlink("/usr/bin/" + program, root / "bin" / program);
    return "PATH=" + (root / "bin").string();
  }

  fs::path root = fs::temp_directory_path() / ("pvg_bad_input_" + std::to_string(getpid()));
};

TEST_F(BadInput, AMissingTaskFile) {
  fs::remove(root / "data/tasks/weigh_beaker.yaml");
  expect_sentence(generate(), 2, {"weigh_beaker.yaml"});
}

TEST_F(BadInput, AMissingMeshFile) {
  fs::remove(root / "data/objects/beaker.obj");
  expect_sentence(generate(), 2, {"beaker.obj"});
}

TEST_F(BadInput, AnUnknownKey) {
  edit("tasks/weigh_beaker.yaml", "time_step:", "time_stepp:");
  expect_sentence(generate(), 2, {"weigh_beaker.yaml", "time_step"});
}

TEST_F(BadInput, AWrongUnit) {
  edit("tasks/weigh_beaker.yaml", "time_step: 20 ms", "time_step: 20 mm");
  expect_sentence(generate(), 2, {"weigh_beaker.yaml", "time_step", "`mm`", "s, ms"});
}

TEST_F(BadInput, AWrongSign) {
  edit("tasks/weigh_beaker.yaml", "density: 2230", "density: -2230");
  expect_sentence(generate(), 2, {"weigh_beaker.yaml", "density"});
}

TEST_F(BadInput, AMeshWithAHole) {
  edit("objects/beaker.obj", "\nf ", "\n# ");
  expect_sentence(generate(), 2, {"beaker.obj"});
}

TEST_F(BadInput, AMeshWithAFlippedTriangle) {
  // swaps the last two corners of the first face
  const fs::path path = root / "data/objects/beaker.obj";
  std::string text = text_of(path);
  const std::size_t at = text.find("\nf ") + 3, second = text.find(' ', at) + 1, third = text.find(' ', second) + 1,
                    end = text.find('\n', third);
  const std::string b = text.substr(second, third - 1 - second), c = text.substr(third, end - third);
  text.replace(second, end - second, c + " " + b);
  std::ofstream(path) << text;
  expect_sentence(generate(), 2, {"beaker.obj"});
}

TEST_F(BadInput, VerticesThatAreNoNumbers) {
  edit("objects/beaker.obj", "\nv ", "\nv nan nan nan\n# ");
  expect_sentence(generate(), 2, {"beaker.obj"});
}

TEST_F(BadInput, NoTetgen) { expect_sentence(generate(path_with({"ffmpeg"})), 1, {"tetgen", "PATH"}); }

TEST_F(BadInput, NoFfmpeg) {
  const fs::path err = root / "stderr";
  const std::string command = path_with({"tetgen"}) + " " + PVG_PROGRAM + " generate " +
                              (root / "data/tasks/weigh_beaker.yaml").string() + " -o " + (root / "out").string() +
                              " >/dev/null 2>" + err.string();
  const int status = std::system(command.c_str());
  expect_sentence({WEXITSTATUS(status), text_of(err)}, 2, {"ffmpeg"});
}

TEST_F(BadInput, AJointWithoutLimits) {
  // the first limit of the robot's own joints
  edit("robots/fr3/fr3.urdf", "<limit ", "<unlimited ");
  expect_sentence(generate(), 2, {"fr3.urdf", "fr3_joint1", "limit"});
}

TEST_F(BadInput, ATargetOutOfReach) {
  edit("tasks/weigh_beaker.yaml", "position: [0, 0, 190 mm]", "position: [0, 0, 3 m]");
  expect_sentence(generate(), 1, {"approach", "reach"});
}

TEST_F(BadInput, BodiesThatIntersectAtTheStart) {
  edit("tasks/weigh_beaker.yaml", "z: 0.5 mm", "z: -20 mm");
  expect_sentence(generate(), 1, {"beaker", "table"});
}

TEST_F(BadInput, AnOutputFolderThatCannotBeWritten) {
  std::ofstream(root / "file") << "";
  const fs::path err = root / "stderr";
  const std::string command = std::string(PVG_PROGRAM) + " generate " +
                              (root / "data/tasks/weigh_beaker.yaml").string() + " -o " + (root / "file/out").string() +
                              " --no-render >/dev/null 2>" + err.string();
  const int status = std::system(command.c_str());
  expect_sentence({WEXITSTATUS(status), text_of(err)}, 2, {(root / "file/out").string()});
}

TEST_F(BadInput, NoOpenClDevice) { expect_sentence(generate("OCL_ICD_VENDORS=/nonexistent"), 2, {"no OpenCL device"}); }

TEST_F(BadInput, ADeviceThatDoesNotExist) {
  expect_sentence(generate("", "--device abacus"), 2, {"--device abacus", "phyvisgen devices"});
}

TEST_F(BadInput, OptionsThatMakeNoSense) {
  expect_sentence(generate("", "--shard 4/4"), 2, {"--shard 4/4"});
  expect_sentence(generate("", "--shard 0/18446744073709551615"), 2,
                  {"--shard 0/18446744073709551615", "at most 1000000000"});
  expect_sentence(generate("", "--fps 30"), 2, {"30 frames per second"});
  expect_sentence(generate("", "--no-such-option"), 2, {"--no-such-option"});
}

TEST_F(BadInput, AFolderOfAnotherSeed) {
  edit("tasks/weigh_beaker.yaml", "position: [0, 0, 190 mm]", "position: [0, 0, 3 m]");
  generate("", "--seed 1");  // fails, but begins a set
  expect_sentence(generate("", "--seed 2"), 2, {"set.json", "another seed"});
}

}  // namespace

// Nothing is written onto what is read, by whatever name it is called.
#include "host/base/outputs.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "host/base/error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct Outputs : testing::Test {
  Outputs() { fs::create_directories(root / "set"); }
  ~Outputs() override { fs::remove_all(root); }
  fs::path file(const std::string& name) const {
    std::ofstream(root / name) << "1";
    return root / name;
  }
  fs::path root = fs::temp_directory_path() / ("pvg_outputs_" + std::to_string(getpid()));
};

TEST_F(Outputs, AFileThatWasReadIsRefusedByEachOfItsNames) {
  const fs::path scene = file("scene.yaml");
  fs::create_symlink(scene, root / "link.h5");
  fs::create_hard_link(scene, root / "other.h5");
  check_output_file(scene);
  remember_read(scene);
  EXPECT_THROW(check_output_file(scene), UsageError);
  EXPECT_THROW(check_output_file(root / "set" / ".." / "scene.yaml"), UsageError);
  EXPECT_THROW(check_output_file(root / "link.h5"), UsageError);
  EXPECT_THROW(check_output_file(root / "other.h5"), UsageError);
  check_output_file(root / "new.h5");
  EXPECT_FALSE(fs::exists(root / "new.h5"));
}

TEST_F(Outputs, FoldersPipesAndWrongEndingsAreRefused) {
  ASSERT_EQ(mkfifo((root / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(check_output_file(root / "pipe"), UsageError);
  EXPECT_THROW(check_output_file(root / "set"), UsageError);
  EXPECT_THROW(check_output_file(root / "none" / "a.h5"), UsageError);
  EXPECT_THROW(check_output_file(root / "page.txt", {".html"}), UsageError);
  EXPECT_THROW(check_output_file(root / std::string(300, 'n')), UsageError);
  check_output_file(root / "page.html", {".html"});
}

TEST_F(Outputs, AFolderIsNotWrittenIntoNorAroundWhatIsRead) {
  fs::create_directory_symlink(root / "set", root / "way");
  for (const fs::path& output :
       {root / "set", root / "set" / "whole", root / "set" / ".." / "set" / "whole", root / "way" / "whole", root})
    EXPECT_THROW(check_apart(output, root / "set", "merge"), UsageError) << output;
  check_not_within(root, root / "set", "merge");  // parts may lie in the whole
  EXPECT_THROW(check_not_within(root / "way" / "whole", root / "set", "merge"), UsageError);
  EXPECT_THROW(check_not_within(root / "set", root / "set", "merge"), UsageError);
  check_apart(root / "settled", root / "set", "merge");
  check_apart(root / "whole", root / "set", "merge");
}

TEST_F(Outputs, AFolderIsReplacedOnlyWhereAllInItWasWrittenByTheCommand) {
  const std::vector<std::string> ours = {"room.yaml", "plane_*.obj"};
  check_output_folder(root / "new", ours, "capture");
  EXPECT_FALSE(fs::exists(root / "new"));
  check_output_folder(root / "set", ours, "capture");
  file("set/room.yaml"), file("set/plane_12.obj");
  check_output_folder(root / "set", ours, "capture");
  file("set/notes.txt");
  EXPECT_THROW(check_output_folder(root / "set", ours, "capture"), UsageError);
  EXPECT_THROW(check_output_folder(file("mine"), ours, "capture"), UsageError);
}

}  // namespace
}  // namespace pvg

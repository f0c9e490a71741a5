// The job scripts that `submit` writes; submit_quoting.sh has --generate, which asks the program itself and not this
// test. That a cluster runs them is shown by scripts/test_slurm.sh.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "host/base/error.hpp"
#include "pipeline/command_line/program.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

constexpr const char* TASK = PVG_DATA_FOLDER "/tasks/weigh_beaker.yaml";

struct Submit : testing::Test {
  TestFolder root;
  void submit(const std::string& task, const std::string& n_shards, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"submit", task,     "-n", "10", "--shards",
                                      n_shards, "--seed", "6",  "-o", (root.path / "a set").string()};
    words.insert(words.end(), more.begin(), more.end());
    run_command_line(all_commands(), words);
  }
  std::string script(const std::string& name) {
    std::ifstream in(root.path / "a set/jobs" / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void expect_in(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nis not in\n" << text;
  }
};

TEST_F(Submit, TheScriptsNameEverythingAndAreShellScripts) {
  submit(TASK, "4", {"--at-once", "2", "--sbatch=--gres=gpu:1", "--sbatch=--time=10"});
  const std::string generate = script("generate.sbatch"), merge = script("merge.sbatch");
  expect_in(generate, "#SBATCH --array=0-3%2\n");
  expect_in(generate, "#SBATCH --requeue\n");
  expect_in(generate, "#SBATCH --output=\"" + (root.path / "a set/jobs/shard_%a.log").string() + "\"\n");
  expect_in(generate, "#SBATCH --gres=gpu:1\n#SBATCH --time=10\n");
  expect_in(generate, "-n 10 --seed 6 --shard \"$SLURM_ARRAY_TASK_ID/4\"");
  expect_in(merge, "'" + (root.path / "a set").string() + "'/shards/*/");
  for (const std::string& text : {generate, merge}) EXPECT_EQ(text.find("{{"), std::string::npos);
  for (const char* name : {"generate.sbatch", "merge.sbatch"})
    EXPECT_EQ(std::system(("bash -n '" + (root.path / "a set/jobs" / name).string() + "'").c_str()), 0);
}

TEST_F(Submit, MoreShardsThanEpisodesAndABrokenTaskAreRefusedHere) {
  expect_error<UsageError>([&] { submit(TASK, "11"); }, {"--shards 11", "10"});
  EXPECT_THROW(submit(root.write("task.yaml", "schema: 1\n").string(), "2"), UsageError);
  EXPECT_FALSE(std::filesystem::exists(root.path / "a set"));
}

}  // namespace
}  // namespace pvg

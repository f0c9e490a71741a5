// The job scripts that `submit` writes, without --generate, whose options the program itself checks. That a cluster
// runs them is shown by scripts/test_slurm.sh.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "host/base/error.hpp"
#include "pipeline/commands/commands.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

struct Submit : testing::Test {
  TestFolder root;
  SubmitOptions options;
  Submit() {
    options.task = PVG_DATA_FOLDER "/tasks/weigh_beaker.yaml";
    options.folder = (root.path / "a set").string();
    options.n_episodes = 10;
    options.n_shards = 4;
    options.seed = 6;
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
  options.n_at_once = 2;
  options.sbatch_options = {"--gres=gpu:1", "--time=10"};
  run_submit(options);
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
  options.n_shards = 11;
  expect_error<UsageError>([&] { run_submit(options); }, {"--shards 11", "10"});
  options.n_shards = 2;
  options.task = root.write("task.yaml", "schema: 1\n").string();
  EXPECT_THROW(run_submit(options), UsageError);
  EXPECT_FALSE(std::filesystem::exists(root.path / "a set"));
}

}  // namespace
}  // namespace pvg

// The page of `view`: what a text of its data holds never ends a script, nor keeps one open.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/base/files.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/program.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

TEST(View, TextsOfItsDataAreNoMarkup) {
  const TestFolder folder;
  const nlohmann::json evaluation = {{"policy", "a <!-- <script> b </script>"},
                                     {"episodes", 0},
                                     {"success", 0},
                                     {"low", 0},
                                     {"high", 1},
                                     {"beta", {0, 1}},
                                     {"events", nlohmann::json::object()},
                                     {"episodes_detail", nlohmann::json::array()},
                                     {"baselines", nlohmann::json::object()},
                                     {"perturbed", nlohmann::json::array()},
                                     {"videos", nlohmann::json::array()}};
  folder.write("evaluation.json", evaluation.dump());
  const std::string page = (folder.path / "page.html").string();
  run_command_line(all_commands(), {"view", (folder.path / "evaluation.json").string(), "-o", page});
  const std::string text = read_whole_file(page).value();
  EXPECT_EQ(text.find("<!-- <script"), std::string::npos);
  const std::string begin = "type=\"application/json\">";
  const std::size_t at = text.find(begin) + begin.size(), end = text.find('<', at);
  EXPECT_EQ(nlohmann::json::parse(text.substr(at, end - at))["evaluation"]["policy"], evaluation["policy"]);
}

}  // namespace
}  // namespace pvg

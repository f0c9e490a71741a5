// What the page of an evaluation is made of, and files that are none.
#include "pipeline/episode/evaluation_data.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "host/base/error.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

using Json = nlohmann::ordered_json;

Json result(std::initializer_list<bool> successes) {
  Json made = {{"episodes", successes.size()},
               {"success", 0.5},
               {"low", 0.1},
               {"high", 0.9},
               {"beta", {0.1, 0.9}},
               {"events", {{"dropped", 1}}},
               {"episodes_detail", Json::array()}};
  for (const bool success : successes)
    made["episodes_detail"].push_back({{"seed", made["episodes_detail"].size()},
                                       {"success", success},
                                       {"reason", success ? "" : "it lies"},
                                       {"events", {"dropped"}},
                                       {"periods", 7}});
  return made;
}

// As `evaluate policy --json` prints it.
Json evaluation() {
  Json made = {{"schema", 1}, {"task", "push"}, {"policy", "act"}};
  made.update(result({true, false}));
  Json blind = result({false, false});
  blind["policy_above"] = {{"difference", 0.5}, {"low", -0.1}, {"high", 0.9}, {"gained", 1}, {"lost", 0}, {"p", 1.0}};
  made["baselines"] = {{"blind", blind}};
  Json low = result({true, true}), high = result({false, true});
  low["amount"] = 0.5;
  high["amount"] = 2;
  made["perturbed"] = {{{"quantity", "friction"},
                        {"points", {low, high}},
                        {"control", {{"spread", 0.2}, {"shuffled_spread_95", 0.1}, {"p", 0.01}}}}};
  made["videos"] = {"elsewhere/failure_1_front.mp4"};
  return made;
}

struct EvaluationData : testing::Test {
  std::filesystem::path written(const Json& json) const {
    std::ofstream(folder.path / "evaluation.json") << json;
    return folder.path / "evaluation.json";
  }
  TestFolder folder;
};

TEST_F(EvaluationData, VideosLieBesideTheFileAndGoIntoThePage) {
  std::ofstream(folder.path / "failure_1_front.mp4") << "abc";
  const Json report = evaluation_report(written(evaluation()));
  EXPECT_EQ(report["videos"], Json({{{"name", "failure_1_front"}, {"source", "data:video/mp4;base64,YWJj"}}}));
  EXPECT_EQ(report["file"], "evaluation.json");
  EXPECT_EQ(report["evaluation"], evaluation());
}

TEST_F(EvaluationData, AVideoThatIsGoneIsNamed) {
  expect_error<UsageError>([&] { evaluation_report(written(evaluation())); }, {"failure_1_front.mp4", "is not there"});
}

TEST_F(EvaluationData, AFileThatIsNoneIsNamedWithItsKey) {
  const auto refused = [&](const std::function<void(Json&)>& change, const char* part) {
    Json spoiled = evaluation();
    spoiled["videos"] = Json::array();
    change(spoiled);
    expect_error<UsageError>([&] { evaluation_report(written(spoiled)); }, {"evaluation.json", part});
  };
  refused([](Json& j) { j.erase("policy"); }, "the key `policy` is missing");
  refused([](Json& j) { j["baselines"]["blind"].erase("policy_above"); }, "`baselines.blind.policy_above` is missing");
  refused([](Json& j) { j["episodes_detail"].push_back(j["episodes_detail"][0]); }, "different numbers of episodes");
  refused([](Json& j) { j["episodes_detail"][1]["success"] = 1; }, "`episodes_detail[1].success` is not true or false");
  refused([](Json& j) { j["perturbed"][0]["points"][1].erase("amount"); }, "`perturbed[0].points[1].amount`");
  refused([](Json& j) { j["perturbed"][0]["points"].erase(0); }, "fewer than two points");
  refused([](Json& j) { j["success"] = "all"; }, "`success` is not a number");
  refused([](Json& j) { j["events"]["dropped"] = "once"; }, "`dropped` is no number");
  refused([](Json& j) { j["videos"] = {3}; }, "a video's name is no text");
  refused([](Json& j) { j = Json::object(); }, "is missing");
  refused([](Json& j) { j = 3; },
          "no JSON file with one mapping; view takes a file that `evaluate policy --json` printed");
  expect_error<UsageError>([&] { evaluation_report(folder.path / "none.json"); }, {"none.json", "could not be read"});
}

}  // namespace
}  // namespace pvg

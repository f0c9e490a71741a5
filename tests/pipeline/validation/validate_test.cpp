// The commands `validate` and `simulate` through the real program: what they print, write and return.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <tinyxml.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "host/hdf5/file.hpp"
#include "pipeline/validation/validation.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Outcome {
  int code = -1;
  std::string out, err;
  nlohmann::json json() const { return nlohmann::json::parse(out); }
};

struct Validate : testing::Test {
  Outcome run(const std::string& arguments) const {
    const fs::path out = folder.path / "stdout", err = folder.path / "stderr";
    const std::string command = std::string(PVG_PROGRAM) + " " + arguments + " >" + out.string() + " 2>" + err.string();
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
  }

  // A copy of the scenes with one text, which must be there, replaced in one file.
  std::string scenes_with(const std::string& file, const std::string& from, const std::string& to) const {
    const fs::path scenes = folder.path / "scenes";
    fs::copy(PVG_DATA_FOLDER "/validation", scenes, fs::copy_options::recursive);
    std::string text = text_of(scenes / file);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << file << " has no '" << from << "': the test is out of date";
    text.replace(at, from.size(), to);
    std::ofstream(scenes / file) << text;
    return " --scenes " + scenes.string();
  }

  const TestFolder folder;
};

std::set<std::string> first_words(const std::string& text) {
  std::set<std::string> words;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) words.insert(line.substr(0, line.find(' ')));
  return words;
}

TEST_F(Validate, TheListNamesEveryCaseOnceAndTheQuickListTheQuickOnes) {
  std::set<std::string> all, quick;
  for (const ValidationCase& each : validation_cases()) {
    EXPECT_TRUE(all.insert(each.name).second) << each.name << " stands twice";
    if (each.is_quick) quick.insert(each.name);
  }
  EXPECT_EQ(first_words(run("validate --list").out), all);
  EXPECT_EQ(first_words(run("validate --list --quick").out), quick);
  EXPECT_EQ(first_words(run("validate --list --case slope").out), std::set<std::string>{"slope"});
}

TEST_F(Validate, ACasesRowsHoldEveryFieldAndSayWhetherTheyPass) {
  const Outcome outcome = run("validate --case drive --json");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json report = outcome.json();
  EXPECT_EQ(report.at("schema"), 1);
  ASSERT_GE(report.at("cases").size(), 3u);
  std::set<std::string> quantities;
  for (const nlohmann::json& row : report["cases"]) {
    EXPECT_EQ(row.at("case"), "drive");
    EXPECT_TRUE(quantities.insert(row.at("quantity")).second) << row["quantity"] << " stands twice";
    EXPECT_TRUE(row.at("unit").is_string());
    EXPECT_FALSE(row.at("source").get<std::string>().empty());
    const double expected = row.at("expected"), measured = row.at("measured"), error = row.at("error");
    EXPECT_DOUBLE_EQ(error, measured - expected);
    const std::string kind = row.at("kind");
    EXPECT_TRUE(kind == "must" || kind == "report") << kind;
    EXPECT_EQ(row.at("pass"), kind == "report" || std::abs(error) <= row.at("tolerance").get<double>());
    EXPECT_GT(row.at("seconds").get<double>(), 0);
  }
  EXPECT_TRUE(quantities.contains("steps not converged"));
}

TEST_F(Validate, AWrongNumberFailsItsRowAndTheCommand) {
  const std::string scenes = scenes_with("drive.yaml", "{stiffness: 1000, damping: 50", "{stiffness: 990, damping: 50");
  const Outcome outcome = run("validate --case drive --json" + scenes);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("1 of "), std::string::npos) << outcome.err;
  const nlohmann::json report = outcome.json();
  ASSERT_EQ(report.at("cases").size(), 4u);
  for (const nlohmann::json& row : report["cases"])
    EXPECT_EQ(row.at("pass"), row["quantity"] != "prismatic: deflection") << row.dump();
}

TEST_F(Validate, ACaseThatCannotGoOnFailsAndTheNextOnesAreStillRun) {
  const std::string scenes = scenes_with("drive.yaml", "velocity_tolerance: 1e-8",
                                         "max_newton: 1, max_step_halvings: 0, velocity_tolerance: 1e-9");
  const Outcome outcome = run("validate --case drive --case oscillator --json" + scenes);
  EXPECT_EQ(outcome.code, 1);
  int of_drive = 0, of_oscillator = 0;
  const nlohmann::json report = outcome.json();
  for (const nlohmann::json& row : report.at("cases")) {
    of_drive += row["case"] == "drive" && row["pass"] == false;
    of_oscillator += row["case"] == "oscillator" && row["pass"] == true;
  }
  EXPECT_GE(of_drive, 1);
  EXPECT_GE(of_oscillator, 2);
}

TEST_F(Validate, ACaseThatDoesNotExistIsNamedBesideThoseThatDo) {
  const Outcome outcome = run("validate --case slop");
  EXPECT_EQ(outcome.code, 2);
  for (const char* word : {"--case slop", "slope", "arch"})
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1);
}

TEST_F(Validate, ACaseWhoseRecordingsAreAbsentIsLeftOutAndSaysSo) {
  const Outcome outcome =
      run("validate --json --case cube_toss --case silicone_beam --recordings " + (folder.path / "nowhere").string());
  EXPECT_EQ(outcome.code, 0);
  EXPECT_TRUE(outcome.json().at("cases").empty());
  for (const char* word : {"cube_toss is left out", "silicone_beam is left out", "nowhere"})
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
}

TEST_F(Validate, ThePlotIsADrawingWithAllOfItsCurvesAndLabelledAxes) {
  const fs::path plots = folder.path / "plots";
  ASSERT_EQ(run("validate --case oscillator --plots " + plots.string()).code, 0);
  TiXmlDocument drawing;
  ASSERT_TRUE(drawing.LoadFile((plots / "oscillator.svg").string())) << drawing.ErrorDesc();
  const TiXmlElement* svg = drawing.RootElement();
  ASSERT_STREQ(svg->Value(), "svg");
  int n_curves = 0;
  for (const TiXmlElement* e = svg->FirstChildElement("polyline"); e; e = e->NextSiblingElement("polyline")) {
    ++n_curves;
    const std::string points = e->Attribute("points");
    EXPECT_EQ(std::count(points.begin(), points.end(), ','), 60);  // one per step
    EXPECT_EQ(points.find("nan"), std::string::npos);
  }
  EXPECT_EQ(n_curves, 2);
  std::set<std::string> texts;
  for (const TiXmlElement* e = svg->FirstChildElement("text"); e; e = e->NextSiblingElement("text"))
    texts.insert(e->GetText());
  for (const char* text : {"time [s]", "position [m]", "simulated"}) EXPECT_TRUE(texts.contains(text)) << text;
}

TEST_F(Validate, SimulateWritesTheStatesOfEveryStepAndSaysWhatTheyCost) {
  const fs::path file = folder.path / "drive.h5";
  const std::string scene = PVG_DATA_FOLDER "/validation/drive.yaml";
  const Outcome outcome = run("simulate " + scene + " -o " + file.string() + " --duration 0.1 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json report = outcome.json();
  EXPECT_EQ(report.at("scene"), "drive");
  EXPECT_EQ(report.at("steps"), 10);
  EXPECT_GE(report.at("newton"), 10);
  EXPECT_EQ(report.at("retries"), 0);
  const hdf5::File states = hdf5::File::open(file);
  EXPECT_EQ(states.shape("/q"), (hdf5::Shape{10, 2}));
  const std::vector<double> time = states.read<double>("/time").values;
  EXPECT_NEAR(time.back(), 0.1, 1e-12);
  // two falls that springs and dampers hold back: down, and slower than freely, g t (t + h) / 2
  const std::vector<double> q = states.read<double>("/q").values;
  EXPECT_LT(q.back(), 0);
  EXPECT_GT(q.back(), -9.80665 * 0.1 * 0.11 / 2);
}

TEST_F(Validate, SimulateNamesWhatItCannotUse) {
  const std::string out = " -o " + (folder.path / "x.h5").string();
  const std::string scene = PVG_DATA_FOLDER "/validation/drive.yaml";
  const std::pair<std::string, std::string> wrong[] = {{"simulate" + out, "scene"},
                                                       {"simulate " + scene, "-o"},
                                                       {"simulate nowhere.yaml" + out, "nowhere.yaml"},
                                                       {"simulate " + scene + out + " --duration 0.001", "duration"}};
  for (const auto& [arguments, word] : wrong) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(fs::exists(folder.path / "x.h5"));
}

}  // namespace
}  // namespace pvg

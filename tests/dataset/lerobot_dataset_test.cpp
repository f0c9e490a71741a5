// The tables and files of LeRobot's layouts, as they go to the program that writes Parquet. That lerobot itself loads
// them is shown by scripts/check_lerobot.sh.
#include "host/dataset/lerobot_dataset.hpp"

#include <map>

#include "tests/dataset/small_episode.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct LeRobot : testing::Test {
  TestFolder root;
  std::map<std::string, ParquetTable> tables;  // by their path in the set
  Json info;

  void pack(LeRobotVersion version) {
    const fs::path out = root.path / "out";
    const auto keep = [&](const ParquetTable& table) { tables[table.path.lexically_relative(out).string()] = table; };
    const auto writer = make_lerobot_writer(out, {version, "", {{"seed", 7}}}, keep);
    writer->add(read_packed_episode(write_small_episode(root, "a", 0), {}));
    writer->add(read_packed_episode(write_small_episode(root, "b", 3, 2), {}));
    writer->finish();
    info = json("meta/info.json");
  }
  Json json(const std::string& name) { return Json::parse(std::ifstream(root.path / "out" / name)); }
  const ParquetColumn& column(const std::string& table, const std::string& name) {
    for (const ParquetColumn& each : tables.at(table).columns)
      if (each.name == name) return each;
    throw std::out_of_range(table + " has no column " + name);
  }
};

TEST_F(LeRobot, RowsCountOnOverTheSetAndTimeBeginsAnewInEachEpisode) {
  pack(LeRobotVersion::v3_0);
  const std::string second = "data/chunk-000/file-001.parquet";
  EXPECT_EQ(column(second, "index").values.dump(), "[3,4]");
  EXPECT_EQ(column(second, "episode_index").values.dump(), "[1,1]");
  EXPECT_EQ(column(second, "frame_index").values.dump(), "[0,1]");
  EXPECT_EQ(column(second, "timestamp").values.at(0), 0);
  EXPECT_FLOAT_EQ(column(second, "timestamp").values.at(1), 0.2f);
  EXPECT_EQ(column(second, "action").type, "list<float>");
  EXPECT_FLOAT_EQ(column(second, "action").values.at(0).at(0), 40);
  EXPECT_EQ(column(second, "timestamp").type, "float");
  EXPECT_EQ(column(second, "index").type, "int64");
}

TEST_F(LeRobot, PosesOfObjectsAreWrittenWhereTheyAreAskedFor) {
  pack(LeRobotVersion::v3_0);
  EXPECT_FALSE(info["features"].contains("observation.environment_state"));
  const fs::path out = root.path / "states";
  const auto keep = [&](const ParquetTable& table) { tables[table.path.lexically_relative(out).string()] = table; };
  const auto writer = make_lerobot_writer(out, {LeRobotVersion::v3_0, "", {{"seed", 7}}, true}, keep);
  writer->add(read_packed_states(write_small_episode(root, "c", 0, 3, "", false)));
  writer->finish();
  const Json feature = Json::parse(std::ifstream(out / "meta/info.json"))["features"]["observation.environment_state"];
  EXPECT_EQ(feature["shape"].dump(), "[7]");
  EXPECT_EQ(feature["names"].at(1), "cup_y");
  const ParquetColumn& poses = column("data/chunk-000/file-000.parquet", "observation.environment_state");
  EXPECT_FLOAT_EQ(poses.values.at(2).at(1), 6);
  // the cup never tilts: so say the statistics of the episode, and those that a policy divides by bear a tilt
  const ParquetColumn& of_episode =
      column("meta/episodes/chunk-000/file-000.parquet", "stats/observation.environment_state/std");
  EXPECT_EQ(of_episode.values.at(0).at(3), 0);
  const Json of_set = Json::parse(std::ifstream(out / "meta/stats.json"))["observation.environment_state"];
  EXPECT_EQ(of_set["std"].at(3), 0.05);
  EXPECT_EQ(of_set["std"].at(0), 0.01);
}

TEST_F(LeRobot, EveryColumnIsDeclaredAndEveryVideoIsThere) {
  pack(LeRobotVersion::v3_0);
  EXPECT_EQ(info["codebase_version"], "v3.0");
  EXPECT_EQ(info["total_episodes"], 2);
  EXPECT_EQ(info["total_frames"], 5);
  EXPECT_EQ(info["fps"], 5);
  EXPECT_EQ(info["features"]["observation.images.wrist"]["shape"].dump(), "[16,32,3]");
  std::size_t n_videos = 0;
  for (const auto& [name, feature] : info["features"].items()) n_videos += feature["dtype"] == "video";
  const ParquetTable& data = tables.at("data/chunk-000/file-000.parquet");
  EXPECT_EQ(data.columns.size() + n_videos, info["features"].size());
  for (const ParquetColumn& each : data.columns) {
    EXPECT_TRUE(info["features"].contains(each.name)) << each.name;
    const Json& first = each.values.at(0);
    EXPECT_EQ(info["features"][each.name]["shape"].at(0), first.is_array() ? first.size() : 1u) << each.name;
  }
  for (const char* video : {"file-000.mp4", "file-001.mp4"})
    EXPECT_GT(fs::file_size(root.path / "out/videos/observation.images.wrist/chunk-000" / video), 0u);
  EXPECT_EQ(json("meta/phyvisgen.json")["seed"], 7);
}

TEST_F(LeRobot, EpisodesSayWhereTheirRowsAndPicturesAre) {
  pack(LeRobotVersion::v3_0);
  const std::string table = "meta/episodes/chunk-000/file-000.parquet";
  EXPECT_EQ(column(table, "length").values.dump(), "[3,2]");
  EXPECT_EQ(column(table, "dataset_from_index").values.dump(), "[0,3]");
  EXPECT_EQ(column(table, "dataset_to_index").values.dump(), "[3,5]");
  EXPECT_EQ(column(table, "data/file_index").values.dump(), "[0,1]");
  EXPECT_EQ(column(table, "tasks").values.dump(), R"([["lift cup"],["lift cup"]])");
  const ParquetColumn& until = column(table, "videos/observation.images.wrist/to_timestamp");
  EXPECT_EQ(until.type, "double");
  EXPECT_DOUBLE_EQ(until.values.at(0), 0.6);
  EXPECT_EQ(column(table, "stats/observation.images.wrist/mean").type, "list<list<list<double>>>");
  EXPECT_EQ(column(table, "stats/action/count").type, "list<int64>");
}

TEST_F(LeRobot, StatisticsAreOfAllRowsAndOfThePicturesThemselves) {
  pack(LeRobotVersion::v3_0);
  const Json stats = json("meta/stats.json");
  EXPECT_DOUBLE_EQ(stats["action"]["mean"][0], (40 + 60 + 60 + 40 + 40) / 5.0);
  EXPECT_EQ(stats["action"]["max"][1], double(0.24f));  // of what the tables hold, to the bit
  // greys 40, 80, 120 and 40, 80; one part in a hundred for the video
  EXPECT_NEAR(double(stats["observation.images.wrist"]["mean"][0][0][0]), 72 / 255.0, 0.01);
  EXPECT_EQ(stats["observation.images.wrist"]["count"].dump(), "[5]");
}

TEST_F(LeRobot, TheOlderLayoutListsEpisodesInLinesAndNamesFilesByEpisode) {
  pack(LeRobotVersion::v2_1);
  EXPECT_EQ(info["codebase_version"], "v2.1");
  EXPECT_EQ(info["total_videos"], 2);
  EXPECT_EQ(column("data/chunk-000/episode_000001.parquet", "index").values.dump(), "[3,4]");
  EXPECT_TRUE(fs::exists(root.path / "out/videos/chunk-000/observation.images.wrist/episode_000001.mp4"));
  std::ifstream lines(root.path / "out/meta/episodes.jsonl");
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, R"({"episode_index":0,"tasks":["lift cup"],"length":3})");
  EXPECT_EQ(Json::parse(std::ifstream(root.path / "out/meta/tasks.jsonl"))["task"], "lift cup");
}

TEST_F(LeRobot, TheVideoBeginsWithTheStartAndHasThePicturesOfTheEpisodeToTheBit) {
  const auto whole = write_small_episode(root, "it's a set", 0, 3, "", true, false, true);
  const PackedEpisode episode = read_packed_episode(whole, {}, true);
  const auto keep = [&](const ParquetTable& table) {
    tables[table.path.lexically_relative(root.path / "out").string()] = table;
  };
  const auto writer = make_lerobot_writer(root.path / "out", {LeRobotVersion::v3_0, "", {{"seed", 7}}}, keep);
  writer->add(episode);
  writer->finish();
  const std::string data = "data/chunk-000/file-000.parquet";
  EXPECT_EQ(column(data, "frame_index").values.dump(), "[0,1,2,3]");
  EXPECT_FLOAT_EQ(column(data, "action").values.at(0).at(0), 20);
  EXPECT_FLOAT_EQ(column(data, "observation.state").values.at(0).at(0), 0);
  EXPECT_EQ(column("meta/episodes/chunk-000/file-000.parquet", "length").values.dump(), "[4]");
  using Pictures = std::vector<std::vector<std::uint8_t>>;
  const auto pictures_of = [](PackedCamera camera, std::size_t n) {
    Pictures pictures;
    read_pictures(camera, n, 0, [&](auto rgb) { pictures.emplace_back(rgb.begin(), rgb.end()); });
    return pictures;
  };
  PackedCamera joined = episode.cameras[0];
  joined.start.clear();
  joined.video = root.path / "out/videos/observation.images.wrist/chunk-000/file-000.mp4";
  EXPECT_TRUE(pictures_of(joined, 4) == pictures_of(episode.cameras[0], 4));
}

}  // namespace
}  // namespace pvg

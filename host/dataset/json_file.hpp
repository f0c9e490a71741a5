// JSON files that the program wrote and reads again, checked: set.json and summary.json. A UsageError names file and
// key.
#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace pvg {

// What to do where a file of an episode or a set is not as it was written.
inline constexpr const char* OF_EPISODES = "it was not left so by generate: make the episodes again";

// One mapping; nothing where there is no such file. Throws a UsageError that ends with the advice where it holds
// something else.
std::optional<nlohmann::ordered_json> read_json_file(const std::filesystem::path& file,
                                                     const char* advice = OF_EPISODES);

// Of a mapping that was read from `file`.
std::string text_in(const nlohmann::ordered_json& json, const std::string& key, const std::filesystem::path& file);
std::uint64_t whole_in(const nlohmann::ordered_json& json, const std::string& key, std::uint64_t low,
                       std::uint64_t high, const std::filesystem::path& file);

// What summary.json says of an episode's pictures.
struct SummaryCamera {
  std::string name;
  int width = 0, height = 0;  // [pixels]
};
struct SummaryPictures {
  double frames_per_second = 0;
  std::vector<SummaryCamera> cameras;
};
SummaryPictures read_summary_pictures(const std::filesystem::path& file);

}  // namespace pvg

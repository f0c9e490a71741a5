#include "host/dataset/json_file.hpp"

#include <cmath>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/base/numbers.hpp"

namespace pvg {
namespace {

using Json = nlohmann::ordered_json;
constexpr int DEEPEST = 100;                // mappings in each other, of what we write three
constexpr double FASTEST = 1e4;             // [pictures/s]
constexpr std::uint64_t LARGEST = 1 << 16;  // a picture's side [pixels]

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what, const char* advice = OF_EPISODES) {
  throw UsageError(file.string() + " " + what + "; " + advice);
}

// the library would follow a deep file as far as the stack goes
bool is_deep(const std::string& text) {
  int depth = 0;
  for (const char c : text) {
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (depth > DEEPEST) return true;
  }
  return false;
}

const Json& value_in(const Json& json, const std::string& key, const std::filesystem::path& file) {
  const auto at = json.find(key);
  if (at == json.end()) fail(file, "lacks the key `" + key + "`");
  return *at;
}

}  // namespace

std::optional<Json> read_json_file(const std::filesystem::path& file, const char* advice) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) fail(file, "is a folder", advice);
  const std::optional<std::string> text = read_whole_file(file);
  if (!text) return std::nullopt;
  Json json;
  if (!is_deep(*text)) json = Json::parse(*text, nullptr, false);
  if (!json.is_object()) fail(file, "is no JSON file with one mapping", advice);
  return json;
}

std::string text_in(const Json& json, const std::string& key, const std::filesystem::path& file) {
  const Json& value = value_in(json, key, file);
  if (!value.is_string()) fail(file, "has a key `" + key + "` that is no text");
  return value.get<std::string>();
}

std::uint64_t whole_in(const Json& json, const std::string& key, std::uint64_t low, std::uint64_t high,
                       const std::filesystem::path& file) {
  const Json& value = value_in(json, key, file);
  const std::string range = std::to_string(low) + " to " + std::to_string(high);
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() < low || value.get<std::uint64_t>() > high)
    fail(file, "has a key `" + key + "` that is no whole number from " + range);
  return value.get<std::uint64_t>();
}

SummaryPictures read_summary_pictures(const std::filesystem::path& file) {
  const std::optional<Json> summary = read_json_file(file);
  if (!summary) throw UsageError(file.string() + " does not exist; name an episode of generate");
  SummaryPictures pictures;
  const Json& rate = value_in(*summary, "frames_per_second", file);
  if (rate.is_number()) pictures.frames_per_second = rate.get<double>();
  if (!(pictures.frames_per_second > 0 && pictures.frames_per_second <= FASTEST))
    fail(file, "has a key `frames_per_second` that is no rate above 0");
  const Json& cameras = value_in(*summary, "cameras", file);
  if (!cameras.is_object()) fail(file, "has a key `cameras` that is no mapping");
  for (const auto& [name, size] : cameras.items()) {
    if (!is_identifier(name)) fail(file, "has a camera `" + name.substr(0, 80) + "`, which is no name");
    if (!size.is_object()) fail(file, "has a camera `" + name + "` without its size");
    pictures.cameras.push_back(
        {name, int(whole_in(size, "width", 1, LARGEST, file)), int(whole_in(size, "height", 1, LARGEST, file))});
  }
  return pictures;
}

}  // namespace pvg

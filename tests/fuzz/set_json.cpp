// set.json and summary.json by structure: sound mappings of which the input takes keys out or puts other values in.
#include <nlohmann/json.hpp>

#include "host/dataset/json_file.hpp"
#include "pipeline/episode/episode_set.hpp"
#include "tests/fuzz/choices.hpp"
#include "tests/fuzz/input_file.hpp"

namespace pvg {
namespace {

using Json = nlohmann::ordered_json;

Json other_value(Choices& choices, int depth = 0) {
  switch (choices.below(depth < 4 ? 9 : 6)) {
    case 0:
      return nullptr;
    case 1:
      return choices.whole();
    case 2:
      return choices.real();  // NaN is written as null
    case 3:
      return choices.text();
    case 4:
      return std::uint64_t(choices.whole());
    case 5:
      return choices.byte() % 2 == 0;
    case 6:
      return Json::array({other_value(choices, depth + 1), other_value(choices, depth + 1)});
    default:
      return Json{{choices.text(), other_value(choices, depth + 1)}, {"width", other_value(choices, depth + 1)}};
  }
}

void spoil(Json& json, Choices& choices) {
  std::vector<std::string> keys;
  for (const auto& entry : json.items()) keys.push_back(entry.key());
  for (const std::string& key : keys) {
    if (choices.spoils())
      json.erase(key);
    else if (choices.spoils())
      json[key] = other_value(choices);
    else if (json[key].is_object())
      spoil(json[key], choices);
  }
}

void write_spoilt(const std::string& name, Json json, Choices& choices) {
  spoil(json, choices);
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (choices.spoils()) text.resize(text.size() * choices.byte() / 256);
  input_file(name, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace
}  // namespace pvg

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pvg;
  Choices choices(data, size);
  write_spoilt("set.json",
               {{"schema", 1},
                {"task", "lift"},
                {"seed", 3u},
                {"configuration", "00"},
                {"episodes", 2u},
                {"done", {0}},
                {"failed", Json::array()},
                {"versions", {{"program", "1"}, {"opencl_device", "x"}}}},
               choices);
  write_spoilt("summary.json",
               {{"success", true},
                {"reason", "none"},
                {"frames_per_second", 10.0},
                {"cameras", {{"front", {{"width", 64u}, {"height", 48u}}}}}},
               choices);
  const std::filesystem::path folder = input_file("x", data, 0).parent_path();
  may_refuse([&] {
    const EpisodeSet set = read_set(folder);
    const SetStatus status = read_status(folder);
    if (set.n_asked < 1000) missing(set, status);
  });
  may_refuse([&] {
    EpisodeSet set;
    set.folder = folder;
    join_set(set);
  });
  may_refuse([&] { read_summary_pictures(folder / "summary.json"); });
  return 0;
}

// states.h5 by structure: a sound record of one rigid and one soft body, of which the input spoils data sets, shapes,
// numbers and attributes. All that read records read it.
#include "host/dataset/packed_episode.hpp"
#include "host/dataset/states_record.hpp"
#include "pipeline/episode/intersections.hpp"
#include "pipeline/episode/report_data.hpp"
#include "tests/fuzz/choices.hpp"
#include "tests/fuzz/input_file.hpp"

namespace pvg {
namespace {

constexpr std::uint64_t T = 4;  // steps

struct Writer {
  hdf5::File file;
  Choices& choices;

  hdf5::Shape spoilt(hdf5::Shape shape) {
    if (choices.spoils() && !shape.empty()) shape[choices.below(shape.size())] = choices.below(6);
    if (choices.spoils() && !shape.empty()) shape.pop_back();
    if (choices.spoils()) shape.push_back(choices.below(4));
    return shape;
  }
  template <class Number>
  void put(const std::string& name, const hdf5::Shape& right, std::vector<Number> values) {
    if (choices.spoils()) return;
    const hdf5::Shape shape = spoilt(right);
    values.resize(hdf5::n_values(shape));
    if (choices.spoils() && !values.empty()) {
      Number& value = values[choices.below(values.size())];
      if constexpr (std::is_floating_point_v<Number>)
        value = Number(choices.real());
      else
        value = Number(choices.whole());
    }
    file.write<Number>(name, shape, values);
  }
  void names(const std::string& object, const std::string& attribute, std::vector<std::string> texts) {
    if (choices.spoils() || !file.has(object)) return;
    if (choices.spoils()) texts.pop_back();
    if (choices.spoils() && !texts.empty()) texts[choices.below(texts.size())] = choices.text();
    if (!texts.empty()) file.attribute(object, attribute, texts);
  }
  void text(const std::string& attribute, const std::string& right) {
    if (!choices.spoils()) file.attribute("/", attribute, choices.spoils() ? choices.text() : right);
  }
};

std::vector<double> poses() {
  std::vector<double> values;
  for (std::uint64_t step = 0; step < T; ++step)
    for (const double v : {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}) values.push_back(v);
  return values;
}

void write_record(const std::filesystem::path& path, Choices& choices) {
  Writer out{hdf5::File::create(path), choices};
  out.put<double>("/time", {T}, {0.1, 0.2, 0.3, 0.4});
  out.put<std::int64_t>("/frame_step", {2}, {1, 3});
  for (const char* name : {"/q", "/a", "/torque"}) {
    out.put<double>(name, {T, 2}, std::vector<double>(2 * T, 0.5));
    out.names(name, "names", {"hinge", "slide"});
  }
  for (const char* name : {"/T_link", "/T_rigid"}) {
    out.put<double>(name, {T, 1, 3, 4}, poses());
    out.names(name, "names", {name[3] == 'i' ? "hand" : "cup"});
  }
  out.put<double>("/X_deform/pad", {T, 4, 3}, std::vector<double>(12 * T, 0.25));
  for (const char* body : {"cup", "pad"}) {
    const std::string at = std::string("/mesh/") + body;
    out.put<double>(at + "/rest", {4, 3}, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
    out.put<std::uint32_t>(at + "/triangles", {4, 3}, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
    out.put<std::int64_t>(at + "/body", {}, {body[0] == 'c' ? 1 : 2});
  }
  out.put<std::int64_t>("/bodies/source", {3}, {0, 1, 2});
  out.put<std::int64_t>("/bodies/row", {3}, {0, 0, 0});
  out.put<std::int64_t>("/bodies/is_fixed", {3}, {0, 0, 0});
  out.put<std::int64_t>("/bodies/noncolliding", {1, 2}, {0, 1});
  out.names("/bodies", "names", {"hand", "cup", "pad"});
  out.names("/bodies", "data_sets", {"/T_link", "/T_rigid", "/X_deform/pad"});
  out.put<std::int64_t>("/pair_force/offset", {T + 1}, {0, 1, 1, 2, 2});
  out.put<std::int64_t>("/pair_force/bodies", {2, 2}, {1, 2, -1, 2});
  out.put<double>("/pair_force/normal", {2, 3}, std::vector<double>(6, 1));
  out.put<double>("/camera/front/K", {2, 3, 3}, std::vector<double>(18, 1));
  out.put<double>("/camera/front/T_world_camera", {2, 4, 4}, std::vector<double>(32, 1));
  out.put<double>("/sampled", {1}, {0.5});
  out.names("/sampled", "names", {"mass"});
  out.text("task", "lift");
  out.text("configuration",
           "robot: {urdf: arm.urdf}\ngripper: {base_link: hand, joints: [slide], tool_center: {position: [0, 0, 0], "
           "quaternion: [0, 0, 0, 1]}}");
  if (!choices.spoils()) out.file.attribute("/", "seed", std::uint64_t(1));
  if (!choices.spoils()) out.file.attribute("/", "episode", std::uint64_t(0));
  if (!choices.spoils()) out.file.attribute("/", "h", choices.spoils() ? choices.real() : 0.1);
  out.file.close();
}

}  // namespace
}  // namespace pvg

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pvg;
  const std::string summary = R"({"frames_per_second": 5.0, "cameras": {"front": {"width": 32, "height": 16}}})";
  const std::filesystem::path folder =
      input_file("summary.json", reinterpret_cast<const std::uint8_t*>(summary.data()), summary.size()).parent_path();
  Choices choices(data, size);
  write_record(folder / "states.h5", choices);
  may_refuse([&] { read_packed_episode(folder, {}); });
  may_refuse([&] { episode_report(folder, true); });
  may_refuse([&] { count_intersected_steps(folder / "states.h5", 1); });
  return 0;
}

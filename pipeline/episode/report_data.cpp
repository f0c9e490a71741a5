#include "pipeline/episode/report_data.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/dataset/json_file.hpp"
#include "host/dataset/states_record.hpp"
#include "host/hdf5/series.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t MOST_KEYS = 150;    // moments of the motion, where there are no pictures
constexpr std::size_t MOST_PAIRS = 6;     // of bodies whose contact force is drawn
constexpr std::size_t MOST_POINTS = 400;  // of a curve

template <class T>
std::string base64_of(const std::vector<T>& values) {
  return base64({reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)});
}

// Steps that are shown: the pictures' where there are some.
std::vector<std::size_t> key_steps(const StatesRecord& record) {
  std::vector<std::size_t> steps = record.filmed_steps();
  if (!steps.empty()) return steps;
  const std::vector<std::size_t> kept = record.kept_steps();
  const std::size_t every = std::max<std::size_t>(1, (kept.size() + MOST_KEYS - 1) / MOST_KEYS);
  for (std::size_t i = every - 1; i < kept.size(); i += every) steps.push_back(kept[i]);
  return steps;
}

double rounded(double value) { return std::round(value * 1e6) / 1e6; }

// Every k-th step, so that a curve stays light.
std::vector<std::size_t> curve_steps(std::size_t n_steps) {
  const std::size_t every = std::max<std::size_t>(1, (n_steps + MOST_POINTS - 1) / MOST_POINTS);
  std::vector<std::size_t> steps;
  for (std::size_t step = 0; step < n_steps; step += every) steps.push_back(step);
  return steps;
}

Json joint_lines(const StatesRecord& record, const std::string& name, const std::vector<std::size_t>& steps,
                 bool slides) {
  const StatesRecord::Series series = record.series(name);
  const std::vector<std::string>& names = series.names;
  Json lines = Json::array();
  for (std::size_t j = 0; j < names.size(); ++j) {
    if ((names[j].find("slide") != std::string::npos) != slides) continue;
    Json values = Json::array();
    for (const std::size_t step : steps) values.push_back(rounded(series.at(step, j)));
    lines.push_back({{"name", names[j]}, {"values", values}});
  }
  return lines;
}

// How hard bodies press on each other, by pair; those with the most force over time.
Json contact_lines(const StatesRecord& record, const std::vector<std::size_t>& steps) {
  const std::vector<StatesRecord::Body> all = record.bodies();
  const auto [offset, bodies, normal] = record.pair_forces();
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<double>> series;
  std::map<std::pair<std::int64_t, std::int64_t>, double> sum;
  for (std::size_t i = 0; i < steps.size(); ++i)
    for (std::size_t at = offset[steps[i]]; at < offset[steps[i] + 1]; ++at) {
      const auto pair = std::minmax(bodies[2 * at], bodies[2 * at + 1]);
      const double force = std::hypot(normal[3 * at], normal[3 * at + 1], normal[3 * at + 2]);
      std::vector<double>& values = series.try_emplace(pair, steps.size(), 0.0).first->second;
      values[i] += force;
      sum[pair] += force;
    }
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  for (const auto& [pair, total] : sum) pairs.push_back(pair);
  std::stable_sort(pairs.begin(), pairs.end(), [&](const auto& a, const auto& b) { return sum[a] > sum[b]; });
  if (pairs.size() > MOST_PAIRS) pairs.resize(MOST_PAIRS);
  const auto name_of = [&](std::int64_t body) {
    return body >= 0 && std::size_t(body) < all.size() ? all[std::size_t(body)].name : std::string("plane");
  };
  Json lines = Json::array();
  for (const auto& pair : pairs) {
    Json values = Json::array();
    for (const double value : series[pair]) values.push_back(rounded(value));
    lines.push_back({{"name", name_of(pair.first) + " / " + name_of(pair.second)}, {"values", values}});
  }
  return lines;
}

Json reading_lines(const StatesRecord& record, const std::vector<std::size_t>& steps) {
  constexpr double GRAMS = 1e3;  // in a kilogram
  const StatesRecord::Series series = record.series("/reading");
  Json lines = Json::array();
  for (std::size_t i = 0; i < series.names.size(); ++i) {
    Json values = Json::array();
    for (const std::size_t step : steps) values.push_back(rounded(GRAMS * series.at(step, i)));
    lines.push_back({{"name", series.names[i]}, {"values", values}});
  }
  return lines;
}

void add_curve(Json& curves, const char* title, const char* unit, Json lines) {
  if (!lines.empty()) curves.push_back({{"title", title}, {"unit", unit}, {"lines", std::move(lines)}});
}

// The nodes that a surface uses, and its triangles in their numbering.
struct Surface {
  std::vector<std::uint32_t> nodes, triangles;
};

Surface compact(const std::vector<std::uint32_t>& triangles) {
  Surface surface;
  std::map<std::uint32_t, std::uint32_t> place;
  for (const std::uint32_t node : triangles) {
    const auto [at, is_new] = place.try_emplace(node, std::uint32_t(place.size()));
    if (is_new) surface.nodes.push_back(node);
    surface.triangles.push_back(at->second);
  }
  return surface;
}

Json soft_motion(const StatesRecord& record, const std::string& data_set, const std::vector<std::size_t>& keys,
                 const Surface& surface) {
  std::vector<float> all;
  for (const std::size_t step : keys) {
    const std::vector<double> x = record.row(data_set, step);
    for (const std::uint32_t node : surface.nodes)
      for (std::size_t k = 0; k < 3; ++k) all.push_back(float(x.at(3 * node + k)));
  }
  Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>> points(all.data(), 3, Eigen::Index(all.size() / 3));
  const Eigen::Vector3f low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  std::vector<std::uint16_t> frames;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Eigen::Index k = Eigen::Index(i % 3);
    const float range = std::max(high[k] - low[k], 1e-9f);
    frames.push_back(std::uint16_t(std::lround((all[i] - low[k]) / range * 65535)));
  }
  return {{"low", {low[0], low[1], low[2]}}, {"high", {high[0], high[1], high[2]}}, {"frames", base64_of(frames)}};
}

Json rigid_motion(const StatesRecord& record, const std::string& data_set, std::size_t row,
                  const std::vector<std::size_t>& keys) {
  std::vector<float> poses;
  for (const std::size_t step : keys) {
    const std::vector<double> all = record.row(data_set, step);
    for (std::size_t i = 0; i < 12; ++i) poses.push_back(float(all.at(12 * row + i)));
  }
  return {{"poses", base64_of(poses)}};
}

Json motion(const StatesRecord& record, const std::vector<std::size_t>& keys) {
  Json bodies = Json::array(), key_times = Json::array();
  for (const std::size_t step : keys) key_times.push_back(record.times()[step]);
  for (const StatesRecord::Body& shown : record.bodies()) {
    if (!record.has_mesh(shown)) continue;
    const auto [rest, triangles] = record.mesh(shown);
    const Surface surface = compact(triangles);
    if (surface.triangles.empty()) continue;
    std::vector<float> points;
    for (const std::uint32_t node : surface.nodes)
      for (std::size_t k = 0; k < 3; ++k) points.push_back(float(rest.at(3 * node + k)));
    Json body = {{"name", shown.name},
                 {"is_fixed", shown.is_fixed},
                 {"points", base64_of(points)},
                 {"triangles", base64_of(surface.triangles)}};
    body.update(shown.is_rigid ? rigid_motion(record, shown.data_set, shown.row, keys)
                               : soft_motion(record, shown.data_set, keys, surface));
    bodies.push_back(std::move(body));
  }
  return {{"times", key_times}, {"bodies", bodies}};
}

Json videos(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".mp4") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  Json list = Json::array();
  for (const fs::path& file : files) {
    const std::string bytes = read_whole_file(file).value_or("");
    const std::span all(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    list.push_back({{"name", file.stem().string()}, {"source", "data:video/mp4;base64," + base64(all)}});
  }
  return list;
}

}  // namespace

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr const char* DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? DIGITS[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

Json episode_report(const fs::path& folder, bool whole) {
  std::optional<Json> summary = read_json_file(folder / "summary.json");
  if (!summary) throw UsageError(folder.string() + " holds no summary.json; name an episode or a set of generate");
  Json report = {{"folder", folder.filename().string()}, {"summary", std::move(*summary)}};
  const fs::path states = folder / "states.h5";
  if (!fs::exists(states)) return report;  // failed, and its record not kept
  const StatesRecord record(states);
  if (const auto drawn = record.sampled(); !drawn.empty()) {
    Json& sampled = report["sampled"] = Json::object();
    for (const auto& [name, value] : drawn) sampled[name] = value;
  }
  const std::vector<double>& times = record.times();
  if (!whole || times.empty()) return report;
  const std::vector<std::size_t> steps = curve_steps(times.size());
  Json curve_times = Json::array(), curves = Json::array();
  for (const std::size_t step : steps) curve_times.push_back(rounded(times[step]));
  add_curve(curves, "Joints", "rad", joint_lines(record, "/q", steps, false));
  add_curve(curves, "Fingers", "m", joint_lines(record, "/q", steps, true));
  add_curve(curves, "Torques of the joints", "N m", joint_lines(record, "/torque", steps, false));
  add_curve(curves, "Forces of the fingers' drives", "N", joint_lines(record, "/torque", steps, true));
  add_curve(curves, "Normal force between bodies", "N", contact_lines(record, steps));
  if (record.has("/reading")) add_curve(curves, "Readings of scales", "g", reading_lines(record, steps));
  report["times"] = curve_times;
  report["curves"] = curves;
  report["videos"] = videos(folder);
  report["motion"] = motion(record, key_steps(record));
  return report;
}

}  // namespace pvg

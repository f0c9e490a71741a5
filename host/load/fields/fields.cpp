#include "host/load/fields/fields.hpp"
#include "host/base/counted.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace pvg {
namespace {

constexpr double PI = std::numbers::pi;

// about the fixed axes x, y, z in this order
Mat3 from_roll_pitch_yaw(const Vec3& angles) {
  using Eigen::AngleAxisd;
  return (AngleAxisd(angles.z(), Vec3::UnitZ()) * AngleAxisd(angles.y(), Vec3::UnitY()) *
          AngleAxisd(angles.x(), Vec3::UnitX()))
      .toRotationMatrix();
}

std::string in_table(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

}  // namespace

Pose read_pose(YamlSection& section) {
  Pose pose = Pose::Identity();
  pose.translation() = section.vector("position", Unit::length, -REACH, REACH, Vec3::Zero());
  if (section.is_resolved()) {
    const std::vector<double> q = section.numbers("quaternion", Unit::none, -1, 1);
    if (q.size() != 4) section.fail("quaternion", "must hold four numbers");
    pose.linear() = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix();
    return pose;
  }
  pose.linear() = from_roll_pitch_yaw(section.vector("rotation", Unit::angle, -2 * PI, 2 * PI, Vec3::Zero()));
  return pose;
}

Pose read_pose(YamlSection& parent, const std::string& key) {
  if (!parent.has(key)) return Pose::Identity();
  YamlSection section = parent.section(key);
  const Pose pose = read_pose(section);
  section.done();
  return pose;
}

std::string shown_number(double value) {
  std::ostringstream s;
  s.precision(6);
  s << value;
  return s.str();
}

std::string shown_names(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "`" : ", `") + name + "`";
  return all;
}

std::string shown_bounds(const NumberBounds& bounds) {
  if (std::isinf(bounds.high)) return "at least " + shown_number(bounds.low);
  return shown_number(bounds.low) + " to " + shown_number(bounds.high);
}

std::string markdown_table(const std::vector<FieldText>& rows) {
  std::string text = "| key | unit | default | values | meaning |\n|---|---|---|---|---|\n";
  for (const FieldText& row : rows)
    text += "| `" + row.key + "` | " + row.unit + " | " + row.otherwise + " | " + row.bounds + " | " +
            in_table(row.meaning) + " |\n";
  return text;
}

void read_value(YamlSection& section, const std::string& key, const NumberBounds& b, double& value) {
  value = section.number(key, b.unit, b.low, b.high);
}
void read_value(YamlSection& section, const std::string& key, const NumberBounds& b, float& value) {
  value = float(section.number(key, b.unit, b.low, b.high));
}
void read_value(YamlSection& section, const std::string& key, const NumberBounds& b, int& value) {
  value = section.integer(key, int(b.low), int(b.high));
}
void read_value(YamlSection& section, const std::string& key, const NumberBounds& b, Vec3& value) {
  value = section.vector(key, b.unit, b.low, b.high);
}
void read_value(YamlSection& section, const std::string& key, const NumberBounds& b, Vec3f& value) {
  value = section.vector(key, b.unit, b.low, b.high).cast<float>();
}
void read_value(YamlSection& section, const std::string& key, const NumberBounds& b, std::vector<double>& value) {
  value = section.numbers(key, b.unit, b.low, b.high);
}
void read_value(YamlSection& section, const std::string& key, const NumberBounds& b, Range& value) {
  value = section.range(key, b.unit, b.low, b.high, 0);
}
void read_value(YamlSection& section, const std::string& key, const NumberBounds& b, std::optional<double>& value) {
  value = section.number(key, b.unit, b.low, b.high);
}

void read_value(YamlSection& section, const std::string& key, const NumberBounds& b, std::span<double> values) {
  const std::vector<double> given = section.numbers(key, b.unit, b.low, b.high);
  if (given.size() != values.size()) section.fail(key, "must hold " + counted(values.size(), "number"));
  std::copy(given.begin(), given.end(), values.begin());
}
void read_value(YamlSection& section, const std::string& key, const NumberBounds& b, std::span<int> values) {
  std::vector<double> given(values.size());
  read_value(section, key, b, std::span<double>(given));
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (given[i] != std::floor(given[i])) section.fail(key, "must hold whole numbers");
    values[i] = int(given[i]);
  }
}

std::string shown(const std::string& value) { return value.empty() ? "none" : "`" + value + "`"; }
std::string shown(bool value) { return value ? "true" : "false"; }
std::string shown(double value) { return shown_number(value); }
std::string shown(const std::vector<double>& value) {
  if (value.empty()) return "none";
  std::string all;
  for (const double number : value) all += (all.empty() ? "[" : ", ") + shown_number(number);
  return all + "]";
}
std::string shown(const Vec3& value) { return shown(std::vector<double>(value.begin(), value.end())); }

}  // namespace pvg

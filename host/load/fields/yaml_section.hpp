// A mapping of a YAML file, read key by key. Every number is asked for with its unit and range; what is missing,
// unknown, doubled, of the wrong type, not finite or out of range throws a UsageError that names file, line and key.
//
// A number may stand alone and is then in SI, or carry a unit of its dimension: 1.5 mm, 30 deg, 20 MPa, 500 g.
#pragma once
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/model/task.hpp"

namespace pvg {

// The dimension of a number; its SI unit stands behind it.
enum class Unit {
  none,               // 1
  length,             // m
  angle,              // rad
  mass,               // kg
  inertia,            // kg m^2
  time,               // s
  frequency,          // Hz
  speed,              // m/s
  angular_speed,      // rad/s
  force,              // N
  torque,             // N m
  pressure,           // Pa
  density,            // kg/m^3
  area_density,       // kg/m^2
  volume,             // m^3
  stiffness,          // N/m
  angular_stiffness,  // N m/rad
  damping,            // N s/m
  angular_damping,    // N m s/rad
  acceleration,       // m/s^2
  per_length,         // 1/m
  radiance,           // W/(sr m^2)
};

std::string si_unit(Unit unit);

// "1.5 mm" -> 0.0015. Throws std::invalid_argument with a sentence's end that says what is wrong.
double parse_quantity(const std::string& text, Unit unit);

class YamlSection {
 public:
  // The root of a file. what: such as "task file", for messages.
  static YamlSection load(const std::filesystem::path& file, const std::string& what);

  // The root of what a file of another format was translated to. Messages name that file and the line of the text.
  static YamlSection translated(const std::string& text, const std::filesystem::path& file);

  // The root of a configuration that resolved_yaml wrote. file: what messages name; paths are relative to its folder.
  // Such a text holds drawn numbers and files that may have moved since: bounds and files are not checked.
  static YamlSection resolved(const std::string& text, const std::filesystem::path& file);
  bool is_resolved() const { return origin_ == Origin::resolved; }

  bool has(const std::string& key);
  bool holds(const std::string& key) const;                  // without asking for it: done() will not accept it
  void skip(const std::string& key) { asked_.insert(key); }  // done() accepts it

  // low <= value <= high
  double number(const std::string& key, Unit unit, double low, double high);
  double number(const std::string& key, Unit unit, double low, double high, double otherwise);
  int integer(const std::string& key, int low, int high);
  int integer(const std::string& key, int low, int high, int otherwise);
  bool boolean(const std::string& key, bool otherwise);
  std::string text(const std::string& key);
  std::string text(const std::string& key, const std::string& otherwise);
  std::string name();                                 // the key `name`, of what may name files: see is_identifier
  std::string text_or_empty(const std::string& key);  // as a resolved configuration may have it
  std::size_t choice(const std::string& key, const std::vector<std::string>& allowed);  // index
  std::size_t choice(const std::string& key, const std::vector<std::string>& allowed, std::size_t otherwise);
  std::vector<double> numbers(const std::string& key, Unit unit, double low, double high);
  std::vector<std::string> texts(const std::string& key);
  Vec3 vector(const std::string& key, Unit unit, double low, double high);
  Vec3 vector(const std::string& key, Unit unit, double low, double high, const Vec3& otherwise);
  Range range(const std::string& key, Unit unit, double low, double high, double otherwise);  // a number or [low, high]
  std::filesystem::path file(const std::string& key);  // relative to this file's folder; must exist
  std::vector<std::filesystem::path> files(const std::string& key);

  YamlSection section(const std::string& key);
  std::vector<YamlSection> sections(const std::string& key);  // a list of mappings; absent: empty

  // Throws if the mapping holds a key that nobody asked for. Call when all is read.
  void done() const;

  // For what only the caller can judge: throws "FILE:LINE: KEY SENTENCE." or, without key, about the section itself.
  [[noreturn]] void fail(const std::string& key, const std::string& sentence) const;
  const std::filesystem::path& path() const { return file_; }
  std::string place_of(const std::string& key) const;              // "FILE:LINE: `KEY`", for notes
  std::vector<double> bare_numbers(const std::string& key) const;  // that stand there without a unit, as a user wrote
  std::string place() const;  // "FILE:LINE", of a resolved configuration empty: for what is found wrong only later

 private:
  enum class Origin { file, translated, resolved };
  std::filesystem::path found_file(const std::string& key, const std::string& given);
  YamlSection(YAML::Node node, std::filesystem::path file, std::string name, Origin origin);
  std::optional<YAML::Node> find(const std::string& key);
  YAML::Node need(const std::string& key, const std::string& kind);
  double number_of(const YAML::Node& node, const std::string& key, Unit unit, double low, double high) const;
  std::string full_name(const std::string& key) const;
  [[noreturn]] void fail_at(const YAML::Node& node, const std::string& sentence) const;

  YAML::Node node_;
  std::filesystem::path file_;
  std::string name_;  // such as objects[1].pose; empty: the root
  std::set<std::string> asked_;
  Origin origin_ = Origin::file;
};

}  // namespace pvg

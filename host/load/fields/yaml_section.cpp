#include "host/load/fields/yaml_section.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>

#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/base/outputs.hpp"
#include "host/load/fields/yaml_fault.hpp"

namespace pvg {
namespace {

constexpr double DEGREE = 3.14159265358979323846 / 180;

struct NamedUnit {
  const char* name;
  double factor;  // to SI
};

// The first of each list is the SI unit.
const std::vector<NamedUnit>& units_of(Unit unit) {
  static const std::map<Unit, std::vector<NamedUnit>> UNITS = {
      {Unit::none, {{"1", 1}}},
      {Unit::length, {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}}},
      {Unit::angle, {{"rad", 1}, {"deg", DEGREE}}},
      {Unit::mass, {{"kg", 1}, {"g", 1e-3}}},
      {Unit::time, {{"s", 1}, {"ms", 1e-3}}},
      {Unit::frequency, {{"Hz", 1}}},
      {Unit::speed, {{"m/s", 1}, {"cm/s", 1e-2}, {"mm/s", 1e-3}}},
      {Unit::angular_speed, {{"rad/s", 1}, {"deg/s", DEGREE}}},
      {Unit::force, {{"N", 1}, {"mN", 1e-3}, {"kN", 1e3}}},
      {Unit::torque, {{"N m", 1}, {"mN m", 1e-3}}},
      {Unit::pressure, {{"Pa", 1}, {"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}}},
      {Unit::inertia, {{"kg m^2", 1}, {"g cm^2", 1e-7}}},
      {Unit::density, {{"kg/m^3", 1}, {"g/cm^3", 1e3}}},
      {Unit::area_density, {{"kg/m^2", 1}, {"g/m^2", 1e-3}}},
      {Unit::volume, {{"m^3", 1}, {"cm^3", 1e-6}, {"mm^3", 1e-9}}},
      {Unit::stiffness, {{"N/m", 1}, {"N/mm", 1e3}, {"kN/m", 1e3}}},
      {Unit::angular_stiffness, {{"N m/rad", 1}, {"N m/deg", 1 / DEGREE}}},
      {Unit::damping, {{"N s/m", 1}}},
      {Unit::angular_damping, {{"N m s/rad", 1}}},
      {Unit::acceleration, {{"m/s^2", 1}}},
      {Unit::per_length, {{"1/m", 1}, {"1/mm", 1e3}}},
      {Unit::radiance, {{"W/(sr m^2)", 1}}}};
  return UNITS.at(unit);
}

std::string number_text(double value) {
  std::ostringstream s;
  s.precision(9);
  s << value;
  return s.str();
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

// Its beginning, which is enough to see how it is indented.
std::string line_of(const std::filesystem::path& file, int number) {
  std::ifstream in(file);
  for (; number > 0; --number) in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  std::string line(200, '\0');
  in.getline(line.data(), std::streamsize(line.size()));
  return line.c_str();
}

}  // namespace

std::string si_unit(Unit unit) { return units_of(unit).front().name; }

double parse_quantity(const std::string& text, Unit unit) {
  double value = 0;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc() || end == begin) throw std::invalid_argument("must be a number, but is `" + text + "`");
  if (!std::isfinite(value)) throw std::invalid_argument("must be finite, but is `" + text + "`");
  std::string name(end, text.data() + text.size());
  name.erase(0, name.find_first_not_of(' '));
  if (name.empty()) return value;
  std::vector<std::string> allowed;
  for (const NamedUnit& known : units_of(unit)) {
    if (name == known.name && unit != Unit::none) return value * known.factor;
    allowed.push_back(known.name);
  }
  if (unit == Unit::none) throw std::invalid_argument("must be a number without a unit, but is `" + text + "`");
  throw std::invalid_argument("has the unit `" + name + "`, which must be one of: " + joined(allowed));
}

YamlSection YamlSection::load(const std::filesystem::path& file, const std::string& what) {
  if (!is_file(file)) throw UsageError(file.string() + ": there is no such " + what + ".");
  remember_read(file);
  YAML::Node node;
  try {
    node = YAML::LoadFile(file.string());
  } catch (const YAML::ParserException& e) {
    throw UsageError(file.string() + ":" + std::to_string(e.mark.line + 1) +
                     ": this is not YAML: " + yaml_fault(e.msg, line_of(file, e.mark.line)) + ".");
  } catch (const YAML::Exception& e) {
    throw UsageError(file.string() + ": cannot be read; is it a file that you may read?");
  }
  return YamlSection(node, std::filesystem::absolute(file).lexically_normal(), "", Origin::file);
}

YamlSection YamlSection::translated(const std::string& text, const std::filesystem::path& file) {
  remember_read(file);
  return YamlSection(YAML::Load(text), std::filesystem::absolute(file).lexically_normal(), "", Origin::translated);
}

YamlSection YamlSection::resolved(const std::string& text, const std::filesystem::path& file) {
  try {
    return YamlSection(YAML::Load(text), file, "configuration", Origin::resolved);
  } catch (const YAML::Exception& e) {
    throw UsageError(file.string() + ": its configuration is not YAML: " + yaml_fault(e.msg) +
                     "; make the record again.");
  }
}

YamlSection::YamlSection(YAML::Node node, std::filesystem::path file, std::string name, Origin origin)
    : node_(node), file_(std::move(file)), name_(std::move(name)), origin_(origin) {
  if (!node_.IsMap())
    fail_at(node_, (name_.empty() ? "the file" : "`" + name_ + "`") + " must be a mapping of keys to values");
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) fail_at(entry.first, "a key must be a word");
    if (!seen.insert(entry.first.Scalar()).second) {
      fail_at(entry.first,
              "the key `" + full_name(entry.first.Scalar()) + "` stands here a second time; keep one of them");
    }
  }
}

std::string YamlSection::full_name(const std::string& key) const { return name_.empty() ? key : name_ + "." + key; }

void YamlSection::fail_at(const YAML::Node& node, const std::string& sentence) const {
  const int line = node.Mark().is_null() ? 0 : node.Mark().line + 1;
  throw UsageError(file_.string() + ":" + std::to_string(line) + ": " + sentence + ".");
}

void YamlSection::fail(const std::string& key, const std::string& sentence) const {
  if (key.empty()) fail_at(node_, (name_.empty() ? "this file" : "`" + name_ + "`") + " " + sentence);
  const YAML::Node node = node_[key];
  fail_at(node.IsDefined() ? node : node_, "`" + full_name(key) + "` " + sentence);
}

std::string YamlSection::place() const {
  if (is_resolved() || node_.Mark().is_null()) return "";
  return file_.string() + ":" + std::to_string(node_.Mark().line + 1);
}

std::string YamlSection::place_of(const std::string& key) const {
  const YAML::Node node = node_[key];
  const int line = (node.IsDefined() ? node : node_).Mark().line + 1;
  return file_.string() + ":" + std::to_string(line) + ": `" + full_name(key) + "`";
}

std::vector<double> YamlSection::bare_numbers(const std::string& key) const {
  std::vector<double> values;
  const auto add = [&](const YAML::Node& node) {
    try {
      values.push_back(parse_quantity(node.Scalar(), Unit::none));
    } catch (const std::invalid_argument&) {  // it has a unit
    }
  };
  const YAML::Node node = node_[key];
  if (origin_ != Origin::file || !node.IsDefined()) return values;
  if (node.IsScalar()) add(node);
  if (node.IsSequence())
    for (const YAML::Node& entry : node) add(entry);
  return values;
}

std::optional<YAML::Node> YamlSection::find(const std::string& key) {
  asked_.insert(key);
  for (const auto& entry : node_) {
    if (entry.first.Scalar() == key) return entry.second;
  }
  return {};
}

YAML::Node YamlSection::need(const std::string& key, const std::string& kind) {
  const auto node = find(key);
  if (!node) fail_at(node_, "the key `" + full_name(key) + "` (" + kind + ") is missing");
  return *node;
}

bool YamlSection::has(const std::string& key) { return find(key).has_value(); }

bool YamlSection::holds(const std::string& key) const { return node_[key].IsDefined(); }

double YamlSection::number_of(const YAML::Node& node, const std::string& key, Unit unit, double low,
                              double high) const {
  if (!node.IsScalar()) fail_at(node, "`" + full_name(key) + "` must be a number [" + si_unit(unit) + "]");
  double value = 0;
  try {
    value = parse_quantity(node.Scalar(), unit);
  } catch (const std::invalid_argument& e) {
    fail_at(node, "`" + full_name(key) + "` " + e.what());
  }
  if (!is_resolved() && !(value >= low && value <= high)) {
    const std::string range =
        std::isinf(high) ? "at least " + number_text(low) : "between " + number_text(low) + " and " + number_text(high);
    fail_at(node,
            "`" + full_name(key) + "` must be " + range + " [" + si_unit(unit) + "], but is " + number_text(value));
  }
  return value;
}

double YamlSection::number(const std::string& key, Unit unit, double low, double high) {
  return number_of(need(key, "a number [" + si_unit(unit) + "]"), key, unit, low, high);
}

double YamlSection::number(const std::string& key, Unit unit, double low, double high, double otherwise) {
  const auto node = find(key);
  return node ? number_of(*node, key, unit, low, high) : otherwise;
}

int YamlSection::integer(const std::string& key, int low, int high) {
  const double value = number(key, Unit::none, low, high);
  if (value != std::floor(value)) fail(key, "must be a whole number, but is " + number_text(value));
  return int(value);
}

int YamlSection::integer(const std::string& key, int low, int high, int otherwise) {
  return has(key) ? integer(key, low, high) : otherwise;
}

bool YamlSection::boolean(const std::string& key, bool otherwise) {
  const auto node = find(key);
  if (!node) return otherwise;
  if (node->IsScalar() && node->Scalar() == "true") return true;
  if (node->IsScalar() && node->Scalar() == "false") return false;
  fail_at(*node, "`" + full_name(key) + "` must be true or false");
}

std::string YamlSection::text(const std::string& key) {
  const YAML::Node node = need(key, "a text");
  if (!node.IsScalar() || node.Scalar().empty()) fail_at(node, "`" + full_name(key) + "` must be a text");
  return node.Scalar();
}

std::string YamlSection::text(const std::string& key, const std::string& otherwise) {
  return has(key) ? text(key) : otherwise;
}

std::string YamlSection::name() {
  const std::string given = text("name");
  if (!is_identifier(given)) fail("name", std::string(IDENTIFIER_RULE) + ", but is `" + given.substr(0, 80) + "`");
  return given;
}

std::string YamlSection::text_or_empty(const std::string& key) {
  const YAML::Node node = need(key, "a text");
  if (!node.IsScalar()) fail_at(node, "`" + full_name(key) + "` must be a text");
  return node.Scalar();
}

std::size_t YamlSection::choice(const std::string& key, const std::vector<std::string>& allowed) {
  const std::string given = text(key);
  for (std::size_t i = 0; i < allowed.size(); ++i) {
    if (allowed[i] == given) return i;
  }
  fail(key, "is `" + given + "`, but must be one of: " + joined(allowed));
}

std::size_t YamlSection::choice(const std::string& key, const std::vector<std::string>& allowed,
                                std::size_t otherwise) {
  return has(key) ? choice(key, allowed) : otherwise;
}

std::vector<double> YamlSection::numbers(const std::string& key, Unit unit, double low, double high) {
  const YAML::Node node = need(key, "a list of numbers [" + si_unit(unit) + "]");
  if (!node.IsSequence()) fail_at(node, "`" + full_name(key) + "` must be a list of numbers [" + si_unit(unit) + "]");
  std::vector<double> values;
  for (const YAML::Node& entry : node) values.push_back(number_of(entry, key, unit, low, high));
  return values;
}

std::vector<std::string> YamlSection::texts(const std::string& key) {
  const YAML::Node node = need(key, "a list of texts");
  if (!node.IsSequence()) fail_at(node, "`" + full_name(key) + "` must be a list of texts");
  std::vector<std::string> values;
  for (const YAML::Node& entry : node) {
    if (!entry.IsScalar()) fail_at(entry, "`" + full_name(key) + "` must be a list of texts");
    values.push_back(entry.Scalar());
  }
  return values;
}

Vec3 YamlSection::vector(const std::string& key, Unit unit, double low, double high) {
  const std::vector<double> values = numbers(key, unit, low, high);
  if (values.size() != 3)
    fail(key, "must hold three numbers [" + si_unit(unit) + "], but holds " + std::to_string(values.size()));
  return {values[0], values[1], values[2]};
}

Vec3 YamlSection::vector(const std::string& key, Unit unit, double low, double high, const Vec3& otherwise) {
  return has(key) ? vector(key, unit, low, high) : otherwise;
}

Range YamlSection::range(const std::string& key, Unit unit, double low, double high, double otherwise) {
  const auto node = find(key);
  if (!node) return {otherwise, otherwise};
  if (!node->IsSequence()) {
    const double value = number_of(*node, key, unit, low, high);
    return {value, value};
  }
  const std::vector<double> values = numbers(key, unit, low, high);
  if (values.size() != 2 || !(values[0] <= values[1])) fail(key, "must be a number or [low, high] with low <= high");
  return {values[0], values[1]};
}

std::filesystem::path YamlSection::file(const std::string& key) { return found_file(key, text(key)); }

std::vector<std::filesystem::path> YamlSection::files(const std::string& key) {
  std::vector<std::filesystem::path> all;
  for (const std::string& given : texts(key)) all.push_back(found_file(key, given));
  return all;
}

std::filesystem::path YamlSection::found_file(const std::string& key, const std::string& given) {
  const std::filesystem::path full = (file_.parent_path() / given).lexically_normal();
  if (!is_resolved() && !is_file(full)) {
    std::error_code ignored;
    fail(key, "names the file " + full.string() +
                  (std::filesystem::exists(full, ignored) ? ", which is no file" : ", which does not exist"));
  }
  if (!is_resolved()) remember_read(full);
  return full;
}

YamlSection YamlSection::section(const std::string& key) {
  return YamlSection(need(key, "a mapping"), file_, full_name(key), origin_);
}

std::vector<YamlSection> YamlSection::sections(const std::string& key) {
  const auto node = find(key);
  if (!node) return {};
  if (!node->IsSequence()) fail_at(*node, "`" + full_name(key) + "` must be a list of mappings");
  std::vector<YamlSection> all;
  for (std::size_t i = 0; i < node->size(); ++i) {
    all.push_back(YamlSection((*node)[i], file_, full_name(key) + "[" + std::to_string(i) + "]", origin_));
  }
  return all;
}

void YamlSection::done() const {
  for (const auto& entry : node_) {
    if (asked_.contains(entry.first.Scalar())) continue;
    fail_at(entry.first, "the key `" + full_name(entry.first.Scalar()) +
                             "` is unknown here; allowed are: " + joined({asked_.begin(), asked_.end()}));
  }
}

}  // namespace pvg

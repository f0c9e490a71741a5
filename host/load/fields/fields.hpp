// A section of a scene, task or gripper file, declared once: a table of fields (key, unit, default, bounds, meaning).
// From it come the reader, the writer of the resolved configuration and the table of the reference page.
//
//   static const Fields<ContactSettings> FIELDS =
//       Fields<ContactSettings>()
//           .number("stiffness", &ContactSettings::stiffness, Unit::pressure, 1, 1e12, "scale of the barrier pressure")
//
// A key is optional unless required() follows its row; what is absent keeps the value that the struct has. A row's
// member is a pointer to member, or a function that returns the member of a T& and of a const T&.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "host/load/fields/yaml_section.hpp"
#include "host/load/fields/yaml_writer.hpp"

namespace pvg {

constexpr double REACH = 100;  // nothing stands further from the origin [m]

// `position` and `rotation` (roll, pitch, yaw about the fixed axes x, y, z in this order), of this section or of the
// one at `key`; absent: none. A resolved configuration has `quaternion` instead of `rotation`.
Pose read_pose(YamlSection& section);
Pose read_pose(YamlSection& parent, const std::string& key);

// A row of the reference page.
struct FieldText {
  std::string key, unit, otherwise, bounds, meaning;
};
std::string markdown_table(const std::vector<FieldText>& rows);
std::string shown_number(double value);
std::string shown_names(const std::vector<std::string>& names);  // `a`, `b`

struct NumberBounds {
  Unit unit = Unit::none;
  double low = 0, high = 0;
};
std::string shown_bounds(const NumberBounds& bounds);

// Numbers of every type that a member may have.
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds, double& value);
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds, float& value);
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds, int& value);
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds, Vec3& value);
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds, Vec3f& value);
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds, std::vector<double>& value);
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds, Range& value);
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds, std::optional<double>& value);
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds, std::span<double> values);
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds, std::span<int> values);
template <class Number, std::size_t N>
void read_value(YamlSection& section, const std::string& key, const NumberBounds& bounds,
                std::array<Number, N>& values) {
  read_value(section, key, bounds, std::span<Number>(values));
}

std::string shown(const std::string& value);
std::string shown(bool value);
std::string shown(double value);
std::string shown(const Vec3& value);
std::string shown(const std::vector<double>& value);
template <class Number, std::size_t N>
std::string shown(const std::array<Number, N>& values) {
  return shown(std::vector<double>(values.begin(), values.end()));
}
inline std::string shown(float value) { return shown(double(value)); }
inline std::string shown(int value) { return shown(double(value)); }
inline std::string shown(const Vec3f& value) { return shown(Vec3(value.cast<double>())); }
inline std::string shown(const Range& value) { return shown(value.low); }
inline std::string shown(const std::optional<double>&) { return "none"; }
inline std::string shown(const std::vector<std::string>&) { return "none"; }
inline std::string shown(const std::optional<std::vector<std::string>>&) { return "none"; }

template <class T>
class Fields {
 public:
  using Read = std::function<void(YamlSection&, T&)>;
  using Write = std::function<void(YamlWriter&, const T&)>;
  using Applies = std::function<bool(const T&)>;
  using UnitOf = std::function<Unit(const T&)>;
  inline static const T DEFAULTS = {};

  // low <= every number <= high
  template <class Member>
  Fields& number(const std::string& key, Member member, Unit unit, double low, double high,
                 const std::string& meaning) {
    const std::string unit_text = unit == Unit::none ? "" : si_unit(unit);
    return number(
        key, member, [unit](const T&) { return unit; }, unit_text, low, high, meaning);
  }

  // the same of a unit that rows above decide; unit_text: in words
  template <class Member>
  Fields& number(const std::string& key, Member member, const UnitOf& unit_of, const std::string& unit_text, double low,
                 double high, const std::string& meaning) {
    using M = std::remove_cvref_t<std::invoke_result_t<Member, T&>>;
    const auto read = [=](YamlSection& s, T& t) {
      read_value(s, key, {unit_of(t), low, high}, std::invoke(member, t));
    };
    const auto write = [=](YamlWriter& w, const T& t) {
      const M& value = std::invoke(member, t);
      if constexpr (std::is_same_v<M, Range>)
        w.range(key, value);
      else if constexpr (std::is_same_v<M, Vec3> || std::is_same_v<M, Vec3f>)
        w.vector(key, value);
      else if constexpr (std::is_same_v<M, std::vector<double>>)
        w.flow(key, value);
      else if constexpr (requires { std::tuple_size<M>::value; })
        w.flow(key, std::vector(value.begin(), value.end()));
      else if constexpr (std::is_same_v<M, std::optional<double>>) {
        if (value) w.entry(key, *value);
      } else
        w.entry(key, value);
    };
    return custom(
        {key, unit_text, shown(std::invoke(member, DEFAULTS)), shown_bounds({Unit::none, low, high}), meaning}, read,
        write);
  }

  template <class Member>
  Fields& flag(const std::string& key, Member member, const std::string& meaning) {
    const auto read = [=](YamlSection& s, T& t) { std::invoke(member, t) = s.boolean(key, false); };
    const auto write = [=](YamlWriter& w, const T& t) { w.entry(key, std::invoke(member, t)); };
    return custom({key, "", shown(bool(std::invoke(member, DEFAULTS))), "true, false", meaning}, read, write);
  }

  // a text, or a list of texts
  template <class Member>
  Fields& text(const std::string& key, Member member, const std::string& meaning) {
    using M = std::remove_cvref_t<std::invoke_result_t<Member, T&>>;
    constexpr bool is_text = std::is_same_v<M, std::string>;
    const auto read = [=](YamlSection& s, T& t) {
      if constexpr (is_text)
        std::invoke(member, t) = s.is_resolved() ? s.text_or_empty(key) : s.text(key);
      else
        std::invoke(member, t) = s.texts(key);
    };
    const auto write = [=](YamlWriter& w, const T& t) {
      const M& value = std::invoke(member, t);
      if constexpr (is_text)
        w.entry(key, value);
      else if constexpr (std::is_same_v<M, std::vector<std::string>>)
        w.flow(key, value);
      else if (value)
        w.flow(key, *value);
    };
    return custom({key, "", shown(std::invoke(member, DEFAULTS)), is_text ? "text" : "texts", meaning}, read, write);
  }

  // the key `name`, an identifier
  template <class Member>
  Fields& name(Member member, const std::string& meaning) {
    text("name", member, meaning).required();
    rows_.back().read = [=](YamlSection& s, T& t) {
      std::invoke(member, t) = s.is_resolved() ? s.text_or_empty("name") : s.name();
    };
    return *this;
  }

  // one of these names; the member is an enumeration that counts them
  template <class Member>
  Fields& choice(const std::string& key, Member member, const std::vector<std::string>& names,
                 const std::string& meaning) {
    using M = std::remove_cvref_t<std::invoke_result_t<Member, T&>>;
    const auto read = [=](YamlSection& s, T& t) { std::invoke(member, t) = M(s.choice(key, names)); };
    const auto write = [=](YamlWriter& w, const T& t) { w.entry(key, names[std::size_t(std::invoke(member, t))]); };
    return custom({key, "", "`" + names[std::size_t(std::invoke(member, DEFAULTS))] + "`", shown_names(names), meaning},
                  read, write);
  }

  // a file that is there, relative to the file that names it
  template <class Member>
  Fields& file(const std::string& key, Member member, const std::string& meaning) {
    const auto read = [=](YamlSection& s, T& t) { std::invoke(member, t) = s.file(key); };
    const auto write = [=](YamlWriter& w, const T& t) { w.path(key, std::invoke(member, t)); };
    return custom({key, "", "none", "file", meaning}, read, write);
  }

  template <class Member>
  Fields& files(const std::string& key, Member member, const std::string& meaning) {
    const auto read = [=](YamlSection& s, T& t) { std::invoke(member, t) = s.files(key); };
    const auto write = [=](YamlWriter& w, const T& t) { w.paths(key, std::invoke(member, t)); };
    return custom({key, "", "none", "list of files", meaning}, read, write);
  }

  // a mapping with `position` and `rotation`
  template <class Member>
  Fields& pose(const std::string& key, Member member, const std::string& meaning) {
    const auto read = [=](YamlSection& s, T& t) { std::invoke(member, t) = read_pose(s, key); };
    const auto write = [=](YamlWriter& w, const T& t) { w.pose(key, std::invoke(member, t)); };
    return custom({key, "m, rad", "none", "`{position, rotation}`", meaning}, read, write);
  }

  // `position` and `rotation` in this section itself; `pose` of the resolved configuration
  template <class Member>
  Fields& own_pose(Member member, const std::string& meaning) {
    custom({"position", "m", "[0, 0, 0]", shown_bounds({Unit::length, -REACH, REACH}), meaning}, nullptr, nullptr);
    custom({"rotation", "rad", "[0, 0, 0]", "", "roll, pitch, yaw about the fixed axes x, y, z in this order"}, nullptr,
           nullptr);
    reads([=](YamlSection& s, T& t) { std::invoke(member, t) = read_pose(s); });
    return pose("pose", member, meaning).only_resolved();
  }

  // a mapping with fields of its own
  template <class U, class Member>
  Fields& section(const std::string& key, Member member, const Fields<U>& fields, const std::string& meaning) {
    const auto read = [=](YamlSection& s, T& t) {
      YamlSection inner = s.section(key);
      fields.read(inner, std::invoke(member, t));
      inner.done();
    };
    const auto write = [=](YamlWriter& w, const T& t) {
      w.begin(key);
      fields.write(w, std::invoke(member, t));
      w.end();
    };
    custom({key, "", "", "mapping", meaning}, read, write);
    rows_.back().inner = fields.texts(key + ".");
    return *this;
  }

  // a list of such mappings. check_last: what the table of one cannot judge, by its section and the list up to it
  template <class U, class Member>
  Fields& list(const std::string& key, Member member, const Fields<U>& fields, const std::string& meaning,
               const Read& check_last = nullptr) {
    const auto read = [=](YamlSection& s, T& t) {
      for (YamlSection& item : s.sections(key)) {
        fields.read(item, std::invoke(member, t).emplace_back());
        item.done();
        if (check_last) check_last(item, t);
      }
    };
    const auto write = [=](YamlWriter& w, const T& t) {
      w.list(key, std::invoke(member, t), [&](const U& item) { fields.write(w, item); });
    };
    custom({key, "", "none", "list", meaning}, read, write);
    rows_.back().inner = fields.texts(key + "[].");
    return *this;
  }

  // the fields of a member, in this section itself
  template <class U, class Member>
  Fields& include(const Fields<U>& fields, Member member) {
    custom(
        {}, [=](YamlSection& s, T& t) { fields.read(s, std::invoke(member, t)); },
        [=](YamlWriter& w, const T& t) { fields.write(w, std::invoke(member, t)); });
    rows_.back().is_always_read = true;
    rows_.back().inner = fields.texts("");
    return *this;
  }

  // Without `write`: only in files. Without both: only on the reference page.
  Fields& custom(const FieldText& text, const Read& read, const Write& write) {
    rows_.push_back({text, {}, read, write, {}, {}});
    return *this;
  }

  // a number of files alone, that sets others
  Fields& sets(const std::string& key, const std::function<void(T&, double)>& set, Unit unit, double low, double high,
               const std::string& meaning) {
    const auto read = [=](YamlSection& s, T& t) { set(t, s.number(key, unit, low, high)); };
    const std::string unit_text = unit == Unit::none ? "" : si_unit(unit);
    return custom({key, unit_text, "none", shown_bounds({unit, low, high}), meaning}, read, nullptr);
  }
  // at this place of the reading of a file; what belongs to the keys of the rows above that read nothing
  Fields& reads(const Read& read) {
    custom({}, read, nullptr);
    rows_.back().is_always_read = true;
    return *this;
  }
  Fields& then(const std::function<void(T&)>& act) {
    return reads([=](YamlSection&, T& t) { act(t); });
  }

  // ---- of the row above

  Fields& required() {
    rows_.back().is_required = true;
    return otherwise("required");
  }
  Fields& otherwise(const std::string& text) {  // on the reference page
    rows_.back().text.otherwise = text;
    return *this;
  }
  // The key is only allowed where this holds of what the rows above have read. text: the same in words
  Fields& when(const Applies& applies, const std::string& text) {
    rows_.back().applies = applies;
    if (!text.empty()) rows_.back().text.meaning = text + ": " + rows_.back().text.meaning;
    return *this;
  }
  // read even where its key is absent: a row of several keys, which it reads itself
  Fields& always_read() {
    rows_.back().is_always_read = true;
    return *this;
  }
  Fields& written_when(const Applies& applies) {
    rows_.back().is_written = applies;
    return *this;
  }
  Fields& only_file() {
    rows_.back().write = nullptr;
    return *this;
  }
  Fields& only_resolved() {
    rows_.back().is_in_file = false;
    return *this;
  }

  // What one field cannot judge; a resolved configuration is not judged again.
  Fields& check(const Read& check) {
    checks_.push_back(check);
    return *this;
  }

  // ---- what comes of the table

  // without done()
  void read(YamlSection& section, T& value) const {
    for (const Row& row : rows_) {
      const bool is_meant =
          section.is_resolved() ? bool(row.write) : row.is_in_file && (!row.applies || row.applies(value));
      const bool is_needed = row.is_always_read || (row.is_required && !section.is_resolved());
      if (row.read && is_meant && (is_needed || section.has(row.text.key))) row.read(section, value);
    }
    if (section.is_resolved()) return;
    for (const Read& check : checks_) check(section, value);
  }

  void write(YamlWriter& writer, const T& value) const {
    for (const Row& row : rows_)
      if (row.write && (!row.is_written || row.is_written(value))) row.write(writer, value);
  }

  std::vector<FieldText> texts(const std::string& prefix) const {
    std::vector<FieldText> all;
    for (const Row& row : rows_) {
      if (!row.is_in_file) continue;
      if (!row.text.key.empty()) all.push_back(row.text);
      if (!row.text.key.empty()) all.back().key = prefix + row.text.key;
      for (const FieldText& inner : row.inner) {
        all.push_back(inner);
        all.back().key = prefix + inner.key;
      }
    }
    return all;
  }

 private:
  struct Row {
    FieldText text;
    std::vector<FieldText> inner;
    Read read;
    Write write;
    Applies applies, is_written;
    bool is_required = false, is_in_file = true, is_always_read = false;
  };
  std::vector<Row> rows_;
  std::vector<Read> checks_;
};

}  // namespace pvg

#include "host/identify/criteria.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <type_traits>

#include "host/base/error.hpp"

namespace pvg::diagnose {
namespace {

Criteria& mutable_criteria() {
  static Criteria all;
  return all;
}

template <class T>
void assign(T& field, double value) {
  if constexpr (std::is_integral_v<T>)
    field = T(std::max(1.0, std::round(value)));
  else
    field = value;
}

void assign(Series& field, double first) {
  const double ratio = first / field.front();
  for (double& value : field) value *= ratio;
  field.front() = first;
}

double first_of(double value) { return value; }
double first_of(const Series& series) { return series.front(); }

Series series_of(double) { return {}; }
Series series_of(const Series& series) { return series; }

}  // namespace

const Criteria& criteria() { return mutable_criteria(); }

void reset_criteria() { mutable_criteria() = Criteria(); }

void set_criterion(std::string_view name, double value) {
  if (!std::isfinite(value)) throw UsageError("criterion " + std::string(name) + ": the value must be a number");
  Criteria& all = mutable_criteria();
#define PVG_CRITERION(stage, type, field, usual, unit, meaning, evidence) \
  if (name == #field) {                                                   \
    assign(all.field, value);                                             \
    return;                                                               \
  }
  PVG_CRITERIA(PVG_CRITERION)
#undef PVG_CRITERION
  std::string similar;
  const std::string_view word = name.substr(0, name.find('_'));
  for (const Criterion& one : list_criteria())
    if (one.name.starts_with(word)) similar += (similar.empty() ? "" : ", ") + one.name;
  throw UsageError("there is no criterion " + std::string(name) +
                   (similar.empty() ? "; `phyvisgen diagnose --list-criteria` prints all" : "; there are " + similar));
}

void set_criterion(const std::string& text) {
  const std::size_t sign = text.find('=');
  char* end = nullptr;
  const double value = sign == std::string::npos ? 0 : std::strtod(text.c_str() + sign + 1, &end);
  if (end == nullptr || *end != 0 || end == text.c_str() + sign + 1)
    throw UsageError("--set-criterion " + text + ": write NAME=VALUE, such as unexplained=1.8");
  set_criterion(std::string_view(text).substr(0, sign), value);
}

std::vector<Criterion> list_criteria() {
  const Criteria& now = criteria();
  const Criteria table;
  std::vector<Criterion> list;
#define PVG_CRITERION(stage, type, field, usual, unit, meaning, evidence)                             \
  list.push_back({stage, #field, unit, meaning, evidence, first_of(now.field), first_of(table.field), \
                  series_of(table.field), std::is_integral_v<type>});
  PVG_CRITERIA(PVG_CRITERION)
#undef PVG_CRITERION
  return list;
}

}  // namespace pvg::diagnose

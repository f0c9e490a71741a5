// A number of the scene that a diagnosis may correct, and a recording may state for a run or give a prior, as a row:
// where it is in the scene, how far it may be wrong, and how it is written into the scene file. The rows are in
// scene_numbers.cpp. The templates below cover numbers that one key of the file says; others have functions of their
// own beside their row.
#pragma once
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/identify/data/scene_entry.hpp"
#include "host/model/scene.hpp"

namespace pvg::diagnose {

// One place of the scene that has such a number.
struct NumberPlace {
  std::string target;
  double value = 0;
  std::function<void(PhysicalScene&, double)> set;
};

// What is written into the scene file.
struct NumberInFile {
  YAML::Node& root;
  const std::string& target;
  double value, ratio;           // ratio: of the value to what the scene says
  const PhysicalScene& amended;  // the scene with this value
};

// A row without places or without a way to write it does not compile.
struct SceneNumber {
  const char *name, *unit, *meaning;
  double low, high;  // of the ratio to the scene's value
  // touching: pairs of bodies that touch in the runs
  std::vector<NumberPlace> (&places)(const PhysicalScene&, const std::vector<std::string>& touching);
  bool (&write)(const NumberInFile&);  // false where the file does not say this number itself
  double prior_sigma = 0;              // one standard deviation before any data [unit]; 0: anything
  double prior_sigma_share = 0;        // the same as a share of the scene's value
  double log_prior = 0;                // log of how likely it is before any data
  bool is_logarithmic = false;         // as Parameter has it
  bool is_often_far = false;           // likewise
};

std::span<const SceneNumber> scene_numbers();

// The places of a number that each item of a list of the scene has. value(item): a reference to it.
template <auto list, auto value>
std::vector<NumberPlace> in_each(const PhysicalScene& scene, const std::vector<std::string>&) {
  std::vector<NumberPlace> places;
  for (std::size_t i = 0; i < (scene.*list).size(); ++i) {
    auto item = (scene.*list)[i];
    if (const double* number = value(item))
      places.push_back({item.name, *number, [i](PhysicalScene& s, double x) { *value((s.*list)[i]) = x; }});
  }
  return places;
}

// A text as the argument of a template.
template <std::size_t n>
struct Key {
  char text[n];
  consteval Key(const char (&given)[n]) { std::copy_n(given, n, text); }
};

// Writes list/TARGET/key, where the file has that entry.
template <Key list, Key key>
bool write_in_entry(const NumberInFile& number) {
  YAML::Node entry = entry_named(number.root[list.text], number.target);
  if (!entry.IsDefined() || !entry.IsMap()) return false;
  entry[key.text] = number.value;
  return true;
}

// Writes list/TARGET/section/key, where the file has that section.
template <Key list, Key section, Key key>
bool write_in_section(const NumberInFile& number) {
  YAML::Node entry = entry_named(number.root[list.text], number.target);
  if (!entry.IsDefined() || !entry.IsMap() || !entry[section.text]) return false;
  entry[section.text][key.text] = number.value;
  return true;
}

}  // namespace pvg::diagnose

// Look-up in lists whose items have a `name`.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

namespace pvg {

// The first item of that name; nullptr: there is none.
template <typename T>
const T* find_named(const std::vector<T>& list, const std::string& name) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const T& item) { return item.name == name; });
  return at == list.end() ? nullptr : &*at;
}

// Its index; -1: there is none.
template <typename T>
int index_named(const std::vector<T>& list, const std::string& name) {
  const T* found = find_named(list, name);
  return found ? int(found - list.data()) : -1;
}

}  // namespace pvg

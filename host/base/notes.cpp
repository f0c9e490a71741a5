#include "host/base/notes.hpp"

#include <cstdio>
#include <mutex>
#include <set>

namespace pvg {

void tell_note(const std::string& sentence) {
  static std::mutex mutex;
  static std::set<std::string> told;
  const std::lock_guard lock(mutex);
  if (told.insert(sentence).second) std::fprintf(stderr, "phyvisgen: note: %s\n", sentence.c_str());
}

}  // namespace pvg

// What the user should know though nothing is wrong: one line on stderr, once per process.
#pragma once
#include <string>

namespace pvg {

void tell_note(const std::string& sentence);

}  // namespace pvg

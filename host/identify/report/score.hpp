// Reports of the hidden-effect suite held against the truth of its cases.
#pragma once
#include <string>

namespace pvg::diagnose {

// The table of all cases of `suite` that have both files, report.json and truth.json; nothing else is read.
// text: for people; json: the same as JSON.
struct Score {
  std::string text, json;
};
Score score(const std::string& suite, const std::string& reports);

}  // namespace pvg::diagnose

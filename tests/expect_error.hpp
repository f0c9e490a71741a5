// Expects that a call throws an error of type E whose message holds all of the given words.
#pragma once
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

namespace pvg {

template <typename E, typename Call>
void expect_error(const Call& call, std::initializer_list<const char*> words) {
  try {
    call();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const E& e) {
    for (const char* word : words) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << "`" << word << "` is not in: " << e.what();
    }
  }
}

}  // namespace pvg

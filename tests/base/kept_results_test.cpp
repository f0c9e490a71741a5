// A result is made once per key, and a file that changed has another key.
#include "host/base/kept_results.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

TEST(KeptResults, AreMadeOncePerKeyAndAnewWithoutOne) {
  KeptResults<int> kept(2);
  int made = 0;
  const auto make = [&] { return ++made; };
  EXPECT_EQ(kept.of("a", make), 1);
  EXPECT_EQ(kept.of("a", make), 1);
  EXPECT_EQ(kept.of("b", make), 2);
  EXPECT_EQ(kept.of("", make), 3);
  EXPECT_EQ(kept.of("", make), 4);
  EXPECT_EQ(kept.of("c", make), 5);  // the third: the two before are given up
  EXPECT_EQ(kept.of("a", make), 6);
}

TEST(KeptResults, WhatFailsIsTriedAgain) {
  KeptResults<int> kept(2);
  EXPECT_THROW(kept.of("a", []() -> int { throw std::runtime_error("no"); }), std::runtime_error);
  EXPECT_EQ(kept.of("a", [] { return 1; }), 1);
}

TEST(KeptResults, AChangedFileHasAnotherKey) {
  const TestFolder folder;
  const auto file = folder.write("a.obj", "v 1 2 3");
  const std::string key = file_key(file);
  EXPECT_EQ(file_key(file), key);
  std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) + std::chrono::milliseconds(1));
  EXPECT_NE(file_key(file), key);
  EXPECT_NE(file_key(folder.write("a.obj", "v 1 2 3 4")), key);
  EXPECT_EQ(file_key(folder.path / "none.obj"), "");
}

}  // namespace
}  // namespace pvg

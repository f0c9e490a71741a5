// Compiled programs on disk: found by their whole key, never taken when damaged, and nothing fails without a folder.
#include "host/device/program_cache.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "host/device/device.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

using Bytes = std::vector<unsigned char>;
const Bytes program = {0, 1, 2, 255, 0, 7};

const char* const twice_text =
    "kernel void twice(const uint n, global const uint* x, global uint* y) {\n"
    "  const uint i = get_global_id(0); if (i >= n) return; y[i] = 2 * x[i]; }\n";

// doubles 21 on a device that keeps programs in this folder; how many programs it had to compile
std::size_t n_compiled_for_twice(const std::string& folder) {
  Device device;
  device.keep_programs_in(folder);
  Kernel twice = Program::from_text(device, "twice", twice_text).kernel("twice");
  Buffer<unsigned> x(device, std::vector<unsigned>{21}, "x"), y(device, 1, "y");
  twice(1, 1u, x, y);
  EXPECT_EQ(y.read().at(0), 42u);
  return device.n_compiled();
}

std::string read_all(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_all(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

TEST(ProgramCache, AProgramIsFoundByItsOwnKeyAlone) {
  const TestFolder folder;
  const ProgramCache cache(folder.path / "made" / "by" / "it");
  EXPECT_FALSE(cache.find("a"));
  cache.keep("a", program);
  EXPECT_EQ(cache.find("a"), program);
  EXPECT_FALSE(cache.find("b"));
  std::filesystem::rename(cache.file_of("a"), cache.file_of("b"));
  EXPECT_FALSE(cache.find("b")) << "another key's file";
}

TEST(ProgramCache, ADamagedFileIsNoProgram) {
  const TestFolder folder;
  const ProgramCache cache(folder.path);
  cache.keep("key", program);
  const std::string whole = read_all(cache.file_of("key"));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = char(damaged[i] ^ 16);
    write_all(cache.file_of("key"), damaged);
    EXPECT_FALSE(cache.find("key")) << "byte " << i;
    write_all(cache.file_of("key"), whole.substr(0, i));
    EXPECT_FALSE(cache.find("key")) << "cut after " << i << " bytes";
  }
  cache.keep("key", program);
  EXPECT_EQ(cache.find("key"), program) << "written again";
}

TEST(ProgramCache, AFolderThatCannotBeWrittenKeepsNothing) {
  const TestFolder folder;
  write_all(folder.path / "file", "no folder");
  const ProgramCache cache(folder.path / "file" / "below");
  cache.keep("key", program);
  EXPECT_FALSE(cache.find("key"));
  EXPECT_EQ(n_compiled_for_twice(folder.path / "file" / "below"), 1u) << "it is compiled instead";
}

TEST(ProgramCache, NothingUnfinishedStays) {
  const TestFolder folder;
  const ProgramCache cache(folder.path);
  cache.keep("key", program);
  std::filesystem::remove(cache.file_of("key"));
  std::filesystem::create_directories(cache.file_of("key") / "in the way");
  cache.keep("key", program);
  for (const auto& entry : std::filesystem::directory_iterator(folder.path))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST(ProgramCache, TheSecondStartCompilesNothingAndComputesTheSame) {
  if (std::getenv("PVG_OCLGRIND")) GTEST_SKIP() << "Oclgrind gives no compiled programs";
  const TestFolder folder;
  EXPECT_EQ(n_compiled_for_twice(folder.path), 1u);
  EXPECT_EQ(n_compiled_for_twice(folder.path), 0u);
}

// PoCL compiles a kernel when it is first launched, and all of a program when it is asked for the program's bytes
TEST(CompiledOnce, PoclCompilesNoKernelThatIsNotLaunched) {
  const TestFolder folder;
  setenv("POCL_CACHE_DIR", folder.path.c_str(), 1);  // read once in a process, hence this test has one of its own
  Device device;
  if (device.info().platform != "Portable Computing Language") GTEST_SKIP() << "runs on " << device.info().platform;
  Program program =
      Program::from_text(device, "two", std::string(twice_text) + "kernel void never(global uint* x) { x[0] = 1; }\n");
  Kernel twice = program.kernel("twice");
  Buffer<unsigned> x(device, std::vector<unsigned>{21}, "x"), y(device, 1, "y");
  twice(1, 1u, x, y);
  EXPECT_EQ(y.read().at(0), 42u);
  int n_compiled = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path))
    n_compiled += entry.path().extension() == ".so";
  EXPECT_EQ(n_compiled, 1);
}

TEST(ProgramCache, WhatTheDriverDoesNotTakeIsCompiledAgain) {
  if (std::getenv("PVG_OCLGRIND")) GTEST_SKIP() << "Oclgrind gives no compiled programs";
  const TestFolder folder;
  n_compiled_for_twice(folder.path);
  std::filesystem::path file;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path)) file = entry.path();
  // a file in order, whose program is none
  const std::string whole = read_all(file);
  std::uint64_t key_bytes = 0;
  std::copy_n(whole.data() + 8, sizeof key_bytes, reinterpret_cast<char*>(&key_bytes));
  ProgramCache(folder.path).keep(whole.substr(32, key_bytes), program);
  EXPECT_EQ(n_compiled_for_twice(folder.path), 1u);
  EXPECT_EQ(n_compiled_for_twice(folder.path), 0u);
}

TEST(ProgramCache, TheFolderFollowsTheXdgSpecification) {
  const auto with = [](const char* cache, const char* home) {
    setenv("XDG_CACHE_HOME", cache, 1);
    setenv("HOME", home, 1);
    return program_cache_folder().string();
  };
  const char* const home = std::getenv("HOME");
  const char* const cache = std::getenv("XDG_CACHE_HOME");
  const std::string old_home = home ? home : "", old_cache = cache ? cache : "";
  EXPECT_EQ(with("/c", "/h"), "/c/phyvisgen/programs");
  EXPECT_EQ(with("", "/h"), "/h/.cache/phyvisgen/programs");
  EXPECT_EQ(with("relative", "/h"), "/h/.cache/phyvisgen/programs");
  EXPECT_EQ(with("", ""), "");
  with(old_cache.c_str(), old_home.c_str());
}

}  // namespace
}  // namespace pvg

// Programs that say more on stderr than a pipe holds, as ffmpeg does of a damaged video, before they take or give all
#include "host/base/program_pipe.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr std::size_t MANY = 300'000;  // bytes

struct ProgramPipes : testing::Test {
  void SetUp() override { alarm(60); }  // what waits for ever ends the test
  void TearDown() override { alarm(0); }
};

std::vector<std::string> script(const std::string& text) { return {"-c", text}; }
const std::string SAYS_MUCH = "head -c 300000 /dev/zero | tr '\\0' '\\n' >&2; echo the last word >&2; ";

TEST_F(ProgramPipes, GivesAllBesideManyMessages) {
  ProgramPipe pipe("/bin/sh", script(SAYS_MUCH + "head -c 300000 /dev/zero"), ProgramPipe::Direction::from_program,
                   "a test");
  std::string bytes(MANY + 1, 'x');
  EXPECT_EQ(pipe.read(bytes.data(), bytes.size()), MANY);
  pipe.finish();
}

TEST_F(ProgramPipes, TakesAllBesideManyMessages) {
  ProgramPipe pipe("/bin/sh", script(SAYS_MUCH + "test $(wc -c) = 300000"), ProgramPipe::Direction::to_program,
                   "a test");
  const std::string bytes(MANY, 'x');
  pipe.write(bytes.data(), bytes.size());
  pipe.finish();
}

TEST_F(ProgramPipes, TellsTheLastOfManyMessages) {
  ProgramPipe pipe("/bin/sh", script(SAYS_MUCH + "exit 3"), ProgramPipe::Direction::from_program, "a test");
  char byte;
  EXPECT_EQ(pipe.read(&byte, 1), 0u);
  try {
    pipe.finish();
    FAIL() << "no failure";
  } catch (const Failure& failure) {
    EXPECT_STREQ(failure.what(), "a test: the last word");
  }
}

}  // namespace
}  // namespace pvg

// Messages through a pipe, and requests that are wrong.
#include "pipeline/serve/server.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <thread>

#include "host/load/task_file.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

using Json = nlohmann::ordered_json;

struct Pipe {
  Pipe() {
    if (pipe(files) != 0) throw Failure("no pipe");
  }
  ~Pipe() {
    for (const int file : files)
      if (file >= 0) close(file);
  }
  void end() {
    close(files[1]);
    files[1] = -1;
  }
  int files[2];
};

TEST(Protocol, AMessageComesBackAsItWas) {
  Pipe pipe;
  Message sent;
  sent.head["text"] = "a\n\"b\"";
  const std::vector<double> numbers = {0.1, -1e300, 3};
  const std::vector<std::uint8_t> bytes = {1, 2, 255, 0};
  add_array(sent, "numbers", {3}, std::span<const double>(numbers));
  add_array(sent, "picture", {2, 2}, std::span<const std::uint8_t>(bytes));
  write_message(pipe.files[1], sent);
  const auto got = read_message(pipe.files[0]);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->head, sent.head);
  EXPECT_EQ(got->bytes, sent.bytes);
  EXPECT_EQ(got->head["arrays"][1]["offset"], 24);
  pipe.end();
  EXPECT_FALSE(read_message(pipe.files[0]));
}

TEST(Protocol, AStreamThatBreaksOffOrLiesIsAFailure) {
  {
    Pipe pipe;
    ASSERT_EQ(write(pipe.files[1], "\x05\0\0\0\0\0\0\0{}", 10), 10);
    pipe.end();
    expect_error<Failure>([&] { read_message(pipe.files[0]); }, {"ended within a message"});
  }
  Pipe pipe;
  ASSERT_EQ(write(pipe.files[1], "GET / HTTP/1.1\r\n", 16), 16);
  expect_error<Failure>([&] { read_message(pipe.files[0]); }, {"longer than any"});
}

TEST(Protocol, AHeadThatIsNoObjectIsRefusedAndTheNextOneRead) {
  Pipe pipe;
  ASSERT_EQ(write(pipe.files[1], "\x03\0\0\0\0\0\0\0[1]\x02\0\0\0\0\0\0\0{}", 21), 21);
  expect_error<UsageError>([&] { read_message(pipe.files[0]); }, {"no JSON object"});
  EXPECT_TRUE(read_message(pipe.files[0]));
}

struct Server : testing::Test {
  Json ask(const Json& head) {
    Message request;
    request.head = head;
    return answer(served, request).head;
  }
  static Task task() { return load_task(PVG_DATA_FOLDER "/../tests/pipeline/small_task/push_beaker.yaml"); }

  Device device;
  ServedTask served{task(), device, nullptr};
};

TEST_F(Server, WhatIsWrongWithARequestIsOneSentence) {
  EXPECT_EQ(ask({{"do", "step"}, {"action", {1}}})["error"], "no episode has begun; send a reset first");
  const Json started = ask({{"do", "reset"}, {"seed", 1}, {"episode", 2}, {"id", 5}});
  EXPECT_FALSE(started.contains("error")) << started;
  EXPECT_EQ(started["id"], 5);
  EXPECT_EQ(started["success"], false);
  EXPECT_TRUE(started["sampled"].contains("beaker/x"));
  const int memory = memfd_create("small", 0);
  ASSERT_EQ(ftruncate(memory, 10), 0);
  const std::string small = "/proc/self/fd/" + std::to_string(memory);
  for (const auto& [request, part] : std::vector<std::pair<Json, std::string>>{
           {{{"do", "fly"}}, "`fly`"},
           {{{"time", 1}}, "one of reset, step"},
           {{{"do", "reset"}, {"seed", -1}, {"episode", 0}}, "`seed` is a whole number"},
           {{{"do", "reset"}, {"seed", 1}}, "needs the key `episode`"},
           {{{"do", "reset"}, {"seed", 1}, {"episode", 0}, {"speed", 2}}, "no key `speed`"},
           {{{"do", "step"}}, "one of the keys"},
           {{{"do", "step"}, {"action", "left"}}, "list of numbers"},
           {{{"do", "step"}, {"action", {1, 2}}}, "8 numbers"},
           {{{"do", "step"}, {"action", {1, 2, 3, 4, 5, 6, 7, nullptr}}}, "list of numbers"},
           {{{"do", "step"}, {"targets", {1}}}, "list of numbers"},
           {{{"do", "observe"}, {"pictures", {"back"}}}, "no camera"},
           {{{"do", "observe"}, {"pictures", 3}}, "`pictures` is"},
           {{{"do", "observe"}, {"pictures", true}, {"memory", 3}}, "`memory` is the path"},
           {{{"do", "observe"}, {"pictures", true}, {"memory", "/nowhere"}}, "cannot be opened"},
           {{{"do", "observe"}, {"pictures", true}, {"memory", small}}, "has 10 bytes"},
           {{{"do", "observe"}, {"pictures", true}, {"memory", "/dev/null"}}, "no file in memory"},
       }) {
    const Json got = ask(request);
    ASSERT_TRUE(got.contains("error")) << request;
    EXPECT_NE(got["error"].get<std::string>().find(part), std::string::npos) << got;
  }
  close(memory);
  const Json after = ask({{"do", "observe"}});
  EXPECT_EQ(after["n_steps"], 0);
  EXPECT_EQ(after["failure"], started["failure"]);
}

TEST_F(Server, AStreamBeginsWithAGreetingAndEndsWhereItIsClosed) {
  Pipe requests, answers;
  for (const char* what : {"fly", "close"}) {
    Message request;
    request.head["do"] = what;
    write_message(requests.files[1], request);
  }
  serve_stream(served, "0.0", requests.files[0], answers.files[1]);
  const Json greeting = read_message(answers.files[0])->head;
  EXPECT_EQ(greeting["protocol"], PROTOCOL_VERSION);
  EXPECT_EQ(greeting["grasps"], false);
  EXPECT_EQ(greeting["columns"].size(), 8u);
  EXPECT_EQ(greeting["columns"][7]["joints"], Json({7, 8}));
  EXPECT_EQ(greeting["objects"], Json({"table", "beaker"}));
  EXPECT_EQ(greeting["environment"][7], "beaker_x");
  EXPECT_TRUE(read_message(answers.files[0])->head.contains("error"));
  EXPECT_FALSE(read_message(answers.files[0])->head.contains("error"));
}

}  // namespace
}  // namespace pvg

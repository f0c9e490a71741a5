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

// Sentences quote the first 40 bytes of what was asked for, which may end within a character.
TEST(Protocol, ATextThatIsCutWithinACharacterIsSent) {
  Pipe pipe;
  Message sent;
  sent.head["error"] = "\xc3\xa9 `\xc3`";
  write_message(pipe.files[1], sent);
  EXPECT_EQ(read_message(pipe.files[0])->head["error"], "\xc3\xa9 `\xef\xbf\xbd`");
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
  ServedWorlds served{task(), device, nullptr, 1};
};

TEST_F(Server, WhatIsWrongWithARequestIsOneSentence) {
  EXPECT_EQ(ask({{"do", "step"}, {"action", {1}}})["error"], "no episode has begun; send a reset first");
  for (const char* what : {"observe", "state", "measure", "intersection", "plan"})
    EXPECT_EQ(ask({{"do", what}})["error"], "no episode has begun; send a reset first") << what;
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
           {{{"do", "step"}, {"action", Json(std::vector<double>(8, 0.0))}, {"pictures", true}}, "--no-render"},
           {{{"do", "step"}, {"action", Json(std::vector<double>(8, 1e300))}}, "it may be 1000 at most"},
           {{{"do", "reset"}, {"seed", 7}, {"episode", 7}, {"pictures", {"front"}}}, "--no-render"},
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
  EXPECT_EQ(after["events"], Json::array());
}

TEST(ServerOfAFarTask, AMotionThatCannotBePlannedIsToldAndTheEpisodeGoesOnWithoutIt) {
  Task task = Server::task();
  task.motion.front().target.translation().x() = 5;
  Device device;
  ServedWorlds served{task, device, nullptr, 1};
  const auto ask = [&](const Json& head) {
    Message request;
    request.head = head;
    return answer(served, request).head;
  };
  ask({{"do", "reset"}, {"seed", 1}, {"episode", 2}});
  const Json plan = ask({{"do", "plan"}});
  EXPECT_EQ(plan["periods"], 0);
  EXPECT_NE(plan["reason"], "");
  EXPECT_EQ(ask({{"do", "observe"}})["over"], false);
  const Json stepped = ask({{"do", "step"}, {"plan", true}});
  EXPECT_EQ(stepped["over"], true);
  EXPECT_EQ(stepped["reason"], plan["reason"]);
}

// Each request of a `together` has its answer in its place; what is wrong with one leaves the others alone.
TEST_F(Server, RequestsOfSeveralWorldsAreAnsweredTogether) {
  ServedWorlds three(task(), device, nullptr, 3);
  EXPECT_EQ(greeting(three, "0.0").head["worlds"], 3);
  const auto ask_three = [&](const Json& head) {
    Message request;
    request.head = head;
    return answer(three, request);
  };
  const auto begin = [](int world, int episode) {
    return Json{{"do", "reset"}, {"world", world}, {"seed", 1}, {"episode", episode}, {"id", 10 + world}};
  };
  const Message started =
      ask_three({{"do", "together"}, {"id", 7}, {"requests", {begin(2, 5), begin(0, 5), {{"do", "fly"}, {"id", 3}}}}});
  EXPECT_EQ(started.head["id"], 7);
  const Json& answers = started.head["answers"];
  ASSERT_EQ(answers.size(), 3u);
  EXPECT_EQ(answers[0]["id"], 12);
  EXPECT_EQ(answers[2]["id"], 3);
  EXPECT_TRUE(answers[2].contains("error"));
  const Message alone = ask_three({{"do", "observe"}, {"world", 2}});
  // the arrays of the second answer lie after those of the first, and both starts are the same
  const std::size_t n = alone.bytes.size();
  ASSERT_EQ(started.bytes.size(), 2 * n);
  EXPECT_EQ(std::vector(started.bytes.begin(), started.bytes.begin() + std::ptrdiff_t(n)), alone.bytes);
  EXPECT_EQ(std::vector(started.bytes.begin() + std::ptrdiff_t(n), started.bytes.end()), alone.bytes);
  EXPECT_EQ(answers[1]["arrays"][0]["offset"], n);
  const auto error_of = [&](const Json& request) { return ask_three(request).head["error"].get<std::string>(); };
  EXPECT_EQ(error_of({{"do", "observe"}, {"world", 1}}), "no episode has begun; send a reset first");
  EXPECT_NE(error_of({{"do", "observe"}, {"world", 3}}).find("from 0 to 2"), std::string::npos);
  EXPECT_NE(error_of({{"do", "observe"}, {"world", "all"}}).find("`world` is a whole number"), std::string::npos);
  EXPECT_NE(error_of({{"do", "together"}}).find("needs the key `requests`"), std::string::npos);
  EXPECT_NE(error_of({{"do", "together"}, {"requests", {{{"do", "close"}}}}}).find("cannot be among"),
            std::string::npos);
  EXPECT_NE(error_of({{"do", "together"}, {"world", 1}, {"requests", Json::array()}}).find("no key `world`"),
            std::string::npos);
  const Json twice = ask_three({{"do", "together"}, {"requests", {begin(0, 1), begin(0, 2)}}}).head["answers"];
  EXPECT_FALSE(twice[0].contains("error"));
  EXPECT_EQ(twice[1]["error"], "`together` has two requests of world 0");
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

// The stage graph: what streams equals the plain loop, the bound holds, wrong tables are refused, errors say where.
#include "pipeline/graph/graph.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

namespace pvg {
namespace {

const Field<double> position("position", "1", "m", true), shown("shown", "1", "m"), brightness("brightness", "1", "-"),
    last("last", "1", "-", true), packet("packet", "1", "-");
const Field<std::vector<double>> samples("samples", "frame % 3", "-");

// uneven work, so that frames would overtake each other if they could
void dawdle(std::size_t frame) { std::this_thread::sleep_for(std::chrono::microseconds(37 * (frame * 7 % 5))); }

struct Toy {
  std::vector<double> record;
  std::atomic<int> under_way = 0, most = 0;

  Table table() {
    return {
        {"simulate",
         {&position},
         {&position, &shown, &samples},
         1,
         [this](const Access& a) {
           const int now = ++under_way;
           if (now > most) most = now;
           double& x = a.write(position);
           x = std::sin(x + 0.1 * double(a.frame()));
           a.write(shown) = x;
           // appends to what should be empty: a slot that kept an older frame's values would show
           for (std::size_t i = 0; i < a.frame() % 3; ++i) a.write(samples).push_back(x * double(i + 1));
         }},
        {"render",
         {&shown, &samples},
         {&brightness},
         3,
         [](const Access& a) {
           dawdle(a.frame());
           double sum = std::exp(a.read(shown));
           for (const double s : a.read(samples)) sum += s;
           a.write(brightness) = sum;
         }},
        {"encode",
         {&brightness, &last},
         {&last, &packet},
         1,
         [](const Access& a) {
           a.write(packet) = a.read(brightness) - a.read(last);
           a.write(last) = a.read(brightness);
         }},
        {"record",
         {&packet, &shown},
         {},
         1,
         [this](const Access& a) {
           record.push_back(a.read(packet) + a.read(shown));
           --under_way;
         }},
    };
  }
};

std::vector<double> plain_loop(std::size_t n) {
  std::vector<double> record;
  double x = 0, before = 0;
  for (std::size_t t = 0; t < n; ++t) {
    x = std::sin(x + 0.1 * double(t));
    double b = std::exp(x);
    for (std::size_t i = 0; i < t % 3; ++i) b += x * double(i + 1);
    record.push_back(b - before + x);
    before = b;
  }
  return record;
}

const std::atomic<bool> go_on = false;

TEST(Graph, StreamedFramesEqualThePlainLoopBitByBitForEveryBound) {
  for (const std::size_t n : {0, 1, 3, 257})
    for (const std::size_t bound : {1, 2, 3, 8}) {
      Toy toy;
      const Table table = toy.table();
      Store store(table, bound);
      stream(table, store, n, go_on);
      EXPECT_EQ(toy.record, plain_loop(n)) << n << " frames, bound " << bound;
    }
}

TEST(Graph, NoMoreFramesAreUnderWayThanTheBound) {
  for (const int bound : {1, 2, 5}) {
    Toy toy;
    const Table table = toy.table();
    Store store(table, std::size_t(bound));
    stream(table, store, 60, go_on);
    EXPECT_LE(toy.most, bound);
    EXPECT_GE(toy.most, 1);
  }
}

TEST(Graph, StagesWorkOnDifferentFramesAtTheSameTime) {
  // the first stage of frame 1 can only end once the second stage has begun frame 0
  std::atomic<bool> second_has_begun = false, waited_in_vain = false;
  const Field<int> number("number", "1", "-");
  const Table table = {{"first",
                        {},
                        {&number},
                        1,
                        [&](const Access& a) {
                          if (a.frame() != 1) return;
                          for (int i = 0; i < 2000 && !second_has_begun; ++i)
                            std::this_thread::sleep_for(std::chrono::milliseconds(1));
                          waited_in_vain = !second_has_begun;
                        }},
                       {"second", {&number}, {}, 1, [&](const Access&) { second_has_begun = true; }}};
  Store store(table, 2);
  stream(table, store, 2, go_on);
  EXPECT_FALSE(waited_in_vain);
}

TEST(Graph, AnErrorNamesStageAndFrameAndKeepsItsCause) {
  Toy toy;
  Table table = toy.table();
  table[1].run = [](const Access& a) {
    if (a.frame() == 5) throw UsageError("the glass is broken");
    a.write(brightness) = 1;
  };
  Store store(table, 3);
  try {
    stream(table, store, 40, go_on);
    FAIL() << "nothing was thrown";
  } catch (const StageError& error) {
    EXPECT_STREQ(error.what(), "render, frame 5: the glass is broken");
    EXPECT_THROW(std::rethrow_exception(error.cause), UsageError);
  }
  EXPECT_LE(toy.record.size(), 5u);  // frames behind the broken one did not leave
}

TEST(Graph, AskedToStopItEndsEarlyWithTryAgain) {
  Toy toy;
  Table table = toy.table();
  std::atomic<bool> stop = false;
  const auto record = table.back().run;
  table.back().run = [&](const Access& a) {
    record(a);
    if (a.frame() == 10) stop = true;
  };
  Store store(table, 2);
  EXPECT_THROW(stream(table, store, 100000, stop), TryAgain);
  EXPECT_LT(toy.record.size(), 20u);
}

TEST(Graph, AStageThatTouchesWhatItsRowDoesNotSayIsStopped) {
  Toy toy;
  Table table = toy.table();
  table[3].run = [](const Access& a) { a.read(brightness); };
  Store store(table, 2);
  EXPECT_THROW(stream(table, store, 3, go_on), StageError);
}

TEST(Graph, WrongTablesAreRefused) {
  const auto nothing = [](const Access&) {};
  const Field<int> shown_again("shown", "1", "m");
  EXPECT_NO_THROW(check(Toy().table()));
  EXPECT_THROW(check({}), std::logic_error);
  EXPECT_THROW(check({{"read", {&shown}, {}, 1, nothing}}), std::logic_error);
  EXPECT_THROW(check({{"read", {&shown}, {}, 1, nothing}, {"write", {}, {&shown}, 1, nothing}}), std::logic_error);
  EXPECT_THROW(check({{"a", {}, {&shown}, 1, nothing}, {"b", {}, {&shown}, 1, nothing}}), std::logic_error);
  EXPECT_THROW(check({{"a", {}, {&last}, 1, nothing}, {"b", {&last}, {}, 1, nothing}}), std::logic_error);
  EXPECT_THROW(check({{"a", {}, {&last}, 2, nothing}}), std::logic_error);
  EXPECT_THROW(check({{"a", {}, {&shown}, 0, nothing}}), std::logic_error);
  EXPECT_THROW(check({{"a", {}, {&shown, &shown_again}, 1, nothing}}), std::logic_error);
}

TEST(Graph, ThePictureShowsEveryArrowOfTheTable) {
  const std::string picture = draw(Toy().table());
  for (const char* arrow : {"  position([position]) -.-> simulate\n", "  simulate --> shown([shown])\n",
                            "  shown([shown]) --> render\n", "  encode -.-> last([last])\n"})
    EXPECT_NE(picture.find(arrow), std::string::npos) << arrow;
}

}  // namespace
}  // namespace pvg

// What happens when, as a table: every frame passes the stages from top to bottom, and each stage says which fields it
// reads and writes. check() proves the table, draw() prints its picture, stream() runs it on oneTBB's flow graph with
// several frames under way, each in another stage, but never more than the bound. No result depends on the bound.
#pragma once
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host/base/error.hpp"

namespace pvg {

// A named value of one type. An ordinary field is made anew for every frame and travels with it. A state field lives
// from frame to frame and belongs to the one stage that touches it, which then may not work on two frames at once.
struct FieldInfo {
  std::string name, shape, unit;
  bool is_state;
  std::unique_ptr<void, void (*)(void*)> (*make)();  // an empty value
  void (*clear)(void*);                              // back to the empty value
};

template <class T>
struct Field : FieldInfo {
  Field(std::string name, std::string shape, std::string unit, bool is_state = false)
      : FieldInfo{
            std::move(name),
            std::move(shape),
            std::move(unit),
            is_state,
            [] { return std::unique_ptr<void, void (*)(void*)>(new T{}, [](void* p) { delete static_cast<T*>(p); }); },
            [](void* p) { *static_cast<T*>(p) = T{}; }} {}
};

class Access;

struct Stage {
  std::string name;
  std::vector<const FieldInfo*> reads, writes;
  std::size_t width;  // frames it may work on at once
  std::function<void(const Access&)> run;
};

using Table = std::vector<Stage>;

// Throws std::logic_error on a read without a writer above it, a second writer, state that two stages touch, state in a
// stage wider than 1, two fields of one name.
void check(const Table& table);

// The table as a mermaid flow chart; state fields hang on dotted arrows.
std::string draw(const Table& table);

// A stage threw: says where, and keeps what it threw.
struct StageError : Failure {
  StageError(const std::string& stage, std::size_t frame, const std::string& message, std::exception_ptr cause)
      : Failure(stage + ", frame " + std::to_string(frame) + ": " + message),
        stage(stage),
        frame(frame),
        cause(cause) {}
  std::string stage;
  std::size_t frame;
  std::exception_ptr cause;
};

// The values of a table's fields: a ring of `bound` slots for those that travel, one each for those that stay.
class Store {
 public:
  Store(const Table& table, std::size_t bound);
  std::size_t bound() const { return slots_.size(); }
  void* find(const FieldInfo& field, std::size_t frame);
  template <class T>
  T& state(const Field<T>& field) {
    return *static_cast<T*>(find(field, 0));
  }

 private:
  using Values = std::map<const FieldInfo*, std::unique_ptr<void, void (*)(void*)>>;
  Values state_;
  std::vector<Values> slots_;
};

// What a stage may touch while it works on one frame: the fields of its row and nothing else (std::logic_error).
class Access {
 public:
  Access(const Stage& stage, Store& store, std::size_t frame, const std::atomic<bool>& stop)
      : stage_(stage), store_(store), frame_(frame), stop_(stop) {}
  std::size_t frame() const { return frame_; }
  template <class T>
  const T& read(const Field<T>& field) const {
    return *static_cast<const T*>(granted(field, stage_.reads, "reads"));
  }
  template <class T>
  T& write(const Field<T>& field) const {
    return *static_cast<T*>(granted(field, stage_.writes, "writes"));
  }
  // Throws TryAgain once somebody asked to stop; long stages call it between their steps.
  void stop_here_if_asked() const;

 private:
  void* granted(const FieldInfo& field, const std::vector<const FieldInfo*>& row, const char* verb) const;
  const Stage& stage_;
  Store& store_;
  std::size_t frame_;
  const std::atomic<bool>& stop_;
};

// Runs n frames through the table, at most `store.bound()` at a time; frames leave in order. The first thing that a
// stage throws ends the run and comes out as a StageError; once `stop` is true the run ends with TryAgain. Returns the
// time that each stage was at work, over all frames [s].
std::vector<double> stream(const Table& table, Store& store, std::size_t n, const std::atomic<bool>& stop);

}  // namespace pvg

#include "pipeline/graph/graph.hpp"

#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <mutex>
#include <stdexcept>

namespace pvg {
namespace {

constexpr std::size_t THREADS_OF_ALL_GRAPHS = 1024;

void demand(bool ok, const std::string& complaint) {
  if (!ok) throw std::logic_error(complaint);
}

void check_states(const Table& table) {
  std::map<const FieldInfo*, std::string> owner;
  std::map<std::string, const FieldInfo*> named;
  for (const Stage& stage : table)
    for (const auto* row : {&stage.reads, &stage.writes})
      for (const FieldInfo* field : *row) {
        demand(named.try_emplace(field->name, field).first->second == field, "two fields are named " + field->name);
        if (!field->is_state) continue;
        const std::string& first = owner.try_emplace(field, stage.name).first->second;
        demand(first == stage.name, stage.name + " touches " + field->name + ", the state of " + first);
        demand(stage.width == 1, stage.name + " keeps state and must have width 1");
      }
}

void run_stage(const Stage& stage, Store& store, std::size_t frame, const std::atomic<bool>& stop) {
  const Access access(stage, store, frame, stop);
  access.stop_here_if_asked();
  // what an earlier frame left in the slot must not show
  for (const FieldInfo* field : stage.writes)
    if (!field->is_state) field->clear(store.find(*field, frame));
  try {
    stage.run(access);
  } catch (const TryAgain&) {
    throw;
  } catch (const std::exception& error) {
    throw StageError(stage.name, frame, error.what(), std::current_exception());
  }
}

// seconds: a sum per stage; only one thread at a time may add to it
struct StageClock {
  std::mutex mutex;
  double seconds = 0;
};

void run_graph(const Table& table, Store& store, std::size_t n, const std::atomic<bool>& stop,
               std::deque<StageClock>& clocks) {
  namespace flow = oneapi::tbb::flow;
  flow::graph graph;
  std::size_t next = 0;
  // runs one number ahead of the limiter, so it must not touch the frame's slot
  flow::input_node<std::size_t> numbers(graph, [&](oneapi::tbb::flow_control& control) {
    if (next == n) control.stop();
    return next++;
  });
  flow::limiter_node<std::size_t> under_way(graph, store.bound());
  flow::make_edge(numbers, under_way);

  // before every stage a buffer that restores the order: a function node drops what its successor refuses
  std::deque<flow::sequencer_node<std::size_t>> queues;
  std::deque<flow::function_node<std::size_t, std::size_t>> nodes;
  flow::sender<std::size_t>* above = &under_way;
  const auto in_order = [](std::size_t frame) { return frame; };
  for (const Stage& stage : table) {
    queues.emplace_back(graph, in_order);
    StageClock& clock = clocks.emplace_back();
    nodes.emplace_back(graph, stage.width, [&](std::size_t frame) {
      const auto start = std::chrono::steady_clock::now();
      run_stage(stage, store, frame, stop);
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
      const std::lock_guard lock(clock.mutex);
      clock.seconds += spent.count();
      return frame;
    });
    flow::make_edge(*above, queues.back());
    flow::make_edge(queues.back(), nodes.back());
    above = &nodes.back();
  }
  // a slot may be used again only when all frames before it have left, too
  flow::sequencer_node<std::size_t> last(graph, in_order);
  flow::function_node<std::size_t> leave(graph, 1, [](std::size_t) { return flow::continue_msg(); });
  flow::make_edge(*above, last);
  flow::make_edge(last, leave);
  flow::make_edge(leave, under_way.decrementer());
  numbers.activate();
  graph.wait_for_all();
}

}  // namespace

void check(const Table& table) {
  demand(!table.empty(), "the table has no stage");
  check_states(table);
  std::map<const FieldInfo*, std::string> writer;
  for (const Stage& stage : table) {
    demand(stage.width > 0, stage.name + " has width 0 and would never run");
    for (const FieldInfo* field : stage.reads)
      demand(field->is_state || writer.contains(field),
             stage.name + " reads " + field->name + ", which no stage above it writes");
    for (const FieldInfo* field : stage.writes) {
      if (field->is_state) continue;
      const std::string& first = writer.try_emplace(field, stage.name).first->second;
      demand(first == stage.name, stage.name + " writes " + field->name + ", which " + first + " has written");
    }
  }
}

std::string draw(const Table& table) {
  std::string text = "flowchart LR\n";
  for (const Stage& stage : table) {
    for (const FieldInfo* field : stage.reads)
      text +=
          "  " + field->name + "([" + field->name + "]) " + (field->is_state ? "-.-> " : "--> ") + stage.name + "\n";
    for (const FieldInfo* field : stage.writes)
      text += "  " + stage.name + (field->is_state ? " -.-> " : " --> ") + field->name + "([" + field->name + "])\n";
  }
  return text;
}

Store::Store(const Table& table, std::size_t bound) {
  if (bound == 0) throw std::invalid_argument("the graph needs room for one frame at least");
  slots_.resize(bound);
  for (const Stage& stage : table)
    for (const auto* row : {&stage.reads, &stage.writes})
      for (const FieldInfo* field : *row) {
        if (field->is_state) state_.try_emplace(field, field->make());
        for (Values& slot : slots_)
          if (!field->is_state) slot.try_emplace(field, field->make());
      }
}

void* Store::find(const FieldInfo& field, std::size_t frame) {
  Values& values = field.is_state ? state_ : slots_[frame % slots_.size()];
  const auto found = values.find(&field);
  demand(found != values.end(), "the table knows no field " + field.name);
  return found->second.get();
}

void* Access::granted(const FieldInfo& field, const std::vector<const FieldInfo*>& row, const char* verb) const {
  demand(std::find(row.begin(), row.end(), &field) != row.end(),
         stage_.name + " " + verb + " " + field.name + ", which its row does not say");
  return store_.find(field, frame_);
}

void Access::stop_here_if_asked() const {
  if (stop_) throw TryAgain("stopped before the end; what was finished stays, the same command continues");
}

std::vector<double> stream(const Table& table, Store& store, std::size_t n, const std::atomic<bool>& stop) {
  check(table);
  // a stage that waits for a device holds its thread: as many threads as pieces of work, whatever the cores.
  // It takes both, the control and the arena. Several graphs may run at once and the smallest control holds for all,
  // so it allows more than all of them take; oneTBB makes those threads only that have work.
  std::size_t threads = 1;
  for (const Stage& stage : table) threads += stage.width;
  namespace tbb = oneapi::tbb;
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism,
                                  std::max(threads, THREADS_OF_ALL_GRAPHS));
  std::deque<StageClock> clocks;
  tbb::task_arena(int(threads)).execute([&] { run_graph(table, store, n, stop, clocks); });
  std::vector<double> seconds;
  for (const StageClock& clock : clocks) seconds.push_back(clock.seconds);
  return seconds;
}

}  // namespace pvg

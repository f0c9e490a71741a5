// Threads that wait for work, made once; the caller is one of them. Which thread runs which task is left open, so tasks
// must be independent and their results must not show the order.
#pragma once
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace pvg {

class Workers {
 public:
  explicit Workers(std::size_t n_threads = std::thread::hardware_concurrency());
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  // Calls task(0) ... task(n_tasks - 1), begun in this order, and returns when all are done. Tasks must not throw and
  // must not call run().
  void run(std::size_t n_tasks, const std::function<void(std::size_t)>& task);
  std::size_t n_threads() const { return threads_.size() + 1; }

 private:
  void work(std::unique_lock<std::mutex>& lock);  // until no task is left to begin

  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::condition_variable has_work_, is_done_;
  const std::function<void(std::size_t)>* task_ = nullptr;
  std::size_t n_tasks_ = 0, next_task_ = 0, n_running_ = 0;
  bool is_ending_ = false;
};

}  // namespace pvg

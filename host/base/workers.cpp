#include "host/base/workers.hpp"

namespace pvg {

Workers::Workers(std::size_t n_threads) {
  for (std::size_t i = 1; i < n_threads; ++i)
    threads_.emplace_back([this] {
      std::unique_lock lock(mutex_);
      while (!is_ending_) {
        work(lock);
        has_work_.wait(lock, [this] { return is_ending_ || next_task_ < n_tasks_; });
      }
    });
}

Workers::~Workers() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  has_work_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Workers::work(std::unique_lock<std::mutex>& lock) {
  while (next_task_ < n_tasks_) {
    const std::size_t task = next_task_++;
    ++n_running_;
    lock.unlock();
    (*task_)(task);
    lock.lock();
    if (--n_running_ == 0 && next_task_ == n_tasks_) is_done_.notify_one();
  }
}

void Workers::run(std::size_t n_tasks, const std::function<void(std::size_t)>& task) {
  std::unique_lock lock(mutex_);
  task_ = &task;
  n_tasks_ = n_tasks;
  next_task_ = 0;
  if (n_tasks > 1) has_work_.notify_all();
  work(lock);
  is_done_.wait(lock, [this] { return n_running_ == 0; });
}

}  // namespace pvg

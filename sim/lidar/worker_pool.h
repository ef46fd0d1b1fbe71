// A few threads that share the tasks of one call after the other.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>
#include <vector>

namespace rigwire::sim {

/// When the threads that a pool starts run: as their starter does, or behind everybody else (nice),
/// and then they give way between tasks.
enum class PoolPriority { as_starter, spare_time };

class WorkerPool {
 public:
  /// `threads` in all, the caller of run() included; with 1 no thread is started.
  explicit WorkerPool(int threads, PoolPriority priority = PoolPriority::as_starter);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Calls task(i) for i = 0 .. count-1, in any order, on any of the threads, and returns when all
  /// are done. Does not allocate. The task must not throw. One run() at a time.
  template <class Task>
  void run(std::size_t count, const Task& task) {
    run_erased(
        count, [](const void* erased, std::size_t i) { (*static_cast<const Task*>(erased))(i); },
        &task);
  }

 private:
  using Call = void (*)(const void*, std::size_t);
  void run_erased(std::size_t count, Call call, const void* task);
  void work();

  std::mutex mutex_;
  std::condition_variable start_;
  std::condition_variable done_;
  Call call_ = nullptr;
  const void* task_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_{0};
  std::size_t busy_ = 0;  ///< Tasks that its threads have in hand.
  std::size_t generation_ = 0;
  PoolPriority priority_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace rigwire::sim

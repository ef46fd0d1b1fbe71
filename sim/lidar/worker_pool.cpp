#include "sim/lidar/worker_pool.h"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace rigwire::sim {
namespace {

/// Niceness of threads of PoolPriority::spare_time: beside an equally busy thread they get a tenth
/// of a processor. With SCHED_IDLE they got three thousandths, and a thread that waited for one of
/// their tasks waited for seconds while other programs were busy.
constexpr int kNiceness = 10;

}  // namespace

WorkerPool::WorkerPool(int threads, PoolPriority priority) : priority_(priority) {
  for (int i = 1; i < threads; ++i) {
    threads_.emplace_back([this, priority] {
      if (priority == PoolPriority::spare_time) {
        (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);
      }
      work();
    });
  }
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  start_.notify_all();
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

void WorkerPool::run_erased(std::size_t count, Call call, const void* task) {
  {
    const std::lock_guard lock(mutex_);
    call_ = call;
    task_ = task;
    count_ = count;
    next_ = 0;
    ++generation_;
  }
  start_.notify_all();
  for (std::size_t i = next_++; i < count; i = next_++) {
    call(task, i);
  }
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return busy_ == 0; });
}

void WorkerPool::work() {
  std::size_t seen = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    start_.wait(lock, [&] { return stopping_ || generation_ != seen; });
    if (stopping_) {
      return;
    }
    if (priority_ == PoolPriority::spare_time) {
      // Yields the processor to waiting threads now, and not while a task is held.
      lock.unlock();
      ::sched_yield();
      lock.lock();
    }
    const std::size_t i = next_++;
    if (i >= count_) {
      seen = generation_;
      continue;
    }
    // The caller waits for tasks that were taken, not for threads that come when all are.
    ++busy_;
    const Call call = call_;
    const void* const task = task_;
    lock.unlock();
    call(task, i);
    lock.lock();
    if (--busy_ == 0) {
      done_.notify_one();
    }
  }
}

}  // namespace rigwire::sim

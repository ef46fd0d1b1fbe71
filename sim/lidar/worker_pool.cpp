#include "sim/lidar/worker_pool.h"

#include <sched.h>

namespace rigwire::sim {

WorkerPool::WorkerPool(int threads, PoolPriority priority) {
  for (int i = 1; i < threads; ++i) {
    threads_.emplace_back([this, priority] {
      if (priority == PoolPriority::spare_time) {
        const sched_param none{};
        (void)::sched_setscheduler(0, SCHED_IDLE, &none);  // of this thread; needs no privilege
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
    busy_ = threads_.size();
    ++generation_;
  }
  start_.notify_all();
  take_tasks();
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
    seen = generation_;
    lock.unlock();
    take_tasks();
    lock.lock();
    if (--busy_ == 0) {
      done_.notify_one();
    }
  }
}

void WorkerPool::take_tasks() {
  for (std::size_t i = next_++; i < count_; i = next_++) {
    call_(task_, i);
  }
}

}  // namespace rigwire::sim

#include "hil/executive/batch_ring.h"

namespace rigwire::hil {

BatchRing::BatchRing(std::size_t slots) : slots_(slots) {}

SampleBatch* BatchRing::acquire() {
  std::unique_lock lock(mutex_);
  room_.wait(lock, [this] { return closed_ || count_ < slots_.size(); });
  return closed_ ? nullptr : &slots_[(first_ + count_) % slots_.size()];
}

void BatchRing::publish() {
  const std::scoped_lock lock(mutex_);
  ++count_;
}

const SampleBatch* BatchRing::front() {
  const std::scoped_lock lock(mutex_);
  return count_ == 0 ? nullptr : &slots_[first_];
}

void BatchRing::release() {
  {
    const std::scoped_lock lock(mutex_);
    first_ = (first_ + 1) % slots_.size();
    --count_;
  }
  room_.notify_one();
}

void BatchRing::close() {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
  }
  room_.notify_one();
}

}  // namespace rigwire::hil

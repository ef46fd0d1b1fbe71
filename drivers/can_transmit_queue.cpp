#include "drivers/can_transmit_queue.h"

#include <cassert>
#include <cerrno>

namespace rigwire::drivers {

CanTransmitQueue::CanTransmitQueue(std::size_t capacity, Writer writer)
    : writer_(std::move(writer)), ring_(capacity) {
  assert(capacity > 0);
}

bool CanTransmitQueue::offer(const can_frame& frame) {
  if (count_ == 0) {
    const int error = writer_(frame);
    if (settle(error)) {
      return error == 0;
    }
  }
  if (count_ == ring_.size()) {
    ++counters_.overflown;
    return false;
  }
  ring_[(first_ + count_) % ring_.size()] = frame;
  ++count_;
  return true;
}

void CanTransmitQueue::retry() {
  while (count_ != 0) {
    const int error = writer_(ring_[first_]);
    if (error == ENOBUFS || error == EAGAIN) {
      return;
    }
    first_ = (first_ + 1) % ring_.size();
    --count_;
    counters_.waited += error == 0 ? 1 : 0;
    settle(error);
  }
}

bool CanTransmitQueue::settle(int error) {
  switch (error) {
    case 0:
      ++counters_.sent;
      link_ = CanLink::up;
      return true;
    case ENOBUFS:
    case EAGAIN:
      return false;
    case ENETDOWN:
    case ENETUNREACH:
      ++counters_.down;
      set_link(CanLink::down);
      return true;
    case ENXIO:
    case ENODEV:
      ++counters_.down;
      set_link(CanLink::gone);
      return true;
    case EPERM:
      ++counters_.forbidden;
      return true;
    default:
      ++counters_.failed;
      return true;
  }
}

void CanTransmitQueue::set_link(CanLink link) {
  link_ = link;
  if (link != CanLink::up) {
    counters_.down += count_;
    count_ = 0;
  }
}

}  // namespace rigwire::drivers

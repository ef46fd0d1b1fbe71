#include "hil/wires/emission_queue.h"

#include <algorithm>
#include <cassert>

namespace rigwire::hil {

EmissionQueue::EmissionQueue(std::size_t units, std::size_t bytes)
    : slots_(units), storage_(bytes) {
  assert(units > 0 && bytes > 0);
}

bool EmissionQueue::push(SimTime due, std::uint64_t tag, WireStatistics& statistics,
                         std::span<const std::uint8_t> bytes) {
  const auto refuse = [&] {
    statistics.hash.add(due, bytes);
    ++statistics.dropped;
    return false;
  };
  if (count_ == slots_.size()) {
    return refuse();
  }
  // The bytes of a unit lie in one piece: either behind the newest unit or, where the end of the
  // storage is too near, at its beginning.
  const std::size_t oldest = count_ == 0 ? write_at_ : slots_[first_].offset;
  std::size_t offset = write_at_;
  if (count_ == 0) {
    offset = 0;
    if (bytes.size() > storage_.size()) {
      return refuse();
    }
  } else if (write_at_ >= oldest) {
    if (storage_.size() - write_at_ < bytes.size()) {
      if (bytes.size() >= oldest) {
        return refuse();
      }
      offset = 0;
    }
  } else if (oldest - write_at_ <= bytes.size()) {
    return refuse();
  }
  Slot& slot = slots_[(first_ + count_) % slots_.size()];
  slot = {due, tag, &statistics, offset, bytes.size()};
  std::copy(bytes.begin(), bytes.end(), storage_.begin() + static_cast<std::ptrdiff_t>(offset));
  write_at_ = offset + bytes.size();
  ++count_;
  return true;
}

SimTime EmissionQueue::next_due() const {
  return empty() ? kNever : slots_[first_].due;
}

EmissionQueue::Unit EmissionQueue::front() const {
  assert(!empty());
  const Slot& slot = slots_[first_];
  return {slot.due, slot.tag, slot.statistics,
          std::span(storage_).subspan(slot.offset, slot.length)};
}

void EmissionQueue::pop() {
  assert(!empty());
  first_ = (first_ + 1) % slots_.size();
  --count_;
}

}  // namespace rigwire::hil

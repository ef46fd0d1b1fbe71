#include "emulators/velodyne/faulty_cable.h"

#include <algorithm>
#include <cassert>

namespace rigwire::emulators {

FaultyCable::FaultyCable(ByteOutput& output, std::span<const VelodyneFault> faults,
                         std::uint64_t seed, Swapping swapping)
    : output_(output), faults_(faults), random_(seed), swapping_(swapping) {}

void FaultyCable::send(SimTime due, std::span<const std::uint8_t> bytes) {
  if (faults_.empty()) {
    output_.send(due, bytes);
    return;
  }
  if (happens(VelodyneFaultKind::lost_packets, due)) {
    ++lost_;
    return;
  }
  if (held_size_ == 0 && swapping_ == Swapping::as_the_faults_say &&
      happens(VelodyneFaultKind::swapped_packets, due)) {
    assert(bytes.size() <= held_.size());
    std::ranges::copy(bytes, held_.begin());
    held_size_ = bytes.size();
    return;
  }
  output_.send(due, bytes);
  if (happens(VelodyneFaultKind::duplicated_packets, due)) {
    output_.send(due, bytes);
  }
  if (held_size_ != 0) {
    output_.send(due, std::span(held_).first(held_size_));
    held_size_ = 0;
  }
}

bool FaultyCable::happens(VelodyneFaultKind kind, SimTime now) {
  const VelodyneFault* fault = find_fault(faults_, kind, now);
  return fault != nullptr && random_.uniform() < fault->probability;
}

}  // namespace rigwire::emulators

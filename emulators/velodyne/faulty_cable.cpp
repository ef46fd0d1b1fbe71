#include "emulators/velodyne/faulty_cable.h"

#include <algorithm>
#include <cassert>

namespace rigwire::emulators {

FaultyCable::FaultyCable(ByteOutput& output, std::span<const VelodyneFault> faults,
                         std::uint64_t seed, Swapping swapping)
    : output_(output), faults_(faults), random_state_(seed), swapping_(swapping) {}

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
  return fault != nullptr && uniform() < fault->probability;
}

/// splitmix64.
double FaultyCable::uniform() {
  random_state_ += 0x9E37'79B9'7F4A'7C15U;
  std::uint64_t z = random_state_;
  z = (z ^ z >> 30U) * 0xBF58'476D'1CE4'E5B9U;
  z = (z ^ z >> 27U) * 0x94D0'49BB'1331'11EBU;
  z ^= z >> 31U;
  return static_cast<double>(z >> 11U) * 0x1p-53;
}

}  // namespace rigwire::emulators

#include "emulators/velodyne/faulty_cable.h"

#include <algorithm>
#include <cassert>

namespace rigwire::emulators {

FaultyCable::FaultyCable(ByteOutput& output, const VelodyneFaults& faults, std::uint64_t seed,
                         Swapping swapping)
    : output_(output), faults_(faults), random_(seed), swapping_(swapping) {}

template <class Fault>
bool FaultyCable::happens(SimTime now) {
  const auto fault = faults_.first_grown<Fault>(now);
  return fault && random_.uniform() < fault->share;
}

void FaultyCable::send(SimTime due, std::span<const std::uint8_t> bytes) {
  if (faults_.empty()) {
    output_.send(due, bytes);
    return;
  }
  if (happens<LostPacketsFault>(due)) {
    ++lost_;
    return;
  }
  if (held_size_ == 0 && swapping_ == Swapping::as_the_faults_say &&
      happens<SwappedPacketsFault>(due)) {
    assert(bytes.size() <= held_.size());
    std::ranges::copy(bytes, held_.begin());
    held_size_ = bytes.size();
    return;
  }
  output_.send(due, bytes);
  if (happens<DuplicatedPacketsFault>(due)) {
    output_.send(due, bytes);
  }
  if (held_size_ != 0) {
    output_.send(due, std::span(held_).first(held_size_));
    held_size_ = 0;
  }
}

}  // namespace rigwire::emulators

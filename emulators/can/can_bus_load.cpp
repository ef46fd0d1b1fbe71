#include "emulators/can/can_bus_load.h"

#include <algorithm>

namespace rigwire::emulators {

void CanBusLoad::occupy(SimTime begin, SimTime end) {
  const auto size = static_cast<std::int64_t>(busy_ns_.size());
  while (begin < end) {
    const std::int64_t bucket = begin.time_since_epoch() / kBucket;
    newest_ = std::max(newest_, bucket - size);
    while (newest_ < bucket) {
      ++newest_;
      busy_ns_[static_cast<std::size_t>(newest_ % size)] = 0;
    }
    const SimTime until = std::min(end, SimTime{(bucket + 1) * kBucket});
    // An occupied span is divided over the hundredths that it touches.
    busy_ns_[static_cast<std::size_t>(bucket % size)] += (until - begin).count();
    begin = until;
  }
}

double CanBusLoad::share(SimTime now) const {
  const auto size = static_cast<std::int64_t>(busy_ns_.size());
  const std::int64_t current = now.time_since_epoch() / kBucket;
  std::int64_t busy = 0;
  for (std::int64_t bucket = std::max<std::int64_t>(current - kBuckets, 0); bucket < current;
       ++bucket) {
    if (bucket <= newest_ && bucket > newest_ - size) {
      busy += busy_ns_[static_cast<std::size_t>(bucket % size)];
    }
  }
  return static_cast<double>(busy) * 1e-9;
}

}  // namespace rigwire::emulators

// Which share of the last second a bus was occupied.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/samples/time.h"

namespace rigwire::emulators {

class CanBusLoad {
 public:
  /// The bus is occupied in [begin, end). Spans come in order and do not overlap.
  void occupy(SimTime begin, SimTime end);
  /// Share of the second before `now`, 0..1, in steps of 10 ms: counted are the hundred whole
  /// hundredths of a second that ended last.
  [[nodiscard]] double share(SimTime now) const;

 private:
  static constexpr Duration kBucket = std::chrono::milliseconds{10};
  static constexpr std::int64_t kBuckets = 100;

  std::array<std::int64_t, kBuckets + 2> busy_ns_{};  ///< Per 10 ms, by number modulo size.
  std::int64_t newest_ = 0;
};

}  // namespace rigwire::emulators

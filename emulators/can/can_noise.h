// What is wrong with the wire itself, frame by frame: the faults bit_errors, disturbance and
// short_circuit.
#pragma once

#include <cstdint>
#include <vector>

#include "emulators/can/can_bit_clock.h"
#include "emulators/can/can_bit_level.h"
#include "emulators/can/can_bus_faults.h"
#include "emulators/random_bits.h"

namespace rigwire::emulators {

class CanNoise {
 public:
  CanNoise() : CanNoise(CanBusFaults{}) {}
  explicit CanNoise(const CanBusFaults& faults);

  /// Of an attempt that begins at the clock's present position and has `bits` bits when it goes
  /// well. To be called once for each attempt: random numbers are drawn. Bit errors are those of
  /// attempts that begin while the fault holds.
  [[nodiscard]] CanLineState attempt(const CanBitClock& clock, unsigned bits);

 private:
  struct Source {
    CanFault fault;
    RandomBits random;
    std::uint64_t good_bits_left = 0;  ///< bit_errors.
  };
  void draw_gap(Source& source);

  std::vector<Source> sources_;
};

}  // namespace rigwire::emulators

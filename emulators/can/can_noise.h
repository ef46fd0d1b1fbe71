// What is wrong with the wire itself, frame by frame: the faults noise, disturbance and
// short.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "emulators/can/can_bit_level.h"
#include "emulators/can/can_bus_faults.h"
#include "emulators/random_bits.h"

namespace rigwire::emulators {

class CanNoise {
 public:
  /// `book` must outlive it.
  CanNoise(const FaultBook<CanFault>& book, std::uint64_t seed) : book_(book), seed_(seed) {}

  /// The newest fault of the book is one more. Each draws from a stream of its own, by its place.
  void add_newest();

  /// Of an attempt that begins at the clock's present position and has `bits` bits when it goes
  /// well. To be called once for each attempt: random numbers are drawn. Bit errors are those of
  /// attempts that begin while the fault holds.
  [[nodiscard]] CanLineState attempt(const CanBitClock& clock, unsigned bits);
  /// Of the same attempt, after the book has changed: as if it had been so when it began.
  [[nodiscard]] CanLineState attempt_again(const CanBitClock& clock, unsigned bits);

 private:
  struct State {
    RandomBits random;
    std::optional<std::uint64_t> good_bits_left;  ///< noise; nothing: not drawn yet.
  };
  struct Source {
    FaultBook<CanFault>::Id id;  ///< Of the book.
    State state;
    State before_attempt;
  };
  [[nodiscard]] static unsigned first_bit_error(const BitErrorsFault& errors, State& state,
                                                unsigned bits);

  const FaultBook<CanFault>& book_;
  std::uint64_t seed_;
  std::vector<Source> sources_;
};

}  // namespace rigwire::emulators

// Errors of the wire itself, frame by frame: the faults noise, disturbance and short.
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

  /// Registers the newest fault of the book. Each fault draws from a random stream of its own,
  /// chosen by its position in the book.
  void add_newest();

  /// Returns the errors of an attempt that begins at the clock's present position and has `bits`
  /// bits when it succeeds. To be called once for each attempt: random numbers are drawn. Bit
  /// errors affect only attempts that begin while the fault holds.
  [[nodiscard]] CanLineState attempt(const CanBitClock& clock, unsigned bits);
  /// Returns the errors of the same attempt after the book has changed, as if the new state had
  /// held when it began.
  [[nodiscard]] CanLineState attempt_again(const CanBitClock& clock, unsigned bits);

 private:
  struct State {
    RandomBits random;
    std::optional<std::uint64_t> good_bits_left;  ///< noise; nothing: not drawn yet.
  };
  struct Source {
    FaultBook<CanFault>::Id id;  ///< Number of the fault in `book_`.
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

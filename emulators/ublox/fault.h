// Defects of a u-blox receiver itself; those of its surroundings come with the samples.
#pragma once

#include <variant>

#include "fields/rules.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

/// Position, velocity and satellites are repeated.
struct FrozenFixFault {
  static constexpr fields::Named kNamed{"frozen_fix",
                                        "The device repeats its last fix; time goes on."};
};
struct WrongLeapSecondFault {
  static constexpr fields::Named kNamed{"wrong_leap_second", "The device's leap seconds are off."};

  int seconds = 1;
};
struct UartNoiseFault {
  static constexpr fields::Named kNamed{"uart_noise",
                                        "Bits of the serial line are turned over, both ways."};

  double bit_error_rate = 1e-4;
};

inline void visit(fields::Visitor&, FrozenFixFault&) {}
void visit(fields::Visitor& v, WrongLeapSecondFault& p);
void visit(fields::Visitor& v, UartNoiseFault& p);

struct UbloxFault {
  FaultPeriod when;
  std::variant<FrozenFixFault, WrongLeapSecondFault, UartNoiseFault> what;
};
void visit(fields::Visitor& v, UbloxFault& p);

}  // namespace rigwire::emulators

// How long a Modbus server takes from a request to its answer: always the same, or drawn.
#pragma once

#include <cstdint>

#include "emulators/random_bits.h"
#include "fields/rules.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

enum class DelayDistribution : std::uint8_t {
  constant,  ///< `typical`.
  uniform,   ///< Between `minimum` and `maximum`.
  normal,    ///< Mean `typical`, standard deviation `sigma`, held within `minimum` .. `maximum`.
};

struct ResponseDelaySettings {
  DelayDistribution distribution = DelayDistribution::constant;
  Duration typical = std::chrono::microseconds(300);  ///< 0 .. 10 s.
  Duration sigma{0};                                  ///< 0 .. 10 s.
  Duration minimum{0};                                ///< 0 .. maximum.
  Duration maximum = std::chrono::milliseconds(10);   ///< .. 10 s.
};
void visit(fields::Visitor& v, ResponseDelaySettings& p);
/// Throws std::invalid_argument.
void validate(const ResponseDelaySettings& settings);

class ResponseDelay {
 public:
  /// Throws std::invalid_argument. The same seed draws the same delays.
  ResponseDelay(const ResponseDelaySettings& settings, std::uint64_t seed);

  [[nodiscard]] Duration draw();
  /// No draw is shorter.
  [[nodiscard]] Duration minimum() const {
    return settings_.distribution == DelayDistribution::constant ? settings_.typical
                                                                 : settings_.minimum;
  }

 private:
  ResponseDelaySettings settings_;
  RandomBits random_;
};

}  // namespace rigwire::emulators

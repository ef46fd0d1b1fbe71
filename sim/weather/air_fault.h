// Faults of a scene's air: rain, snow and fog for a while, in addition to the course of the
// weather.
//
//   faults:
//     - {on: air, type: fog, at: 30 s, for: 60 s, visibility: 40 m, ramp: 20 s}
//     - {on: air, type: rain, at: 60 s, for: 30 s, rate: 25 mm/h}
//
// Everything adds up with what the course has: rates, and of visibilities the extinctions.
#pragma once

#include <mutex>
#include <variant>
#include <vector>

#include "fields/rules.h"
#include "fields/visitor.h"
#include "sim/samples/fault_book.h"

namespace rigwire::sim {

struct AirState;

struct RainFault {
  static constexpr fields::Named kNamed{"rain", "Rain falls, beside that of the weather."};

  double rate_mmph = 10.0;
  Duration ramp{0};

  void grow(double share) { rate_mmph *= share; }
};
struct SnowFault {
  static constexpr fields::Named kNamed{"snow", "Snow falls, beside that of the weather."};

  double rate_mmph = 2.0;  ///< Water equivalent.
  Duration ramp{0};

  void grow(double share) { rate_mmph *= share; }
};
struct FogFault {
  static constexpr fields::Named kNamed{"fog", "Fog comes up, beside that of the weather."};

  double visibility_m = 100.0;
  Duration ramp{0};

  /// Its extinction grows evenly.
  void grow(double share);
};
void visit(fields::Visitor& v, RainFault& p);
void visit(fields::Visitor& v, SnowFault& p);
void visit(fields::Visitor& v, FogFault& p);

struct AirFault {
  FaultPeriod when;
  std::variant<RainFault, SnowFault, FogFault> what;
};
inline void visit(fields::Visitor& v, AirFault& p) {
  visit_fault(v, p);
}

/// Faults for all sensors that look through the air, from any thread. A change takes effect later
/// than any instant that a sensor has read.
class AirFaults {
 public:
  AirFaults() = default;
  explicit AirFaults(std::vector<AirFault> faults) : book_(std::move(faults)) {}

  void apply(const FaultChange<AirFault>& change);
  /// Adds the faults that hold at `time` to `state`.
  void lay_over(SimTime time, AirState& state) const;

 private:
  mutable std::mutex mutex_;
  FaultBook<AirFault> book_;
};

}  // namespace rigwire::sim

// The GNSS receiver's serial line: NMEA sentences in, the last position out.
//
// Everything between sentences (binary UBX messages, noise, halves of lines after a late start) is
// skipped.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocols/nmea/sentence.h"

namespace rigwire::field {

/// Kinds of positions, in ascending quality.
enum class FixKind : std::uint8_t { none, autonomous, differential, float_ambiguities, fixed };
inline constexpr std::array<std::string_view, 5> kFixKinds{"none", "autonomous", "differential",
                                                           "float", "fixed"};
/// Returns the kind of fix for GGA's quality. Qualities without corrections, estimated and
/// simulated included, give `autonomous`.
[[nodiscard]] FixKind fix_kind(int quality);

struct GnssFixBelief {
  int quality = 0;  ///< Quality indicator of GGA.
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;  ///< Above mean sea level.
  int satellites = 0;
  std::optional<double> horizontal_dilution;
  double ground_speed_mps = 0.0;     ///< From RMC.
  std::optional<double> course_rad;  ///< From RMC, clockwise from north; none at standstill.
  std::uint64_t positions = 0;       ///< GGA with a position so far.
  std::uint64_t velocities = 0;      ///< RMC with a velocity so far.
};

class GnssWire {
 public:
  /// Calls `heard` for every sound RMC or GGA, with or without a fix.
  explicit GnssWire(std::function<void()> heard);

  void receive(std::span<const std::uint8_t> bytes);
  [[nodiscard]] const GnssFixBelief& fix() const { return fix_; }
  [[nodiscard]] std::uint64_t rejected() const { return rejected_; }

 private:
  void take(const protocols::nmea::SentenceView& sentence);

  std::function<void()> heard_;
  std::vector<std::uint8_t> pending_;
  GnssFixBelief fix_;
  std::uint64_t rejected_ = 0;  ///< Starts of sentences that were none.
};

}  // namespace rigwire::field

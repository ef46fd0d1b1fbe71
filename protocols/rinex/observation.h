// RINEX observation files: what a receiver measured, as text.
//
// Source: RINEX 3.04 (IGS, 2018) tables A2 and A3. Written are GPS L1 C/A observations: C1C
// pseudorange (m), L1C carrier phase (cycles), D1C Doppler (Hz), S1C carrier-to-noise density
// (dBHz); each with three decimals.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "protocols/rinex/navigation.h"
#include "protocols/rinex/text.h"

namespace rigwire::protocols::rinex {

struct ObservationHeader {
  Origin origin;
  std::string marker = "RIGWIRE";
  std::string receiver_number;
  std::string receiver_type;
  std::string receiver_version;
  std::array<double, 3> position_E_m{};  ///< Approximate, earth-fixed.
  double interval_s = 1.0;
  Epoch first;
  std::int32_t leap_seconds = 18;
};

/// One satellite at one epoch.
struct Observation {
  std::uint8_t prn = 0;  ///< 1..32.
  double pseudorange_m = 0.0;
  double carrier_phase_cycles = 0.0;
  double doppler_hz = 0.0;  ///< Positive while the satellite comes nearer.
  double cn0_dbhz = 0.0;
  bool has_phase = true;
  bool slipped = false;  ///< Lock was lost since the epoch before: loss of lock indicator bit 0.
};

void append_observation_header(std::string& out, const ObservationHeader& header);

/// `epoch` is the time on the receiver's clock.
void append_observations(std::string& out, const Epoch& epoch,
                         std::span<const Observation> observations);

}  // namespace rigwire::protocols::rinex

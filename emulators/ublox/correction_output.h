// The RTCM 3 messages that a u-blox receiver sends as a base station: its place (1005, when it
// knows it), what it measures (MSM4 and MSM7), 1230, and as a moving base 4072.
//
// Source: ZED-F9P integration manual UBX-18010802, table 7; signals and constant fields from
// recordings of a ZED-F9T and a ZED-F9P as base stations. 4072.0 is not published: ours.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "protocols/ubx/frame.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

/// The class of RTCM 3 messages in CFG-MSG.
inline constexpr std::uint8_t kClassRtcm3 = 0xF5;

/// Content of one epoch's messages.
struct UbloxCorrectionContent {
  const GnssSample* sample = nullptr;  ///< Null before the first.
  GpsTime measured;                    ///< What the receiver's clock showed then.
  int leap_seconds = 18;
  std::uint16_t station = 0;
  std::optional<std::array<double, 3>> place_E_m;  ///< Surveyed or configured: 1005.
  std::array<double, 3> position_E_m{};            ///< Solved, 4072 ...
  std::array<double, 3> velocity_E_mps{};
  bool has_fix = false;  ///< ... when there is a fix.
};

/// Number of the message that CFG-MSG names so; 4072 for both of its subtypes, 0 for none.
[[nodiscard]] std::uint16_t correction_number(protocols::ubx::MessageId id);
/// Whether it is one of an epoch's observations.
[[nodiscard]] bool is_observation(protocols::ubx::MessageId id);

/// Writes the frame and returns its size; 0 when there is nothing to say, as of a system without
/// measurements. `more`: other observations of the epoch follow. Precondition: `out` holds
/// rtcm3::kGreatestFrame.
[[nodiscard]] std::size_t encode_correction(const UbloxCorrectionContent& content,
                                            protocols::ubx::MessageId id, bool more,
                                            std::span<std::uint8_t> out);
/// Whether encode_correction() has something to say.
[[nodiscard]] bool has_correction(const UbloxCorrectionContent& content,
                                  protocols::ubx::MessageId id);

}  // namespace rigwire::emulators

// Signals that a u-blox receiver uses from RTCM 3 multiple signal messages and writes into them:
// number within the message, and carrier.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "protocols/rtcm3/message.h"
#include "sim/samples/gnss_carriers.h"

namespace rigwire::emulators {

struct UbloxCorrectionSignal {
  protocols::rtcm3::MsmSystem message;
  GnssSystem system;
  std::uint8_t lowest;  ///< Numbers within the mask of the codes on this carrier ...
  std::uint8_t highest;
  std::uint8_t sent;  ///< ... and the one that the receiver measures (recordings of ZED-F9P).
  bool second;        ///< Carrier.
};

// Numbers: RTCM 10403.3 tables 3.5-91, 96, 99, 108.
inline constexpr std::array<UbloxCorrectionSignal, 8> kCorrectionSignals{{
    {protocols::rtcm3::MsmSystem::gps, GnssSystem::gps, 2, 4, 2, false},
    {protocols::rtcm3::MsmSystem::gps, GnssSystem::gps, 8, 17, 16, true},
    {protocols::rtcm3::MsmSystem::glonass, GnssSystem::glonass, 2, 3, 2, false},
    {protocols::rtcm3::MsmSystem::glonass, GnssSystem::glonass, 8, 9, 8, true},
    {protocols::rtcm3::MsmSystem::galileo, GnssSystem::galileo, 2, 6, 2, false},
    {protocols::rtcm3::MsmSystem::galileo, GnssSystem::galileo, 14, 16, 15, true},
    {protocols::rtcm3::MsmSystem::beidou, GnssSystem::beidou, 2, 4, 2, false},
    {protocols::rtcm3::MsmSystem::beidou, GnssSystem::beidou, 14, 16, 14, true},
}};

/// Nothing: a GLONASS signal whose channel is not known.
[[nodiscard]] constexpr std::optional<double> wavelength_m(const UbloxCorrectionSignal& signal,
                                                           std::optional<int> channel) {
  if (signal.system == GnssSystem::glonass && !channel) {
    return std::nullopt;
  }
  return protocols::rtcm3::kLightSpeed_mps /
         carrier_hz(signal.system, signal.second, channel.value_or(0));
}

}  // namespace rigwire::emulators

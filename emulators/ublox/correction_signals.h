// Which signals a u-blox receiver takes from and puts into RTCM 3 multiple signal messages: numbers
// within the message, band, carrier.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "protocols/rtcm3/message.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

struct UbloxCorrectionSignal {
  protocols::rtcm3::MsmSystem message;
  GnssSystem system;
  std::uint8_t lowest;  ///< Numbers within the mask of the codes on this carrier ...
  std::uint8_t highest;
  std::uint8_t sent;  ///< ... and the one that the receiver measures (recordings of ZED-F9P).
  bool second;        ///< Band.
  double carrier_hz;  ///< GLONASS: of channel 0 ...
  double channel_hz;  ///< ... and from one channel to the next.
};

// Carriers: IS-GPS-200, GLONASS ICD 5.1, Galileo OS SIS ICD, BDS-SIS-ICD; numbers: RTCM 10403.3
// tables 3.5-91, 96, 99, 108.
inline constexpr std::array<UbloxCorrectionSignal, 8> kCorrectionSignals{{
    {protocols::rtcm3::MsmSystem::gps, GnssSystem::gps, 2, 4, 2, false, 1575.42e6, 0.0},
    {protocols::rtcm3::MsmSystem::gps, GnssSystem::gps, 8, 17, 16, true, 1227.60e6, 0.0},
    {protocols::rtcm3::MsmSystem::glonass, GnssSystem::glonass, 2, 3, 2, false, 1602e6, 562.5e3},
    {protocols::rtcm3::MsmSystem::glonass, GnssSystem::glonass, 8, 9, 8, true, 1246e6, 437.5e3},
    {protocols::rtcm3::MsmSystem::galileo, GnssSystem::galileo, 2, 6, 2, false, 1575.42e6, 0.0},
    {protocols::rtcm3::MsmSystem::galileo, GnssSystem::galileo, 14, 16, 15, true, 1207.14e6, 0.0},
    {protocols::rtcm3::MsmSystem::beidou, GnssSystem::beidou, 2, 4, 2, false, 1561.098e6, 0.0},
    {protocols::rtcm3::MsmSystem::beidou, GnssSystem::beidou, 14, 16, 14, true, 1207.14e6, 0.0},
}};

/// Nothing: a GLONASS signal whose channel is not known.
[[nodiscard]] constexpr std::optional<double> wavelength_m(const UbloxCorrectionSignal& signal,
                                                           std::optional<int> channel) {
  if (signal.channel_hz > 0.0 && !channel) {
    return std::nullopt;
  }
  return protocols::rtcm3::kLightSpeed_mps /
         (signal.carrier_hz + signal.channel_hz * channel.value_or(0));
}

}  // namespace rigwire::emulators

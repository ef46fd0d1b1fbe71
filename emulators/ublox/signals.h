// How u-blox numbers the signals that its receivers follow, and those whose data they hand on.
//
// Source: u-blox F9 HPG 1.50 interface description, UBXDOC-963802114-12815, section 1.5.4 "Signal
// identifiers"; pilots where a signal has one, as recordings of ZED-F9P show.
#pragma once

#include <cstdint>

#include "sim/samples/gnss_carriers.h"

namespace rigwire::emulators {

/// sigId of what is measured: L1 C/A, E1 C, B1I, L1OF are 0.
[[nodiscard]] constexpr std::uint8_t ublox_signal(GnssSystem system, bool second) {
  if (!second) {
    return 0;
  }
  switch (system) {
    case GnssSystem::gps:
      return 3;  // L2 CL
    case GnssSystem::galileo:
      return 6;  // E5b Q
    case GnssSystem::qzss:
      return 5;  // L2 CL
    default:
      return 2;  // B2I, L2OF
  }
}

/// sigId of the navigation data.
[[nodiscard]] constexpr std::uint8_t ublox_data_signal(GnssSystem system, bool second) {
  if (system == GnssSystem::galileo) {
    return second ? 5 : 1;  // E5b I, E1 B
  }
  if (system == GnssSystem::gps) {
    return second ? 4 : 0;  // L2 CM
  }
  return ublox_signal(system, second);
}

/// freqId: GLONASS' channel and seven, 0 for the others.
[[nodiscard]] constexpr std::uint8_t ublox_frequency(GnssSystem system, std::uint8_t number) {
  constexpr int kLowest = -7;
  return system == GnssSystem::glonass
             ? static_cast<std::uint8_t>(glonass_channel(system, number) - kLowest)
             : std::uint8_t{0};
}

}  // namespace rigwire::emulators

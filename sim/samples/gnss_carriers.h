// The two carriers on which each satellite system sends to an emulated receiver, and the code that
// the receiver follows there:
//
//              first          second
//   GPS        L1 C/A         L2C
//   SBAS       L1 C/A
//   Galileo    E1             E5b
//   BeiDou     B1I            B2I
//   QZSS       L1 C/A         L2C
//   GLONASS    L1OF           L2OF, on the channel of its slot
//
// Source: IS-GPS-200, Galileo OS SIS ICD, BDS-SIS-ICD-2.1, GLONASS ICD 5.1.
#pragma once

#include <array>
#include <cstdint>

#include "sim/samples/gnss_sample.h"

namespace rigwire {

/// Channels of the slots 1 to 24, as GLONASS lists them.
inline constexpr std::array<std::int8_t, 24> kGlonassChannels{
    1, -4, 5, 6, 1, -4, 5, 6, -2, -7, 0, -1, -2, -7, 0, -1, 4, -3, 3, 2, 4, -3, 3, 2};

/// Returns the channel of a GLONASS satellite; 0 for other systems and for slots that do not exist.
[[nodiscard]] constexpr int glonass_channel(GnssSystem system, std::uint8_t number) {
  return system == GnssSystem::glonass && number >= 1 && number <= kGlonassChannels.size()
             ? kGlonassChannels[number - 1U]
             : 0;
}

[[nodiscard]] constexpr bool has_second_carrier(GnssSystem system) {
  return system != GnssSystem::sbas && system != GnssSystem::imes;
}

/// `channel` matters for GLONASS only.
[[nodiscard]] constexpr double carrier_hz(GnssSystem system, bool second, int channel) {
  switch (system) {
    case GnssSystem::galileo:
      return second ? 1'207.14e6 : 1'575.42e6;
    case GnssSystem::beidou:
      return second ? 1'207.14e6 : 1'561.098e6;
    case GnssSystem::glonass:
      return second ? 1'246e6 + 437.5e3 * channel : 1'602e6 + 562.5e3 * channel;
    default:
      return second ? 1'227.60e6 : 1'575.42e6;
  }
}

}  // namespace rigwire

// Satellites, their signals, orbits and corrections (class 0x01), in wire units.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 32.17.5
// "UBX-NAV-DGPS", 32.17.14 "UBX-NAV-ORB", 32.17.20 "UBX-NAV-SAT", 32.17.21 "UBX-NAV-SBAS", 32.17.25
// "UBX-NAV-SVINFO"; ZED-F9P interface description HPG 1.50, UBXDOC-963802114-12815, section 3.15.18
// "UBX-NAV-SIG".
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// NAV-SVINFO: the head, followed by `channels` blocks.
struct NavSvinfoHead {
  static constexpr MessageId kId{0x01, 0x30};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*channels, flags*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t channels = 0;
  std::uint8_t global_flags = 3;  ///< b0-2 chip generation: 3 = u-blox 7, 4 = u-blox 8.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavSvinfoHead::time_of_week_ms), at(4, &NavSvinfoHead::channels),
                           at(5, &NavSvinfoHead::global_flags));
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return channels; }
  friend bool operator==(const NavSvinfoHead&, const NavSvinfoHead&) = default;
};

/// NAV-SVINFO: one channel.
struct NavSvinfoChannel {
  static constexpr std::size_t kLength = 6 /*state*/ + 2 /*azimuth*/ + 4 /*residual*/;

  std::uint8_t channel = 0;    ///< 255 when no channel is on it.
  std::uint8_t satellite = 0;  ///< GPS 1..32, SBAS 120..158.
  /// b0 used, b1 corrected, b2 orbit available, b3 orbit from ephemeris, b5 from almanac.
  std::uint8_t flags = 0;
  std::uint8_t quality = 0;  ///< 0 idle, 1 search, 4 code lock, 7 code and carrier lock.
  std::uint8_t cn0_dbhz = 0;
  std::int8_t elevation_deg = 0;
  std::int16_t azimuth_deg = 0;
  std::int32_t residual_cm = 0;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &NavSvinfoChannel::channel), at(1, &NavSvinfoChannel::satellite),
        at(2, &NavSvinfoChannel::flags), at(3, &NavSvinfoChannel::quality),
        at(4, &NavSvinfoChannel::cn0_dbhz), at(5, &NavSvinfoChannel::elevation_deg),
        at(6, &NavSvinfoChannel::azimuth_deg), at(8, &NavSvinfoChannel::residual_cm));
  }
  friend bool operator==(const NavSvinfoChannel&, const NavSvinfoChannel&) = default;
};

/// NavSatBlock::flags.
inline constexpr std::uint32_t kSatQualityMask = 0x0000'0007;  ///< As NavSvinfoChannel::quality.
inline constexpr std::uint32_t kSatUsed = 0x0000'0008;
inline constexpr std::uint32_t kSatHealthy = 0x0000'0010;
inline constexpr std::uint32_t kSatUnhealthy = 0x0000'0020;
inline constexpr std::uint32_t kSatCorrected = 0x0000'0040;
inline constexpr std::uint32_t kSatSmoothed = 0x0000'0080;
inline constexpr std::uint32_t kSatOrbitEphemeris = 0x0000'0100;  ///< Source of the orbit, b8..10.
inline constexpr std::uint32_t kSatOrbitAlmanac = 0x0000'0200;
inline constexpr std::uint32_t kSatEphemerisAvailable = 0x0000'0800;
inline constexpr std::uint32_t kSatAlmanacAvailable = 0x0000'1000;
inline constexpr std::uint32_t kSatSbasCorrections = 0x0001'0000;
inline constexpr std::uint32_t kSatRtcmCorrections = 0x0002'0000;
inline constexpr std::uint32_t kSatRangeCorrected = 0x0010'0000;
inline constexpr std::uint32_t kSatCarrierCorrected = 0x0020'0000;
inline constexpr std::uint32_t kSatDopplerCorrected = 0x0040'0000;

/// NAV-SAT: the head, followed by `satellites` blocks. u-blox 8 and later.
struct NavSatHead {
  static constexpr MessageId kId{0x01, 0x35};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*version, satellites*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t version = 1;
  std::uint8_t satellites = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavSatHead::time_of_week_ms), at(4, &NavSatHead::version),
                           at(5, &NavSatHead::satellites));
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return satellites; }
  friend bool operator==(const NavSatHead&, const NavSatHead&) = default;
};

/// NAV-SAT: one satellite.
struct NavSatBlock {
  static constexpr std::size_t kLength =
      4 /*satellite, signal*/ + 4 /*azimuth, residual*/ + 4 /*flags*/;

  std::uint8_t system = 0;     ///< 0 GPS, 1 SBAS, 2 Galileo, 3 BeiDou, 5 QZSS, 6 GLONASS.
  std::uint8_t satellite = 0;  ///< Within its system; 255 an unidentified GLONASS satellite.
  std::uint8_t cn0_dbhz = 0;
  std::int8_t elevation_deg = 0;  ///< -91 when not known.
  std::int16_t azimuth_deg = 0;
  std::int16_t residual_dm = 0;
  std::uint32_t flags = 0;  ///< kSatUsed, ...

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavSatBlock::system), at(1, &NavSatBlock::satellite),
                           at(2, &NavSatBlock::cn0_dbhz), at(3, &NavSatBlock::elevation_deg),
                           at(4, &NavSatBlock::azimuth_deg), at(6, &NavSatBlock::residual_dm),
                           at(8, &NavSatBlock::flags));
  }
  friend bool operator==(const NavSatBlock&, const NavSatBlock&) = default;
};

/// NAV-SIG: the head, followed by `signals` blocks. F9.
struct NavSigHead {
  static constexpr MessageId kId{0x01, 0x43};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*version, signals*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t version = 0;
  std::uint8_t signals = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavSigHead::time_of_week_ms), at(4, &NavSigHead::version),
                           at(5, &NavSigHead::signals));
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return signals; }
  friend bool operator==(const NavSigHead&, const NavSigHead&) = default;
};

/// NAV-SIG: one signal.
struct NavSigBlock {
  static constexpr std::size_t kLength =
      4 /*signal*/ + 2 /*residual*/ + 4 /*quality*/ + 2 /*flags*/ + 4 /*reserved*/;

  std::uint8_t system = 0;  ///< As NavSatBlock::system.
  std::uint8_t satellite = 0;
  std::uint8_t signal = 0;          ///< GPS: 0 L1C/A, 3 L2CL, 4 L2CM.
  std::uint8_t frequency_slot = 0;  ///< GLONASS only: slot + 7.
  std::int16_t residual_dm = 0;
  std::uint8_t cn0_dbhz = 0;
  std::uint8_t quality = 0;            ///< As NavSvinfoChannel::quality.
  std::uint8_t correction_source = 0;  ///< 0 none, 1 SBAS, 4 RTCM 3 observations.
  std::uint8_t ionosphere_model = 0;   ///< 0 none, 1 Klobuchar of GPS, 2 SBAS, 8 two frequencies.
  /// b0-1 health, b2 smoothed, b3-5 range, carrier, Doppler used, b6-8 the same corrected.
  std::uint16_t flags = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavSigBlock::system), at(1, &NavSigBlock::satellite),
                           at(2, &NavSigBlock::signal), at(3, &NavSigBlock::frequency_slot),
                           at(4, &NavSigBlock::residual_dm), at(6, &NavSigBlock::cn0_dbhz),
                           at(7, &NavSigBlock::quality), at(8, &NavSigBlock::correction_source),
                           at(9, &NavSigBlock::ionosphere_model), at(10, &NavSigBlock::flags));
  }
  friend bool operator==(const NavSigBlock&, const NavSigBlock&) = default;
};

/// NAV-ORB: the head, followed by `satellites` blocks. u-blox 8 and later.
struct NavOrbHead {
  static constexpr MessageId kId{0x01, 0x34};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*version, satellites*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t version = 1;
  std::uint8_t satellites = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavOrbHead::time_of_week_ms), at(4, &NavOrbHead::version),
                           at(5, &NavOrbHead::satellites));
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return satellites; }
  friend bool operator==(const NavOrbHead&, const NavOrbHead&) = default;
};

/// NAV-ORB: what is known of one satellite's orbit.
struct NavOrbBlock {
  static constexpr std::size_t kLength = 2 /*satellite*/ + 1 /*flags*/ + 3 /*orbits*/;

  std::uint8_t system = 0;  ///< As NavSatBlock::system.
  std::uint8_t satellite = 0;
  /// b0-1 health (1 healthy), b2-3 visibility (2 above horizon, 3 above mask).
  std::uint8_t flags = 0;
  /// b0-4 usable for n quarters of an hour, b5-7 source (1 broadcast).
  std::uint8_t ephemeris = 0;
  std::uint8_t almanac = 0;  ///< b0-4 usable for n days, b5-7 source (1 broadcast).
  std::uint8_t other = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavOrbBlock::system), at(1, &NavOrbBlock::satellite),
                           at(2, &NavOrbBlock::flags), at(3, &NavOrbBlock::ephemeris),
                           at(4, &NavOrbBlock::almanac), at(5, &NavOrbBlock::other));
  }
  friend bool operator==(const NavOrbBlock&, const NavOrbBlock&) = default;
};

/// NAV-DGPS: the head, followed by `channels` blocks.
struct NavDgpsHead {
  static constexpr MessageId kId{0x01, 0x31};
  static constexpr std::size_t kLength =
      4 /*time*/ + 4 /*age*/ + 4 /*station*/ + 2 /*channels, status*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::int32_t age_ms = 0;
  std::int16_t station = 0;
  std::int16_t station_health = 0;
  std::uint8_t channels = 0;
  std::uint8_t status = 0;  ///< 0 none, 1 range and range rate corrections.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavDgpsHead::time_of_week_ms), at(4, &NavDgpsHead::age_ms),
                           at(8, &NavDgpsHead::station), at(10, &NavDgpsHead::station_health),
                           at(12, &NavDgpsHead::channels), at(13, &NavDgpsHead::status));
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return channels; }
  friend bool operator==(const NavDgpsHead&, const NavDgpsHead&) = default;
};

/// NAV-DGPS: one satellite.
struct NavDgpsBlock {
  static constexpr std::size_t kLength = 2 /*satellite, flags*/ + 2 /*age*/ + 8 /*corrections*/;

  std::uint8_t satellite = 0;
  std::uint8_t flags = 0;  ///< b0-3 channel, b4 used.
  std::uint16_t age_ms = 0;
  float range_correction_m = 0.0F;
  float range_rate_correction_mps = 0.0F;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavDgpsBlock::satellite), at(1, &NavDgpsBlock::flags),
                           at(2, &NavDgpsBlock::age_ms), at(4, &NavDgpsBlock::range_correction_m),
                           at(8, &NavDgpsBlock::range_rate_correction_mps));
  }
  friend bool operator==(const NavDgpsBlock&, const NavDgpsBlock&) = default;
};

/// NAV-SBAS: the head, followed by `satellites` blocks.
struct NavSbasHead {
  static constexpr MessageId kId{0x01, 0x32};
  static constexpr std::size_t kLength = 4 /*time*/ + 6 /*state*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t geostationary = 0;     ///< PRN whose corrections are used; 0 none.
  std::uint8_t mode = 0;              ///< 0 off, 1 on (integrity), 3 test.
  std::int8_t system = -1;            ///< -1 unknown, 0 WAAS, 1 EGNOS, 2 MSAS, 3 GAGAN, 16 GPS.
  std::uint8_t services = 0;          ///< b0 ranging, b1 corrections, b2 integrity, b3 test.
  std::uint8_t satellites = 0;
  std::uint8_t status_flags = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavSbasHead::time_of_week_ms), at(4, &NavSbasHead::geostationary),
                           at(5, &NavSbasHead::mode), at(6, &NavSbasHead::system),
                           at(7, &NavSbasHead::services), at(8, &NavSbasHead::satellites),
                           at(9, &NavSbasHead::status_flags));
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return satellites; }
  friend bool operator==(const NavSbasHead&, const NavSbasHead&) = default;
};

/// NAV-SBAS: one satellite.
struct NavSbasBlock {
  static constexpr std::size_t kLength =
      5 /*satellite*/ + 1 /*reserved*/ + 2 /*range*/ + 2 /*reserved*/ + 2 /*ionosphere*/;

  std::uint8_t satellite = 0;
  std::uint8_t flags = 0;       ///< Reserved from u-blox 8 on.
  std::uint8_t monitoring = 0;  ///< User differential range error index.
  std::int8_t system = -1;
  std::uint8_t services = 0;
  std::int16_t range_correction_cm = 0;
  std::int16_t ionosphere_correction_cm = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavSbasBlock::satellite), at(1, &NavSbasBlock::flags),
                           at(2, &NavSbasBlock::monitoring), at(3, &NavSbasBlock::system),
                           at(4, &NavSbasBlock::services),
                           at(6, &NavSbasBlock::range_correction_cm),
                           at(10, &NavSbasBlock::ionosphere_correction_cm));
  }
  friend bool operator==(const NavSbasBlock&, const NavSbasBlock&) = default;
};

}  // namespace rigwire::protocols::ubx

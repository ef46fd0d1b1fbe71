// Raw measurements and broadcast navigation data (class 0x02), in wire units.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.18 "UBX-RXM"; ZED-F9P
// interface description HPG 1.50, UBXDOC-963802114-12815, section 3.17.6; RXM-RAW and RXM-SFRB of
// u-blox 7: recordings of a NEO-7P, and the fields that RTKLIB reads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// RXM-RAW: the head, followed by `satellites` blocks. NEO-7P.
struct RxmRawHead {
  static constexpr MessageId kId{0x02, 0x10};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*week*/ + 2 /*satellites, reserved*/;

  std::int32_t time_of_week_ms = 0;  ///< Time of the measurement by the receiver's clock.
  std::int16_t week = 0;
  std::uint8_t satellites = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.week, m.satellites, gap<1>);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return satellites; }
};

/// RXM-RAW: one satellite.
struct RxmRawBlock {
  static constexpr std::size_t kLength =
      8 /*carrier*/ + 8 /*range*/ + 4 /*Doppler*/ + 4 /*satellite, quality*/;

  double carrier_phase_cycles = 0.0;
  double pseudorange_m = 0.0;
  float doppler_hz = 0.0F;     ///< Positive while the satellite comes nearer.
  std::uint8_t satellite = 0;  ///< GPS 1..32, SBAS 120..158.
  /// 4 and more: range and Doppler; 6 and more: carrier too; 7: no half-cycle slip.
  std::int8_t quality = 0;
  std::int8_t cn0_dbhz = 0;
  std::uint8_t loss_of_lock = 0;  ///< Loss of lock indicator of RINEX.

  static constexpr auto fields(auto& m) {
    return std::tie(m.carrier_phase_cycles, m.pseudorange_m, m.doppler_hz, m.satellite, m.quality,
                    m.cn0_dbhz, m.loss_of_lock);
  }
};

/// RXM-SFRB: one subframe. u-blox 7.
struct RxmSfrb {
  static constexpr MessageId kId{0x02, 0x11};
  static constexpr std::size_t kLength = 2 /*channel, satellite*/ + 10 * 4 /*words*/;

  std::uint8_t channel = 0;
  std::uint8_t satellite = 0;             ///< GPS 1..32, SBAS 120..158.
  std::array<std::uint32_t, 10> words{};  ///< GPS: 24 data bits, sign-extended, no parity.

  static constexpr auto fields(auto& m) { return std::tie(m.channel, m.satellite, m.words); }
};

/// RXM-SFRBX: the head, followed by `words` words. u-blox 8 and later.
struct RxmSfrbxHead {
  static constexpr MessageId kId{0x02, 0x13};
  static constexpr std::size_t kLength = 4 /*signal*/ + 4 /*words, channel, version, reserved*/;

  std::uint8_t system = 0;  ///< Coded as NavSatBlock::system.
  std::uint8_t satellite = 0;
  std::uint8_t signal = 0;          ///< F9; reserved before it.
  std::uint8_t frequency_slot = 0;  ///< GLONASS only: slot + 7.
  std::uint8_t words = 0;
  std::uint8_t channel = 0;
  std::uint8_t version = 2;

  static constexpr auto fields(auto& m) {
    return std::tie(m.system, m.satellite, m.signal, m.frequency_slot, m.words, m.channel,
                    m.version, gap<1>);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return words; }
};

/// RXM-SFRBX: one word.
struct RxmSfrbxWord {
  static constexpr std::size_t kLength = 4 /*word*/;

  std::uint32_t word = 0;  ///< GPS: two bits of padding, 24 of data, 6 of parity.

  static constexpr auto fields(auto& m) { return std::tie(m.word); }
};

/// RXM-RTCM: an RTCM 3 message came in. F9.
struct RxmRtcm {
  static constexpr MessageId kId{0x02, 0x32};
  static constexpr std::size_t kLength = 2 /*version, flags*/ + 3 * 2 /*message*/;

  std::uint8_t version = 2;
  std::uint8_t flags = 0;     ///< b0 checksum failed, b1-2 use: 0 unknown, 1 not used, 2 used.
  std::uint16_t subtype = 0;  ///< Subtype of message 4072.
  std::uint16_t station = 0;
  std::uint16_t message = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, m.flags, m.subtype, m.station, m.message);
  }
};

/// RxmRawxHead::status.
inline constexpr std::uint8_t kRawxLeapSecondsKnown = 0x01;
inline constexpr std::uint8_t kRawxClockReset = 0x02;
/// RxmRawxBlock::status.
inline constexpr std::uint8_t kRawxRangeValid = 0x01;
inline constexpr std::uint8_t kRawxCarrierValid = 0x02;
inline constexpr std::uint8_t kRawxHalfCycleKnown = 0x04;
inline constexpr std::uint8_t kRawxHalfCycleSubtracted = 0x08;
/// RxmRawxBlock::locked_ms counts no further.
inline constexpr std::uint16_t kRawxLongestLock_ms = 64'500;
/// RxmRawxBlock::carrier_sigma of a carrier phase without an estimate.
inline constexpr std::uint8_t kRawxNoCarrierSigma = 15;

/// RXM-RAWX: the head, followed by `measurements` blocks. u-blox M8T, F9.
struct RxmRawxHead {
  static constexpr MessageId kId{0x02, 0x15};
  static constexpr std::size_t kLength =
      8 /*time*/ + 4 /*week, leap, measurements*/ + 4 /*status, version, reserved*/;

  double time_of_week_s = 0.0;  ///< Time of the measurement by the receiver's clock.
  std::uint16_t week = 0;
  std::int8_t leap_seconds = 0;
  std::uint8_t measurements = 0;
  std::uint8_t status = 0;   ///< kRawxLeapSecondsKnown, ...
  std::uint8_t version = 1;  ///< 0 before F9.

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_s, m.week, m.leap_seconds, m.measurements, m.status, m.version,
                    gap<2>);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return measurements; }
};

/// RXM-RAWX: one signal.
struct RxmRawxBlock {
  static constexpr std::size_t kLength =
      8 /*range*/ + 8 /*carrier*/ + 4 /*Doppler*/ + 4 /*signal*/ + 8 /*quality*/;

  double pseudorange_m = 0.0;
  double carrier_phase_cycles = 0.0;
  float doppler_hz = 0.0F;  ///< Positive while the satellite comes nearer.
  std::uint8_t system = 0;  ///< Coded as NavSatBlock::system.
  std::uint8_t satellite = 0;
  std::uint8_t signal = 0;          ///< F9: GPS 0 L1C/A, 3 L2CL, 4 L2CM.
  std::uint8_t frequency_slot = 0;  ///< GLONASS only: slot + 7.
  std::uint16_t locked_ms = 0;      ///< At most kRawxLongestLock_ms.
  std::uint8_t cn0_dbhz = 0;
  std::uint8_t pseudorange_sigma = 0;                ///< n of 0.01 * 2^n m.
  std::uint8_t carrier_sigma = kRawxNoCarrierSigma;  ///< n of 0.004 * n cycles.
  std::uint8_t doppler_sigma = 0;                    ///< n of 0.002 * 2^n Hz.
  std::uint8_t status = 0;                           ///< kRawxRangeValid, ...

  static constexpr auto fields(auto& m) {
    return std::tie(m.pseudorange_m, m.carrier_phase_cycles, m.doppler_hz, m.system, m.satellite,
                    m.signal, m.frequency_slot, m.locked_ms, m.cn0_dbhz, m.pseudorange_sigma,
                    m.carrier_sigma, m.doppler_sigma, m.status, gap<1>);
  }
};

/// RXM-SVSI: the head, followed by `satellites` blocks.
struct RxmSvsiHead {
  static constexpr MessageId kId{0x02, 0x20};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*week*/ + 2 /*visible, satellites*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::int16_t week = 0;
  std::uint8_t visible = 0;
  std::uint8_t satellites = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.week, m.visible, m.satellites);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return satellites; }
};

/// RXM-SVSI: one satellite.
struct RxmSvsiBlock {
  static constexpr std::size_t kLength =
      2 /*satellite, flags*/ + 2 /*azimuth*/ + 2 /*elevation, age*/;

  std::uint8_t satellite = 0;
  /// b0-3 accuracy (URA), b4 healthy, b5 ephemeris, b6 almanac, b7 not available.
  std::uint8_t flags = 0;
  std::int16_t azimuth_deg = 0;
  std::int8_t elevation_deg = 0;
  std::uint8_t age = 0;  ///< b0-3 almanac in days + 4, b4-7 ephemeris in hours + 4.

  static constexpr auto fields(auto& m) {
    return std::tie(m.satellite, m.flags, m.azimuth_deg, m.elevation_deg, m.age);
  }
};

}  // namespace rigwire::protocols::ubx

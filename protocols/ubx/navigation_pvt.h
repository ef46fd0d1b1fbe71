// NAV-PVT, the whole solution in one message, in its 84-byte form (u-blox 7) and its 92-byte form
// (u-blox 8 and later). Wire units.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.17.17 "UBX-NAV-PVT", and
// ZED-F9P interface description HPG 1.50, UBXDOC-963802114-12815, section 3.15.13. The 84-byte form
// ends before headVeh; no recording of it was at hand, two client drivers accept that length.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"
#include "protocols/ubx/navigation_values.h"

namespace rigwire::protocols::ubx {

/// NavPvt::valid. M8 and later also say in b4..7 whose UTC it is.
inline constexpr std::uint8_t kPvtValidDate = 0x01;
inline constexpr std::uint8_t kPvtValidTime = 0x02;
inline constexpr std::uint8_t kPvtFullyResolved = 0x04;
inline constexpr std::uint8_t kPvtValidDeclination = 0x08;
/// NavPvt::flags.
inline constexpr std::uint8_t kPvtFixOk = 0x01;
inline constexpr std::uint8_t kPvtDifferential = 0x02;
inline constexpr std::uint8_t kPvtVehicleHeadingValid = 0x20;
inline constexpr std::uint8_t kPvtCarrierFloat = 0x40;
inline constexpr std::uint8_t kPvtCarrierFixed = 0x80;
/// NavPvt::flags2, u-blox 8 and later.
inline constexpr std::uint8_t kPvtConfirmationAvailable = 0x20;
inline constexpr std::uint8_t kPvtConfirmedDate = 0x40;
inline constexpr std::uint8_t kPvtConfirmedTime = 0x80;
/// NavPvt92::flags3: b0; b1..4 hold the age class of the last correction (F9).
inline constexpr std::uint16_t kPvtInvalidPosition = 0x0001;
inline constexpr unsigned kPvtCorrectionAgeShift = 1;

/// NAV-PVT in the 84-byte form of u-blox 7.
struct NavPvt {
  static constexpr MessageId kId{0x01, 0x07};
  static constexpr std::size_t kLength =
      20 /*time*/ + 4 /*fix*/ + 24 /*position*/ + 28 /*velocity*/ + 2 /*dilution*/ + 6 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint16_t year = 0;
  std::uint8_t month = 0;
  std::uint8_t day = 0;
  std::uint8_t hour = 0;
  std::uint8_t minute = 0;
  std::uint8_t second = 0;  ///< 0..60.
  std::uint8_t valid = 0;   ///< kPvtValidDate, ...
  std::uint32_t time_accuracy_ns = 0;
  std::int32_t nanosecond = 0;  ///< Add to second; may be negative.
  std::uint8_t fix_type = 0;
  std::uint8_t flags = 0;  ///< kPvtFixOk, ...
  std::uint8_t flags2 = 0;
  std::uint8_t satellites_used = 0;
  std::int32_t longitude_e7deg = 0;
  std::int32_t latitude_e7deg = 0;
  std::int32_t ellipsoid_height_mm = 0;
  std::int32_t mean_sea_level_height_mm = 0;
  std::uint32_t horizontal_accuracy_mm = 0;
  std::uint32_t vertical_accuracy_mm = 0;
  std::array<std::int32_t, 3> velocity_ned_mmps{};
  std::int32_t ground_speed_mmps = 0;
  std::int32_t heading_e5deg = 0;  ///< Of motion.
  std::uint32_t speed_accuracy_mmps = 0;
  std::uint32_t heading_accuracy_e5deg = 0;
  std::uint16_t position_dilution_e2 = kNoDilution;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &NavPvt::time_of_week_ms), at(4, &NavPvt::year), at(6, &NavPvt::month),
        at(7, &NavPvt::day), at(8, &NavPvt::hour), at(9, &NavPvt::minute), at(10, &NavPvt::second),
        at(11, &NavPvt::valid), at(12, &NavPvt::time_accuracy_ns), at(16, &NavPvt::nanosecond),
        at(20, &NavPvt::fix_type), at(21, &NavPvt::flags), at(22, &NavPvt::flags2),
        at(23, &NavPvt::satellites_used), at(24, &NavPvt::longitude_e7deg),
        at(28, &NavPvt::latitude_e7deg), at(32, &NavPvt::ellipsoid_height_mm),
        at(36, &NavPvt::mean_sea_level_height_mm), at(40, &NavPvt::horizontal_accuracy_mm),
        at(44, &NavPvt::vertical_accuracy_mm), at(48, &NavPvt::velocity_ned_mmps),
        at(60, &NavPvt::ground_speed_mmps), at(64, &NavPvt::heading_e5deg),
        at(68, &NavPvt::speed_accuracy_mmps), at(72, &NavPvt::heading_accuracy_e5deg),
        at(76, &NavPvt::position_dilution_e2));
  }
  friend bool operator==(const NavPvt&, const NavPvt&) = default;
};

/// NAV-PVT in the 92-byte form of u-blox 8 and later: the shorter form and what stands in and after
/// its reserved bytes.
struct NavPvt92 : NavPvt {
  static constexpr MessageId kId{0x01, 0x07};
  static constexpr std::size_t kLength = NavPvt::kLength - 6 /*reserved*/ + 2 /*flags*/ +
                                         4 /*reserved*/ + 4 /*vehicle*/ + 4 /*declination*/;

  std::uint16_t flags3 = 0;                ///< kPvtInvalidPosition, ...
  std::int32_t vehicle_heading_e5deg = 0;  ///< Valid with kPvtVehicleHeadingValid.
  std::int16_t declination_e2deg = 0;      ///< Magnetic; valid with kPvtValidDeclination.
  std::uint16_t declination_accuracy_e2deg = 0;

  static constexpr auto fields() {
    return std::tuple_cat(
        NavPvt::fields(),
        std::make_tuple(at(78, &NavPvt92::flags3), at(84, &NavPvt92::vehicle_heading_e5deg),
                        at(88, &NavPvt92::declination_e2deg),
                        at(90, &NavPvt92::declination_accuracy_e2deg)));
  }
  friend bool operator==(const NavPvt92&, const NavPvt92&) = default;
};

}  // namespace rigwire::protocols::ubx

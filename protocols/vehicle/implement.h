// What a tractor reports to its implements, and what they request of it: hitches and power
// take-offs, power after the key is off, and the operator's language (ISO 11783-7).
//
// Sources: isobus.net (positions, scales, SPNs of 65090 .. 65096); AgIsoStack (values of codes,
// language command, maintain power).
#pragma once

#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// SPN numbers and groups of one end's hitch.
struct HitchNumbers {
  Group group;
  std::uint16_t position;
  std::uint16_t limit;
  std::uint16_t in_work;
  std::uint16_t link_force;
  std::uint16_t draft;
  std::uint16_t exit;
};
inline constexpr HitchNumbers kRearHitch{
    {"RHS", 65093, 3, std::chrono::milliseconds{100}}, 1873, 5151, 1877, 1881, 1879, 5819};
inline constexpr HitchNumbers kFrontHitch{
    {"FHS", 65094, 3, std::chrono::milliseconds{100}}, 1872, 5150, 1876, 1880, 1878, 5816};

/// Hitch status: 0 is full down, 1 full up.
template <const HitchNumbers& numbers>
struct HitchStatus {
  static constexpr Group kGroup = numbers.group;

  double position_share = kNotAvailable;
  std::uint8_t limit_status = 7;  ///< 3 bits, LimitStatus (steering.h).
  Switch in_work = Switch::not_available;
  double link_force_share = kNotAvailable;
  double draft_n = kNotAvailable;
  std::uint8_t exit_reason = 0x3F;  ///< 6 bits, ExitReason.

  static constexpr auto parameters() {
    using M = HitchStatus;
    return std::array{
        number("hitch position", numbers.position, {1}, 8, kShare, &M::position_share),
        code("position limit status", numbers.limit, {2, 4}, 3, &M::limit_status),
        state("in-work indication", numbers.in_work, {2, 7}, &M::in_work),
        number("nominal lower link force", numbers.link_force, {3}, 8,
               {0.8 * kPercent, -1.0, "1", kInPercent}, &M::link_force_share),
        number("draft", numbers.draft, {4}, 16, {10.0, -320000.0, "N"}, &M::draft_n),
        code("exit/reason code", numbers.exit, {6, 1}, 6, &M::exit_reason),
    };
  }
};
using RearHitchStatus = HitchStatus<kRearHitch>;
using FrontHitchStatus = HitchStatus<kFrontHitch>;

/// Suspect parameter numbers of one end's power take-off.
struct PowerTakeOffNumbers {
  Group group;
  std::uint16_t speed;
  std::uint16_t set_point;
  std::uint16_t engagement_request;
  std::uint16_t economy;
  std::uint16_t mode;
  std::uint16_t engagement;
  std::uint16_t limit;
  std::uint16_t economy_request;
  std::uint16_t mode_request;
  std::uint16_t exit;
};
inline constexpr PowerTakeOffNumbers kRearPowerTakeOff{
    {"RPTO", 65091, 3, std::chrono::milliseconds{100}},
    1883,
    1885,
    5156,
    1892,
    1890,
    2408,
    5159,
    5158,
    5157,
    5820};
inline constexpr PowerTakeOffNumbers kFrontPowerTakeOff{
    {"FPTO", 65092, 3, std::chrono::milliseconds{100}},
    1882,
    1884,
    5152,
    1891,
    1889,
    1888,
    5155,
    5154,
    5153,
    5817};

/// Power take-off output shaft; every 100 ms while it is engaged, else on request.
template <const PowerTakeOffNumbers& numbers>
struct PowerTakeOffStatus {
  static constexpr Group kGroup = numbers.group;

  double speed_radps = kNotAvailable;
  double set_point_radps = kNotAvailable;
  std::uint8_t engagement_request = 3;  ///< 2 bits: 0 accepted, 1 overridden, 2 error.
  Switch economy = Switch::not_available;
  Switch mode = Switch::not_available;  ///< Off: 540 rpm, on: 1000 rpm.
  Switch engaged = Switch::not_available;
  std::uint8_t limit_status = 7;
  std::uint8_t economy_request = 3;
  std::uint8_t mode_request = 3;
  std::uint8_t exit_reason = 0x3F;

  static constexpr auto parameters() {
    using M = PowerTakeOffStatus;
    return std::array{
        number("shaft speed", numbers.speed, {1}, 16, kShaftSpeed, &M::speed_radps),
        number("shaft speed set point", numbers.set_point, {3}, 16, kShaftSpeed,
               &M::set_point_radps),
        code("engagement request status", numbers.engagement_request, {5, 1}, 2,
             &M::engagement_request),
        state("economy mode", numbers.economy, {5, 3}, &M::economy),
        state("mode", numbers.mode, {5, 5}, &M::mode),
        state("engagement", numbers.engagement, {5, 7}, &M::engaged),
        code("shaft speed limit status", numbers.limit, {6, 2}, 3, &M::limit_status),
        code("economy mode request status", numbers.economy_request, {6, 5}, 2,
             &M::economy_request),
        code("mode request status", numbers.mode_request, {6, 7}, 2, &M::mode_request),
        code("exit/reason code", numbers.exit, {7, 1}, 6, &M::exit_reason),
    };
  }
};
using RearPowerTakeOffStatus = PowerTakeOffStatus<kRearPowerTakeOff>;
using FrontPowerTakeOffStatus = PowerTakeOffStatus<kFrontPowerTakeOff>;

/// Hitch and PTO commands: both ends in one message.
struct HitchPowerTakeOffCommand {
  static constexpr Group kGroup{"HPTOC", 65090, 3, std::chrono::milliseconds{100}};

  double front_hitch_share = kNotAvailable;
  double rear_hitch_share = kNotAvailable;
  double front_speed_radps = kNotAvailable;
  double rear_speed_radps = kNotAvailable;
  Switch rear_engage = Switch::not_available;
  Switch front_engage = Switch::not_available;
  Switch rear_economy = Switch::not_available;
  Switch front_economy = Switch::not_available;
  Switch rear_mode = Switch::not_available;
  Switch front_mode = Switch::not_available;

  static constexpr auto parameters() {
    using M = HitchPowerTakeOffCommand;
    return std::array{
        number("front hitch position", 1874, {1}, 8, kShare, &M::front_hitch_share),
        number("rear hitch position", 1875, {2}, 8, kShare, &M::rear_hitch_share),
        number("front PTO shaft speed", 1886, {3}, 16, kShaftSpeed, &M::front_speed_radps),
        number("rear PTO shaft speed", 1887, {5}, 16, kShaftSpeed, &M::rear_speed_radps),
        state("rear PTO engagement", 1894, {7, 5}, &M::rear_engage),
        state("front PTO engagement", 1893, {7, 7}, &M::front_engage),
        state("rear PTO economy mode", 1898, {8, 1}, &M::rear_economy),
        state("front PTO economy mode", 1897, {8, 3}, &M::front_economy),
        state("rear PTO mode", 1896, {8, 5}, &M::rear_mode),
        state("front PTO mode", 1895, {8, 7}, &M::front_mode),
    };
  }
};

/// Maintain power: an implement asks for 2 s more after the key is off. On: it needs them.
struct MaintainPower {
  static constexpr Group kGroup{"MP", 65095, 6, std::chrono::milliseconds{0}};

  Switch actuator_power = Switch::not_available;
  Switch ecu_power = Switch::not_available;
  Switch in_work = Switch::not_available;
  Switch ready_to_work = Switch::not_available;
  Switch parked = Switch::not_available;
  Switch transport = Switch::not_available;

  static constexpr auto parameters() {
    return std::array{
        state("maintain actuator power", 1868, {1, 5}, &MaintainPower::actuator_power),
        state("maintain ECU power", 1867, {1, 7}, &MaintainPower::ecu_power),
        state("implement in work", 0, {2, 1}, &MaintainPower::in_work),
        state("implement ready to work", 0, {2, 3}, &MaintainPower::ready_to_work),
        state("implement parked", 0, {2, 5}, &MaintainPower::parked),
        state("implement in transport", 0, {2, 7}, &MaintainPower::transport),
    };
  }
};

/// Language command: how displays shall write. Codes as AgIsoStack has them; all ones of a code:
/// take no action.
struct LanguageCommand {
  static constexpr Group kGroup{"LANG", 65039, 6, std::chrono::milliseconds{0}};

  std::uint8_t language_first = 0xFF;  ///< ISO 639, two letters.
  std::uint8_t language_second = 0xFF;
  std::uint8_t time_format = 3;     ///< 0: 24 h, 1: 12 h.
  std::uint8_t decimal_symbol = 3;  ///< 0: comma, 1: point.
  std::uint8_t date_format = 0xFF;  ///< 0: ddmmyyyy .. 3: mmddyyyy, 4: yyyymmdd.
  std::uint8_t mass_units = 3;      ///< This and the following: 0 metric, 1 imperial, 2 US.
  std::uint8_t volume_units = 3;
  std::uint8_t area_units = 3;
  std::uint8_t distance_units = 3;
  std::uint8_t general_units = 3;
  std::uint8_t force_units = 3;
  std::uint8_t pressure_units = 3;
  std::uint8_t temperature_units = 3;
  std::uint8_t country_first = 0xFF;  ///< ISO 3166, two letters.
  std::uint8_t country_second = 0xFF;

  static constexpr auto parameters() {
    using M = LanguageCommand;
    return std::array{
        code("language, first letter", 0, {1}, 8, &M::language_first),
        code("language, second letter", 0, {2}, 8, &M::language_second),
        code("time format", 0, {3, 5}, 2, &M::time_format),
        code("decimal symbol", 0, {3, 7}, 2, &M::decimal_symbol),
        code("date format", 0, {4}, 8, &M::date_format),
        code("mass units", 0, {5, 1}, 2, &M::mass_units),
        code("volume units", 0, {5, 3}, 2, &M::volume_units),
        code("area units", 0, {5, 5}, 2, &M::area_units),
        code("distance units", 0, {5, 7}, 2, &M::distance_units),
        code("general units", 0, {6, 1}, 2, &M::general_units),
        code("force units", 0, {6, 3}, 2, &M::force_units),
        code("pressure units", 0, {6, 5}, 2, &M::pressure_units),
        code("temperature units", 0, {6, 7}, 2, &M::temperature_units),
        code("country, first letter", 0, {7}, 8, &M::country_first),
        code("country, second letter", 0, {8}, 8, &M::country_second),
    };
  }

  friend bool operator==(const LanguageCommand&, const LanguageCommand&) = default;
};

}  // namespace rigwire::protocols::vehicle

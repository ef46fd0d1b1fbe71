// Gearbox and differentials: their state (ETC1, ETC2, EAC1) and the request to them (TC1).
#pragma once

#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

// Gears are sent as number + 125: forward positive, 0 neutral, reverse negative. 251 is "park".
// Source of park: general knowledge of J1939-71, not in the annex extract.
inline constexpr std::uint8_t kGearPark = 251;
inline constexpr std::uint8_t kGearError = 0xFE;
inline constexpr std::uint8_t kGearNotAvailable = 0xFF;
inline constexpr int kGearLimit = 125;

/// Gears beyond -125 .. 125 are sent as error.
[[nodiscard]] constexpr std::uint8_t gear_code(int gear) {
  return gear < -kGearLimit || gear > kGearLimit ? kGearError
                                                 : static_cast<std::uint8_t>(gear + kGearLimit);
}
/// Nothing for park, error and not available.
[[nodiscard]] constexpr std::optional<int> gear_of(std::uint8_t code) {
  return code <= 2 * kGearLimit ? std::optional<int>(code - kGearLimit) : std::nullopt;
}

/// Electronic Transmission Controller 1.
struct Etc1 {
  static constexpr Group kGroup{"ETC1", 61442, 3, std::chrono::milliseconds{10}};

  Switch driveline_engaged = Switch::not_available;
  Switch converter_lockup = Switch::not_available;
  Switch shift_in_process = Switch::not_available;
  double output_shaft_radps = kNotAvailable;
  double clutch_slip_share = kNotAvailable;
  double input_shaft_radps = kNotAvailable;
  std::uint8_t controlling_address = 0xFF;

  static constexpr auto parameters() {
    return std::array{
        state("driveline engaged", 560, {1, 1}, &Etc1::driveline_engaged),
        state("torque converter lock-up", 573, {1, 3}, &Etc1::converter_lockup),
        state("shift in process", 574, {1, 5}, &Etc1::shift_in_process),
        number("output shaft speed", 191, {2}, 16, kShaftSpeed, &Etc1::output_shaft_radps),
        number("clutch slip", 522, {4}, 8, kShare, &Etc1::clutch_slip_share),
        number("input shaft speed", 161, {6}, 16, kShaftSpeed, &Etc1::input_shaft_radps),
        code("controlling address", 1482, {8}, 8, &Etc1::controlling_address),
    };
  }
};

/// Electronic Transmission Controller 2. Gears: gear_code, gear_of. Ranges: two ASCII characters.
struct Etc2 {
  static constexpr Group kGroup{"ETC2", 61445, 6, std::chrono::milliseconds{100}};

  std::uint8_t selected_gear = kGearNotAvailable;
  double ratio = kNotAvailable;  ///< Input to output speed.
  std::uint8_t current_gear = kGearNotAvailable;
  std::uint8_t requested_range_first = 0xFF;
  std::uint8_t requested_range_second = 0xFF;
  std::uint8_t current_range_first = 0xFF;
  std::uint8_t current_range_second = 0xFF;

  static constexpr auto parameters() {
    return std::array{
        code("selected gear", 524, {1}, 8, &Etc2::selected_gear),
        number("actual gear ratio", 526, {2}, 16, {0.001, 0.0, "1"}, &Etc2::ratio),
        code("current gear", 523, {4}, 8, &Etc2::current_gear),
        code("requested range, first character", 162, {5}, 8, &Etc2::requested_range_first),
        code("requested range, second character", 162, {6}, 8, &Etc2::requested_range_second),
        code("current range, first character", 163, {7}, 8, &Etc2::current_range_first),
        code("current range, second character", 163, {8}, 8, &Etc2::current_range_second),
    };
  }
};

/// Transmission Control 1, addressed. J1939 has no request to engage a differential lock, only one
/// to disengage it: off permits engagement, on asks for disengagement.
struct Tc1 {
  static constexpr Group kGroup{"TC1", 256, 3, std::chrono::milliseconds{50}};

  double clutch_slip_share = kNotAvailable;
  std::uint8_t requested_gear = kGearNotAvailable;
  Switch disengage_front_lock_1 = Switch::not_available;
  Switch disengage_front_lock_2 = Switch::not_available;
  Switch disengage_rear_lock_1 = Switch::not_available;
  Switch disengage_rear_lock_2 = Switch::not_available;
  Switch disengage_central_lock = Switch::not_available;
  Switch disengage_central_front_lock = Switch::not_available;
  Switch disengage_central_rear_lock = Switch::not_available;

  static constexpr auto parameters() {
    return std::array{
        number("requested clutch slip", 684, {2}, 8, kShare, &Tc1::clutch_slip_share),
        code("requested gear", 525, {3}, 8, &Tc1::requested_gear),
        state("disengage lock, front axle 1", 685, {4, 1}, &Tc1::disengage_front_lock_1),
        state("disengage lock, front axle 2", 686, {4, 3}, &Tc1::disengage_front_lock_2),
        state("disengage lock, rear axle 1", 687, {4, 5}, &Tc1::disengage_rear_lock_1),
        state("disengage lock, rear axle 2", 688, {4, 7}, &Tc1::disengage_rear_lock_2),
        state("disengage lock, central", 689, {5, 1}, &Tc1::disengage_central_lock),
        state("disengage lock, central front", 690, {5, 3}, &Tc1::disengage_central_front_lock),
        state("disengage lock, central rear", 691, {5, 5}, &Tc1::disengage_central_rear_lock),
    };
  }
};

/// Electronic Axle Controller 1: differential locks, on = engaged.
struct Eac1 {
  static constexpr Group kGroup{"EAC1", 61446, 6, std::chrono::milliseconds{500}};

  std::uint8_t location = 0xFF;
  Switch front_lock_1 = Switch::not_available;
  Switch front_lock_2 = Switch::not_available;
  Switch rear_lock_1 = Switch::not_available;
  Switch rear_lock_2 = Switch::not_available;
  Switch central_lock = Switch::not_available;
  Switch central_front_lock = Switch::not_available;
  Switch central_rear_lock = Switch::not_available;
  Switch rear_lock_3 = Switch::not_available;
  Switch front_group_engaged = Switch::not_available;  ///< Driven, as by all-wheel drive.
  Switch rear_group_engaged = Switch::not_available;

  static constexpr auto parameters() {
    return std::array{
        code("location", 927, {1}, 8, &Eac1::location),
        state("lock, front axle 1", 567, {2, 1}, &Eac1::front_lock_1),
        state("lock, front axle 2", 568, {2, 3}, &Eac1::front_lock_2),
        state("lock, rear axle 1", 569, {2, 5}, &Eac1::rear_lock_1),
        state("lock, rear axle 2", 570, {2, 7}, &Eac1::rear_lock_2),
        state("lock, central", 564, {3, 1}, &Eac1::central_lock),
        state("lock, central front", 565, {3, 3}, &Eac1::central_front_lock),
        state("lock, central rear", 566, {3, 5}, &Eac1::central_rear_lock),
        state("lock, rear axle 3", 7716, {3, 7}, &Eac1::rear_lock_3),
        state("front axle group engaged", 3819, {4, 1}, &Eac1::front_group_engaged),
        state("rear axle group engaged", 3820, {4, 3}, &Eac1::rear_group_engaged),
    };
  }
};

}  // namespace rigwire::protocols::vehicle

// Speeds: of the wheels (EBC2, HRW), of the vehicle (CCVS1, ISO 11783-7 wheel-based and selected
// speed) and the one that is asked for (machine selected speed command).
//
// J1939 speeds have no sign; the direction is a parameter of its own in the ISO messages.
#pragma once

#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// One count of 1/256 km/h.
inline constexpr Scale kWheelSpeed{kKilometrePerHour_mps / 256.0, 0.0, "m/s", kInKilometrePerHour};
/// One count of 1/16 km/h, from -7.8125 km/h.
inline constexpr Scale kRelativeSpeed{kKilometrePerHour_mps / 16.0, -7.8125 * kKilometrePerHour_mps,
                                      "m/s", kInKilometrePerHour};
/// One count of 1 mm/s, 1 mm.
inline constexpr Scale kMachineSpeed{0.001, 0.0, "m/s"};
inline constexpr Scale kMachineDistance{0.001, 0.0, "m"};

/// Electronic Brake Controller 2. A wheel's speed is the front axle's plus its relative one.
struct Ebc2 {
  static constexpr Group kGroup{"EBC2", 65215, 6, std::chrono::milliseconds{100}};

  double front_axle_mps = kNotAvailable;
  double front_left_mps = kNotAvailable;  ///< This and the following ones: relative.
  double front_right_mps = kNotAvailable;
  double rear_1_left_mps = kNotAvailable;
  double rear_1_right_mps = kNotAvailable;
  double rear_2_left_mps = kNotAvailable;
  double rear_2_right_mps = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        number("front axle speed", 904, {1}, 16, kWheelSpeed, &Ebc2::front_axle_mps),
        number("relative, front left", 905, {3}, 8, kRelativeSpeed, &Ebc2::front_left_mps),
        number("relative, front right", 906, {4}, 8, kRelativeSpeed, &Ebc2::front_right_mps),
        number("relative, rear 1 left", 907, {5}, 8, kRelativeSpeed, &Ebc2::rear_1_left_mps),
        number("relative, rear 1 right", 908, {6}, 8, kRelativeSpeed, &Ebc2::rear_1_right_mps),
        number("relative, rear 2 left", 909, {7}, 8, kRelativeSpeed, &Ebc2::rear_2_left_mps),
        number("relative, rear 2 right", 910, {8}, 8, kRelativeSpeed, &Ebc2::rear_2_right_mps),
    };
  }
};

/// High Resolution Wheel Speed.
struct Hrw {
  static constexpr Group kGroup{"HRW", 65134, 2, std::chrono::milliseconds{20}};

  double front_left_mps = kNotAvailable;
  double front_right_mps = kNotAvailable;
  double rear_left_mps = kNotAvailable;
  double rear_right_mps = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        number("front left wheel", 1592, {1}, 16, kWheelSpeed, &Hrw::front_left_mps),
        number("front right wheel", 1593, {3}, 16, kWheelSpeed, &Hrw::front_right_mps),
        number("rear left wheel", 1594, {5}, 16, kWheelSpeed, &Hrw::rear_left_mps),
        number("rear right wheel", 1595, {7}, 16, kWheelSpeed, &Hrw::rear_right_mps),
    };
  }
};

/// Cruise Control / Vehicle Speed 1.
struct Ccvs1 {
  static constexpr Group kGroup{"CCVS1", 65265, 6, std::chrono::milliseconds{100}};

  Switch parking_brake = Switch::not_available;
  double wheel_based_speed_mps = kNotAvailable;
  Switch brake_switch = Switch::not_available;
  Switch clutch_switch = Switch::not_available;
  double set_speed_mps = kNotAvailable;
  std::uint8_t power_take_off_state = 0x1F;  ///< 5 bits.
  std::uint8_t cruise_state = 7;             ///< 3 bits.

  static constexpr auto parameters() {
    return std::array{
        state("parking brake", 70, {1, 3}, &Ccvs1::parking_brake),
        number("wheel-based speed", 84, {2}, 16, kWheelSpeed, &Ccvs1::wheel_based_speed_mps),
        state("brake switch", 597, {4, 5}, &Ccvs1::brake_switch),
        state("clutch switch", 598, {4, 7}, &Ccvs1::clutch_switch),
        number("cruise set speed", 86, {6}, 8,
               {kKilometrePerHour_mps, 0.0, "m/s", kInKilometrePerHour}, &Ccvs1::set_speed_mps),
        code("power take-off governor state", 976, {7, 1}, 5, &Ccvs1::power_take_off_state),
        code("cruise control state", 527, {7, 6}, 3, &Ccvs1::cruise_state),
    };
  }
};

/// ISO 11783-7 wheel-based speed and distance, with what implements ask of the tractor's power.
/// Direction: on = forward, off = reverse.
struct WheelBasedSpeed {
  static constexpr Group kGroup{"WBSD", 65096, 3, std::chrono::milliseconds{100}};

  double speed_mps = kNotAvailable;
  double distance_m = kNotAvailable;
  Switch forward = Switch::not_available;
  double power_time_s = kNotAvailable;  ///< The longest that power is kept once the key is off.
  Switch key_switch = Switch::not_available;  ///< On: not off.
  Switch start_stop = Switch::not_available;  ///< Implement operations, by the operator.
  Switch operator_reversed = Switch::not_available;

  static constexpr auto parameters() {
    return std::array{
        number("wheel-based speed", 1862, {1}, 16, kMachineSpeed, &WheelBasedSpeed::speed_mps),
        number("wheel-based distance", 1863, {3}, 32, kMachineDistance,
               &WheelBasedSpeed::distance_m),
        number("maximum time of tractor power", 1866, {7}, 8, {60.0, 0.0, "s", kInMinute},
               &WheelBasedSpeed::power_time_s),
        state("wheel-based direction", 1864, {8, 1}, &WheelBasedSpeed::forward),
        state("key switch", 1865, {8, 3}, &WheelBasedSpeed::key_switch),
        state("implement start/stop", 5203, {8, 5}, &WheelBasedSpeed::start_stop),
        state("operator direction reversed", 5244, {8, 7}, &WheelBasedSpeed::operator_reversed),
    };
  }
};

/// ISO 11783-7 ground-based speed and distance: by radar or satellites, free of wheel slip.
/// Direction: on = forward, off = reverse.
struct GroundBasedSpeed {
  static constexpr Group kGroup{"GBSD", 65097, 3, std::chrono::milliseconds{100}};

  double speed_mps = kNotAvailable;
  double distance_m = kNotAvailable;
  Switch forward = Switch::not_available;

  static constexpr auto parameters() {
    return std::array{
        number("ground-based speed", 1859, {1}, 16, kMachineSpeed, &GroundBasedSpeed::speed_mps),
        number("ground-based distance", 1860, {3}, 32, kMachineDistance,
               &GroundBasedSpeed::distance_m),
        state("ground-based direction", 1861, {8, 1}, &GroundBasedSpeed::forward),
    };
  }
};

/// Where the machine selected speed comes from.
enum class SpeedSource : std::uint8_t { wheel_based = 0, ground_based = 1, navigation = 2 };

/// ISO 11783-7 machine selected speed: what the machine itself takes for its speed.
struct MachineSelectedSpeed {
  static constexpr Group kGroup{"MSS", 61474, 3, std::chrono::milliseconds{100}};

  double speed_mps = kNotAvailable;
  double distance_m = kNotAvailable;
  std::uint8_t exit_reason = 0x3F;  ///< 6 bits.
  Switch forward = Switch::not_available;
  std::uint8_t source = 7;        ///< SpeedSource; 3 bits.
  std::uint8_t limit_status = 7;  ///< 3 bits.

  static constexpr auto parameters() {
    return std::array{
        number("machine selected speed", 4305, {1}, 16, kMachineSpeed,
               &MachineSelectedSpeed::speed_mps),
        number("machine selected distance", 4306, {3}, 32, kMachineDistance,
               &MachineSelectedSpeed::distance_m),
        code("exit/reason code", 5818, {7, 1}, 6, &MachineSelectedSpeed::exit_reason),
        state("machine selected direction", 4309, {8, 1}, &MachineSelectedSpeed::forward),
        code("speed source", 4308, {8, 3}, 3, &MachineSelectedSpeed::source),
        code("limit status", 4307, {8, 6}, 3, &MachineSelectedSpeed::limit_status),
    };
  }
};

/// ISO 11783-7 machine selected speed command.
struct MachineSelectedSpeedCommand {
  static constexpr Group kGroup{"MSSC", 64835, 3, std::chrono::milliseconds{100}};

  double speed_mps = kNotAvailable;
  double speed_limit_mps = kNotAvailable;  ///< Not to be exceeded.
  Switch forward = Switch::not_available;

  static constexpr auto parameters() {
    return std::array{
        number("set point", 4310, {1}, 16, kMachineSpeed, &MachineSelectedSpeedCommand::speed_mps),
        number("set point limit", 4311, {3}, 16, kMachineSpeed,
               &MachineSelectedSpeedCommand::speed_limit_mps),
        state("direction", 4312, {8, 1}, &MachineSelectedSpeedCommand::forward),
    };
  }
};

}  // namespace rigwire::protocols::vehicle

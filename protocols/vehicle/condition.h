// How the machine is doing: engine oil (EFL/P1), temperatures (ET1), fuel (DD1, LFE1, LFC1),
// battery (VEP1), hydraulic fluid (VF), hours (HOURS).
//
// Source: SAE J1939 digital annex. Temperatures in degrees Celsius.
#pragma once

#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// One count of 1 degree, from -40.
inline constexpr Scale kFluidTemperature{1.0, -40.0, "degC"};
/// One count of 1/32 degree, from -273.
inline constexpr Scale kFineTemperature{1.0 / 32.0, -273.0, "degC"};

/// Engine Fluid Level/Pressure 1.
struct Eflp1 {
  static constexpr Group kGroup{"EFLP1", 65263, 6, std::chrono::milliseconds{500}};

  double fuel_pressure_pa = kNotAvailable;
  double oil_level_share = kNotAvailable;
  double oil_pressure_pa = kNotAvailable;
  double coolant_level_share = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        number("fuel delivery pressure", 94, {1}, 8, {4000.0, 0.0, "Pa", kInKilopascal},
               &Eflp1::fuel_pressure_pa),
        number("oil level", 98, {3}, 8, kShare, &Eflp1::oil_level_share),
        number("oil pressure", 100, {4}, 8, {4000.0, 0.0, "Pa", kInKilopascal},
               &Eflp1::oil_pressure_pa),
        number("coolant level", 111, {8}, 8, kShare, &Eflp1::coolant_level_share),
    };
  }
};

/// Engine Temperature 1.
struct Et1 {
  static constexpr Group kGroup{"ET1", 65262, 6, std::chrono::seconds{1}};

  double coolant_c = kNotAvailable;
  double fuel_c = kNotAvailable;
  double oil_c = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        number("coolant temperature", 110, {1}, 8, kFluidTemperature, &Et1::coolant_c),
        number("fuel temperature", 174, {2}, 8, kFluidTemperature, &Et1::fuel_c),
        number("oil temperature", 175, {3}, 16, kFineTemperature, &Et1::oil_c),
    };
  }
};

/// Dash Display 1.
struct Dd1 {
  static constexpr Group kGroup{"DD1", 65276, 6, std::chrono::seconds{1}};

  double washer_fluid_share = kNotAvailable;
  double fuel_level_share = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        number("washer fluid level", 80, {1}, 8, kShare, &Dd1::washer_fluid_share),
        number("fuel level", 96, {2}, 8, kShare, &Dd1::fuel_level_share),
    };
  }
};

/// Vehicle Fluids.
struct VehicleFluids {
  static constexpr Group kGroup{"VF", 65128, 6, std::chrono::seconds{1}};

  double hydraulic_c = kNotAvailable;
  Switch filter_restricted = Switch::not_available;
  double hydraulic_level_share = kNotAvailable;

  static constexpr auto parameters() {
    using M = VehicleFluids;
    return std::array{
        number("hydraulic temperature", 1638, {1}, 8, kFluidTemperature, &M::hydraulic_c),
        state("hydraulic filter restriction", 1713, {2, 1}, &M::filter_restricted),
        number("hydraulic oil level", 2602, {3}, 8, kShare, &M::hydraulic_level_share),
    };
  }
};

/// Vehicle Electrical Power 1.
struct Vep1 {
  static constexpr Group kGroup{"VEP1", 65271, 6, std::chrono::seconds{1}};

  double battery_a = kNotAvailable;  ///< Into the battery.
  double alternator_a = kNotAvailable;
  double charging_v = kNotAvailable;
  double battery_v = kNotAvailable;
  double key_switch_v = kNotAvailable;

  static constexpr auto parameters() {
    constexpr Scale kVoltage{0.05, 0.0, "V"};
    return std::array{
        number("battery net current", 114, {1}, 8, {1.0, -125.0, "A"}, &Vep1::battery_a),
        number("alternator current", 115, {2}, 8, {1.0, 0.0, "A"}, &Vep1::alternator_a),
        number("charging potential", 167, {3}, 16, kVoltage, &Vep1::charging_v),
        number("battery potential", 168, {5}, 16, kVoltage, &Vep1::battery_v),
        number("key switch battery potential", 158, {7}, 16, kVoltage, &Vep1::key_switch_v),
    };
  }
};

/// Fuel Economy (Liquid).
struct Lfe1 {
  static constexpr Group kGroup{"LFE1", 65266, 6, std::chrono::milliseconds{100}};

  double fuel_rate_m3ps = kNotAvailable;

  static constexpr auto parameters() {
    constexpr Scale kRate{0.05 * kLitrePerHour_m3ps, 0.0, "m3/s", {"l/h", kLitrePerHour_m3ps}};
    return std::array{
        number("fuel rate", 183, {1}, 16, kRate, &Lfe1::fuel_rate_m3ps),
    };
  }
};

/// Fuel Consumption (Liquid) 1.
struct Lfc1 {
  static constexpr Group kGroup{"LFC1", 65257, 6, std::chrono::milliseconds{0}};

  double trip_m3 = kNotAvailable;
  double total_m3 = kNotAvailable;

  static constexpr auto parameters() {
    constexpr Scale kFuel{0.5e-3, 0.0, "m3", {"l", 1e-3}};
    return std::array{
        number("trip fuel", 182, {1}, 32, kFuel, &Lfc1::trip_m3),
        number("total fuel used", 250, {5}, 32, kFuel, &Lfc1::total_m3),
    };
  }
};

/// Engine Hours, Revolutions.
struct Hours {
  static constexpr Group kGroup{"HOURS", 65253, 6, std::chrono::milliseconds{0}};

  double operation_s = kNotAvailable;  ///< Total, of the running engine.
  double revolutions = kNotAvailable;  ///< Total.

  static constexpr auto parameters() {
    return std::array{
        number("total hours of operation", 247, {1}, 32, {0.05 * 3600.0, 0.0, "s", kInHour},
               &Hours::operation_s),
        number("total revolutions", 249, {5}, 32, {1000.0, 0.0, "1"}, &Hours::revolutions),
    };
  }
};

}  // namespace rigwire::protocols::vehicle

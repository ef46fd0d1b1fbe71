// Tyres, the channels of their inflation, and how the machine is doing.
#include <algorithm>

#include "emulators/vehicle_gateway/report.h"
#include "emulators/vehicle_gateway/report_values.h"

namespace rigwire::emulators {

namespace vehicle = protocols::vehicle;
using vehicle::kNotAvailable;
using vehicle::Switch;
using vehicle::TyreChannelMode;

namespace {

/// The first tyre of an axle; the second one follows.
enum Axle : std::size_t { front_axle = 0, rear_axle = 2 };

double mean(const std::array<double, kWheels>& values, Axle axle) {
  return reading(0.5 * (values[axle] + values[axle + 1U]));
}

/// Not available where no set point is known.
double target(const VehicleSample& sample, Axle axle) {
  const auto& targets = sample.tyre_pressure_target_pa;
  return targets[axle] != 0.0 && targets[axle + 1U] != 0.0 ? mean(targets, axle) : kNotAvailable;
}

std::uint8_t channel_mode(const VehicleSample& sample, Axle axle) {
  constexpr double kHeld_pa = 2e3;  // *ours*: nearer than this to its set point it is kept
  const double missing_pa = target(sample, axle) - mean(sample.tyre_pressure_pa, axle);
  const TyreChannelMode mode = !std::isfinite(missing_pa) ? TyreChannelMode::not_available
                               : missing_pa > kHeld_pa    ? TyreChannelMode::inflate
                               : missing_pa < -kHeld_pa   ? TyreChannelMode::deflate
                                                          : TyreChannelMode::maintain;
  return static_cast<std::uint8_t>(mode);
}

/// Of a gear pump with a relief valve. *Ours*: the simulation has no oil.
double oil_pressure_pa(double engine_speed_radps) {
  constexpr double kRelief_pa = 400e3;
  constexpr double kReliefSpeed_radps = 1200.0 * vehicle::kRevolutionPerMinute_radps;
  return kRelief_pa * std::clamp(engine_speed_radps / kReliefSpeed_radps, 0.0, 1.0);
}

}  // namespace

void VehicleReport::put_tyres(std::uint32_t pgn, std::uint8_t source, const VehicleSample* sample,
                              const VehicleControl& control) {
  if (!is<vehicle::Tire1>(pgn) && !is<vehicle::Tire2>(pgn) && !is<vehicle::Tpri>(pgn)) {
    return;
  }
  const auto& asked_pa = control.command().tyre_pressure_pa;
  for (std::size_t tyre = 0; tyre < kWheels; ++tyre) {
    const std::uint8_t location = vehicle::kTyreLocations[tyre];
    const double pressure_pa =
        sample != nullptr ? reading(sample->tyre_pressure_pa[tyre]) : kNotAvailable;
    const double reported_pa = sample != nullptr ? sample->tyre_pressure_target_pa[tyre] : 0.0;
    // What was just asked for has not yet come back with a sample.
    const double set_pa = asked_pa[tyre] != 0.0 ? asked_pa[tyre] : reported_pa;
    const double target_pa = set_pa != 0.0 ? reading(set_pa) : kNotAvailable;
    if (is<vehicle::Tire1>(pgn)) {
      vehicle::Tire1 message;
      message.location = location;
      message.pressure_pa = pressure_pa;
      message.extended_support = sample != nullptr ? Switch::on : Switch::not_available;
      put(message, source);
    } else if (is<vehicle::Tire2>(pgn)) {
      put(vehicle::Tire2{location, pressure_pa, target_pa}, source);
    } else {
      put(vehicle::Tpri{location, target_pa}, source);
    }
  }
}

void VehicleReport::put_channels(std::uint32_t pgn, std::uint8_t source,
                                 const VehicleSample* sample) {
  if (is<vehicle::Tp1>(pgn)) {
    vehicle::Tp1 message;
    if (sample != nullptr) {
      message.steer_mode = channel_mode(*sample, front_axle);
      message.drive_mode = channel_mode(*sample, rear_axle);
    }
    put(message, source);
  } else if (is<vehicle::Tp2>(pgn)) {
    vehicle::Tp2 message;
    if (sample != nullptr) {
      message.steer_pa = target(*sample, front_axle);
      message.drive_pa = target(*sample, rear_axle);
    }
    put(message, source);
  } else if (is<vehicle::Tp3>(pgn)) {
    vehicle::Tp3 message;
    if (sample != nullptr) {
      message.steer_pa = mean(sample->tyre_pressure_pa, front_axle);
      message.drive_pa = mean(sample->tyre_pressure_pa, rear_axle);
    }
    put(message, source);
  }
}

void VehicleReport::put_condition(std::uint32_t pgn, std::uint8_t source,
                                  const VehicleSample* sample) {
  if (is<vehicle::Eflp1>(pgn)) {
    vehicle::Eflp1 message;
    if (sample != nullptr) {
      message.oil_pressure_pa = reading(oil_pressure_pa(sample->engine_speed_radps));
    }
    put(message, source);
  } else if (is<vehicle::Et1>(pgn)) {
    put(vehicle::Et1{}, source);
  } else if (is<vehicle::Dd1>(pgn)) {
    put(vehicle::Dd1{}, source);
  } else if (is<vehicle::VehicleFluids>(pgn)) {
    put(vehicle::VehicleFluids{}, source);
  } else if (is<vehicle::Hours>(pgn)) {
    put(vehicle::Hours{engine_s_, engine_turns_}, source);
  }
}

}  // namespace rigwire::emulators

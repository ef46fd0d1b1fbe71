// Tyres, the channels of their inflation, and implements.
#include "emulators/j1939/reading.h"
#include "emulators/vehicle_gateway/report.h"

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

void VehicleReport::put_implements(std::uint32_t pgn, std::uint8_t source,
                                   const VehicleSample* sample, const VehicleControl& control) {
  const auto exit = static_cast<std::uint8_t>(control.implement_exit());
  const auto put_hitch = [&]<class Message>(ImplementEnd end) {
    Message message;
    if (sample != nullptr) {
      constexpr double kWorks = 0.5;  // below this height an implement is at work
      const HitchReading& hitch = sample->hitch[static_cast<std::size_t>(end)];
      message.position_share = reading(hitch.height_share);
      message.in_work = vehicle::to_switch(hitch.height_share < kWorks);
      message.limit_status = static_cast<std::uint8_t>(vehicle::LimitStatus::not_limited);
      message.exit_reason = exit;
    }
    put(message, source);
  };
  const auto put_shaft = [&]<class Message>(ImplementEnd end) {
    Message message;
    if (sample != nullptr) {
      constexpr std::uint8_t kAccepted = 0;
      constexpr std::uint8_t kOverridden = 1;
      const auto i = static_cast<std::size_t>(end);
      const PowerTakeOffReading& shaft = sample->power_take_off[i];
      const PowerTakeOffCommand& asked = control.command().power_take_off[i];
      message.speed_radps = reading(shaft.speed_radps);
      message.set_point_radps = asked.speed_radps.value_or(kNotAvailable);
      message.engaged = vehicle::to_switch(shaft.engaged);
      message.engagement_request = kAccepted;
      message.economy_request = control.economy_refused(end) ? kOverridden : kAccepted;
      message.mode_request = control.mode_refused(end) ? kOverridden : kAccepted;
      // The engine belongs to the travel speed while one is asked for.
      const bool limited = asked.speed_radps && control.command().travel_speed_mps;
      message.limit_status = static_cast<std::uint8_t>(
          limited ? vehicle::LimitStatus::operator_limited : vehicle::LimitStatus::not_limited);
      message.exit_reason = exit;
    }
    put(message, source);
  };
  if (is<vehicle::FrontHitchStatus>(pgn)) {
    put_hitch.operator()<vehicle::FrontHitchStatus>(ImplementEnd::front);
  } else if (is<vehicle::RearHitchStatus>(pgn)) {
    put_hitch.operator()<vehicle::RearHitchStatus>(ImplementEnd::rear);
  } else if (is<vehicle::FrontPowerTakeOffStatus>(pgn)) {
    put_shaft.operator()<vehicle::FrontPowerTakeOffStatus>(ImplementEnd::front);
  } else if (is<vehicle::RearPowerTakeOffStatus>(pgn)) {
    put_shaft.operator()<vehicle::RearPowerTakeOffStatus>(ImplementEnd::rear);
  }
}

}  // namespace rigwire::emulators

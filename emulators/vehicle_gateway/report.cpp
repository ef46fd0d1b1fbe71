#include "emulators/vehicle_gateway/report.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigwire::emulators {

namespace vehicle = protocols::vehicle;
using vehicle::is;
using vehicle::kNotAvailable;
using vehicle::magnitude;
using vehicle::reading;
using vehicle::Switch;
using vehicle::to_switch;
using vehicle::TyreChannelMode;

namespace {

constexpr double kBrakeApplied = 0.005;  // share above which the brake switch is on

/// Full turns of the steering wheel as they are counted on the wire: 32 is none.
std::uint8_t turns(double angle_rad) {
  constexpr double kNone = 32.0;
  const double counted = kNone + std::trunc(angle_rad / (2.0 * std::numbers::pi));
  return counted >= 0.0 && counted < 63.0 ? static_cast<std::uint8_t>(counted)
                                          : vehicle::code_not_available(6);
}

constexpr std::array kSchedule{
    VehicleReport::Entry{vehicle::Etc1::kGroup, 0},
    VehicleReport::Entry{vehicle::Vdc2::kGroup, 0},
    VehicleReport::Entry{vehicle::Sas::kGroup, 0},
    VehicleReport::Entry{vehicle::Hrw::kGroup, 0},
    VehicleReport::Entry{vehicle::Eec1::kGroup, 1},
    VehicleReport::Entry{vehicle::Esc1::kGroup, 1},
    VehicleReport::Entry{vehicle::Eec2::kGroup, 2},
    VehicleReport::Entry{vehicle::Hpg::kGroup, 4},
    VehicleReport::Entry{vehicle::GuidanceMachineInfo::kGroup, 0},
    VehicleReport::Entry{vehicle::MachineSelectedSpeed::kGroup, 1},
    VehicleReport::Entry{vehicle::WheelBasedSpeed::kGroup, 3},
    VehicleReport::Entry{vehicle::GroundBasedSpeed::kGroup, 7},
    VehicleReport::Entry{vehicle::RearHitchStatus::kGroup, 2},
    VehicleReport::Entry{vehicle::FrontHitchStatus::kGroup, 2},
    VehicleReport::Entry{vehicle::RearPowerTakeOffStatus::kGroup, 7},
    VehicleReport::Entry{vehicle::FrontPowerTakeOffStatus::kGroup, 7},
    VehicleReport::Entry{vehicle::Lfe1::kGroup, 4},
    VehicleReport::Entry{vehicle::Eec3::kGroup, 12},
    VehicleReport::Entry{vehicle::Ebc2::kGroup, 4},
    VehicleReport::Entry{vehicle::Ccvs1::kGroup, 5},
    VehicleReport::Entry{vehicle::Etc2::kGroup, 6},
    VehicleReport::Entry{vehicle::Ebc1::kGroup, 8},
    VehicleReport::Entry{vehicle::MachineFunctionState::kGroup, 9},
    VehicleReport::Entry{vehicle::Eac1::kGroup, 3},
    VehicleReport::Entry{vehicle::Eflp1::kGroup, 13},
    VehicleReport::Entry{vehicle::Et1::kGroup, 33},
    VehicleReport::Entry{vehicle::Dd1::kGroup, 53},
    VehicleReport::Entry{vehicle::VehicleFluids::kGroup, 73},
    VehicleReport::Entry{vehicle::Vep1::kGroup, 93},
    VehicleReport::Entry{vehicle::Tire1::kGroup, 30},
    VehicleReport::Entry{vehicle::Tire2::kGroup, 40},
    VehicleReport::Entry{vehicle::Tpri::kGroup, 0},
    VehicleReport::Entry{vehicle::Tp1::kGroup, 0},
    VehicleReport::Entry{vehicle::Tp2::kGroup, 0},
    VehicleReport::Entry{vehicle::Tp3::kGroup, 0},
    VehicleReport::Entry{vehicle::Hours::kGroup, 0},
    VehicleReport::Entry{vehicle::Lfc1::kGroup, 0},
};

constexpr std::uint64_t ticks(const vehicle::Group& group) {
  return static_cast<std::uint64_t>(group.period / VehicleReport::kTick);
}
static_assert(std::ranges::all_of(kSchedule, [](const VehicleReport::Entry& entry) {
  return entry.group.period % VehicleReport::kTick == Duration{0} &&
         (ticks(entry.group) == 0 || entry.phase < ticks(entry.group));
}));

/// What gear, brake and set point leave, or else what the machine can do.
vehicle::LimitStatus speed_limit(const VehicleSample& sample, const VehicleControl& control) {
  const vehicle::LimitStatus limit = control.speed_limit();
  if (limit != vehicle::LimitStatus::not_limited || !control.in_force(VehicleRequest::speed)) {
    return limit;
  }
  switch (sample.travel_limit) {
    case TravelLimit::none:
      return limit;
    case TravelLimit::power:
      return vehicle::LimitStatus::limited_high;
    case TravelLimit::braking:
      return vehicle::LimitStatus::limited_low;
  }
  return limit;
}

double speed_of(const VehicleSample& sample, std::size_t wheel) {
  return sample.wheel_rate_radps[wheel] * sample.wheel_radius_m[wheel];
}

enum Wheel : std::size_t { front_left, front_right, rear_left, rear_right };

constexpr double kRpm = vehicle::kRevolutionPerMinute_radps;
constexpr Quantity quantity(std::string_view name, const vehicle::Scale& scale,
                            std::uint8_t width) {
  return emulators::quantity(vehicle::number_signal(name, 0, {}, width, scale));
}
constexpr std::array kQuantities{
    quantity("wheel speed", vehicle::kWheelSpeed, 16),
    quantity("machine selected speed", vehicle::kMachineSpeed, 16),
    quantity("engine speed", vehicle::kShaftSpeed, 16),
    quantity("engine torque", vehicle::kTorqueShare, 8),
    quantity("shaft speed", vehicle::kShaftSpeed, 16),
    Quantity{"gear", "1", -125.0, 125.0, 1.0},
    Quantity{"gear ratio", "1", 0.0, 64.255, 0.001},
    quantity("brake", vehicle::kShare, 8),
    quantity("steering angle", vehicle::kMachineAngle, 16),
    quantity("curvature", vehicle::kCurvature, 16),
    quantity("slip angle", vehicle::kMachineAngle, 16),
    Quantity{"tyre pressure", "Pa", 0.0, 64.255e6, 1000.0},
    Quantity{"hydraulic pressure", "Pa", 0.0, 128.51e6, 2000.0},
    quantity("edge cutter", vehicle::kShare, 8),
    quantity("spreader rate", vehicle::kSpreaderRate, 16),
    Quantity{"hopper mass", "kg", 0.0, 64255.0, 1.0},
    Quantity{"requested engine speed", "rad/s", 0.0, 64255 * 0.125 * kRpm, 0.125 * kRpm},
    Quantity{"requested acceleration", "m/s2", -15.687, 15.687, 1.0 / 2048.0},
};

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

std::span<const VehicleReport::Entry> VehicleReport::schedule() {
  return kSchedule;
}

bool VehicleReport::is_due(const Entry& entry, std::uint64_t tick) {
  const std::uint64_t period = ticks(entry.group);
  return period != 0 && tick % period == entry.phase;
}

std::span<const Quantity> VehicleReport::quantities() {
  return kQuantities;
}

VehicleReport::VehicleReport(const VehicleGatewaySettings& settings)
    : settings_(settings), power_(settings), engine_(settings.engine, settings.engine_hours) {}

void VehicleReport::take(const VehicleSample& sample) {
  if (sample_ && std::isfinite(sample.odometry.speed_mps)) {
    distance_m_ += std::abs(sample.odometry.speed_mps) * to_seconds(sample.time - sample_->time);
  }
  if (sample_ && std::isfinite(sample.ground_speed_mps)) {
    ground_distance_m_ +=
        std::abs(sample.ground_speed_mps) * to_seconds(sample.time - sample_->time);
  }
  engine_.take(sample.time, sample.engine);
  sample_ = sample;
}

const VehicleSample* VehicleReport::fresh(SimTime now) const {
  return sample_ && now - sample_->time <= kStale ? &*sample_ : nullptr;
}

double VehicleReport::speed_mps(SimTime now) const {
  const VehicleSample* sample = fresh(now);
  return sample != nullptr ? sample->odometry.speed_mps : kNotAvailable;
}

bool VehicleReport::sends(const Entry& entry) const {
  const bool rear = is<vehicle::RearPowerTakeOffStatus>(entry.group.pgn);
  const bool shaft = rear || is<vehicle::FrontPowerTakeOffStatus>(entry.group.pgn);
  return count(entry.group.pgn) != 0 &&
         (!shaft || (sample_ && sample_->power_take_off[rear ? 1 : 0].engaged));
}

std::size_t VehicleReport::count(std::uint32_t pgn) const {
  if (is<vehicle::Tire1>(pgn) || is<vehicle::Tire2>(pgn) || is<vehicle::Tpri>(pgn)) {
    return kWheels;
  }
  const auto one = [](bool there) { return there ? std::size_t{1} : std::size_t{0}; };
  if (is<vehicle::GroundBasedSpeed>(pgn)) {
    return one(settings_.has_ground_radar);
  }
  if (is<vehicle::FrontHitchStatus>(pgn) || is<vehicle::RearHitchStatus>(pgn)) {
    return one(settings_.has_hitch[is<vehicle::RearHitchStatus>(pgn)]);
  }
  if (is<vehicle::FrontPowerTakeOffStatus>(pgn) || is<vehicle::RearPowerTakeOffStatus>(pgn)) {
    return one(settings_.has_power_take_off[is<vehicle::RearPowerTakeOffStatus>(pgn)]);
  }
  return is<vehicle::Esc1>(pgn) && settings_.steering != SteeringLayout::front_only ? 2 : 1;
}

std::span<const protocols::can::Frame> VehicleReport::frames(SimTime now, std::uint32_t pgn,
                                                             std::uint8_t source,
                                                             const VehicleControl& control) {
  frame_count_ = 0;
  if (count(pgn) == 0) {
    return {};
  }
  const VehicleSample* sample = fresh(now);
  if (const auto frame =
          engine_.frame(pgn, source, sample != nullptr ? &sample->engine : nullptr)) {
    frames_[frame_count_++] = *frame;
  }
  const Wanted wanted{now, pgn, source, sample, control};
  put_engine(wanted);
  put_gearbox(wanted);
  put_speed(wanted);
  put_steering(wanted);
  put_tyres(wanted);
  put_channels(wanted);
  put_machine(wanted);
  put_implements(wanted);
  return std::span(frames_).first(frame_count_);
}

void VehicleReport::put_engine(const Wanted& wanted) {
  const VehicleControl& control = wanted.control;
  // SPN 899: 0 no request, 3 a governor holds the speed, 11 remote accelerator.
  constexpr std::uint8_t kNoRequest = 0;
  constexpr std::uint8_t kGovernor = 3;
  constexpr std::uint8_t kRemoteAccelerator = 11;
  constexpr std::uint8_t kCruiseControl = 2;
  const VehicleCommand& command = control.command();
  const bool travels = command.travel_speed_mps.has_value();
  const bool by_speed = !travels && command.engine_control == EngineControl::speed;
  report<vehicle::Eec1>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.torque_mode = travels                             ? kCruiseControl
                          : by_speed                          ? kGovernor
                          : command.engine_torque_share > 0.0 ? kRemoteAccelerator
                                                              : kNoRequest;
    message.actual_torque_share = engine_.torque_share(sample.engine);
    message.demand_torque_share = by_speed || travels ? kNotAvailable : command.engine_torque_share;
    message.speed_radps = magnitude(sample.engine.speed_radps);
    // The idle governor asks, too.
    message.engine_demand_torque_share =
        by_speed || travels ? message.actual_torque_share
                            : std::max(command.engine_torque_share, message.actual_torque_share);
    message.controlling_address = control.requester(
        control.in_force(VehicleRequest::speed) ? VehicleRequest::speed : VehicleRequest::engine);
  });
  report<vehicle::Eec2>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.pedal_share = by_speed ? kNotAvailable : travels ? 0.0 : command.engine_torque_share;
    message.load_share = EngineReport::load_share(sample.engine);
  });
}

void VehicleReport::put_gearbox(const Wanted& wanted) {
  const VehicleControl& control = wanted.control;
  report<vehicle::Etc1>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.driveline_engaged = to_switch(sample.driveline_engaged);
    message.shift_in_process = to_switch(sample.shifting);
    message.output_shaft_radps = magnitude(sample.output_shaft_radps);
    message.clutch_slip_share = reading(sample.clutch_slip_share);
    message.input_shaft_radps = magnitude(sample.input_shaft_radps);
    message.controlling_address = control.requester(
        control.command().automatic_gear ? VehicleRequest::speed : VehicleRequest::gearbox);
  });
  report<vehicle::Etc2>(wanted, [&](auto& message, const VehicleSample& sample) {
    // Range: direction, then the group. This project's own letters.
    const auto direction = [](int gear) -> std::uint8_t {
      return gear == 0 ? 'N' : gear > 0 ? 'D' : 'R';
    };
    const auto group = [](bool crawler) -> std::uint8_t { return crawler ? 'C' : ' '; };
    message.selected_gear = vehicle::gear_code(sample.gear_requested);
    message.current_gear = vehicle::gear_code(sample.gear);
    message.ratio = sample.gear_ratio == 0.0 ? kNotAvailable : magnitude(sample.gear_ratio);
    message.requested_range_first = direction(sample.gear_requested);
    message.requested_range_second = group(control.command().crawler_group);
    message.current_range_first = direction(sample.gear);
    message.current_range_second = group(sample.crawler_group);
  });
  report<vehicle::Eac1>(wanted, [&](auto& message, const VehicleSample& sample) {
    const auto lock = [&sample](Differential differential) {
      return to_switch(sample.lock[static_cast<std::size_t>(differential)]);
    };
    message.front_lock_1 = lock(Differential::front);
    message.central_lock = lock(Differential::centre);
    message.rear_lock_1 = lock(Differential::rear);
  });
}

void VehicleReport::put_speed(const Wanted& wanted) {
  const VehicleControl& control = wanted.control;
  report<vehicle::Ebc2>(wanted, [&](auto& message, const VehicleSample& sample) {
    const double axle_mps = 0.5 * (speed_of(sample, front_left) + speed_of(sample, front_right));
    const double direction = axle_mps < 0.0 ? -1.0 : 1.0;
    const auto relative = [&](Wheel wheel) {
      return reading(direction * (speed_of(sample, wheel) - axle_mps));
    };
    message.front_axle_mps = magnitude(axle_mps);
    message.front_left_mps = relative(front_left);
    message.front_right_mps = relative(front_right);
    message.rear_1_left_mps = relative(rear_left);
    message.rear_1_right_mps = relative(rear_right);
  });
  report<vehicle::Hrw>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.front_left_mps = magnitude(speed_of(sample, front_left));
    message.front_right_mps = magnitude(speed_of(sample, front_right));
    message.rear_left_mps = magnitude(speed_of(sample, rear_left));
    message.rear_right_mps = magnitude(speed_of(sample, rear_right));
  });
  report<vehicle::Ccvs1>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.parking_brake = to_switch(sample.parking_brake);
    message.wheel_based_speed_mps = magnitude(sample.odometry.speed_mps);
    message.brake_switch = to_switch(sample.brake_share > kBrakeApplied);
    if (control.in_force(VehicleRequest::speed)) {
      message.set_speed_mps = std::abs(control.command().travel_speed_mps.value_or(0.0));
    }
  });
  report<vehicle::Ebc1>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.pedal_share = reading(sample.brake_share);
  });
  const auto by_wheels = [&](auto& message, const VehicleSample& sample) {
    message.speed_mps = magnitude(sample.odometry.speed_mps);
    message.distance_m = distance_m_;
    message.forward = std::isfinite(sample.odometry.speed_mps)
                          ? to_switch(sample.odometry.speed_mps >= 0.0)
                          : Switch::error;
  };
  report<vehicle::MachineSelectedSpeed>(wanted, [&](auto& message, const VehicleSample& sample) {
    by_wheels(message, sample);
    message.source = static_cast<std::uint8_t>(vehicle::SpeedSource::wheel_based);
    message.limit_status = static_cast<std::uint8_t>(speed_limit(sample, control));
    message.exit_reason = static_cast<std::uint8_t>(control.speed_exit());
  });
  if (is<vehicle::WheelBasedSpeed>(wanted.pgn)) {
    vehicle::WheelBasedSpeed message;
    if (wanted.sample != nullptr) {
      by_wheels(message, *wanted.sample);
    }
    // No operator sits there who could start implements; he would look ahead.
    message.power_time_s = to_seconds(power_.longest(wanted.now));
    message.key_switch = to_switch(power_.key_on(wanted.now));
    message.operator_reversed = Switch::off;
    put(message, wanted.source);
  }
  report<vehicle::GroundBasedSpeed>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.speed_mps = magnitude(sample.ground_speed_mps);
    message.distance_m = ground_distance_m_;
    // A radar does not see which way: the wheels do.
    if (std::isfinite(sample.odometry.speed_mps)) {
      message.forward = to_switch(sample.odometry.speed_mps >= 0.0);
    }
  });
}

// Encodes the steering messages. Steering wheel angle = front steering angle * steering ratio; the
// turn counters are derived from it.
void VehicleReport::put_steering(const Wanted& wanted) {
  const VehicleControl& control = wanted.control;
  const auto wheel_rad = [this](const VehicleSample& sample) {
    return sample.front_steer_rad * settings_.steering_ratio;
  };
  report<vehicle::Vdc2>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.steering_wheel_rad = reading(wheel_rad(sample));
    message.turn_counter = turns(wheel_rad(sample));
  });
  report<vehicle::Sas>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.steering_wheel_rad = reading(wheel_rad(sample));
    message.range_counter = turns(wheel_rad(sample));
    message.active = Switch::on;
    message.calibrated = Switch::on;
    message.counter = sensor_counter_;
    sensor_counter_ = (sensor_counter_ + 1U) & 0xFU;
  });
  if (is<vehicle::Esc1>(wanted.pgn)) {
    const VehicleSample* const sample = wanted.sample;
    put(vehicle::Esc1{sample != nullptr ? reading(sample->front_steer_rad) : kNotAvailable,
                      vehicle::kFrontAxle},
        wanted.source);
    if (settings_.steering != SteeringLayout::front_only) {
      put(vehicle::Esc1{sample != nullptr ? reading(sample->rear_steer_rad) : kNotAvailable,
                        vehicle::kRearAxle},
          wanted.source);
    }
  }
  report<vehicle::GuidanceMachineInfo>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.curvature_1pm = reading(sample.odometry.curvature_1pm);
    message.lockout = Switch::off;
    message.ready = to_switch(!control.guidance_needs_reset());
    message.input_position_correct = Switch::on;
    message.reset_required = to_switch(control.guidance_needs_reset());
    message.limit_status = static_cast<std::uint8_t>(control.guidance_limit());
    message.exit_reason = static_cast<std::uint8_t>(control.guidance_exit());
  });
}

void VehicleReport::put_machine(const Wanted& wanted) {
  report<vehicle::Hpg>(wanted, [](auto& message, const VehicleSample& sample) {
    message.pressure_pa = reading(sample.hydraulic_pressure_pa);
  });
  report<vehicle::VehicleFluids>(wanted, [](auto&, const VehicleSample&) {});
  report<vehicle::MachineFunctionState>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.parking_brake = to_switch(sample.parking_brake);
    message.crawler_group = to_switch(sample.crawler_group);
    message.vibration_front = to_switch(sample.vibration[0]);
    message.vibration_rear = to_switch(sample.vibration[1]);
    message.edge_cutter_share = reading(sample.edge_cutter_share);
    message.spreader_rate_kgpm2 = reading(sample.spreader_rate_kgpm2);
    message.hopper_mass_kg = reading(sample.hopper_mass_kg);
    message.slip_angle_rad = reading(sample.odometry.slip_angle_rad);
  });
}

// Tyres, the channels of their inflation, and implements.

void VehicleReport::put_tyres(const Wanted& wanted) {
  const std::uint32_t pgn = wanted.pgn;
  const VehicleSample* const sample = wanted.sample;
  if (!is<vehicle::Tire1>(pgn) && !is<vehicle::Tire2>(pgn) && !is<vehicle::Tpri>(pgn)) {
    return;
  }
  const auto& asked_pa = wanted.control.command().tyre_pressure_pa;
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
      put(message, wanted.source);
    } else if (is<vehicle::Tire2>(pgn)) {
      put(vehicle::Tire2{location, pressure_pa, target_pa}, wanted.source);
    } else {
      put(vehicle::Tpri{location, target_pa}, wanted.source);
    }
  }
}

void VehicleReport::put_channels(const Wanted& wanted) {
  report<vehicle::Tp1>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.steer_mode = channel_mode(sample, front_axle);
    message.drive_mode = channel_mode(sample, rear_axle);
  });
  report<vehicle::Tp2>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.steer_pa = target(sample, front_axle);
    message.drive_pa = target(sample, rear_axle);
  });
  report<vehicle::Tp3>(wanted, [&](auto& message, const VehicleSample& sample) {
    message.steer_pa = mean(sample.tyre_pressure_pa, front_axle);
    message.drive_pa = mean(sample.tyre_pressure_pa, rear_axle);
  });
}

void VehicleReport::put_implements(const Wanted& wanted) {
  const VehicleControl& control = wanted.control;
  const auto exit = static_cast<std::uint8_t>(control.implement_exit());
  const auto put_hitch = [&]<class Message>(ImplementEnd end) {
    report<Message>(wanted, [&](Message& message, const VehicleSample& sample) {
      constexpr double kWorks = 0.5;  // below this height an implement is at work
      const HitchReading& hitch = sample.hitch[static_cast<std::size_t>(end)];
      message.position_share = reading(hitch.height_share);
      message.in_work = vehicle::to_switch(hitch.height_share < kWorks);
      message.limit_status = static_cast<std::uint8_t>(vehicle::LimitStatus::not_limited);
      message.exit_reason = exit;
    });
  };
  const auto put_shaft = [&]<class Message>(ImplementEnd end) {
    report<Message>(wanted, [&](Message& message, const VehicleSample& sample) {
      constexpr std::uint8_t kAccepted = 0;
      constexpr std::uint8_t kOverridden = 1;
      const auto i = static_cast<std::size_t>(end);
      const PowerTakeOffReading& shaft = sample.power_take_off[i];
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
    });
  };
  put_hitch.operator()<vehicle::FrontHitchStatus>(ImplementEnd::front);
  put_hitch.operator()<vehicle::RearHitchStatus>(ImplementEnd::rear);
  put_shaft.operator()<vehicle::FrontPowerTakeOffStatus>(ImplementEnd::front);
  put_shaft.operator()<vehicle::RearPowerTakeOffStatus>(ImplementEnd::rear);
}

}  // namespace rigwire::emulators

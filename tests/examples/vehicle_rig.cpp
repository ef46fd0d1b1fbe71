#include "vehicle_rig.h"

#include <cmath>
#include <utility>

#include "path_follow/speed_control.h"
#include "protocols/nmea/writers.h"
#include "protocols/openimu/messages.h"

namespace rigwire::field {
namespace {

namespace nmea = protocols::nmea;
namespace openimu = protocols::openimu;
using namespace std::chrono_literals;

constexpr auto kStep = 10ms;
constexpr double kStep_s = 0.01;
constexpr std::uint8_t kImu = 0x80;
constexpr double kWheelRadius_m = 0.5;
constexpr double kFullBrake_mps2 = 6.0;

emulators::VehicleGatewaySettings settings(VehicleRig::Kind kind) {
  emulators::VehicleGatewaySettings settings;
  settings.source_address = 0x27;
  if (kind == VehicleRig::Kind::roller) {
    settings.steering = emulators::SteeringLayout::crab;
    settings.wheelbase_m = 3.4;
    settings.maximum_front_steer_rad = settings.maximum_rear_steer_rad = 0.5236;
  } else {
    settings.wheelbase_m = 3.85;
  }
  return settings;
}

}  // namespace

VehicleRig::VehicleRig(std::filesystem::path directory, Kind kind)
    : directory_(std::move(directory)),
      kind_(kind),
      gnss_(context_, directory_ / "gnss"),
      can_line_(context_, directory_ / "can"),
      can_(can_line_, 250'000) {
  gateway_ = std::make_unique<emulators::VehicleGateway>(
      settings(kind), static_cast<emulators::FrameOutput&>(*this));
  if (kind == Kind::roller) {
    plant.wheelbase_m = 3.4;
    plant.reference_m = 1.7;
  }
  plant.speed_lag_s = 0.3;
  gnss_.start([](std::span<const std::uint8_t>) {});
  can_.start([this](const protocols::can::Frame& frame) { gateway_->receive(now(), frame); });
}

VehicleRig::~VehicleRig() = default;

std::vector<std::string> VehicleRig::arguments() const {
  return {"--gnss",     (directory_ / "gnss").string(),
          "--can",      (directory_ / "can").string(),
          "--gnss-age", "0"};
}

SimTime VehicleRig::now() const {
  return kStart + std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now() - started_);
}

void VehicleRig::send(SimTime /*due*/, const protocols::can::Frame& frame) {
  if (!mute.gateway) {
    (void)can_.send(frame);
  }
}

void VehicleRig::poll() {
  context_.restart();
  context_.run_one_for(2ms);
  context_.poll();
  while (kStart + kStep * (steps_ + 1) <= now()) {
    ++steps_;
    step();
  }
  gateway_->advance(now());
}

void VehicleRig::obey(const VehicleCommand& command) {
  gear_ = command.gear;
  parking_brake_ = command.parking_brake;
  plant.brake_mps2 = parking_brake_ ? kFullBrake_mps2 : command.brake_share * kFullBrake_mps2;
  plant.wish_mps = 0.0;
  if (kind_ == Kind::roller) {
    plant.wish_mps = command.travel_speed_mps.value_or(0.0);
  } else if (gear_ > 0 && command.engine_control == EngineControl::speed &&
             command.engine_speed_radps > 80.0) {
    const path_follow::SpeedControlSettings drive;
    plant.wish_mps =
        command.engine_speed_radps / drive.engine_per_speed[static_cast<std::size_t>(gear_ - 1)];
  }
}

VehicleSample VehicleRig::sample() const {
  VehicleSample sample;
  sample.time = now();
  sample.gear = sample.gear_requested = gear_;
  sample.parking_brake = parking_brake_;
  sample.wheel_radius_m.fill(kWheelRadius_m);
  sample.wheel_rate_radps.fill(plant.speed_mps / kWheelRadius_m);
  sample.front_steer_rad = plant.front_rad;
  sample.rear_steer_rad = plant.rear_rad;
  sample.engine.speed_radps = 100.0;
  sample.odometry = {plant.speed_mps * std::cos(plant.slip_rad), 0.0, plant.slip_rad};
  return sample;
}

void VehicleRig::step() {
  const VehicleCommand& command = gateway_->command();
  obey(command);
  plant.step_angles(kStep_s, command.front_steer_rad, command.rear_steer_rad);
  plant.move(kStep_s);
  gateway_->update(sample());
  if (!mute.imu) {
    openimu::AngularRate rate;
    rate.yaw_dps = -plant.yaw_rate_radps / kDegree;
    (void)can_.send(openimu::encode(rate, kImu));
  }
  if (!mute.gnss && steps_ % 20 == 0) {
    send_gnss();
  }
}

void VehicleRig::send_gnss() {
  nmea::Epoch epoch;
  epoch.time = nmea::TimeOfDay{8, 0, 0, 0};
  epoch.date = nmea::Date{2026, 6, 1};
  epoch.fix_dimensions = 3;
  const LatLon place = plane_.to_geodetic(plant.position);
  epoch.latitude_deg = place.latitude_deg;
  epoch.longitude_deg = place.longitude_deg;
  epoch.satellites_used = 9;
  epoch.ground_speed_mps = std::abs(plant.speed_mps);
  const double back = plant.speed_mps < 0.0 ? 180.0 : 0.0;
  const double course = turned_compass(plant.heading_rad + plant.slip_rad) / kDegree + back;
  epoch.course_deg = course < 0.0 ? course + 360.0 : course;
  (void)gnss_.write(nmea::write_rmc(epoch).bytes());
  (void)gnss_.write(nmea::write_gga(epoch).bytes());
}

}  // namespace rigwire::field

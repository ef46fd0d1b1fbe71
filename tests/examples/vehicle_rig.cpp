#include "vehicle_rig.h"

#include <array>
#include <cmath>
#include <utility>

#include "path_follow/speed_control.h"
#include "private_wires.h"
#include "protocols/nmea/writers.h"
#include "protocols/openimu/messages.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"

namespace rigwire::field {
namespace {

namespace nmea = protocols::nmea;
namespace openimu = protocols::openimu;
namespace velodyne = protocols::velodyne;
using namespace std::chrono_literals;

constexpr auto kStep = 10ms;
constexpr double kStep_s = 0.01;
constexpr std::uint8_t kImu = 0x80;
constexpr double kWheelRadius_m = 0.5;
constexpr double kFullBrake_mps2 = 6.0;
// The lidar over the front axle, path_follow's default.
constexpr double kLidarAhead_m = 4.2;
constexpr double kLidarHeight_m = 3.1;

emulators::VehicleGatewaySettings settings(VehicleRig::Kind kind) {
  emulators::VehicleGatewaySettings settings;
  settings.source_address = 0x27;
  // What is tried is the program: a busy host may hold it up, or be late to see that it has ended.
  settings.timeouts = {1s, 1s, 1s, 1s, 1s, 1s};
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
      can_(can_line_, 250'000),
      lidar_port_(test::free_port(SOCK_DGRAM)),
      lidar_(context_, {.destination = drivers::UdpEndpoint{.port = lidar_port_}}) {
  gateway_ = std::make_unique<emulators::VehicleGateway>(
      settings(kind), static_cast<emulators::FrameOutput&>(*this));
  if (kind == Kind::roller) {
    plant.wheelbase_m = 3.4;
    plant.reference_m = 1.7;
  }
  plant.speed_lag_s = 0.3;
  gnss_.start([](std::span<const std::uint8_t>) {});
  can_.start([this](const protocols::can::Frame& frame) {
    clock_.heard();
    gateway_->receive(now(), frame);
  });
}

VehicleRig::~VehicleRig() = default;

std::vector<std::string> VehicleRig::arguments() const {
  return {"--gnss",     (directory_ / "gnss").string(),
          "--can",      (directory_ / "can").string(),
          "--gnss-age", "0"};
}

std::vector<std::string> VehicleRig::lidar_arguments() const {
  return {"--lidar-port", std::to_string(lidar_port_)};
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
  if (!mute.lidar) {
    send_lidar();
  }
}

/// Along a ray, to the trunk or to level ground; 0: to neither.
double VehicleRig::range_m(double azimuth_rad, double elevation_rad) const {
  const double ground_m = elevation_rad < -0.02 ? kLidarHeight_m / std::sin(-elevation_rad) : 0.0;
  if (!trunk) {
    return ground_m;
  }
  const double dx = trunk->place.east_m - plant.position.east_m;
  const double dy = trunk->place.north_m - plant.position.north_m;
  const double c = std::cos(plant.heading_rad);
  const double s = std::sin(plant.heading_rad);
  const double ahead = c * dx + s * dy - kLidarAhead_m;
  const double left = -s * dx + c * dy;
  // Azimuths run clockwise.
  const double along = ahead * std::cos(azimuth_rad) - left * std::sin(azimuth_rad);
  const double aside = ahead * std::sin(azimuth_rad) + left * std::cos(azimuth_rad);
  if (along < 0.0 || std::abs(aside) > trunk->radius_m) {
    return ground_m;
  }
  const double level = along - std::sqrt(trunk->radius_m * trunk->radius_m - aside * aside);
  const double range = level / std::cos(elevation_rad);
  return ground_m > 0.0 && ground_m < range ? ground_m : range;
}

void VehicleRig::send_lidar() {
  // A tenth of a window from 330 to 30 degrees.
  const velodyne::Model& model = *velodyne::find_model("HDL-32E");
  velodyne::DataPacket packet;
  packet.return_mode_byte = 0x37;
  packet.product_id = model.product_id;
  packet.timestamp_us = static_cast<std::uint32_t>(steps_ * 10'000);
  for (std::size_t b = 0; b < velodyne::kBlocksPerPacket; ++b) {
    velodyne::Block& block = packet.blocks[b];
    const auto count = static_cast<int>((steps_ % 10) * velodyne::kBlocksPerPacket + b);
    block.azimuth_counts = static_cast<std::uint16_t>((33000 + 50 * count) % 36000);
    for (std::size_t laser = 0; laser < model.lasers.size(); ++laser) {
      const double range = range_m(block.azimuth_counts * 0.01 * kDegree,
                                   model.lasers[laser].elevation_deg * kDegree);
      block.channels[laser] = {
          static_cast<std::uint16_t>(range < 70.0 ? range * 1000.0 / model.distance_unit_mm : 0.0),
          50};
    }
  }
  std::array<std::uint8_t, velodyne::kDataPacketSize> bytes{};
  velodyne::encode(packet, bytes);
  (void)lidar_.send(bytes);
}

void VehicleRig::send_gnss() {
  nmea::Epoch epoch;
  epoch.time = nmea::TimeOfDay{8, 0, 0, 0};
  epoch.date = nmea::Date{2026, 6, 1};
  epoch.fix_dimensions = 3;
  epoch.differential = differential;
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

#include "fake_rig.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "private_wires.h"
#include "protocols/nmea/writers.h"
#include "protocols/openimu/messages.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"

namespace rigwire::dig_cycle {
namespace {

namespace velodyne = protocols::velodyne;
namespace openimu = protocols::openimu;
namespace nmea = protocols::nmea;
using namespace std::chrono_literals;

constexpr auto kStep = 10ms;
constexpr double kFakeRigStep_s = 0.01;
constexpr double kFakeRigGravity_mps2 = 9.80665;
/// At full opening; faster than a real machine, to keep the tests short.
constexpr PerJoint kFullSpeed_radps{2.0, 0.9, 1.2, 1.8};
constexpr double kChassisPitch_rad = 2.0 * kDegree;

}  // namespace

FakeRig::FakeRig(std::filesystem::path directory)
    : directory_(std::move(directory)),
      gnss_(context_, directory_ / "gnss"),
      can_line_(context_, directory_ / "can"),
      can_(can_line_, 250'000),
      lidar_port_(test::free_port(SOCK_DGRAM)),
      lidar_(context_, {.destination = drivers::UdpEndpoint{.port = lidar_port_}}),
      server_(context_, {.port = 0}) {
  modbus_.add_unit(1, valves_.unit());
  gnss_.start([](std::span<const std::uint8_t>) {});
  can_.start([](const protocols::can::Frame&) {});
  server_.start({.connected = [this](auto id) { modbus_.connected(now(), id); },
                 .received =
                     [this](auto id, auto bytes) {
                       clock_.heard();
                       modbus_.receive(now(), id, bytes);
                     },
                 .disconnected = [this](auto id) { modbus_.disconnected(now(), id); }});
}

FakeRig::~FakeRig() = default;

std::vector<std::string> FakeRig::arguments() const {
  return {"--gnss",        (directory_ / "gnss").string(),
          "--can",         (directory_ / "can").string(),
          "--lidar-port",  std::to_string(lidar_port_),
          "--modbus",      "127.0.0.1:" + std::to_string(server_.port()),
          "--lidar-mount", "0.5,0,3.4,0,0"};
}

void FakeRig::send(emulators::ConnectionId connection, SimTime /*due*/,
                   std::span<const std::uint8_t> bytes) {
  (void)server_.send(connection, bytes);
}

void FakeRig::close(emulators::ConnectionId connection, SimTime /*due*/) {
  server_.close(connection);
}

bool FakeRig::neutral() const {
  const auto& opening = valves_.command().opening;
  return std::all_of(opening.begin(), opening.end(), [](double value) { return value == 0.0; });
}

void FakeRig::poll() {
  context_.restart();
  context_.run_one_for(2ms);
  context_.poll();
  while (kStart + kStep * (steps_ + 1) <= now()) {
    ++steps_;
    step();
  }
  valves_.advance(now());
}

void FakeRig::step() {
  const Machine machine;
  const ValveCommand& command = valves_.command();
  ValveSample sample;
  sample.time = now();
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    rates_radps_[joint] =
        command.opening[joint] * machine.opening_sign[joint] * kFullSpeed_radps[joint];
    const double wanted_rad = angles_rad_[joint] + rates_radps_[joint] * kFakeRigStep_s;
    const double stopped_rad =
        std::clamp(wanted_rad, machine.lower_rad[joint], machine.upper_rad[joint]);
    rates_radps_[joint] = (stopped_rad - angles_rad_[joint]) / kFakeRigStep_s;
    angles_rad_[joint] = stopped_rad;
    sample.spool_position[joint] = command.opening[joint];
  }
  sample.swing_angle_rad = angles_rad_[swing];
  sample.swing_rate_radps = rates_radps_[swing];
  if (!mute.transducers) {
    valves_.update(sample);
  }
  send_imus();
  if (!mute.lidar) {
    send_lidar();
  }
  if (!mute.gnss && steps_ % 20 == 0) {
    send_gnss();
  }
}

void FakeRig::send_imus() {
  double pitch_rad = kChassisPitch_rad;
  double rate_radps = 0.0;
  for (std::size_t link = 0; link < kLinks; ++link) {
    if (link > 0) {
      pitch_rad += angles_rad_[link];  // joints and links have the same order
      rate_radps += rates_radps_[link];
    }
    if (mute.imu[link]) {
      continue;
    }
    const auto source = static_cast<std::uint8_t>(0x80 + link);
    openimu::AngularRate rate;
    rate.pitch_dps = rate_radps / kDegree;
    openimu::Acceleration acceleration;
    acceleration.longitudinal_mps2 = kFakeRigGravity_mps2 * std::sin(pitch_rad);
    acceleration.vertical_mps2 = kFakeRigGravity_mps2 * std::cos(pitch_rad);
    (void)can_.send(openimu::encode(rate, source));
    (void)can_.send(openimu::encode(acceleration, source));
  }
}

void FakeRig::send_lidar() {
  // A tenth of a revolution over level ground, 3.4 m below the sensor.
  const velodyne::Model& model = *velodyne::find_model("HDL-32E");
  velodyne::DataPacket packet;
  packet.return_mode_byte = 0x37;
  packet.product_id = model.product_id;
  packet.timestamp_us = static_cast<std::uint32_t>(steps_ * 10'000);
  for (std::size_t b = 0; b < velodyne::kBlocksPerPacket; ++b) {
    velodyne::Block& block = packet.blocks[b];
    block.azimuth_counts = static_cast<std::uint16_t>((steps_ * 3600 + b * 300) % 36000);
    for (std::size_t laser = 0; laser < model.lasers.size(); ++laser) {
      const double down = -std::sin(model.lasers[laser].elevation_deg * kDegree);
      const double range_m = down > 0.03 ? 3.4 / down : 0.0;
      block.channels[laser] = {
          static_cast<std::uint16_t>(range_m * 1000.0 / model.distance_unit_mm), 50};
    }
  }
  std::array<std::uint8_t, velodyne::kDataPacketSize> bytes{};
  velodyne::encode(packet, bytes);
  truth_.push_back({packet.timestamp_us, angles_rad_});
  (void)lidar_.send(bytes);
}

void FakeRig::send_gnss() {
  nmea::Epoch epoch;
  epoch.time = nmea::TimeOfDay{8, 0, 0, 0};
  epoch.date = nmea::Date{2026, 6, 1};
  epoch.fix_dimensions = 3;
  epoch.latitude_deg = latitude_deg();
  epoch.longitude_deg = 7.75;
  epoch.altitude_m = 250.0;
  epoch.satellites_used = 9;
  (void)gnss_.write(nmea::write_rmc(epoch).bytes());
  (void)gnss_.write(nmea::write_gga(epoch).bytes());
}

}  // namespace rigwire::dig_cycle

// A rig for tests of driving programs: a vehicle without dynamics behind the emulated gateway, an
// exact receiver and yaw gyroscope, on real wires of this host. Each can be muted.
#pragma once

#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/pty.h"
#include "drivers/slcan_adapter.h"
#include "drivers/udp_socket.h"
#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "field/geometry.h"
#include "rig_clock.h"
#include "vehicle_plant.h"

namespace rigwire::field {

class VehicleRig : private emulators::FrameOutput {
 public:
  enum class Kind { truck, roller };

  VehicleRig(std::filesystem::path directory, Kind kind);
  ~VehicleRig() override;

  /// The command line that connects a program to this rig.
  [[nodiscard]] std::vector<std::string> arguments() const;
  /// What connects it to the lidar, too.
  [[nodiscard]] std::vector<std::string> lidar_arguments() const;
  /// Lives up to the present; call often.
  void poll();

  struct Mute {
    bool gnss = false;
    bool imu = false;
    bool gateway = false;
    bool lidar = false;
  };
  /// On level ground, for the lidar.
  struct Trunk {
    PlanePosition place;
    double radius_m = 0.2;
  };
  std::optional<Trunk> trunk;
  Mute mute;
  /// Whether the machine stands while its program is held up.
  void wait_for_client(bool on) { clock_.waits_for_client = on; }
  bool differential = false;  ///< Whether the receiver's positions are differential.
  VehiclePlant plant;

  [[nodiscard]] const emulators::VehicleGateway& gateway() const { return *gateway_; }
  [[nodiscard]] bool moving() const { return std::abs(plant.speed_mps) > 0.3; }
  [[nodiscard]] bool parked() const {
    return std::abs(plant.speed_mps) < 0.01 && gateway_->command().parking_brake;
  }
  [[nodiscard]] const LocalPlane& plane() const { return plane_; }

 private:
  void send(SimTime due, const protocols::can::Frame& frame) override;
  [[nodiscard]] SimTime now() const { return clock_.now(); }
  void step();
  void obey(const VehicleCommand& command);
  [[nodiscard]] VehicleSample sample() const;
  void send_gnss();
  void send_lidar();
  [[nodiscard]] double range_m(double azimuth_rad, double elevation_rad) const;

  std::filesystem::path directory_;
  Kind kind_;
  boost::asio::io_context context_;
  drivers::Pty gnss_;
  drivers::Pty can_line_;
  drivers::SlcanAdapter can_;
  std::uint16_t lidar_port_;
  drivers::UdpSocket lidar_;
  std::unique_ptr<emulators::VehicleGateway> gateway_;
  LocalPlane plane_{{49.4247, 7.7517}};
  mutable test::RigClock clock_;
  std::uint64_t steps_ = 0;
  int gear_ = 0;
  bool parking_brake_ = true;
};

}  // namespace rigwire::field

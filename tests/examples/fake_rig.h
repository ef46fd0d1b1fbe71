// A rig for tests of field programs: an arm that follows its valves without dynamics, and its
// devices on real wires of this host. The sensors tell gravity and rates exactly; each can be
// muted.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dig_cycle/estimator.h"
#include "dig_cycle/machine.h"
#include "drivers/pty.h"
#include "drivers/slcan_adapter.h"
#include "drivers/tcp_server.h"
#include "drivers/udp_socket.h"
#include "emulators/modbus/modbus_server.h"
#include "emulators/valve_driver/valve_driver.h"
#include "rig_clock.h"

namespace rigwire::dig_cycle {

struct TruthEntry {
  std::uint32_t time_of_hour_us = 0;
  PerJoint angles_rad{};
};

class FakeRig : private emulators::StreamOutput {
 public:
  explicit FakeRig(std::filesystem::path directory);
  ~FakeRig() override;

  /// The command line that connects a dig_cycle to this rig.
  [[nodiscard]] std::vector<std::string> arguments() const;
  /// Lives up to the present; call often.
  void poll();

  struct Mute {
    bool gnss = false;
    bool lidar = false;
    std::array<bool, kLinks> imu{};
    bool transducers = false;
  };
  Mute mute;
  /// Whether the machine stands while its program is held up.
  void wait_for_client(bool on) { clock_.waits_for_client = on; }

  [[nodiscard]] const emulators::ValveDriver& valves() const { return valves_; }
  [[nodiscard]] const PerJoint& angles_rad() const { return angles_rad_; }
  [[nodiscard]] const std::vector<TruthEntry>& truth() const { return truth_; }
  [[nodiscard]] static constexpr double latitude_deg() { return 49.42; }
  /// Openings that the valves hold are all neutral.
  [[nodiscard]] bool neutral() const;

 private:
  void send(emulators::ConnectionId connection, SimTime due,
            std::span<const std::uint8_t> bytes) override;
  void close(emulators::ConnectionId connection, SimTime due) override;
  [[nodiscard]] SimTime now() const { return clock_.now(); }
  void step();
  void send_imus();
  void send_lidar();
  void send_gnss();

  std::filesystem::path directory_;
  boost::asio::io_context context_;
  drivers::Pty gnss_;
  drivers::Pty can_line_;
  drivers::SlcanAdapter can_;
  std::uint16_t lidar_port_;
  drivers::UdpSocket lidar_;
  drivers::TcpServer server_;
  emulators::ModbusServer modbus_{{}, *this};
  emulators::ValveDriver valves_{{}};
  mutable test::RigClock clock_;
  std::uint64_t steps_ = 0;
  PerJoint angles_rad_{0.2, 30.0 * kDegree, -90.0 * kDegree, 0.0};
  PerJoint rates_radps_{};
  std::vector<TruthEntry> truth_;
};

}  // namespace rigwire::dig_cycle

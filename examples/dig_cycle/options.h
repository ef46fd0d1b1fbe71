// The command line of the dig cycle.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "dig_cycle/cycle.h"
#include "dig_cycle/imu_wire.h"
#include "dig_cycle/surroundings.h"
#include "field/option_parser.h"

namespace rigwire::dig_cycle {

using field::UsageError;

struct Options {
  std::string gnss = "/tmp/rigwire/gnss";
  std::uint32_t gnss_baud = 115200;
  std::string lidar_address = "127.0.0.1";
  std::uint16_t lidar_port = 2368;
  std::string can = "auto";
  std::string modbus_host = "127.0.0.1";
  std::uint16_t modbus_port = 1502;
  std::string modbus_path;  ///< Device of a serial line; empty: TCP.
  std::uint32_t modbus_baud = 115200;
  std::string log;                       ///< Empty: no log.
  std::chrono::nanoseconds duration{0};  ///< 0: for ever.
  bool wait = false;
  bool quiet = false;
  bool help = false;
  ImuWireSettings imu;
  LidarMount lidar_mount = kRoofMount;
  CycleSettings cycle;
};

/// `arguments` without the program's name. Throws UsageError.
[[nodiscard]] Options parse_options(std::span<const std::string_view> arguments);
[[nodiscard]] std::string_view usage();

}  // namespace rigwire::dig_cycle

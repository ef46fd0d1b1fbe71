// The program between the wires and the decisions: waits until every sensor is alive, works, and
// stops safely.
//
//   waiting --all alive--> working --a sensor silent--> stopped (status 4), or holding with --wait
//   holding --all alive--> working        any --interrupt, time over--> stopped (status 0)
//   working --cycles done--> stopped (0)  --machine does not follow, valve fault--> stopped (1)
//
// Outside `working` the valves are commanded neutral and disabled.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "dig_cycle/cycle.h"
#include "dig_cycle/estimator.h"
#include "dig_cycle/imu_wire.h"
#include "dig_cycle/lidar_wire.h"
#include "dig_cycle/options.h"
#include "dig_cycle/sensor_watch.h"
#include "dig_cycle/surroundings.h"
#include "dig_cycle/valve_wire.h"
#include "drivers/serial_port.h"
#include "drivers/udp_socket.h"
#include "field/can_wire.h"
#include "field/gnss_wire.h"
#include "field/json_line.h"

namespace rigwire::dig_cycle {

using field::exit_done;
using field::exit_machine;
using field::exit_silent_sensor;
using field::exit_usage;
using field::exit_wire;

class Program {
 public:
  static constexpr std::chrono::milliseconds kControlPeriod{25};

  /// Opens the wires. Throws drivers::EndpointError, std::invalid_argument or std::runtime_error.
  Program(boost::asio::io_context& context, const Options& options);

  /// Returns the exit status.
  int run();

 private:
  using Clock = std::chrono::steady_clock;
  enum class State : std::uint8_t { waiting, working, holding };

  void control();
  void tend_wires();
  void take_valves();
  void work(double step_s);
  void stop(int status, const std::string& why);
  void say(const std::string& text) const;
  /// What the bucket that goes to the truck weighs.
  [[nodiscard]] std::string weight_to_say() const;
  /// What it believes, one JSON object per line; docs/field-program.md lists the keys. The figures
  /// are those of the wires: nothing here knows the truth.
  void log(const CycleOutput& output);
  [[nodiscard]] std::chrono::nanoseconds now() const { return Clock::now() - started_; }
  [[nodiscard]] static std::string_view name(State state);

  boost::asio::io_context& context_;
  Options options_;
  Clock::time_point started_ = Clock::now();
  Machine machine_;
  SensorWatch watch_;
  Estimator estimator_;
  Surroundings surroundings_;
  Cycle cycle_;
  field::LineFile log_;
  field::GnssWire gnss_;
  LidarWire lidar_;
  ImuWire imu_;
  drivers::SerialPort gnss_line_;
  drivers::UdpSocket lidar_socket_;
  field::CanWire can_;
  ValveWire valves_;
  boost::asio::signal_set signals_;
  boost::asio::steady_timer control_timer_;
  Clock::time_point next_control_{};
  std::chrono::nanoseconds last_control_{0};
  /// The clock of `watch_`: it stops soon while the program itself is held up, so that no sensor is
  /// called silent while its data wait to be read.
  std::chrono::nanoseconds watched_{0};
  std::uint64_t ticks_ = 0;
  State state_ = State::waiting;
  Phase said_phase_ = Phase::swing_back;
  std::optional<ValveState> valve_state_;
  std::optional<std::uint16_t> measurement_count_;
  std::chrono::nanoseconds last_frame_{0};  ///< When the bus last carried anything.
  std::optional<int> status_;
};

}  // namespace rigwire::dig_cycle

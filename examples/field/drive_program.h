// The program between a vehicle's wires and a mission: waits until every device is alive, finds its
// place at standstill, drives, and stops safely.
//
//   waiting --all alive--> settling --enough fixes--> driving --mission done--> stopping (status 0)
//   driving --device silent--> stopping (4)    --mission's fault--> stopping (1)
//   any --interrupt, time over--> stopping (0) stopping --at rest, parking brake on--> ended
//
// Outside `driving` the brakes are asked for; the program ends when the machine reports that it is
// at rest with its parking brake on, or 6 s after it began to stop.
#pragma once

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "drivers/serial_port.h"
#include "drivers/udp_socket.h"
#include "field/can_wire.h"
#include "field/geometry.h"
#include "field/gnss_wire.h"
#include "field/json_line.h"
#include "field/lidar_wire.h"
#include "field/mission.h"
#include "field/option_parser.h"
#include "field/pose_estimator.h"
#include "field/silence_watch.h"
#include "field/vehicle_wire.h"

namespace rigwire::field {

struct DriveOptions {
  std::string gnss = "/tmp/rigwire/gnss";
  std::uint32_t gnss_baud = 115200;
  FixKind least_fix = FixKind::autonomous;  ///< Minimum kind of fix at which the drive begins.
  std::string can = "auto";
  std::optional<std::uint16_t> lidar_port;  ///< Empty: there is no lidar.
  std::string lidar_address = "127.0.0.1";
  LidarMount lidar_mount;  ///< In the frame of the odometry's reference point.
  VehicleWireSettings vehicle;
  PoseEstimatorSettings estimator;
  std::string log;                       ///< Empty: no log.
  std::chrono::nanoseconds duration{0};  ///< 0: for ever.
  double silence_factor = 1.0;           ///< Factor on the silence that is allowed to each device.
  /// The odometry's reference point is between all wheels, not between the rear ones.
  bool reference_between_axles = false;
  bool quiet = false;
  bool help = false;
};

/// Reads a program's own options and those that all driving programs share; `Options` derives from
/// DriveOptions. Throws UsageError.
template <class Options>
[[nodiscard]] Options parse_drive(std::span<const std::string_view> arguments,
                                  Setters<Options> setters);
/// Their help.
inline constexpr std::string_view kDriveUsage = R"(wires
  --gnss PATH             serial line of the GNSS receiver, NMEA   (/tmp/rigwire/gnss)
  --gnss-baud N           its speed                                (115200)
  --can NAME              vcan0, an slcan adapter's path, or auto  (auto)
  --gateway ADDRESS       source address of the vehicle's gateway  (0x27)
  --imu ADDRESS           source address of the inertial sensor    (0x80)
  --own ADDRESS           address of this program                  (0x2A)
fitting
  --antenna X,Y           GNSS antenna ahead and left of the odometry's reference point, m
  --gnss-sigma M          of a position, per axis                  (1.5)
  --gnss-fix KIND         of the positions it begins with, at least: autonomous,
                          differential, float, fixed               (autonomous)
  --gnss-age S            from its measurement to its arrival      (0.15)
  --silence FACTOR        of the silence that is allowed: gnss 3 s, others 0.5 s; above 1 for
                          a rig that does not keep up with the clock   (1)
output
  --duration S            stop after S seconds
  --log FILE              what it believes, one JSON object per line, 10 per second
  --quiet                 no progress on the terminal

exit status: 0 done or interrupted, 1 the mission cannot go on, 2 usage, 3 a wire does not open,
4 a device went silent; the machine is braked, and parked when it still listens
)";

class DriveProgram {
 public:
  /// Opens the wires. `plane` is the mission's; nothing: the first position is its origin.
  /// Throws drivers::EndpointError or std::runtime_error.
  DriveProgram(boost::asio::io_context& context, std::string_view name, const DriveOptions& options,
               std::optional<LocalPlane> plane, Mission& mission);

  /// Returns the exit status.
  int run();

 private:
  using Clock = std::chrono::steady_clock;
  enum class State : std::uint8_t { waiting, settling, driving, stopping };
  enum Device : std::size_t { gnss_device, imu_device, gateway_device, lidar_device };

  void control();
  void take_fixes();
  void settle();
  void drive(double step_s);
  void come_to_rest();
  void stop(int status, const std::string& why);
  void report();
  void say(const std::string& text) const;
  [[nodiscard]] double speed_mps() const;
  [[nodiscard]] std::chrono::nanoseconds now() const { return Clock::now() - started_; }
  [[nodiscard]] static std::string_view name(State state);

  boost::asio::io_context& context_;
  std::string_view program_;
  DriveOptions options_;
  Clock::time_point started_ = Clock::now();
  std::optional<LocalPlane> plane_;
  Mission& mission_;
  SilenceWatch watch_;
  PoseEstimator estimator_;
  LineFile log_;
  GnssWire gnss_;
  VehicleWire vehicle_;
  LidarWire lidar_;
  drivers::SerialPort gnss_line_;
  CanWire can_;
  std::unique_ptr<drivers::UdpSocket> lidar_socket_;  ///< Null: no lidar.
  boost::asio::signal_set signals_;
  boost::asio::steady_timer timer_;
  Clock::time_point next_{};
  std::chrono::nanoseconds last_{0};
  /// The clock of `watch_`: it stops soon while the program itself is held up, so that no device is
  /// called silent while its data wait to be read.
  std::chrono::nanoseconds watched_{0};
  std::chrono::nanoseconds last_frame_{0};
  std::chrono::nanoseconds stop_began_{0};
  std::chrono::nanoseconds at_rest_since_{0};
  std::uint64_t ticks_ = 0;
  std::uint64_t positions_ = 0;
  std::uint64_t velocities_ = 0;
  PlanePosition settling_sum_;
  int settling_count_ = 0;
  State state_ = State::waiting;
  VehicleOrders orders_;
  int status_ = exit_done;
  bool ended_ = false;
};

// --- templates -----------------------------------------------------------------------------------

template <class Options>
Options parse_drive(std::span<const std::string_view> arguments, Setters<Options> setters) {
  const auto address = [](std::uint8_t VehicleWireSettings::*member) {
    return [member](Options& o, std::string_view n, std::string_view v) {
      o.vehicle.*member = static_cast<std::uint8_t>(whole(n, v, 0xFD, "a J1939 address, 0..0xFD"));
    };
  };
  setters["--gnss"] = [](Options& o, auto, auto v) { o.gnss = v; };
  setters["--gnss-baud"] = [](Options& o, auto n, auto v) { o.gnss_baud = baud(n, v); };
  setters["--can"] = [](Options& o, auto, auto v) { o.can = v; };
  setters["--gateway"] = address(&VehicleWireSettings::gateway);
  setters["--imu"] = address(&VehicleWireSettings::imu);
  setters["--own"] = address(&VehicleWireSettings::own);
  setters["--antenna"] = [](Options& o, auto n, auto v) {
    const auto parts = split(v);
    if (parts.size() != 2) {
      refuse(n, v, "X,Y in m");
    }
    o.estimator.antenna_x_m = number(n, parts[0], -20, 20, "X,Y in m");
    o.estimator.antenna_y_m = number(n, parts[1], -20, 20, "X,Y in m");
  };
  setters["--gnss-sigma"] = [](Options& o, auto n, auto v) {
    o.estimator.gnss_sigma_m = number(n, v, 0.005, 100, "metres, 0.005..100");
  };
  setters["--gnss-fix"] = [](Options& o, auto n, auto v) {
    const auto kind = std::find(kFixKinds.begin() + 1, kFixKinds.end(), v);
    if (kind == kFixKinds.end()) {
      refuse(n, v, "autonomous, differential, float or fixed");
    }
    o.least_fix = static_cast<FixKind>(kind - kFixKinds.begin());
  };
  setters["--gnss-age"] = [](Options& o, auto n, auto v) {
    o.estimator.gnss_age_s = number(n, v, 0, 2, "seconds, 0..2");
  };
  setters["--silence"] = [](Options& o, auto n, auto v) {
    o.silence_factor = number(n, v, 1, 1000, "1..1000");
  };
  setters["--log"] = [](Options& o, auto, auto v) { o.log = v; };
  setters["--duration"] = [](Options& o, auto n, auto v) { o.duration = seconds(n, v); };
  const Flags<Options> flags{
      {"--help", &Options::help}, {"-h", &Options::help}, {"--quiet", &Options::quiet}};
  return parse(arguments, setters, flags);
}

}  // namespace rigwire::field

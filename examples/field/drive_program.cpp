#include "field/drive_program.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

#include "field/geometry.h"

namespace rigwire::field {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kPeriod{VehicleWire::kTick_ms};
constexpr std::uint64_t kTicksPerSecond = 1000ms / kPeriod;
constexpr std::uint64_t kTicksPerLogLine = 5;
/// A step is never taken for longer than this, whatever held the program up.
constexpr std::chrono::nanoseconds kLongestStep = 100ms;
/// Fixes that are averaged before the machine moves.
constexpr int kSettlingFixes = 3;
constexpr double kAtRest_mps = 0.03;
constexpr auto kStopLimit = 6s;
constexpr auto kRest = 500ms;

std::vector<SilenceWatch::Device> devices(const DriveOptions& options) {
  std::vector<SilenceWatch::Device> all{
      {"gnss", 3000ms}, {"imu", 500ms}, {"vehicle gateway", 500ms}};
  if (options.lidar_port) {
    all.push_back({"lidar", 500ms});
  }
  for (SilenceWatch::Device& device : all) {
    device.limit = std::chrono::duration_cast<std::chrono::milliseconds>(device.limit *
                                                                         options.silence_factor);
  }
  return all;
}

}  // namespace

DriveProgram::DriveProgram(boost::asio::io_context& context, std::string_view name,
                           const DriveOptions& options, std::optional<LocalPlane> plane,
                           Mission& mission)
    : context_(context),
      program_(name),
      options_(options),
      plane_(plane),
      mission_(mission),
      watch_(devices(options)),
      estimator_(options.estimator),
      log_(options.log),
      gnss_([this] { watch_.heard(gnss_device, watched_); }),
      vehicle_(options.vehicle, {.gateway = [this] { watch_.heard(gateway_device, watched_); },
                                 .imu = [this] { watch_.heard(imu_device, watched_); }}),
      lidar_({.revolution = [this] { mission_.finish_revolution(); },
              .points =
                  [this](auto points) {
                    for (const auto& point : points) {
                      mission_.see(options_.lidar_mount.to_body({point.x_m, point.y_m, point.z_m}));
                    }
                  },
              .heard = [this] { watch_.heard(lidar_device, watched_); }}),
      gnss_line_(context,
                 {.path = options.gnss, .baud = options.gnss_baud, .wait_for_device = true}),
      can_(context, options.can),
      signals_(context, SIGINT, SIGTERM),
      timer_(context) {
  if (options.lidar_port) {
    lidar_socket_ = std::make_unique<drivers::UdpSocket>(
        context, drivers::UdpSettings{
                     .bind = drivers::UdpEndpoint{options.lidar_address, *options.lidar_port}});
  }
}

std::string_view DriveProgram::name(State state) {
  switch (state) {
    case State::waiting:
      return "waiting";
    case State::settling:
      return "settling";
    case State::driving:
      return "driving";
    case State::stopping:
      return "stopping";
  }
  return "";
}

int DriveProgram::run() {
  gnss_line_.start([this](std::span<const std::uint8_t> bytes) { gnss_.receive(bytes); });
  can_.bus().start([this](const protocols::can::Frame& frame) {
    last_frame_ = now();
    vehicle_.receive(frame);
  });
  if (lidar_socket_) {
    lidar_socket_->start([this](std::span<const std::uint8_t> bytes) { lidar_.receive(bytes); });
  }
  signals_.async_wait([this](boost::system::error_code error, int /*signal*/) {
    if (!error) {
      stop(exit_done, "interrupted");
    }
  });
  next_ = Clock::now();
  control();
  while (!ended_) {
    context_.run_one();
  }
  return status_;
}

double DriveProgram::speed_mps() const {
  const VehicleReadings& readings = vehicle_.readings();
  const auto& wheels = readings.wheel_mps;
  const double rear = 0.5 * (wheels[2] + wheels[3]);
  const double mean =
      options_.reference_between_axles ? 0.5 * (rear + 0.5 * (wheels[0] + wheels[1])) : rear;
  const double signed_mps = readings.wheel_based_speed_mps.value_or(0.0);
  return std::isfinite(mean) ? std::copysign(mean, signed_mps) : signed_mps;
}

void DriveProgram::control() {
  ++ticks_;
  const auto time = now();
  const auto step = std::min(kLongestStep, time - last_);
  const double step_s = std::chrono::duration<double>(step).count();
  last_ = time;
  watched_ += step;
  if (ticks_ % kTicksPerSecond == 1) {
    can_.tend(time - last_frame_ > 1s);
  }
  if (ticks_ % (10 * kTicksPerSecond) == 1) {
    vehicle_.claim(can_.bus());
  }
  estimator_.advance(step_s, speed_mps(), vehicle_.readings().slip_angle_rad,
                     vehicle_.take_yaw_rate_radps());
  take_fixes();
  if (options_.duration > 0ns && time > options_.duration && state_ != State::stopping) {
    stop(exit_done, "time is over");
  }
  if (state_ == State::settling || state_ == State::driving) {
    if (const auto silent = watch_.silent(watched_)) {
      stop(exit_silent_sensor, std::string(watch_.name(*silent)) + " is silent; braking");
    }
  }
  switch (state_) {
    case State::waiting:
      if (watch_.all_alive(watched_)) {
        say("all devices alive; taking the first fixes");
        state_ = State::settling;
      } else if (ticks_ % (2 * kTicksPerSecond) == 0) {
        say("waiting for " + watch_.absent(watched_));
      }
      orders_ = mission_.halt(vehicle_.readings(), std::abs(speed_mps()) < kAtRest_mps);
      break;
    case State::settling:
      settle();
      break;
    case State::driving:
      drive(step_s);
      break;
    case State::stopping:
      come_to_rest();
      break;
  }
  vehicle_.send(can_.bus(), orders_);
  if (ended_ && vehicle_.readings().parking_brake) {
    vehicle_.release(can_.bus());
  }
  report();
  if (ended_) {
    return;
  }
  // Absolute deadlines; what was missed is not made up for.
  next_ = std::max(next_ + kPeriod, Clock::now());
  timer_.expires_at(next_);
  timer_.async_wait([this](boost::system::error_code error) {
    if (!error && !ended_) {
      control();
    }
  });
}

void DriveProgram::take_fixes() {
  const GnssFixBelief& fix = gnss_.fix();
  if (fix.velocities != velocities_) {
    velocities_ = fix.velocities;
    if (fix.course_rad) {
      estimator_.course(turned_compass(*fix.course_rad), fix.ground_speed_mps);
    }
  }
  if (fix.positions == positions_) {
    return;
  }
  positions_ = fix.positions;
  if (!plane_) {
    plane_.emplace(LatLon{fix.latitude_deg, fix.longitude_deg}, fix.altitude_m);
  }
  const PlanePosition antenna = plane_->to_plane({fix.latitude_deg, fix.longitude_deg});
  if (estimator_.started()) {
    estimator_.position(antenna);
  } else if (state_ == State::settling && fix_kind(fix.quality) >= options_.least_fix) {
    settling_sum_.east_m += antenna.east_m;
    settling_sum_.north_m += antenna.north_m;
    ++settling_count_;
  }
}

void DriveProgram::settle() {
  orders_ = mission_.halt(vehicle_.readings(), std::abs(speed_mps()) < kAtRest_mps);
  if (settling_count_ < kSettlingFixes) {
    if (ticks_ % (2 * kTicksPerSecond) == 0) {
      const auto word = [](FixKind kind) {
        return std::string(kFixKinds[static_cast<std::size_t>(kind)]);
      };
      say("waiting for a position, at least " + word(options_.least_fix) + "; it is " +
          word(fix_kind(gnss_.fix().quality)));
    }
    return;
  }
  const PlanePosition mean{settling_sum_.east_m / settling_count_,
                           settling_sum_.north_m / settling_count_};
  const Mission::Start start = mission_.start(mean);
  estimator_.start(mean, start.heading_rad, start.sigma_rad);
  say("driving");
  state_ = State::driving;
}

void DriveProgram::drive(double step_s) {
  orders_ = mission_.update(estimator_.pose(), vehicle_.readings(), step_s);
  if (const auto fault = mission_.fault()) {
    stop(exit_machine, *fault);
  } else if (mission_.done()) {
    stop(exit_done, mission_.progress() + "; done");
  }
}

void DriveProgram::come_to_rest() {
  const VehicleReadings& readings = vehicle_.readings();
  const bool standing = std::abs(speed_mps()) < kAtRest_mps;
  orders_ = mission_.halt(readings, standing);
  if (!standing || !readings.parking_brake) {
    at_rest_since_ = now();
  }
  ended_ = now() - at_rest_since_ > kRest || now() - stop_began_ > kStopLimit;
}

void DriveProgram::stop(int status, const std::string& why) {
  if (state_ == State::stopping) {
    return;
  }
  state_ = State::stopping;
  status_ = status;
  stop_began_ = at_rest_since_ = now();
  orders_ = mission_.halt(vehicle_.readings(), false);
  if (status == exit_done) {
    say(why);
  } else {
    (void)std::fprintf(stderr, "%s: %s\n", program_.data(), why.c_str());
  }
}

void DriveProgram::report() {
  const Pose pose = estimator_.pose();
  if (ticks_ % kTicksPerSecond == 0 && state_ == State::driving) {
    char text[160];
    (void)std::snprintf(text, sizeof(text), "%6.1f s  %5.2f m/s  heading %6.1f deg  +-%.2f m  ",
                        std::chrono::duration<double>(now()).count(), pose.speed_mps,
                        pose.heading_rad / kDegree, pose.position_sigma_m);
    say(text + mission_.progress());
  }
  if (!log_.open() || ticks_ % kTicksPerLogLine != 0) {
    return;
  }
  const VehicleReadings& readings = vehicle_.readings();
  JsonLine line;
  line.number("uptime_s", std::chrono::duration<double>(now()).count(), 3);
  line.text("state", name(state_));
  line.number("east_m", pose.position.east_m, 3);
  line.number("north_m", pose.position.north_m, 3);
  if (plane_) {
    const LatLon place = plane_->to_geodetic(pose.position);
    line.number("latitude_deg", place.latitude_deg, 9);
    line.number("longitude_deg", place.longitude_deg, 9);
  }
  line.number("heading_deg", pose.heading_rad / kDegree, 3);
  line.number("speed_mps", pose.speed_mps, 3);
  line.number("yaw_rate_dps", pose.yaw_rate_radps / kDegree, 3);
  line.number("slip_angle_deg", pose.slip_angle_rad / kDegree, 3);
  line.number("gyro_bias_dps", estimator_.bias_radps() / kDegree, 4);
  line.number("position_sigma_m", pose.position_sigma_m, 3);
  line.number("heading_sigma_deg", pose.heading_sigma_rad / kDegree, 3);
  line.number("engine_radps", readings.engine_speed_radps, 1);
  line.number("curvature_1pm", readings.curvature_1pm, 5);
  line.boolean("parking_brake", readings.parking_brake);
  line.whole("steering_resets", static_cast<std::int64_t>(vehicle_.steering_resets()));
  line.number("odometry_scale_error", estimator_.scale_error(), 4);
  line.open("orders");
  line.number("curvature_1pm", orders_.curvature_1pm, 5);
  line.number("engine_radps", orders_.engine_speed_radps, 1);
  line.number("travel_mps", orders_.travel_speed_mps, 3);
  line.number("brake_mps2", orders_.brake_mps2, 2);
  line.close();
  line.open("gnss");
  line.whole("quality", gnss_.fix().quality);
  line.number("latitude_deg", gnss_.fix().latitude_deg, 8);
  line.number("longitude_deg", gnss_.fix().longitude_deg, 8);
  line.whole("rejected", static_cast<std::int64_t>(estimator_.rejected()));
  line.close();
  mission_.log(line);
  log_.write(std::move(line).take());
}

void DriveProgram::say(const std::string& text) const {
  if (!options_.quiet) {
    (void)std::fprintf(stderr, "%s: %s\n", program_.data(), text.c_str());
  }
}

}  // namespace rigwire::field

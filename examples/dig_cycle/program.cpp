#include "dig_cycle/program.h"

#include <cmath>
#include <cstdio>

namespace rigwire::dig_cycle {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kTicksPerSecond = 1000ms / Program::kControlPeriod;
constexpr std::uint64_t kTicksPerLogLine = 2;
/// A control step is never taken for longer than this, whatever held the program up.
constexpr std::chrono::nanoseconds kLongestStep = 100ms;

drivers::ModbusMasterSettings modbus_settings(const Options& options) {
  drivers::ModbusMasterSettings settings;
  settings.host = options.modbus_host;
  settings.port = options.modbus_port;
  if (!options.modbus_path.empty()) {
    settings.serial = drivers::ModbusSerialPort{
        options.modbus_path, {options.modbus_baud, protocols::modbus::SerialCharacter::even_8e1}};
  }
  settings.response_timeout = 200ms;
  return settings;
}

SurroundingsSettings surroundings_settings(const Options& options) {
  SurroundingsSettings settings;
  settings.mount = options.lidar_mount;
  return settings;
}

}  // namespace

Program::Program(boost::asio::io_context& context, const Options& options)
    : context_(context),
      options_(options),
      surroundings_(surroundings_settings(options)),
      cycle_(machine_, options.cycle),
      log_(options.log),
      gnss_([this] {
        if (gnss_.fix().positions > 0) {  // work begins at a known place; an outage later may pass
          watch_.heard(Sensor::gnss, watched_);
        }
      }),
      lidar_(
          surroundings_, [this] { return arm_shape(machine_, estimator_.belief().angles_rad); },
          [this] { watch_.heard(Sensor::lidar, watched_); }),
      imu_(estimator_, options.imu, [this](Link link) { watch_.heard(imu_of(link), watched_); }),
      gnss_line_(context,
                 {.path = options.gnss, .baud = options.gnss_baud, .wait_for_device = true}),
      lidar_socket_(context,
                    {.bind = drivers::UdpEndpoint{options.lidar_address, options.lidar_port}}),
      can_(context, options.can),
      valves_(modbus_settings(options), kControlPeriod),
      signals_(context, SIGINT, SIGTERM),
      control_timer_(context) {}

std::string_view Program::name(State state) {
  switch (state) {
    case State::waiting:
      return "waiting";
    case State::working:
      return "working";
    case State::holding:
      return "holding";
  }
  return "";
}

int Program::run() {
  gnss_line_.start([this](std::span<const std::uint8_t> bytes) { gnss_.receive(bytes); });
  lidar_socket_.start([this](std::span<const std::uint8_t> bytes) { lidar_.receive(bytes); });
  can_.bus().start([this](const protocols::can::Frame& frame) {
    last_frame_ = now();
    imu_.receive(frame);
  });
  signals_.async_wait([this](boost::system::error_code error, int /*signal*/) {
    if (!error) {
      stop(exit_done, "interrupted");
    }
  });
  next_control_ = Clock::now();
  control();
  while (!status_) {
    context_.run_one();
  }
  return *status_;
}

void Program::control() {
  ++ticks_;
  const auto time = now();
  const auto step = std::min(kLongestStep, time - last_control_);
  const double step_s = std::chrono::duration<double>(step).count();
  last_control_ = time;
  watched_ += step;
  take_valves();
  if (ticks_ % kTicksPerSecond == 1) {
    tend_wires();
  }
  if (options_.duration > 0ns && time > options_.duration) {
    return stop(exit_done, "time is over");
  }

  if (state_ == State::working) {
    if (const auto silent = watch_.silent(watched_)) {
      const std::string what = std::string(dig_cycle::name(*silent)) + " is silent";
      if (!options_.wait) {
        return stop(exit_silent_sensor, what + "; valves neutral and disabled");
      }
      say(what + "; holding");
      state_ = State::holding;
    }
  } else if (const Belief belief = estimator_.belief();
             watch_.all_alive(watched_) && belief.ready && belief.rested) {
    say("all sensors alive; working");
    cycle_.hold();
    state_ = State::working;
  } else if (ticks_ % (2 * kTicksPerSecond) == 0) {
    const std::string absent = watch_.absent(watched_);
    say("waiting for " + (absent.empty() ? "the machine to rest" : absent) +
        (valves_.error().empty() ? "" : " (valves: " + valves_.error() + ")"));
  }
  work(step_s);
  if (status_) {
    return;
  }
  // Absolute deadlines; what was missed is not made up for.
  next_control_ = std::max(next_control_ + kControlPeriod, Clock::now());
  control_timer_.expires_at(next_control_);
  control_timer_.async_wait([this](boost::system::error_code error) {
    if (!error && !status_) {
      control();
    }
  });
}

void Program::take_valves() {
  valve_state_ = valves_.state();
  if (!valve_state_ || Clock::now() - valve_state_->received > SensorWatch::limit(Sensor::valves)) {
    return;
  }
  // A driver that answers while its transducers deliver nothing new counts as silent.
  if (measurement_count_ != valve_state_->measurement_count) {
    measurement_count_ = valve_state_->measurement_count;
    watch_.heard(Sensor::valves, watched_);
    estimator_.swing(valve_state_->swing_rad, valve_state_->swing_rate_radps);
  }
}

void Program::tend_wires() {
  can_.tend(now() - last_frame_ > 1s);
  if (const auto question = imu_.question()) {
    (void)can_.bus().send(*question);
  }
}

/// Makes one step of the cycle. The boom's force is that of its cylinders' pressures: bottom
/// pressure times bottom area less rod side pressure times rod side area.
void Program::work(double step_s) {
  CycleOutput output;
  if (state_ == State::working) {
    View view = surroundings_.view();
    if (valve_state_ && valve_state_->boom_bottom_pa > 0.0) {
      view.boom_force_n = valve_state_->boom_bottom_pa * machine_.boom_bottom_area_m2 -
                          valve_state_->boom_rod_side_pa * machine_.boom_rod_side_area_m2;
    }
    output = cycle_.update(estimator_.belief(), view, step_s);
    valves_.command(output.openings, true);
    if (cycle_.phase() != said_phase_) {
      said_phase_ = cycle_.phase();
      say("cycle " + std::to_string(cycle_.completed() + 1) + ": " +
          std::string(dig_cycle::name(said_phase_)) + weight_to_say());
    }
    if (valve_state_ && valve_state_->faulted && valve_state_->fault_code != kWatchdogFault) {
      return stop(exit_machine,
                  "the valve driver reports fault " + std::to_string(valve_state_->fault_code));
    }
    if (cycle_.fault()) {
      return stop(exit_machine, std::string(*cycle_.fault()));
    }
    if (cycle_.done()) {
      return stop(exit_done, *cycle_.finished());
    }
  } else {
    valves_.command({}, false);
  }
  if (ticks_ % kTicksPerLogLine == 0) {
    log(output);
  }
}

std::string Program::weight_to_say() const {
  const auto load_kg = cycle_.load_kg();
  if (!load_kg || said_phase_ != Phase::swing_to_truck) {
    return "";
  }
  return " with " + std::to_string(std::lround(*load_kg)) + " kg, " +
         std::to_string(std::lround(cycle_.loaded_kg())) + " kg in the truck";
}

void Program::log(const CycleOutput& output) {
  constexpr double kPerDegree = 1.0 / kDegree;
  const Belief belief = estimator_.belief();
  const field::GnssFixBelief& gnss = gnss_.fix();
  field::JsonLine line;
  line.number("uptime_s", std::chrono::duration<double>(now()).count(), 3);
  if (const auto time_of_hour_us = lidar_.time_of_hour_us()) {
    line.whole("time_of_hour_us", *time_of_hour_us);
  } else {
    line.null("time_of_hour_us");
  }
  line.text("state", name(state_));
  line.text("phase", dig_cycle::name(cycle_.phase()));
  line.whole("cycles", static_cast<std::int64_t>(cycle_.completed()));
  line.numbers("joints_deg", belief.angles_rad, kPerDegree, 4);
  line.numbers("joint_rates_dps", belief.rates_radps, kPerDegree, 3);
  line.number("chassis_pitch_deg", belief.chassis_pitch_rad * kPerDegree, 4);
  line.numbers("targets_deg", output.target_rad, kPerDegree, 3);
  line.numbers("openings", output.openings, 1.0, 4);
  line.numbers("spools", valve_state_ ? valve_state_->spool : PerJoint{}, 1.0, 3);
  line.boolean("held_by_obstacle", output.held_by_obstacle);
  line.open("gnss");
  line.whole("quality", gnss.quality);
  line.number("latitude_deg", gnss.latitude_deg, 8);
  line.number("longitude_deg", gnss.longitude_deg, 8);
  line.number("altitude_m", gnss.altitude_m, 2);
  line.whole("satellites", gnss.satellites);
  line.close();
  line.number("lidar_nearest_m", surroundings_.nearest_range_m(), 3);
  line.number("ground_z_m", surroundings_.view().ground_z_m, 3);
  line.number("load_kg", cycle_.load_kg(), 0);
  line.number("truck_kg", cycle_.loaded_kg(), 0);
  log_.write(std::move(line).take());
}

void Program::stop(int status, const std::string& why) {
  if (status_) {
    return;
  }
  status_ = status;
  valves_.command({}, false);  // and ValveWire's end writes it once more
  if (status == exit_done) {
    say(why);
  } else {
    (void)std::fprintf(stderr, "dig_cycle: %s\n", why.c_str());
  }
}

void Program::say(const std::string& text) const {
  if (!options_.quiet) {
    (void)std::fprintf(stderr, "dig_cycle: %s\n", text.c_str());
  }
}

}  // namespace rigwire::dig_cycle

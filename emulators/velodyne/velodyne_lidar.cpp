#include "emulators/velodyne/velodyne_lidar.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fields/constants.h"

namespace rigwire::emulators {

namespace velodyne = protocols::velodyne;
using velodyne::ReturnMode;

namespace {

constexpr double kCountsPerRadian = 100.0 / kDegree;
constexpr int kTurnCounts = velodyne::kAzimuthCounts;
/// Temperature that the boards report.
constexpr std::uint8_t kBoard_c = 35;
/// Phase lock is reported to hold within this.
constexpr int kPhaseTolerance_centideg = 500;

const velodyne::Model& checked_model(const VelodyneSettings& settings) {
  validate(settings);
  return model_of(settings);
}

Duration packet_period(const velodyne::Model& model, ReturnMode mode) {
  return Duration{velodyne::packet_period_ns(model, mode)};
}

/// Streams of what is drawn for the unit, apart from those of the cable.
constexpr std::uint64_t kNoReturnStream = 0x6E6F'7265'7475'726EU;
constexpr std::uint64_t kPositionStream = 0x706F'7369'7469'6F6EU;

/// Draws the reflectivity byte of shots without a return, for each laser.
NoReturnBytes no_return_bytes(const velodyne::Model& model, std::uint64_t seed) {
  NoReturnBytes bytes{};
  RandomBits unit(seed ^ kNoReturnStream);
  const std::uint32_t count = model.no_return.greatest - model.no_return.least + 1U;
  for (std::size_t laser = 0; laser < model.lasers.size(); ++laser) {
    bytes[laser] = static_cast<std::uint8_t>(model.no_return.least + unit.below(count));
  }
  return bytes;
}

/// [0, turn)
double wrapped(double value, double turn) {
  const double rest = std::fmod(value, turn);
  return rest < 0.0 ? rest + turn : rest;
}

double along(const Vector3& axis, const Vector3& v) {
  return axis.x * v.x + axis.y * v.y + axis.z * v.z;
}

/// The sample is expressed in the sensor's frame. Readings stop at 200 deg/s and 2.5 g, the span of
/// the manual (63-9113 Rev. H, "Position packet"); NaN reads 0.
InertialWords inertial_words(
    const ImuSample& sample,
    const std::array<VelodyneInertialAxes, velodyne::kInertialGroups>& axes) {
  InertialWords words;
  for (std::size_t g = 0; g < words.size(); ++g) {
    words[g] = velodyne::to_counts(
        {.rate_radps = along(axes[g].gyro, sample.angular_rate_radps),
         .temperature_c = sample.temperature_c,
         .acceleration_x_mps2 = along(axes[g].acceleration_x, sample.specific_force_mps2),
         .acceleration_y_mps2 = along(axes[g].acceleration_y, sample.specific_force_mps2)});
  }
  return words;
}

// What a defective head sees: dead lasers, dirt on the window.
//
// Dirt takes light twice, on the way out and back: with transmission T an echo of reflectivity rho
// at range r is still found when
//
//   rho T^2 / r^2 >= 0.9 / R^2
//
// where R is the range at which the sensor just finds a white surface of 90 % (Goodin et al.,
// Electronics 8(1):89, 2019, eq. for the least detectable power). Its reflectivity is reported as
// rho T^2, because the sensor makes up for range but does not know of the dirt; of a
// retro-reflector only the part above 1 is scaled.

constexpr double kWhite = 0.9;

void remove(LidarFiring& bank, std::size_t i) {
  bank.strongest[i] = {};
  bank.last[i] = {};
  bank.second[i] = {};
}

void kill_lasers(const DeadLaserFault& fault, std::size_t lasers, LidarFiring& bank) {
  for (std::size_t i = 0; i < lasers; ++i) {
    const auto laser = static_cast<int>(bank.first_laser + i);
    if (laser >= fault.first && laser <= fault.last) {
      remove(bank, i);
    }
  }
}

void dim(LidarReturn& echo, double transmission, double reference_range_m) {
  // Light passes the dirt twice; an echo is found while rho T^2 R^2 >= 0.9 r^2 (link_budget.h).
  const double passed = transmission * transmission;
  const double range_m = echo.range_m;
  const double found = echo.reflectivity * passed * reference_range_m * reference_range_m;
  if (!(found >= kWhite * range_m * range_m) || range_m == 0.0) {
    echo = {};
    return;
  }
  const double reported = echo.reflectivity <= 1.0F ? echo.reflectivity * passed
                                                    : 1.0 + (echo.reflectivity - 1.0) * passed;
  echo.reflectivity = static_cast<float>(reported);
}

void dim_sector(const DirtyWindowFault& fault, const LidarPattern& pattern,
                double reference_range_m, std::size_t lasers, LidarFiring& bank) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const double width_deg = std::fmod(fault.to_deg - fault.from_deg + 720.0, 360.0);
  const bool all_round = width_deg == 0.0;
  for (std::size_t i = 0; i < lasers; ++i) {
    const LaserGeometry& laser = pattern.lasers[bank.first_laser + i];
    const double azimuth_rad = bank.rotor_azimuth_rad + laser.azimuth_offset_rad +
                               bank.rotor_rate_radps * to_seconds(laser.time_offset);
    const double after_start_deg =
        std::fmod(azimuth_rad * kDegrees - fault.from_deg + 1080.0, 360.0);
    if (all_round || after_start_deg < width_deg) {
      dim(bank.strongest[i], fault.transmission, reference_range_m);
      dim(bank.last[i], fault.transmission, reference_range_m);
      dim(bank.second[i], fault.transmission, reference_range_m);
    }
  }
}

/// Applies what of the faults holds at the bank's time. `reference_range_m` is R.
void apply_optical_defects(const VelodyneFaults& faults, const LidarPattern& pattern,
                           double reference_range_m, LidarFiring& bank) {
  const std::size_t lasers = std::min(kBankLasers, pattern.lasers.size() - bank.first_laser);
  faults.each(bank.time, [&](const VelodyneFault& fault) {
    if (const auto* dead = std::get_if<DeadLaserFault>(&fault.what)) {
      kill_lasers(*dead, lasers, bank);
    } else if (const auto* dirt = std::get_if<DirtyWindowFault>(&fault.what)) {
      dim_sector(grown(*dirt, fault.when, bank.time), pattern, reference_range_m, lasers, bank);
    }
  });
}

}  // namespace

VelodyneLidar::VelodyneLidar(const VelodyneSettings& settings, const Calendar& calendar,
                             ByteOutput& data, ByteOutput& position)
    : settings_(settings),
      model_(checked_model(settings_)),
      faults_(settings_.faults),
      supply_({.power_on = Duration{0}, .faults = settings_.supply_faults}),
      data_(data, faults_, settings_.seed, FaultyCable::Swapping::as_the_faults_say),
      position_(position, faults_, ~settings_.seed, FaultyCable::Swapping::never),
      live_(settings_.saved),
      saved_(live_),
      clock_(settings_.clock_drift_ppm),
      time_input_(settings_, faults_, calendar),
      calibration_(unit_calibration(settings_, model_)),
      encode_(model_, range_window(settings_, model_), settings_.reflectivity, calibration_),
      assembly_(model_, encode_, no_return_bytes(model_, settings_.seed)),
      position_period_(position_period(settings_, model_)),
      position_waits_(settings_.seed ^ kPositionStream) {
  build_pattern();
  if (calibration_) {
    report_.emplace(model_, *calibration_, live_);
  }
  if (model_.position_layout == velodyne::PositionLayout::extended) {
    unit_status_ = {.top_board_c = kBoard_c,
                    .bottom_board_c = kBoard_c,
                    .at_calibration_c = kBoard_c,
                    .last_calibration = velodyne::ConverterCalibration::power_on,
                    .at_power_up_c = kBoard_c};
  }
  quantities_ = {{{"range", "m", pattern_.minimum_range_m, pattern_.maximum_range_m,
                   model_.distance_unit_mm * 1e-3},
                  {"azimuth", "deg", 0.0, 359.99, 0.01},
                  {"reflectivity", "%", 0.0, 100.0, 1.0},
                  {"time of hour", "us", 0.0, 3599999999.0, 1.0}}};
  if (supply_.next_change() <= kStart) {
    supply_.change();
    was_on_ = true;
    power_up(kStart, settings_.start_up);
  } else {
    power_down(kStart);
  }
}

void VelodyneLidar::build_pattern() {
  const auto [minimum_m, maximum_m] = range_window(settings_, model_);
  pattern_.firing_period = Duration{model_.firing_period_ns};
  pattern_.minimum_range_m = minimum_m;
  pattern_.maximum_range_m = maximum_m;
  reference_range_m_ = settings_.reference_range_m > 0.0 ? settings_.reference_range_m : maximum_m;
  pattern_.beam = {model_.divergence.horizontal_mrad * 1e-3, model_.divergence.vertical_mrad * 1e-3,
                   Duration{std::llround(model_.pulse_ns)}};
  std::vector<velodyne::Laser> lasers(model_.lasers.begin(), model_.lasers.end());
  if (calibration_) {
    lasers = velodyne::calibrated_lasers(model_, *calibration_);
  }
  for (const velodyne::Laser& laser : lasers) {
    pattern_.lasers.push_back(
        {.elevation_rad = laser.elevation_deg * kDegree,
         .azimuth_offset_rad = laser.azimuth_offset_deg * kDegree,
         .vertical_offset_m = settings_.vertical_offsets ? laser.vertical_offset_mm * 1e-3 : 0.0,
         .horizontal_offset_m = laser.horizontal_offset_mm * 1e-3,
         .time_offset = Duration{laser.time_offset_ns}});
    last_shot_after_ = std::max(last_shot_after_, pattern_.lasers.back().time_offset);
  }
}

void VelodyneLidar::power_up(SimTime now, Duration start_up) {
  powered_up_ = now;
  running_from_ = now + start_up;
  if (report_) {
    report_->power_up();
  }
  time_input_.power_up(now, clock_);
  begin_packets(now);
  if (model_.position_layout != velodyne::PositionLayout::none) {
    position_slot_ = running_from_;
    plan_position();
  }
  command_head(now);
}

void VelodyneLidar::power_down(SimTime now) {
  running_from_ = kNever;
  begin_packets(now);
  command_head(now);
}

void VelodyneLidar::begin_packets(SimTime now) {
  assembly_.discard();
  data_.clear();
  packet_complete_at_ = now + packet_period(model_, live_.return_mode);
  expected_time_ = kNever;
  phase_locked_ = false;
  next_position_ = kNever;
}

SamplePlan VelodyneLidar::sample_plan() const {
  return {kStart + pattern_.firing_period, pattern_.firing_period};
}

double VelodyneLidar::nominal_rate_hz() const {
  double view = wrapped(command_.view_end_rad - command_.view_start_rad, kTurn) / kTurn;
  if (view == 0.0) {
    view = 1.0;
  }
  const double position_hz = model_.position_layout == velodyne::PositionLayout::none
                                 ? 0.0
                                 : 1.0 / to_seconds(position_period_);
  return view / to_seconds(packet_period(model_, live_.return_mode)) + position_hz;
}

SimTime VelodyneLidar::next_event() const {
  return std::min(supply_.next_change(), next_work());
}

SimTime VelodyneLidar::next_work() const {
  return supply_.on() ? std::min({next_position_, next_command_, time_input_.next_event()})
                      : kNever;
}

void VelodyneLidar::advance(SimTime now) {
  while (supply_.next_change() <= now) {
    const SimTime instant = supply_.next_change();
    live_until(instant);
    supply_.change();
    if (!supply_.on()) {
      power_down(instant);
    } else if (was_on_) {
      restart(instant);
    } else {
      was_on_ = true;
      power_up(instant, settings_.start_up);
    }
  }
  live_until(now);
}

void VelodyneLidar::live_until(SimTime now) {
  for (SimTime event = next_work(); event <= now; event = next_work()) {
    if (event == time_input_.next_event()) {
      handle_time_input();
      command_head(event);
    } else if (event == next_command_) {
      command_head(event);
    } else {
      send_position(event);
      plan_position();
    }
  }
  if (packet_complete_at_ <= now) {
    packet_complete_at_ = now + packet_period(model_, live_.return_mode);
  }
}

void VelodyneLidar::plan_position() {
  position_slot_ += position_period_;
  next_position_ = position_slot_;
  if (settings_.position_wait > Duration::zero()) {
    const auto longest_ns = static_cast<double>(settings_.position_wait.count());
    next_position_ += Duration{std::llround(longest_ns * position_waits_.uniform())};
  }
}

void VelodyneLidar::handle_time_input() {
  const SimTime event = time_input_.next_event();
  if (event == time_input_.next_second()) {
    // Rotor carried on from its last firing to the pulse.
    const double azimuth_rad =
        rotor_.azimuth_rad + rotor_.rate_radps * to_seconds(event - rotor_.time);
    phase_centideg_ =
        static_cast<int>(std::lround(wrapped(azimuth_rad, kTurn) * kCountsPerRadian)) % kTurnCounts;
    const int off = std::abs(phase_centideg_ - live_.phase_lock_offset_centideg);
    phase_locked_ = command_.phase_lock.has_value() &&
                    std::min(off, kTurnCounts - off) <= kPhaseTolerance_centideg;
  }
  time_input_.handle_event(clock_);
}

VelodyneFaults::Id VelodyneLidar::begin(const VelodyneFault& fault) {
  check_fault(fault, settings_);
  next_command_ = std::min(next_command_, fault.when.begin());
  return faults_.add(fault);
}

bool VelodyneLidar::end(VelodyneFaults::Id id, SimTime now) {
  next_command_ = std::min(next_command_, now);
  return faults_.end(id, now);
}

void VelodyneLidar::command_head(SimTime now) {
  const bool running = !starting_up(now);
  const bool stalled = faults_.first<MotorStallFault>(now) != nullptr;
  command_.rotor_rate_radps = running && !stalled ? live_.rotor_rpm / 60.0 * kTurn : 0.0;
  command_.laser_on = running && live_.laser_on;
  command_.several_echoes = live_.return_mode != ReturnMode::strongest;
  const int end_deg = (live_.view_end_deg + 1) % 360;
  const bool all_round = end_deg == live_.view_start_deg;
  command_.view_start_rad = all_round ? 0.0 : live_.view_start_deg * kDegree;
  command_.view_end_rad = all_round ? 0.0 : end_deg * kDegree;

  const double phase_rad = live_.phase_lock_offset_centideg / kCountsPerRadian;
  const auto pulse = time_input_.last_pulse(now);
  if (!(running && live_.phase_lock && pulse &&
        time_input_.state(now) == velodyne::PulseState::locked)) {
    command_.phase_lock.reset();
  } else if (!command_.phase_lock || command_.phase_lock->azimuth_rad != phase_rad) {
    command_.phase_lock = PhaseLock{phase_rad, *pulse};
  }
  const SimTime next_stall = faults_.next_change<MotorStallFault>(now);
  next_command_ = running ? next_stall : std::min(running_from_, next_stall);
}

void VelodyneLidar::update(const LidarFiring& bank) {
  // What is fired at the very instant at which the supply goes is taken before.
  advance(bank.time - Duration{1});
  supply_.on() ? live_until(bank.time) : advance(bank.time);
  if (starting_up(bank.time)) {
    return;
  }
  const bool continued = continues(bank);
  if (!continued) {
    assembly_.discard();
    expected_time_ = kNever;
    if (bank.first_laser != 0) {
      return;
    }
  }
  if (!std::isfinite(bank.rotor_azimuth_rad)) {
    return;
  }
  const bool last_bank = bank.first_laser + kBankLasers >= model_.lasers.size();
  expected_time_ = last_bank ? bank.time + pattern_.firing_period : bank.time;
  expected_laser_ = last_bank ? 0 : bank.first_laser + kBankLasers;

  if (bank.first_laser == 0) {
    rotor_ = {bank.time, bank.rotor_azimuth_rad,
              std::isfinite(bank.rotor_rate_radps) ? bank.rotor_rate_radps : 0.0};
    azimuth_counts_ = azimuth_of(bank, continued);
    firing_taken_ = assembly_.within_block() || in_view(bank.rotor_azimuth_rad);
  }
  if (firing_taken_) {
    add(bank);
  }
  const SimTime next_firing = bank.time + pattern_.firing_period;
  packet_complete_at_ =
      std::max(next_firing, bank.time + assembly_.firings_left() * pattern_.firing_period);
}

bool VelodyneLidar::continues(const LidarFiring& bank) const {
  return bank.time == expected_time_ && bank.first_laser == expected_laser_;
}

bool VelodyneLidar::in_view(double azimuth_rad) const {
  if (command_.view_start_rad == command_.view_end_rad) {
    return true;
  }
  return wrapped(azimuth_rad - command_.view_start_rad, kTurn) <
         wrapped(command_.view_end_rad - command_.view_start_rad, kTurn);
}

std::uint16_t VelodyneLidar::azimuth_of(const LidarFiring& bank, bool continued) {
  const double azimuth_rad = bank.rotor_azimuth_rad >= 0.0 && bank.rotor_azimuth_rad <= kTurn
                                 ? bank.rotor_azimuth_rad
                                 : wrapped(bank.rotor_azimuth_rad, kTurn);
  const int counts = static_cast<int>(std::lround(azimuth_rad * kCountsPerRadian)) % kTurnCounts;
  const int step = (counts - azimuth_counts_ + kTurnCounts) % kTurnCounts;
  const bool backward = continued && step > kTurnCounts / 2;
  return backward ? azimuth_counts_ : static_cast<std::uint16_t>(counts);
}

void VelodyneLidar::add(const LidarFiring& bank) {
  if (assembly_.empty()) {
    begin_packet(bank.time);
  }
  const LidarFiring* seen = &bank;
  if (faults_.first<DeadLaserFault>(bank.time) != nullptr ||
      faults_.first<DirtyWindowFault>(bank.time) != nullptr || !live_.laser_on) {
    defective_ = bank;
    apply_optical_defects(faults_, pattern_, reference_range_m_, defective_);
    if (!live_.laser_on) {
      defective_.strongest.fill({});
      defective_.several = false;
    }
    seen = &defective_;
  }
  assembly_.add(*seen, azimuth_counts_);
  if (assembly_.complete()) {
    send_data(bank.time);
    assembly_.discard();
  }
}

void VelodyneLidar::begin_packet(SimTime first_firing) {
  assembly_.begin(live_.return_mode);
  assembly_.write().timestamp(
      microseconds_of_hour(first_firing + Duration{model_.timestamp_lag_ns}));
  if (const auto* wrong = faults_.first<FactoryBytesFault>(first_firing)) {
    assembly_.write().factory_bytes(wrong->return_mode, wrong->product);
  } else if (settings_.legacy_factory_bytes) {
    assembly_.write().factory_bytes(0, 0);
  } else {
    assembly_.write().factory_bytes(static_cast<std::uint8_t>(live_.return_mode),
                                    model_.product_id);
  }
}

void VelodyneLidar::send_data(SimTime last_firing) {
  if (report_) {
    const velodyne::StatusByte status = report_->next(last_firing, time_input_);
    assembly_.write().factory_bytes(status.type, status.value);
  }
  data_.send(last_firing + last_shot_after_ + settings_.send_delay, assembly_.bytes());
}

void VelodyneLidar::send_position(SimTime due) {
  velodyne::PositionPacket packet;
  if (model_.position_layout == velodyne::PositionLayout::inertial) {
    packet.inertial = inertial_;
  }
  packet.status = unit_status_;
  if (model_.position_layout == velodyne::PositionLayout::extended) {
    packet.status.since_calibration_s =
        static_cast<std::uint32_t>((due - powered_up_) / std::chrono::seconds{1});
  }
  packet.timestamp_us = microseconds_of_hour(due);
  packet.pulse_state = time_input_.state(due);
  packet.set_sentence(time_input_.sentence());
  velodyne::encode(packet, position_bytes_);
  position_.send(due, position_bytes_);
}

std::uint32_t VelodyneLidar::microseconds_of_hour(SimTime instant) const {
  std::int64_t hour_ns = clock_.hour_ns(instant);
  if (const auto fault = faults_.first_grown<ClockOffsetFault>(instant)) {
    hour_ns = (hour_ns + from_seconds(fault->offset_s).count() + kHour_ns) % kHour_ns;
  }
  if (const auto* fault = faults_.first<HourOverrunFault>(instant);
      fault != nullptr && hour_ns < from_seconds(fault->overrun_s).count()) {
    hour_ns += kHour_ns;
  }
  return static_cast<std::uint32_t>(hour_ns / 1000);
}

void VelodyneLidar::observe_motion(const ImuSample& sample) {
  inertial_ = inertial_words(sample, settings_.inertial_axes);
}

// The VelodyneControl face of the sensor.

void VelodyneLidar::take(const VelodyneLiveSettings& settings) {
  if (settings.host_address != live_.host_address || settings.data_port != live_.data_port ||
      settings.telemetry_port != live_.telemetry_port) {
    ++destination_changes_;
  }
  live_ = settings;
  if (report_) {
    report_->settings_changed(live_);
  }
}

void VelodyneLidar::apply(SimTime now, const VelodyneLiveSettings& settings) {
  advance(now);
  take(settings);
  command_head(now);
}

void VelodyneLidar::save(SimTime now) {
  advance(now);
  saved_ = live_;
}

void VelodyneLidar::reset(SimTime now) {
  advance(now);
  restart(now);
}

void VelodyneLidar::restart(SimTime now) {
  take(saved_);
  power_up(now, settings_.start_up == Duration::zero() ? kResetTime : settings_.start_up);
}

VelodyneReadings VelodyneLidar::readings(SimTime now) const {
  VelodyneReadings readings;
  readings.motor_on = live_.rotor_rpm > 0 && !starting_up(now);
  readings.motor_rpm = rotor_.rate_radps * 60.0 / (2.0 * std::numbers::pi);
  readings.motor_locked = phase_locked_;
  readings.motor_phase_centideg = phase_centideg_;
  readings.laser_on = command_.laser_on;
  readings.pulse_state = time_input_.state(now);
  readings.gps_position = time_input_.position();
  return readings;
}

VelodyneDestination VelodyneLidar::data_destination() const {
  return {live_.host_address, live_.data_port};
}

VelodyneDestination VelodyneLidar::position_destination() const {
  return {live_.host_address, live_.telemetry_port};
}

}  // namespace rigwire::emulators

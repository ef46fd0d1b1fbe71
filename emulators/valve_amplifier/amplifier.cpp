#include "emulators/valve_amplifier/amplifier.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigwire::emulators {

namespace {

const ValveAmplifierSettings& validated(const ValveAmplifierSettings& settings) {
  validate(settings);
  return settings;
}

template <std::size_t... kIndices>
std::array<ValveCoil, kValveSections> coils(const ValveCoilParameters& parameters,
                                            std::index_sequence<kIndices...>) {
  return {((void)kIndices, ValveCoil(parameters))...};
}

SimTime later(SimTime since, Duration delay) {
  return since == kNever ? kNever : since + delay;
}

/// Begins, or ends, a suspicion.
void note(SimTime& since, bool suspicious, SimTime now) {
  since = suspicious ? std::min(since, now) : kNever;
}

void take(double& kept, double value) {
  if (std::isfinite(value)) {
    kept = value;
  }
}

}  // namespace

void ValveStage::set_target(SimTime now, double command, const ValveStageParameters& parameters) {
  advance(now, parameters);
  target_ = command;
  advance(now, parameters);
}

void ValveStage::advance(SimTime now, const ValveStageParameters& parameters) {
  Duration left = now - moved_until_;
  moved_until_ = now;
  // At most two legs: down to neutral (or to a smaller command), then up with the new sign.
  for (int leg = 0; leg < 2 && ramped_ != target_; ++leg) {
    const bool other_sign = ramped_ * target_ < 0.0;
    const bool down = other_sign || std::abs(target_) < std::abs(ramped_);
    const double goal = other_sign ? 0.0 : target_;
    const Duration full = down ? parameters.ramp_down : parameters.ramp_up;
    const Duration needed = from_seconds(to_seconds(full) * std::abs(goal - ramped_));
    if (needed <= left) {
      ramped_ = goal;
      left -= needed;
      continue;
    }
    // Linear ramp: full travel in the ramp's time.
    const double step = to_seconds(left) / to_seconds(full);
    ramped_ += goal > ramped_ ? step : -step;
    return;
  }
}

void ValveStage::neutral(SimTime now) {
  moved_until_ = now;
  target_ = 0.0;
  ramped_ = 0.0;
}

double ValveStage::opening(const ValveStageParameters& parameters) const {
  const double command = std::clamp(ramped_ * parameters.gain, -1.0, 1.0);
  if (command == 0.0) {
    return 0.0;
  }
  const double band = command > 0.0 ? parameters.dead_band_positive : parameters.dead_band_negative;
  // Dead band compensation: b + (1 - b) |c|.
  const double travel = band + (1.0 - band) * std::abs(command);
  return parameters.polarity * std::copysign(travel, command);
}

ValveAmplifier::ValveAmplifier(const ValveAmplifierSettings& settings)
    : settings_(validated(settings)),
      defects_(settings.defects),
      parameters_(settings.parameters),
      coils_(coils(settings.coil, std::make_index_sequence<kValveSections>{})) {
  section_on_.fill(true);
  measured_.oil_temperature_c = 0.0;
  driver_temperature_c_ =
      settings_.electronics.ambient_temperature_c +
      settings_.electronics.thermal_resistance_kpw * settings_.electronics.idle_power_w;
  forget_suspicions();
  take_defects(kStart);
}

void ValveAmplifier::forget_suspicions() {
  coil_open_since_.fill(kNever);
  over_current_since_.fill(kNever);
  spool_off_since_.fill(kNever);
  under_voltage_since_ = kNever;
}

void ValveAmplifier::restart(SimTime now) {
  advance(now);
  parameters_ = settings_.parameters;
  enable_wanted_ = false;
  reset_wanted_ = false;
  quick_stop_ = false;
  section_on_.fill(true);
  float_wanted_.fill(false);
  commanded_.fill(0.0);
  enabled_ = false;
  watchdog_tripped_ = false;
  fault_ = ValveFault::none;
  fault_section_.reset();
  active_reaction_ = ValveReaction::neutral;
  next_ramp_ = kNever;
  measured_ = {};
  measured_.oil_temperature_c = 0.0;
  measurements_ = 0;
  forget_suspicions();
  release(now);
  refresh_set_points(now);
}

SimTime ValveAmplifier::watchdog_deadline() const {
  return enabled_ && parameters_.watchdog > Duration{0} ? fed_ + parameters_.watchdog : kNever;
}

SimTime ValveAmplifier::supervision_deadline() const {
  if (fault_ != ValveFault::none) {
    return kNever;
  }
  const ValveElectronics& electronics = settings_.electronics;
  SimTime deadline = later(under_voltage_since_, electronics.under_voltage_delay);
  for (std::size_t i = 0; i < sections(); ++i) {
    deadline = std::min({deadline, later(coil_open_since_[i], electronics.open_delay),
                         later(over_current_since_[i], electronics.over_current_delay)});
  }
  return deadline;
}

SimTime ValveAmplifier::next_event() const {
  return std::min({watchdog_deadline(), supervision_deadline(), next_ramp_, next_defect_});
}

void ValveAmplifier::advance(SimTime now) {
  for (SimTime event = next_event(); event <= now; event = next_event()) {
    if (watchdog_deadline() <= event) {
      latch(event, ValveFault::watchdog);
    } else if (next_defect_ <= event) {
      take_defects(event);
    } else if (next_ramp_ <= event) {
      step_ramps(event);
    } else {
      supervise(event);
    }
  }
}

void ValveAmplifier::feed(SimTime now) {
  advance(now);
  fed_ = now;
}

void ValveAmplifier::set_parameters(SimTime now, const ValveAmplifierParameters& parameters) {
  advance(now);
  step_ramps(now);  // up to here by the old ones
  parameters_ = parameters;
  request(now, {});
}

// Applies a request in the order that amplifier.h defines: commands are stored, a rising
// fault_reset clears the latched fault, and outputs that become enabled start from 0 unless this
// request commands them.
void ValveAmplifier::request(SimTime now, const ValveRequest& request) {
  advance(now);
  step_ramps(now);
  const bool was_driving = enabled_ && !quick_stop_;
  const bool reset = request.fault_reset.value_or(false) && !reset_wanted_;
  enable_wanted_ = request.enable.value_or(enable_wanted_);
  reset_wanted_ = request.fault_reset.value_or(reset_wanted_);
  quick_stop_ = request.quick_stop.value_or(quick_stop_);
  for (std::size_t i = 0; i < sections(); ++i) {
    const bool was_on = section_on_[i];
    section_on_[i] = request.section_enable[i].value_or(was_on);
    if (section_on_[i] && !was_on) {
      commanded_[i] = 0.0;
    }
    float_wanted_[i] = request.floating[i].value_or(float_wanted_[i]);
    if (request.command[i] && std::isfinite(*request.command[i])) {
      commanded_[i] = std::clamp(*request.command[i], -1.0, 1.0);
    }
  }
  if (reset) {
    fault_ = ValveFault::none;
    fault_section_.reset();
    watchdog_tripped_ = false;
    active_reaction_ = ValveReaction::neutral;
    forget_suspicions();
  }
  if (!enable_wanted_ || quick_stop_) {
    active_reaction_ = ValveReaction::neutral;
  }
  if (!consistent(parameters_)) {
    latch(now, ValveFault::configuration);
  }
  const bool was_enabled = enabled_;
  enabled_ = enable_wanted_ && fault_ == ValveFault::none;
  if (enabled_ && !was_enabled) {
    fed_ = now;
  }
  const bool driving = enabled_ && !quick_stop_;
  if (driving && !was_driving) {
    begin_from_zero(request);
  }
  if (driving) {
    set_targets(now);
  } else if (active_reaction_ == ValveReaction::neutral) {
    release(now);
  }
  schedule_ramp(now);
  refresh_set_points(now);
}

void ValveAmplifier::begin_from_zero(const ValveRequest& request) {
  for (std::size_t i = 0; i < sections(); ++i) {
    if (!request.command[i]) {
      commanded_[i] = 0.0;
    }
  }
}

void ValveAmplifier::set_targets(SimTime now) {
  for (std::size_t i = 0; i < sections(); ++i) {
    if (section_on_[i]) {
      stages_[i].set_target(now, commanded_[i], parameters_.stage[i]);
    } else {
      stages_[i].neutral(now);
    }
  }
}

void ValveAmplifier::release(SimTime now) {
  for (ValveStage& stage : stages_) {
    stage.neutral(now);
  }
}

void ValveAmplifier::step_ramps(SimTime now) {
  if (next_ramp_ == kNever) {
    return;
  }
  for (std::size_t i = 0; i < sections(); ++i) {
    stages_[i].advance(now, parameters_.stage[i]);
  }
  schedule_ramp(now);
  refresh_set_points(now);
}

void ValveAmplifier::schedule_ramp(SimTime now) {
  const bool ramping = enabled_ && std::ranges::any_of(stages_, &ValveStage::ramping);
  next_ramp_ = ramping ? SamplePlan{kStart, settings_.ramp_cycle}.next_after(now) : kNever;
}

void ValveAmplifier::latch(SimTime now, ValveFault fault, std::optional<std::size_t> section) {
  if (fault_ != ValveFault::none) {
    return;
  }
  step_ramps(now);
  if (fault_ != ValveFault::none) {
    return;
  }
  fault_ = fault;
  fault_section_ = section;
  enabled_ = false;
  if (fault == ValveFault::watchdog) {
    watchdog_tripped_ = true;
    active_reaction_ = quick_stop_ ? ValveReaction::neutral : parameters_.reaction;
  }
  next_ramp_ = kNever;
  refresh_set_points(now);
  release(now);
}

ValveDefects::Id ValveAmplifier::begin(const ValveDefect& defect) {
  check_section(defect, sections());
  next_defect_ = std::min(next_defect_, defect.when.begin());
  return defects_.add(defect);
}

bool ValveAmplifier::end(ValveDefects::Id id, SimTime now) {
  next_defect_ = std::min(next_defect_, now);
  return defects_.end(id, now);
}

void ValveAmplifier::take_defects(SimTime now) {
  const ValveElectronics& electronics = settings_.electronics;
  defect_ =
      defect_state(defects_, now, electronics.supply_voltage_v, electronics.ambient_temperature_c);
  next_defect_ = defects_.next_change(now);
  refresh_output(now);
}

void ValveAmplifier::refresh_set_points(SimTime now) {
  if (enabled_ || active_reaction_ != ValveReaction::hold) {
    for (std::size_t i = 0; i < sections(); ++i) {
      floating_[i] = section_on_[i] && (enabled_ ? float_wanted_[i] && !quick_stop_
                                                 : active_reaction_ == ValveReaction::floating);
      const double idle = section_on_[i] && active_reaction_ == ValveReaction::position
                              ? parameters_.loss_position
                              : 0.0;
      set_point_[i] = floating_[i] ? 0.0
                      : enabled_   ? stages_[i].opening(parameters_.stage[i])
                                   : idle;
    }
  }
  refresh_output(now);
}

double ValveAmplifier::wanted_ma(std::size_t section) const {
  const double opening = std::abs(set_point_[section]);
  if (opening == 0.0) {
    return 0.0;
  }
  // Linear from the current at the minimum opening to that at the full one.
  return parameters_.current_start_ma +
         (parameters_.current_full_ma - parameters_.current_start_ma) * opening;
}

bool ValveAmplifier::limited(std::size_t section) const {
  return defect_.coil_shorted[section] || coils_[section].greatest_ma() < wanted_ma(section);
}

double ValveAmplifier::carried(std::size_t section) const {
  const double set_point = set_point_[section];
  if (set_point == 0.0 || !limited(section)) {
    return set_point;
  }
  if (defect_.coil_shorted[section]) {
    return 0.0;
  }
  const double span_ma = parameters_.current_full_ma - parameters_.current_start_ma;
  // Inverse of wanted_ma(): the opening that the maximum current carries.
  const double opening = (coils_[section].greatest_ma() - parameters_.current_start_ma) / span_ma;
  return std::copysign(std::clamp(opening, 0.0, std::abs(set_point)), set_point);
}

void ValveAmplifier::refresh_output(SimTime now) {
  drive_coils(now);
  ValveCommand next = command_;
  for (std::size_t i = 0; i < sections(); ++i) {
    if (!defect_.spool_stuck[i]) {
      next.opening[i] = carried(i);
      next.floating[i] = floating_[i];
    }
  }
  if (next.opening != command_.opening || next.floating != command_.floating) {
    next.time = now;
    command_ = next;
  }
  supervise(now);
}

void ValveAmplifier::drive_coils(SimTime now) {
  const ValveElectronics& electronics = settings_.electronics;
  double power_w = electronics.idle_power_w;
  for (std::size_t i = 0; i < sections(); ++i) {
    const double current_a = defect_.coil_shorted[i] ? 0.0 : coils_[i].current_ma(now) * 1e-3;
    // Losses of the output stages, i^2 R.
    power_w += current_a * current_a * electronics.output_resistance_ohm;
  }
  driver_temperature_c_ = warmed_c(driver_temperature_c_, defect_.ambient_c, power_w,
                                   electronics.thermal_resistance_kpw,
                                   electronics.thermal_time_constant_s, now - driver_warmed_until_);
  driver_warmed_until_ = now;
  const double surroundings_c = measurements_ > 0 ? measured_.oil_temperature_c : defect_.ambient_c;
  for (std::size_t i = 0; i < sections(); ++i) {
    coils_[i].drive(now, {wanted_ma(i), defect_.supply_voltage_v, defect_.coil_open[i],
                          defect_.coil_shorted[i], surroundings_c});
  }
}

void ValveAmplifier::supervise(SimTime now) {
  const ValveElectronics& electronics = settings_.electronics;
  note(under_voltage_since_, defect_.supply_voltage_v < electronics.under_voltage_v, now);
  for (std::size_t i = 0; i < sections(); ++i) {
    const double wanted = wanted_ma(i);
    // What flows in the end: the rise of a sound coil's current is no suspicion.
    const double flows = std::min(coils_[i].greatest_ma(), defect_.coil_shorted[i] ? 1e9 : wanted);
    const bool open = wanted > 0.0 && flows < electronics.open_share * wanted;
    note(coil_open_since_[i], open && under_voltage_since_ == kNever, now);
    note(over_current_since_[i], wanted > 0.0 && flows > electronics.over_current_ma, now);
  }
  if (fault_ != ValveFault::none) {
    return;
  }
  for (std::size_t i = 0; i < sections(); ++i) {
    if (later(over_current_since_[i], electronics.over_current_delay) <= now) {
      return latch(now, ValveFault::over_current, i);
    }
    if (later(coil_open_since_[i], electronics.open_delay) <= now) {
      return latch(now, ValveFault::open_coil, i);
    }
  }
  if (later(under_voltage_since_, electronics.under_voltage_delay) <= now) {
    return latch(now, ValveFault::under_voltage);
  }
  if (driver_temperature_c_ >= electronics.over_temperature_c) {
    latch(now, ValveFault::over_temperature);
  }
}

void ValveAmplifier::update(const ValveSample& sample) {
  advance(sample.time);
  for (std::size_t i = 0; i < sections(); ++i) {
    const bool lost = defect_.sensor_lost[i] || !std::isfinite(sample.spool_position[i]);
    if (lost) {
      latch(sample.time, ValveFault::sensor, i);
    } else {
      measured_.spool_position[i] = sample.spool_position[i];
    }
    take(measured_.port_a_pressure_pa[i], sample.port_a_pressure_pa[i]);
    take(measured_.port_b_pressure_pa[i], sample.port_b_pressure_pa[i]);
  }
  take(measured_.supply_pressure_pa, sample.supply_pressure_pa);
  take(measured_.tank_pressure_pa, sample.tank_pressure_pa);
  take(measured_.swing_angle_rad, sample.swing_angle_rad);
  take(measured_.swing_rate_radps, sample.swing_rate_radps);
  take(measured_.oil_temperature_c, sample.oil_temperature_c);
  measured_.time = sample.time;
  ++measurements_;
  supervise_spools(sample);
  refresh_output(sample.time);  // what is warmer now carries less
}

void ValveAmplifier::supervise_spools(const ValveSample& sample) {
  for (std::size_t i = 0; i < sections(); ++i) {
    const double error = sample.spool_position[i] - set_point_[i];
    const bool off = enabled_ && !floating_[i] && std::abs(error) > settings_.spool_tolerance;
    note(spool_off_since_[i], off, sample.time);
    if (off && settings_.spool_fault_delay > Duration{0} &&
        sample.time - spool_off_since_[i] >= settings_.spool_fault_delay) {
      latch(sample.time, ValveFault::spool_not_following, i);
    }
  }
}

bool ValveAmplifier::at_limit() const {
  for (std::size_t i = 0; i < sections(); ++i) {
    if (std::abs(set_point_[i]) >= 1.0 || (set_point_[i] != 0.0 && limited(i))) {
      return true;
    }
  }
  return false;
}

double ValveAmplifier::current_ma(SimTime now, std::size_t section) const {
  const ValveCoil& coil = coils_[section];
  return coil.current_ma(now) + coil.dither_ma(now, parameters_.dither);
}

double ValveAmplifier::position(SimTime now, std::size_t section) const {
  const double mean = measured_.spool_position[section];
  const double amplitude_ma = coils_[section].dither_amplitude_ma(now, parameters_.dither);
  if (amplitude_ma <= 0.0 || defect_.spool_stuck[section]) {
    return mean;
  }
  const double omega = 2.0 * std::numbers::pi * parameters_.dither.frequency_hz;
  // Dither through the spool's lag: amplitude / sqrt(1 + (w tau)^2), phase -atan(w tau).
  const double lag = omega * settings_.spool_time_constant_s;
  const double span_ma = std::max(1.0, parameters_.current_full_ma - parameters_.current_start_ma);
  const double ripple = amplitude_ma / span_ma / std::hypot(1.0, lag);
  return mean + std::copysign(ripple, set_point_[section]) *
                    std::sin(2.0 * std::numbers::pi *
                                 std::fmod(parameters_.dither.frequency_hz * to_seconds(now), 1.0) -
                             std::atan(lag));
}

double ValveAmplifier::coil_temperature_c(std::size_t section) const {
  return coils_[section].temperature_c();
}

}  // namespace rigwire::emulators

#include "emulators/valve_driver/valve_driver.h"

#include <algorithm>
#include <cmath>

namespace rigwire::emulators {

using namespace valve_registers;
using protocols::modbus::find_register;
using protocols::modbus::RegisterEntry;
using protocols::modbus::Table;

namespace {

constexpr double kPerMille = 1e-3;
constexpr double kPercent = 100.0;
constexpr double kPascalPerBar = 1e5;
constexpr double kDegreesPerRadian = 57.295779513082320877;

const ValveDriverSettings& validated(const ValveDriverSettings& settings) {
  validate(settings);
  return settings;
}

Duration milliseconds(std::uint16_t count) {
  return std::chrono::milliseconds(count);
}

}  // namespace

ValveDriver::ValveDriver(const ValveDriverSettings& settings)
    : settings_(validated(settings)), unit_(*this) {
  for (const RegisterEntry& entry : map()) {
    std::size_t address = entry.address;
    for (int i = 0; entry.table == Table::holding_registers && i < entry.count; ++i) {
      holding_[address] = static_cast<std::uint16_t>(entry.initial);
      address += entry.stride;
    }
  }
  holding_[kWatchdog] = static_cast<std::uint16_t>(settings.watchdog / milliseconds(1));
  holding_[kReaction] = static_cast<std::uint16_t>(settings.reaction);
  take_parameters();
  store(kSupplyVoltage, settings.supply_voltage_v);
  store(kDriverTemperature, settings.driver_temperature_c);
  spool_off_since_.fill(kNever);
  describe_quantities();
}

void ValveDriver::advance(SimTime now) {
  for (SimTime event = next_event(); event <= now; event = next_event()) {
    if (watchdog_deadline() <= event) {
      latch(event, FaultCode::watchdog);
    } else {
      step_ramps(event);
    }
  }
}

SimTime ValveDriver::next_event() const {
  return std::min(watchdog_deadline(), next_ramp_);
}

SamplePlan ValveDriver::sample_plan() const {
  return {kStart, settings_.sample_period};
}

SimTime ValveDriver::watchdog_deadline() const {
  return enabled_ && holding_[kWatchdog] != 0 ? fed_ + milliseconds(holding_[kWatchdog]) : kNever;
}

void ValveDriver::apply_write(SimTime now, std::uint16_t address,
                              std::span<const std::uint16_t> values) {
  step_ramps(now);  // up to here by the old parameters
  const std::uint16_t old_control = holding_[kControl];
  const std::uint16_t old_heartbeat = holding_[kHeartbeat];
  std::ranges::copy(values, std::span(holding_).subspan(address).begin());
  const auto wrote = [&](std::size_t at) { return at >= address && at < address + values.size(); };
  if (wrote(kHeartbeat)) {
    count_heartbeat(now, old_heartbeat, holding_[kHeartbeat]);
  }
  if (wrote(kWatchdog) || wrote(kWatchdogSource)) {
    fed_ = now;
  }
  take_parameters();
  std::array<bool, kValveSections> commanded{};
  for (std::size_t section = 0; section < kValveSections; ++section) {
    commanded[section] = wrote(kSpoolCommand + section);
  }
  apply_control(now, old_control, commanded);
}

void ValveDriver::apply_control(SimTime now, std::uint16_t old_control,
                                const std::array<bool, kValveSections>& written) {
  const std::uint16_t control = holding_[kControl];
  if ((control & ~old_control & kControlFaultReset) != 0) {
    fault_ = FaultCode::none;
    watchdog_tripped_ = false;
    active_reaction_ = Reaction::neutral;
    spool_off_since_.fill(kNever);
  }
  const bool wanted = (control & kControlEnable) != 0;
  const bool quick_stop = (control & kControlQuickStop) != 0;
  if (!wanted || quick_stop) {
    active_reaction_ = Reaction::neutral;
  }
  const bool was_enabled = enabled_;
  const bool was_driving = was_enabled && (old_control & kControlQuickStop) == 0;
  enabled_ = wanted && fault_ == FaultCode::none;
  if (enabled_ && !was_enabled) {
    fed_ = now;
  }
  if (enabled_ && !quick_stop && !was_driving) {
    for (std::size_t section = 0; section < kValveSections; ++section) {
      if (!written[section]) {
        holding_[kSpoolCommand + section] = 0;
      }
    }
  }
  if (enabled_ && !quick_stop) {
    set_targets(now);
  } else if (active_reaction_ == Reaction::neutral) {
    release(now);
  }
  schedule_ramp(now);
  refresh_output(now);
}

void ValveDriver::count_heartbeat(SimTime now, std::uint16_t old_value, std::uint16_t new_value) {
  constexpr std::uint16_t kRestart = 1000;  // a step this large is a master that started anew
  const auto step = static_cast<std::uint16_t>(new_value - old_value);
  if (step != 0) {
    fed_ = now;
  }
  if (heartbeat_seen_ && step > 1 && step < kRestart) {
    missed_cycles_ = static_cast<std::uint16_t>(missed_cycles_ + step - 1);
  }
  heartbeat_seen_ = true;
}

void ValveDriver::take_parameters() {
  for (std::size_t section = 0; section < kValveSections; ++section) {
    const auto at = [&](Parameter which) {
      return holding_[kSectionParameters + kParameterStride * section + which];
    };
    parameters_[section] = {at(dead_band_positive) * kPerMille,
                            at(dead_band_negative) * kPerMille,
                            milliseconds(at(ramp_up)),
                            milliseconds(at(ramp_down)),
                            at(gain) * kPerMille,
                            static_cast<double>(static_cast<std::int16_t>(at(polarity)))};
  }
}

void ValveDriver::set_targets(SimTime now) {
  for (std::size_t section = 0; section < settings_.sections.size(); ++section) {
    const auto command = static_cast<std::int16_t>(holding_[kSpoolCommand + section]);
    stages_[section].set_target(now, command * kPerMille, parameters_[section]);
  }
}

void ValveDriver::release(SimTime now) {
  for (ValveStage& stage : stages_) {
    stage.neutral(now);
  }
}

void ValveDriver::step_ramps(SimTime now) {
  if (next_ramp_ == kNever) {
    return;
  }
  for (std::size_t section = 0; section < settings_.sections.size(); ++section) {
    stages_[section].advance(now, parameters_[section]);
  }
  schedule_ramp(now);
  refresh_output(now);
}

void ValveDriver::schedule_ramp(SimTime now) {
  const bool ramping = enabled_ && std::ranges::any_of(stages_, &ValveStage::ramping);
  next_ramp_ = ramping ? SamplePlan{kStart, settings_.ramp_cycle}.next_after(now) : kNever;
}

void ValveDriver::latch(SimTime now, FaultCode code) {
  if (fault_ != FaultCode::none) {
    return;
  }
  step_ramps(now);
  fault_ = code;
  enabled_ = false;
  if (code == FaultCode::watchdog) {
    watchdog_tripped_ = true;
    const bool quick_stop = (holding_[kControl] & kControlQuickStop) != 0;
    active_reaction_ = quick_stop ? Reaction::neutral : static_cast<Reaction>(holding_[kReaction]);
  }
  next_ramp_ = kNever;
  refresh_output(now);
  release(now);
}

void ValveDriver::refresh_output(SimTime now) {
  if (!enabled_ && active_reaction_ == Reaction::hold) {
    return;
  }
  const std::uint16_t control = holding_[kControl];
  const bool floating = enabled_
                            ? (control & kControlFloat) != 0 && (control & kControlQuickStop) == 0
                            : active_reaction_ == Reaction::floating;
  ValveCommand next;
  for (std::size_t section = 0; section < settings_.sections.size(); ++section) {
    next.floating[section] = floating;
    if (enabled_ && !floating) {
      next.opening[section] = stages_[section].opening(parameters_[section]);
    }
  }
  if (next.opening != command_.opening || next.floating != command_.floating) {
    next.time = now;
    command_ = next;
  }
}

void ValveDriver::update(const ValveSample& sample) {
  advance(sample.time);
  for (std::size_t i = 0; i < settings_.sections.size(); ++i) {
    if (!std::isfinite(sample.spool_position[i])) {
      latch(sample.time, FaultCode::sensor);
    }
    store(static_cast<std::uint16_t>(kSpoolPosition + i), sample.spool_position[i] * kPercent);
    store(static_cast<std::uint16_t>(kPortAPressure + i),
          sample.port_a_pressure_pa[i] / kPascalPerBar);
    store(static_cast<std::uint16_t>(kPortBPressure + i),
          sample.port_b_pressure_pa[i] / kPascalPerBar);
  }
  store(kSwingAngle, sample.swing_angle_rad * kDegreesPerRadian);
  store(kSwingRate, sample.swing_rate_radps * kDegreesPerRadian);
  store(kSupplyPressure, sample.supply_pressure_pa / kPascalPerBar);
  store(kOilTemperature, sample.oil_temperature_c);
  ++measured_[kMeasurementCount];
  supervise_spools(sample);
}

void ValveDriver::store(std::uint16_t address, double value) {
  const auto place = find_register(map(), Table::input_registers, address);
  if (!place || !std::isfinite(value)) {
    return;
  }
  const auto counts = static_cast<std::uint32_t>(to_counts(*place->entry, value));
  if (words_of(place->entry->format) == 2) {
    measured_[address] = static_cast<std::uint16_t>(counts >> 16U);
    ++address;
  }
  measured_[address] = static_cast<std::uint16_t>(counts & 0xFFFFU);
}

void ValveDriver::supervise_spools(const ValveSample& sample) {
  for (std::size_t section = 0; section < settings_.sections.size(); ++section) {
    const double error = sample.spool_position[section] - command_.opening[section];
    const bool off =
        enabled_ && !command_.floating[section] && std::abs(error) > settings_.spool_tolerance;
    SimTime& since = spool_off_since_[section];
    since = !off ? kNever : std::min(since, sample.time);
    if (off && settings_.spool_fault_delay > Duration{0} &&
        sample.time - since >= settings_.spool_fault_delay) {
      latch(sample.time, FaultCode::spool_not_following);
    }
  }
}

void ValveDriver::describe_quantities() {
  for (const RegisterEntry& entry : map()) {
    if (!entry.unit.empty()) {
      quantities_.push_back({entry.name, entry.unit, to_physical(entry, entry.lower),
                             to_physical(entry, entry.upper), entry.scale});
    }
  }
}

}  // namespace rigwire::emulators

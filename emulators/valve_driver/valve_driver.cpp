#include "emulators/valve_driver/valve_driver.h"

#include <algorithm>
#include <cmath>

#include "emulators/valve_driver/signal_units.h"

namespace rigwire::emulators {

namespace {

const ValveDriverSettings& validated(const ValveDriverSettings& settings) {
  validate(settings);
  return settings;
}

Duration milliseconds(double count) {
  return from_seconds(std::clamp(count, 0.0, 3.6e6) * 1e-3);
}

bool is_boolean(ValveSignal signal) {
  using enum ValveSignal;
  return signal == enable || signal == enable_section || signal == fault_reset ||
         signal == floating || signal == quick_stop;
}

}  // namespace

ValveDriver::ValveDriver(const ValveDriverSettings& settings)
    : settings_(validated(settings)),
      map_(settings.map ? *settings.map
                        : valve_registers::map(settings.amplifier.sections.size(),
                                               settings.amplifier.parameters)),
      image_(map_),
      amplifier_(settings.amplifier),
      enabled_by_section_(enabled_by_section(map_)),
      feed_(map_.watchdog_feed),
      unit_(*this) {
  power_up();
  describe_quantities();
}

void ValveDriver::power_up() {
  Change change;
  change.parameters = amplifier_.parameters();
  change.request.enable = map_.always_enabled;
  if (enabled_by_section_) {
    change.request.section_enable.fill(false);
  }
  for (const ValveRegister& entry : map_.registers) {
    for (std::size_t i = 0; entry.writable && i < entry.count; ++i) {
      if (entry.initial) {
        image_.set(entry, i, encode_count(entry, *entry.initial));
        collect(entry, i, change);
      }
    }
  }
  act(kStart, change);
  for (const ValveRegister& entry : map_.registers) {
    for (std::size_t i = 0; entry.writable && !entry.initial && i < entry.count; ++i) {
      image_.set(entry, i, encode_count(entry, count_of(entry, i)));
    }
  }
  heartbeat_seen_ = false;
  missed_cycles_ = 0;
}

void ValveDriver::advance(SimTime now) {
  amplifier_.advance(now);
  now_ = now;
}

SamplePlan ValveDriver::sample_plan() const {
  return {kStart, settings_.sample_period};
}

void ValveDriver::update(const ValveSample& sample) {
  amplifier_.update(sample);
  now_ = std::max(now_, sample.time);
}

void ValveDriver::feed(SimTime now) {
  if (map_.watchdog_recovers && amplifier_.watchdog_tripped()) {
    ValveRequest again;
    again.fault_reset = false;
    amplifier_.request(now, again);
    again.fault_reset = true;
    for (std::size_t i = 0; i < kValveSections; ++i) {
      again.command[i] = amplifier_.commanded(i);
    }
    amplifier_.request(now, again);
    again = {};
    again.fault_reset = false;
    amplifier_.request(now, again);
  }
  amplifier_.feed(now);
}

void ValveDriver::count_heartbeat(SimTime now, std::uint16_t value) {
  constexpr std::uint16_t kRestart = 1000;  // a step this large is a master that started anew
  const auto step = static_cast<std::uint16_t>(value - heartbeat_);
  heartbeat_ = value;
  if (step != 0 && feed_ == WatchdogFeed::heartbeat_change) {
    feed(now);
  }
  if (heartbeat_seen_ && step > 1 && step < kRestart) {
    missed_cycles_ = static_cast<std::uint16_t>(missed_cycles_ + step - 1);
  }
  heartbeat_seen_ = true;
}

void ValveDriver::complete(Change& change) {
  bool any_on = false;
  for (std::size_t i = 0; i < amplifier_.sections(); ++i) {
    if (change.towards_a[i] || change.towards_b[i]) {
      towards_a_[i] = change.towards_a[i].value_or(towards_a_[i]);
      towards_b_[i] = change.towards_b[i].value_or(towards_b_[i]);
      change.request.command[i] = (towards_a_[i] - towards_b_[i]) / kPercent;
    }
    any_on = any_on || change.request.section_enable[i].value_or(amplifier_.section_on(i));
  }
  if (enabled_by_section_) {
    change.request.enable = any_on;
  }
}

void ValveDriver::act(SimTime now, Change change) {
  complete(change);
  now_ = now;
  feed_ = change.feed.value_or(feed_);
  if (change.heartbeat) {
    count_heartbeat(now, *change.heartbeat);
  }
  if (change.watchdog_written || feed_ == WatchdogFeed::any_write ||
      (feed_ == WatchdogFeed::command_write && change.command_written)) {
    feed(now);
  }
  if (change.parameters_written) {
    amplifier_.set_parameters(now, change.parameters);
  }
  amplifier_.request(now, change.request);
  forget_commands();
}

void ValveDriver::forget_commands() {
  for (const ValveRegister& entry : map_.registers) {
    if (!is_spool_command(entry.signal) || !entry.writable) {
      continue;
    }
    for (std::size_t i = 0; i < entry.count && entry.section + i < amplifier_.sections(); ++i) {
      const std::size_t section = entry.section + i;
      const bool is_half = entry.signal != ValveSignal::command;
      const bool balanced = is_half && towards_a_[section] == towards_b_[section];
      const double count = image_.count(entry, i);
      const bool asks = count * entry.scale + entry.offset != 0.0 && !balanced;
      if (asks && amplifier_.commanded(section) == 0.0) {
        image_.set(entry, i, encode_count(entry, -entry.offset / entry.scale));
      }
    }
  }
  for (std::size_t i = 0; i < amplifier_.sections(); ++i) {
    if (amplifier_.commanded(i) == 0.0 && towards_a_[i] != towards_b_[i]) {
      towards_a_[i] = towards_b_[i] = 0.0;
    }
  }
}

void ValveDriver::collect(const ValveRegister& entry, std::size_t index, Change& change) const {
  const double count = image_.count(entry, index);
  if (entry.signal == ValveSignal::bits) {
    for (const RegisterBit& bit : entry.bits) {
      const bool set = (static_cast<std::uint32_t>(count) >> bit.bit & 1U) != 0;
      collect(bit.signal, bit.section, set != bit.inverted ? 1.0 : 0.0, change);
    }
    return;
  }
  double value =
      (count * entry.scale + entry.offset) * unit_factor(entry.signal, entry.unit).value_or(1.0);
  const auto row = std::ranges::find(entry.values, count, &RegisterTranslation::count);
  if (row != entry.values.end()) {
    value = row->value;
  } else if (!entry.values.empty() && is_boolean(entry.signal)) {
    value = 0.0;
  }
  if (info(entry.signal).per_section) {
    collect(entry.signal, entry.section + index, value, change);
  } else {
    collect(entry.signal, std::nullopt, value, change);
  }
}

void ValveDriver::collect(ValveSignal signal, std::optional<std::size_t> section, double value,
                          Change& change) const {
  using enum ValveSignal;
  if (section && *section >= amplifier_.sections()) {
    return;
  }
  ValveAmplifierParameters& p = change.parameters;
  const auto each = [&](auto&& set) {
    for (std::size_t i = 0; i < amplifier_.sections(); ++i) {
      if (!section || *section == i) {
        set(i);
      }
    }
  };
  const bool on = value != 0.0;
  switch (signal) {
    case command:
      change.command_written = true;
      each([&](std::size_t i) { change.request.command[i] = value / kPercent; });
      return;
    case command_a:
      change.command_written = true;
      each([&](std::size_t i) { change.towards_a[i] = std::clamp(value, 0.0, kPercent); });
      return;
    case command_b:
      change.command_written = true;
      each([&](std::size_t i) { change.towards_b[i] = std::clamp(value, 0.0, kPercent); });
      return;
    case enable:
      change.request.enable = on;
      return;
    case enable_section:
      each([&](std::size_t i) { change.request.section_enable[i] = on; });
      return;
    case fault_reset:
      change.request.fault_reset = on;
      return;
    case quick_stop:
      change.request.quick_stop = on;
      return;
    case floating:
      each([&](std::size_t i) { change.request.floating[i] = on; });
      return;
    case heartbeat:
      change.heartbeat = static_cast<std::uint16_t>(
          static_cast<std::uint64_t>(std::clamp(value, 0.0, 4294967295.0)) & 0xFFFFU);
      return;
    case watchdog_source:
      change.watchdog_written = true;
      change.feed = static_cast<WatchdogFeed>(std::clamp(value, 0.0, 3.0));
      return;
    default:
      break;
  }
  change.parameters_written = true;
  switch (signal) {
    case watchdog:
      change.watchdog_written = true;
      p.watchdog = milliseconds(value);
      return;
    case reaction:
      p.reaction = static_cast<ValveReaction>(std::clamp(value, 0.0, 3.0));
      return;
    case loss_position:
      p.reaction = value > kHold_percent ? ValveReaction::hold : ValveReaction::position;
      p.loss_position =
          value > kHold_percent ? p.loss_position : std::clamp(value / kPercent, -1.0, 1.0);
      return;
    case dead_band_positive:
      return each([&](std::size_t i) {
        p.stage[i].dead_band_positive = std::clamp(value / kPercent, 0.0, 0.5);
      });
    case dead_band_negative:
      return each([&](std::size_t i) {
        p.stage[i].dead_band_negative = std::clamp(value / kPercent, 0.0, 0.5);
      });
    case ramp_up:
      return each([&](std::size_t i) { p.stage[i].ramp_up = milliseconds(value); });
    case ramp_down:
      return each([&](std::size_t i) { p.stage[i].ramp_down = milliseconds(value); });
    case gain:
      return each([&](std::size_t i) { p.stage[i].gain = std::clamp(value / kPercent, 0.0, 2.0); });
    case polarity:
      return each([&](std::size_t i) { p.stage[i].polarity = value < 0.0 ? -1.0 : 1.0; });
    case current_start:
      p.current_start_ma = std::clamp(value, 0.0, 65535.0);
      return;
    case current_full:
      p.current_full_ma = std::clamp(value, 0.0, 65535.0);
      return;
    case dither_amplitude:
      p.dither.amplitude_ma = std::clamp(value, 0.0, 500.0);
      return;
    case dither_frequency:
      p.dither.frequency_hz = std::clamp(value, 20.0, 400.0);
      return;
    default:
      change.parameters_written = false;  // stored: nothing acts
  }
}

void ValveDriver::describe_quantities() {
  for (const ValveRegister& entry : map_.registers) {
    if (!entry.unit.empty()) {
      const double ends[] = {entry.least() * entry.scale + entry.offset,
                             entry.greatest() * entry.scale + entry.offset};
      quantities_.push_back({entry.name, entry.unit, std::min(ends[0], ends[1]),
                             std::max(ends[0], ends[1]), std::abs(entry.scale)});
    }
  }
}

}  // namespace rigwire::emulators

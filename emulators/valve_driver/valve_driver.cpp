#include "emulators/valve_driver/valve_driver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/constants.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

using protocols::modbus::BitBlock;
using protocols::modbus::ExceptionCode;
using namespace std::chrono_literals;

namespace {

constexpr double kPercent = 100.0;  // of full command or travel
// A position after loss of the master beyond this one means: hold.
constexpr double kHold_percent = 100.0;

Duration milliseconds(double count) {
  return from_seconds(std::clamp(count, 0.0, 3.6e6) * 1e-3);
}

bool is_boolean(ValveSignal signal) {
  using enum ValveSignal;
  return signal == enable || signal == enable_section || signal == fault_reset ||
         signal == floating || signal == quick_stop;
}

constexpr std::array<fields::Choice<ValveReaction>, 4> kReactions{
    {{ValveReaction::neutral, "neutral", "Spools go to neutral."},
     {ValveReaction::hold, "hold", "Spools stay where they are."},
     {ValveReaction::floating, "floating", "Spools connect the ports to the tank."},
     {ValveReaction::position, "position", "Spools go to loss_position, which the master sets."}}};

constexpr double kPascalPerBar = 1e5;

double milliseconds(Duration span) {
  return to_seconds(span) * 1e3;
}

/// The parameter that a signal is, of one section or of all, where it is a plain number of the
/// signal's unit or of a hundredth; nullptr for others.
template <class Parameters>
auto number_of(Parameters& p, std::size_t section, ValveSignal signal)
    -> decltype(&p.current_start_ma) {
  using enum ValveSignal;
  switch (signal) {
    case dead_band_positive:
      return &p.stage[section].dead_band_positive;
    case dead_band_negative:
      return &p.stage[section].dead_band_negative;
    case gain:
      return &p.stage[section].gain;
    case current_start:
      return &p.current_start_ma;
    case current_full:
      return &p.current_full_ma;
    case dither_amplitude:
      return &p.dither.amplitude_ma;
    case dither_frequency:
      return &p.dither.frequency_hz;
    default:
      return nullptr;
  }
}
double per_number(const ValveSignalInfo& signal) {
  return signal.unit == "%" ? kPercent : 1.0;
}
/// Returns the duration parameter (ms in the map) that a signal sets; null for other signals.
template <class Parameters>
auto span_of(Parameters& p, std::size_t section, ValveSignal signal) -> decltype(&p.watchdog) {
  switch (signal) {
    case ValveSignal::watchdog:
      return &p.watchdog;
    case ValveSignal::ramp_up:
      return &p.stage[section].ramp_up;
    case ValveSignal::ramp_down:
      return &p.stage[section].ramp_down;
    default:
      return nullptr;
  }
}

}  // namespace

ValveDriver::ValveDriver(const ValveDriverSettings& settings)
    : settings_(checked(settings)),
      map_(settings.map ? *settings.map
                        : valve_registers::map(settings.amplifier.sections.size(),
                                               settings.amplifier.parameters)),
      image_(map_),
      amplifier_(settings.amplifier),
      enabled_by_section_(enabled_by_section(map_)),
      supply_({.power_on = Duration{0}, .faults = settings_.supply_faults}),
      feed_(map_.watchdog_feed),
      unit_(*this) {
  if (supply_.next_change() <= kStart) {
    switch_supply(kStart);
  }
  describe_quantities();
}

void ValveDriver::switch_supply(SimTime now) {
  supply_.change();
  amplifier_.restart(now);
  if (supply_.on()) {
    ++starts_;
    power_up(now);
  }
}

void ValveDriver::power_up(SimTime now) {
  feed_ = map_.watchdog_feed;
  towards_a_.fill(0.0);
  towards_b_.fill(0.0);
  heartbeat_ = 0;
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
  act(now, change);
  for (const ValveRegister& entry : map_.registers) {
    for (std::size_t i = 0; entry.writable && !entry.initial && i < entry.count; ++i) {
      image_.set(entry, i, encode_count(entry, count_of(entry, i)));
    }
  }
  heartbeat_seen_ = false;
  missed_cycles_ = 0;
}

void ValveDriver::advance(SimTime now) {
  while (supply_.next_change() <= now) {
    const SimTime instant = supply_.next_change();
    amplifier_.advance(instant);
    switch_supply(instant);
  }
  amplifier_.advance(now);
  now_ = now;
}

SamplePlan ValveDriver::sample_plan() const {
  return {kStart, settings_.sample_period};
}

void ValveDriver::update(const ValveSample& sample) {
  advance(sample.time);
  if (supply_.on()) {
    amplifier_.update(sample);
  }
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
    case reaction:
      change.parameters_written = true;
      p.reaction = static_cast<ValveReaction>(std::clamp(value, 0.0, 3.0));
      return;
    case loss_position:
      change.parameters_written = true;
      p.reaction = value > kHold_percent ? ValveReaction::hold : ValveReaction::position;
      p.loss_position =
          value > kHold_percent ? p.loss_position : std::clamp(value / kPercent, -1.0, 1.0);
      return;
    case polarity:
      change.parameters_written = true;
      return each([&](std::size_t i) { p.stage[i].polarity = value < 0.0 ? -1.0 : 1.0; });
    default:
      break;
  }
  const ValveSignalInfo& row = info(signal);
  each([&](std::size_t i) {
    auto* const number = number_of(p, i, signal);
    auto* const span = span_of(p, i, signal);
    if (number != nullptr) {
      *number = std::clamp(value, row.least, row.greatest) / per_number(row);
    } else if (span != nullptr) {
      *span = milliseconds(value);
    } else {
      return;  // stored: nothing acts
    }
    change.parameters_written = true;
  });
  change.watchdog_written = change.watchdog_written || signal == watchdog;
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

// Keys and checks of the valve driver's settings.

void visit(fields::Visitor& v, ValveDriverSettings& p) {
  v.duration("watchdog", p.amplifier.parameters.watchdog, {0, 3'600'000'000'000},
             "Without a request for this long the reaction follows; 0 = never.");
  v.choice("reaction", p.amplifier.parameters.reaction, kReactions,
           "What the outputs do when the watchdog runs out.");
  v.rate("rate", p.sample_period, fields::in("Hz").between(1, 1000),
         "Readings of the transducers per second.");
  visit(v, p.amplifier);
}

void validate(const ValveDriverSettings& settings) {
  fields::check(settings);
  validate(settings.amplifier);
  for (const SupplyFault& fault : settings.supply_faults) {
    fields::check(fault);
  }
  if (settings.map) {
    validate(*settings.map);
    return;
  }
  const Duration watchdog = settings.amplifier.parameters.watchdog;
  const bool fits = watchdog >= 20ms && watchdog <= 5s && watchdog % 1ms == 0ns;
  if (watchdog != 0ns && !fits) {
    throw std::invalid_argument("valve driver watchdog: found " +
                                std::to_string(to_seconds(watchdog) * 1e3) +
                                " ms, allowed 0 or 20 .. 5000 ms, whole milliseconds");
  }
}

// What the valve driver's registers read: every signal's value in its map's units and counts.

RegisterWords ValveDriver::words_of(const ValveRegister& entry, std::size_t index) const {
  if (entry.writable) {
    return image_.words(entry, index);
  }
  return encode_count(entry, count_of(entry, index));
}

double ValveDriver::count_of(const ValveRegister& entry, std::size_t index) const {
  if (entry.signal == ValveSignal::constant || entry.signal == ValveSignal::stored) {
    return entry.initial.value_or(0.0);
  }
  if (entry.signal == ValveSignal::bits) {
    std::uint32_t word = 0;
    for (const RegisterBit& bit : entry.bits) {
      const bool on = value_of(bit.signal, bit.section.value_or(0)) != 0.0;
      word |= (on != bit.inverted ? 1U : 0U) << bit.bit;
    }
    return word;
  }
  const std::size_t section = entry.section + index;
  if (info(entry.signal).per_section && section >= amplifier_.sections()) {
    return std::clamp(0.0, entry.least(), entry.greatest());
  }
  const double value = value_of(entry.signal, section);
  if (std::isnan(value)) {
    return entry.initial.value_or(0.0);  // nothing measured yet
  }
  const auto row = std::ranges::find(entry.values, value, &RegisterTranslation::value);
  if (row != entry.values.end()) {
    return row->count;
  }
  const double in_unit = value / unit_factor(entry.signal, entry.unit).value_or(1.0);
  return (in_unit - entry.offset) / entry.scale;
}

// Returns the present value of a signal in its unit (ValveSignalInfo::unit); commands and positions
// in %.
double ValveDriver::value_of(ValveSignal signal, std::size_t section) const {
  using enum ValveSignal;
  const auto bit = [](bool on) { return on ? 1.0 : 0.0; };
  switch (signal) {
    case command:
      return amplifier_.commanded(section) * kPercent;
    case command_a:
      return std::max(0.0, amplifier_.commanded(section)) * kPercent;
    case command_b:
      return std::max(0.0, -amplifier_.commanded(section)) * kPercent;
    case enable:
      return bit(map_.always_enabled);
    case enable_section:
      return bit(amplifier_.section_on(section));
    case section_enabled:
      return bit(amplifier_.section_enabled(section));
    case heartbeat:
    case heartbeat_echo:
      return heartbeat_;
    case watchdog_source:
      return static_cast<double>(feed_);
    case ready:
      return bit(amplifier_.fault() == ValveFault::none);
    case enabled:
      return bit(amplifier_.enabled());
    case fault:
      return bit(amplifier_.fault() != ValveFault::none);
    case watchdog_tripped:
      return bit(amplifier_.watchdog_tripped());
    case at_limit:
      return bit(amplifier_.at_limit());
    case fault_code:
      return static_cast<double>(amplifier_.fault());
    case fault_section:
      return amplifier_.fault_section() ? static_cast<double>(*amplifier_.fault_section() + 1)
                                        : 0.0;
    case missed_cycles:
      return missed_cycles_;
    case measurement_count:
      return static_cast<double>(amplifier_.measurements() & 0xFFFFU);
    case set_point:
      return amplifier_.set_point(section) * kPercent;
    case coil_current:
      return amplifier_.current_ma(now_, section);
    case coil_temperature:
      return amplifier_.coil_temperature_c(section);
    case supply_voltage:
      return amplifier_.supply_voltage_v();
    case driver_temperature:
      return amplifier_.driver_temperature_c();
    case floating:
      return bit(amplifier_.floating(section));
    default:
      return info(signal).commanded ? parameter_value(signal, section)
                                    : measured_value(signal, section);
  }
}

double ValveDriver::measured_value(ValveSignal signal, std::size_t section) const {
  using enum ValveSignal;
  if (amplifier_.measurements() == 0) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const ValveSample& measured = amplifier_.measured();
  switch (signal) {
    case spool_position:
      return amplifier_.position(now_, section) * kPercent;
    case port_a_pressure:
      return measured.port_a_pressure_pa[section] / kPascalPerBar;
    case port_b_pressure:
      return measured.port_b_pressure_pa[section] / kPascalPerBar;
    case supply_pressure:
      return measured.supply_pressure_pa / kPascalPerBar;
    case tank_pressure:
      return measured.tank_pressure_pa / kPascalPerBar;
    case oil_temperature:
      return measured.oil_temperature_c;
    case swing_angle:
      return measured.swing_angle_rad * kDegreesPerRadian;
    case swing_rate:
      return measured.swing_rate_radps * kDegreesPerRadian;
    default:
      return 0.0;
  }
}

double ValveDriver::parameter_value(ValveSignal signal, std::size_t section) const {
  const ValveAmplifierParameters& p = amplifier_.parameters();
  switch (signal) {
    case ValveSignal::reaction:
      return static_cast<double>(p.reaction);
    case ValveSignal::loss_position:
      return p.reaction == ValveReaction::hold ? kHold_percent + 1.0 : p.loss_position * kPercent;
    case ValveSignal::polarity:
      return p.stage[section].polarity;
    default:
      break;
  }
  if (const double* number = number_of(p, section, signal)) {
    return *number * per_number(info(signal));
  }
  const Duration* const span = span_of(p, section, signal);
  return span != nullptr ? milliseconds(*span) : 0.0;
}

// The wire's view of the valve driver: which registers can be read and written.

ValveDriver::Unit::Unit(ValveDriver& driver)
    : driver_(driver),
      objects_{IdentificationObject{0, driver.map_.vendor},
               IdentificationObject{1, driver.map_.product_code},
               IdentificationObject{2, driver.map_.revision},
               IdentificationObject{4, driver.map_.product_name}},
      server_id_(driver.map_.vendor + " " + driver.map_.product_code + " " + driver.map_.revision) {
}

ModbusUnit::Outcome ValveDriver::Unit::read_registers(RegisterTable table, std::uint16_t address,
                                                      std::span<std::uint16_t> values) const {
  if (table == RegisterTable::input) {
    return driver_.read(ModbusTable::input_registers, address, values);
  }
  const auto mirror = driver_.map_.input_mirror;
  if (mirror && address >= *mirror) {
    return driver_.read(ModbusTable::input_registers, static_cast<std::size_t>(address - *mirror),
                        values);
  }
  return driver_.read(ModbusTable::holding_registers, address, values);
}

ModbusUnit::Outcome ValveDriver::Unit::write_registers(SimTime now, std::uint16_t address,
                                                       std::span<const std::uint16_t> values) {
  return driver_.write(now, ModbusTable::holding_registers, address, values);
}

ModbusUnit::Outcome ValveDriver::Unit::read_bits(BitTable table, std::uint16_t address,
                                                 BitBlock& bits) const {
  for (std::size_t i = 0; i < bits.count; ++i) {
    std::uint16_t value = 0;
    if (const auto exception = driver_.read(
            table == BitTable::coils ? ModbusTable::coils : ModbusTable::discrete_inputs,
            address + i, std::span(&value, 1))) {
      return exception;
    }
    bits.set(i, value != 0);
  }
  return std::nullopt;
}

ModbusUnit::Outcome ValveDriver::Unit::write_coils(SimTime now, std::uint16_t address,
                                                   const BitBlock& coils) {
  std::array<std::uint16_t, protocols::modbus::kReadBitsMaximum> values{};
  for (std::size_t i = 0; i < coils.count; ++i) {
    values[i] = coils.test(i) ? 1 : 0;
  }
  return driver_.write(now, ModbusTable::coils, address, std::span(values).first(coils.count));
}

std::string_view ValveDriver::Unit::server_id() const {
  return server_id_;
}

std::span<const ModbusUnit::IdentificationObject> ValveDriver::Unit::identification() const {
  return objects_;
}

bool ValveDriver::Unit::has_function(std::uint8_t function) const {
  return emulators::has_function(driver_.map_, function);
}

void ValveDriver::Unit::served(SimTime now) {
  if (driver_.feed_ == WatchdogFeed::any_request) {
    driver_.feed(now);
  }
}

ModbusUnit::Outcome ValveDriver::read(ModbusTable table, std::size_t address,
                                      std::span<std::uint16_t> values) const {
  if (!image_.has(table)) {
    return ExceptionCode::illegal_function;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto place = image_.find(table, address + i);
    if (!place) {
      if (!map_.gaps_read_zero || !image_.within(table, address, values.size())) {
        return ExceptionCode::illegal_data_address;
      }
      values[i] = 0;
    } else if (place->entry->format == RegisterFormat::text) {
      const auto character = [&](std::size_t at) {
        return at < place->entry->content.size()
                   ? static_cast<std::uint8_t>(place->entry->content[at])
                   : std::uint8_t{0};
      };
      values[i] =
          in_order(*place->entry, static_cast<std::uint16_t>((character(2U * place->index) << 8U) |
                                                             character(2U * place->index + 1U)));
    } else {
      values[i] = words_of(*place->entry, place->index)[place->word];
    }
  }
  return std::nullopt;
}

ModbusUnit::Outcome ValveDriver::check_write(ModbusTable table, std::size_t address,
                                             std::span<std::uint16_t> values) const {
  if (!image_.has(table)) {
    return ExceptionCode::illegal_function;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto place = image_.find(table, address + i);
    if (!place || !place->entry->writable) {
      return ExceptionCode::illegal_data_address;
    }
  }
  for (std::size_t i = 0; i < values.size();) {
    const auto place = *image_.find(table, address + i);
    RegisterWords words = image_.words(place);
    const std::size_t here =
        std::min<std::size_t>(place.entry->words() - place.word, values.size() - i);
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i), here, words.begin() + place.word);
    if (!accepts(*place.entry, place.index, words)) {
      return ExceptionCode::illegal_data_value;
    }
    std::copy_n(words.begin() + place.word, here, values.begin() + static_cast<std::ptrdiff_t>(i));
    i += here;
  }
  return std::nullopt;
}

ModbusUnit::Outcome ValveDriver::write(SimTime now, ModbusTable table, std::size_t address,
                                       std::span<const std::uint16_t> values) {
  std::array<std::uint16_t, protocols::modbus::kReadBitsMaximum> held{};
  const std::span taken = std::span(held).first(values.size());
  std::ranges::copy(values, taken.begin());
  if (const auto exception = check_write(table, address, taken)) {
    return exception;
  }
  Change change;
  change.parameters = amplifier_.parameters();
  for (std::size_t i = 0; i < taken.size();) {
    const auto place = *image_.find(table, address + i);
    RegisterWords words = image_.words(place);
    const std::size_t here =
        std::min<std::size_t>(place.entry->words() - place.word, taken.size() - i);
    std::copy_n(taken.begin() + static_cast<std::ptrdiff_t>(i), here, words.begin() + place.word);
    image_.set(*place.entry, place.index, words);
    collect(*place.entry, place.index, change);
    i += here;
  }
  act(now, change);
  return std::nullopt;
}

bool ValveDriver::accepts(const ValveRegister& entry, std::size_t index,
                          RegisterWords& words) const {
  auto count = decode_count(entry, words);
  if (!count) {
    return false;
  }
  if (entry.signal == ValveSignal::bits && std::isnan(entry.upper)) {
    const std::uint16_t used = in_order(entry, static_cast<std::uint16_t>(entry.greatest()));
    if ((words[0] & ~used) != 0 && !entry.clip.value_or(map_.clip)) {
      return false;
    }
    words[0] &= used;
    return true;
  }
  if (!entry.allows(*count)) {
    if (!entry.clip.value_or(map_.clip)) {
      return false;
    }
    count = std::clamp(*count, entry.least(), entry.greatest());
    if (!entry.allows(*count)) {
      return false;
    }
    words = encode_count(entry, *count);
  }
  const bool fitted =
      !info(entry.signal).per_section || entry.section + index < amplifier_.sections();
  return fitted || !is_spool_command(entry.signal) || *count * entry.scale + entry.offset == 0.0;
}

}  // namespace rigwire::emulators

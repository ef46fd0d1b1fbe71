// The wire's view of the valve driver: which registers can be read and written.
#include <algorithm>

#include "emulators/valve_driver/valve_driver.h"

namespace rigwire::emulators {

using protocols::modbus::BitBlock;
using protocols::modbus::ExceptionCode;

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
  const std::vector<std::uint8_t>& has = driver_.map_.functions;
  return has.empty() || std::ranges::find(has, function) != has.end();
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

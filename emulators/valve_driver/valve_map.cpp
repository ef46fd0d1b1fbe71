#include "emulators/valve_driver/valve_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <utility>

namespace rigwire::emulators {
namespace {

struct FormatInfo {
  const char* name;
  std::uint16_t words;
  double least;
  double greatest;
};
constexpr std::array kFormats{
    FormatInfo{"bit", 1, 0.0, 1.0},
    FormatInfo{"u16", 1, 0.0, 65535.0},
    FormatInfo{"s16", 1, -32768.0, 32767.0},
    FormatInfo{"u32", 2, 0.0, 4294967295.0},
    FormatInfo{"s32", 2, -2147483648.0, 2147483647.0},
    FormatInfo{"f32", 2, -3.4028234e38, 3.4028234e38},
    FormatInfo{"text", 1, 0.0, 65535.0},
};

const FormatInfo& format_info(RegisterFormat format) {
  return kFormats[static_cast<std::size_t>(format)];
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

bool is_bit_table(ModbusTable table) {
  return table == ModbusTable::coils || table == ModbusTable::discrete_inputs;
}

std::string quoted(const std::string& name) {
  return std::string("\"").append(name).append("\"");
}

std::string fault_of_values(const ValveRegister& entry) {
  const FormatInfo& format = format_info(entry.format);
  const auto carried = [&](double count) {
    return count >= format.least && count <= format.greatest &&
           (entry.format == RegisterFormat::f32 || count == std::round(count));
  };
  if (!std::isfinite(entry.scale) || entry.scale == 0.0 || !std::isfinite(entry.offset)) {
    return "scale must be a finite number other than 0, offset a finite number";
  }
  if (!carried(entry.least()) || !carried(entry.greatest()) || entry.least() > entry.greatest()) {
    return "range " + number(entry.least()) + " .. " + number(entry.greatest()) + " of a " +
           format.name + ", allowed: whole counts, ascending, " + number(format.least) + " .. " +
           number(format.greatest);
  }
  if (entry.initial && !entry.allows(*entry.initial)) {
    return "initial count " + number(*entry.initial) + " is not one that may be written";
  }
  for (const RegisterTranslation& row : entry.values) {
    if (!carried(row.count) || !std::isfinite(row.value)) {
      return "values: " + number(row.count) + " is no count of a " + format.name;
    }
  }
  return {};
}

}  // namespace

const char* name_of(ModbusTable table) {
  constexpr std::array kNames{"coil", "discrete", "holding", "input"};
  return kNames[static_cast<std::size_t>(table)];
}

const char* name_of(RegisterFormat format) {
  return format_info(format).name;
}

std::uint16_t ValveRegister::words() const {
  return format_info(format).words;
}

double ValveRegister::least() const {
  return std::isnan(lower) ? format_info(format).least : lower;
}

double ValveRegister::greatest() const {
  if (!std::isnan(upper)) {
    return upper;
  }
  if (signal != ValveSignal::bits || bits.empty()) {
    return format_info(format).greatest;
  }
  unsigned used = 0;
  for (const RegisterBit& bit : bits) {
    used |= 1U << bit.bit;
  }
  return used;
}

bool ValveRegister::allows(double value) const {
  if (std::ranges::find(also, value) != also.end()) {
    return true;
  }
  const bool in_range = value >= least() && value <= greatest();
  return in_range && std::ranges::find(except, value) == except.end();
}

std::string fault_of(const ValveRegister& entry, bool writable_table) {
  const ValveSignalInfo& signal = info(entry.signal);
  if (entry.count == 0 || entry.step() < entry.words() ||
      entry.address + (entry.count - 1) * entry.step() + entry.words() > 65536) {
    return "its row does not fit: address + (count - 1) x stride must stay within 0 .. 65535, and "
           "a stride leave room for a value";
  }
  if (is_bit_table(entry.table) != (entry.format == RegisterFormat::bit)) {
    return "coils and discrete inputs have format bit, registers another";
  }
  if (entry.writable && !writable_table) {
    return "inputs cannot be written";
  }
  const bool made_of_bits = entry.signal == ValveSignal::bits;
  const bool is_text = entry.signal == ValveSignal::text;
  if (made_of_bits != !entry.bits.empty() ||
      (made_of_bits && entry.format != RegisterFormat::u16)) {
    return "signal bits needs format u16 and a list of bits, and only it has one";
  }
  if (is_text != (entry.format == RegisterFormat::text)) {
    return "signal text has format text, and only it";
  }
  if (is_text && (entry.content.size() > 2U * entry.count || entry.writable)) {
    return "a text of " + std::to_string(entry.content.size()) + " characters does not fit into " +
           std::to_string(entry.count) + " registers, or is writable";
  }
  if (entry.writable && !made_of_bits && !signal.commanded) {
    return "signal " + std::string(signal.name) + " cannot be written";
  }
  const auto sections_fit = [&](std::size_t first, std::size_t count) {
    return first + count <= kValveSections;
  };
  if (signal.per_section ? !sections_fit(entry.section, entry.count)
                         : entry.count != 1 && entry.signal != ValveSignal::stored &&
                               entry.signal != ValveSignal::constant && !is_text) {
    return "count " + std::to_string(entry.count) + " of signal " + std::string(signal.name) +
           ", allowed: one for each section, else 1";
  }
  if (!unit_factor(entry.signal, entry.unit)) {
    return "unit " + quoted(entry.unit) + " does not belong to signal " + std::string(signal.name) +
           ", which is in " + std::string(signal.unit);
  }
  unsigned used = 0;
  for (const RegisterBit& bit : entry.bits) {
    const ValveSignalInfo& of = info(bit.signal);
    const bool fine = bit.bit < 16 && (used >> bit.bit & 1U) == 0 &&
                      bit.signal != ValveSignal::bits && bit.signal != ValveSignal::text &&
                      (!bit.section || (of.per_section && *bit.section < kValveSections));
    if (!fine) {
      return "bit " + std::to_string(bit.bit) +
             " is there twice, is above 15, or its signal has no such section";
    }
    used |= 1U << bit.bit;
  }
  return is_text ? std::string() : fault_of_values(entry);
}

std::vector<unsigned> addresses_of(const ValveRegister& entry) {
  std::vector<unsigned> addresses;
  for (unsigned i = 0; i < entry.count; ++i) {
    for (unsigned word = 0; word < entry.words(); ++word) {
      addresses.push_back(entry.address + i * entry.step() + word);
    }
  }
  return addresses;
}

void validate(const ValveMap& map) {
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument("valve map " + quoted(map.name) + ": " + what);
  };
  for (const std::string* text :
       {&map.vendor, &map.product_code, &map.revision, &map.product_name}) {
    if (text->empty() || text->size() > 60) {
      refuse("vendor, product_code, revision and product_name: found " + quoted(*text) +
             ", allowed 1 .. 60 characters");
    }
  }
  bool enable = map.always_enabled;
  std::map<std::pair<ModbusTable, unsigned>, const ValveRegister*> owners;
  for (const ValveRegister& entry : map.registers) {
    const bool writable_table =
        entry.table == ModbusTable::coils || entry.table == ModbusTable::holding_registers;
    if (const std::string fault = fault_of(entry, writable_table); !fault.empty()) {
      refuse("register " + quoted(entry.name) + ": " + fault);
    }
    enable =
        enable || (entry.writable && (entry.signal == ValveSignal::enable ||
                                      std::ranges::find(entry.bits, ValveSignal::enable,
                                                        &RegisterBit::signal) != entry.bits.end()));
    for (const unsigned address : addresses_of(entry)) {
      const auto [owner, fresh] = owners.emplace(std::pair(entry.table, address), &entry);
      if (!fresh) {
        refuse("register " + quoted(entry.name) + ": " + name_of(entry.table) + " address " +
               std::to_string(address) + " belongs to " + quoted(owner->second->name) + " already");
      }
    }
  }
  if (map.registers.empty()) {
    refuse("no registers");
  }
  if (!enable) {
    refuse(
        "nothing enables the outputs: bind signal enable to a register, a bit or a coil, or say "
        "always_enabled: true");
  }
}

std::string markdown_row(const ValveRegister& entry) {
  std::string place = std::to_string(entry.address);
  const unsigned last = entry.address + (entry.count - 1U) * entry.step() + entry.words() - 1U;
  if (entry.count > 1 && entry.step() != entry.words()) {
    place.append(" + ").append(std::to_string(entry.step())).append(" k");
  } else if (last > entry.address) {
    place.append("-").append(std::to_string(last));
  }
  std::string row = "|";
  const auto cell = [&row](const std::string& text) {
    row.append(text.empty() ? "" : " ").append(text).append(" |");
  };
  cell(place);
  cell(std::string("`").append(entry.name).append("`"));
  cell(name_of(entry.format));
  std::string unit = entry.unit.empty() ? std::string() : number(entry.scale) + " " + entry.unit;
  if (entry.offset != 0.0) {
    unit.append(entry.offset < 0.0 ? " - " : " + ").append(number(std::abs(entry.offset)));
  }
  cell(unit);
  const bool is_text = entry.format == RegisterFormat::text;
  cell(is_text ? quoted(entry.content) : number(entry.least()) + " .. " + number(entry.greatest()));
  cell(is_text ? std::string() : number(entry.initial.value_or(0.0)));
  cell(entry.text);
  return row;
}

std::string markdown_table(const ValveMap& map) {
  constexpr std::array kTitles{"Coils", "Discrete inputs", "Holding registers", "Input registers"};
  std::string page;
  for (std::size_t table = 0; table < kTitles.size(); ++table) {
    std::string rows;
    for (const ValveRegister& entry : map.registers) {
      if (static_cast<std::size_t>(entry.table) == table) {
        rows.append(markdown_row(entry)).append("\n");
      }
    }
    if (!rows.empty()) {
      page.append(page.empty() ? "## " : "\n## ")
          .append(kTitles[table])
          .append(
              "\n\n| address | name | format | count | range | power-up | |\n"
              "| --- | --- | --- | --- | --- | --- | --- |\n");
      page.append(rows);
    }
  }
  return page;
}

}  // namespace rigwire::emulators

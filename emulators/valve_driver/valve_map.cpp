#include "emulators/valve_driver/valve_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <utility>

#include "fields/visitor.h"

namespace rigwire::emulators {

using fields::IntegerRule;
using fields::plain;

namespace {

enum class RangeRule : std::uint8_t { of_map, refuse, clip };

/// In the order of ModbusTable.
struct TableName {
  const char* name;
  const char* text;
};
constexpr std::array kTableNames{
    TableName{"coil", "Functions 1, 5, 15."}, TableName{"discrete", "Function 2."},
    TableName{"holding", "Functions 3, 6, 16, 22, 23."}, TableName{"input", "Function 4."}};

/// In the order of RegisterFormat.
struct FormatInfo {
  const char* name;
  const char* text;
  std::uint16_t words;
  double least;
  double greatest;
};
constexpr std::array kFormats{
    FormatInfo{"bit", "Coils and discrete inputs.", 1, 0.0, 1.0},
    FormatInfo{"u16", "", 1, 0.0, 65535.0},
    FormatInfo{"s16", "", 1, -32768.0, 32767.0},
    FormatInfo{"u32", "Two registers.", 2, 0.0, 4294967295.0},
    FormatInfo{"s32", "Two registers.", 2, -2147483648.0, 2147483647.0},
    FormatInfo{"f32", "Two registers, IEEE 754.", 2, -3.4028234e38, 3.4028234e38},
    FormatInfo{"text", "Two characters per register.", 1, 0.0, 65535.0},
};

const FormatInfo& format_info(RegisterFormat format) {
  return kFormats[static_cast<std::size_t>(format)];
}

template <class Enumeration, class Row, std::size_t kCount>
constexpr std::array<fields::Choice<Enumeration>, kCount> choices_of(
    const std::array<Row, kCount>& rows) {
  std::array<fields::Choice<Enumeration>, kCount> choices{};
  for (std::size_t i = 0; i < kCount; ++i) {
    choices[i] = {static_cast<Enumeration>(i), rows[i].name, rows[i].text};
  }
  return choices;
}

constexpr auto kTables = choices_of<ModbusTable>(kTableNames);
constexpr auto kFormatChoices = choices_of<RegisterFormat>(kFormats);
constexpr std::array<fields::Choice<WordOrder>, 2> kOrders{
    {{WordOrder::high_first, "high_first", "The more significant word at the lower address."},
     {WordOrder::low_first, "low_first", "The less significant word at the lower address."}}};
constexpr std::array<fields::Choice<ByteOrder>, 2> kByteOrders{
    {{ByteOrder::high_first, "high_first", "The more significant byte first, as Modbus has it."},
     {ByteOrder::low_first, "low_first", "The less significant byte first."}}};
constexpr std::array<fields::Choice<bool>, 2> kAccess{
    {{false, "read", "The master may read it."}, {true, "write", "And write it."}}};
constexpr std::array<fields::Choice<bool>, 2> kMapRules{
    {{false, "refuse", "Exception 03."}, {true, "clip", "Held at the limit."}}};
constexpr std::array<fields::Choice<RangeRule>, 3> kRangeRules{
    {{RangeRule::of_map, "map", "The map's rule for all registers."},
     {RangeRule::refuse, "refuse", "Exception 03."},
     {RangeRule::clip, "clip", "Held at the limit."}}};
constexpr std::array<fields::Choice<bool>, 2> kGaps{
    {{false, "refuse", "Exception 02."}, {true, "zero", "Read 0."}}};
constexpr std::array<fields::Choice<WatchdogFeed>, 4> kFeeds{
    {{WatchdogFeed::any_request, "any_request", "Every request that is served."},
     {WatchdogFeed::heartbeat_change, "heartbeat_change", "A changed heartbeat."},
     {WatchdogFeed::any_write, "any_write", "Every write that is carried out."},
     {WatchdogFeed::command_write, "command_write", "A write that has a command in it."}}};

/// Function codes of the emulator (docs/devices/valve-driver.md); 7, 8 and 11 on serial lines only.
constexpr std::array<std::uint8_t, 14> kFunctions{1, 2, 3, 4, 5, 6, 7, 8, 11, 15, 16, 17, 22, 23};
constexpr std::uint8_t kIdentification = 43;
constexpr const char* kFunctionNames = "1 .. 8, 11, 15, 16, 17, 22, 23, 43";

bool is_function(double code) {
  return code == kIdentification || std::ranges::find(kFunctions, code) != kFunctions.end();
}

/// What reads and what writes each table, in the order of ModbusTable.
struct TableFunctions {
  std::array<std::uint8_t, 2> read;
  std::array<std::uint8_t, 4> write;
};
constexpr std::array<TableFunctions, 4> kTableFunctions{
    {{{1, 1}, {5, 15, 15, 15}}, {{2, 2}, {}}, {{3, 23}, {6, 16, 22, 23}}, {{4, 4}, {}}}};

constexpr std::size_t kSignalCount = static_cast<std::size_t>(ValveSignal::text) + 1;

std::array<fields::Choice<ValveSignal>, kSignalCount> signal_choices() {
  std::array<fields::Choice<ValveSignal>, kSignalCount> choices{};
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const ValveSignalInfo& row = valve_signals()[i];
    choices[i] = {row.signal, row.name, row.text};
  }
  return choices;
}

constexpr fields::NumberRule kCount = plain().between(-4294967295.0, 4294967295.0);

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
  return kTableNames[static_cast<std::size_t>(table)].name;
}

const char* name_of(RegisterFormat format) {
  return format_info(format).name;
}

std::uint16_t ValveRegister::words() const {
  return format_info(format).words;
}

namespace {

struct CountRange {
  double least = 0.0;
  double greatest = 0.0;
};

/// What the format carries, of a written register no more than the amplifier takes.
CountRange natural_range(const ValveRegister& entry) {
  const FormatInfo& format = format_info(entry.format);
  CountRange range{format.least, format.greatest};
  if (!entry.writable || !entry.values.empty()) {
    return range;
  }
  // count = (value / factor - offset) / scale at both ends, rounded inwards where counts are whole.
  const ValveSignalInfo& signal = info(entry.signal);
  const double factor = unit_factor(entry.signal, entry.unit).value_or(1.0);
  double ends[] = {(signal.least / factor - entry.offset) / entry.scale,
                   (signal.greatest / factor - entry.offset) / entry.scale};
  if (std::isnan(ends[0]) || std::isnan(ends[1])) {
    return range;
  }
  if (ends[0] > ends[1]) {
    std::swap(ends[0], ends[1]);
  }
  if (entry.format != RegisterFormat::f32) {
    constexpr double kRounding = 1e-9;
    ends[0] = std::ceil(ends[0] - kRounding);
    ends[1] = std::floor(ends[1] + kRounding);
  }
  return {std::max(range.least, ends[0]), std::min(range.greatest, ends[1])};
}

}  // namespace

double ValveRegister::least() const {
  return std::isnan(lower) ? natural_range(*this).least : lower;
}

double ValveRegister::greatest() const {
  if (!std::isnan(upper)) {
    return upper;
  }
  if (signal != ValveSignal::bits || bits.empty()) {
    return natural_range(*this).greatest;
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

/// Checks one register of a map. Returns what is wrong with it; empty if nothing is.
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
  if (is_text != (entry.format == RegisterFormat::text) || (!is_text && !entry.content.empty())) {
    return "signal text has format text and a content, and only it";
  }
  if (is_text && (entry.content.size() > 2U * entry.count || entry.writable)) {
    return "a text of " + std::to_string(entry.content.size()) + " characters does not fit into " +
           std::to_string(entry.count) + " registers, or is writable";
  }
  if (entry.writable && !made_of_bits && !signal.commanded) {
    return "signal " + std::string(signal.name) + " cannot be written";
  }
  if (signal.per_section && entry.section + entry.count > kValveSections) {
    return "count " + std::to_string(entry.count) + " of signal " + std::string(signal.name) +
           " from section " + std::to_string(entry.section + 1) + " on, allowed: 1 .. " +
           std::to_string(kValveSections - std::min(entry.section, kValveSections)) +
           ", as there are " + std::to_string(kValveSections) + " sections";
  }
  const bool repeats = signal.per_section || entry.signal == ValveSignal::stored ||
                       entry.signal == ValveSignal::constant || is_text;
  if (!repeats && entry.count != 1) {
    return "count " + std::to_string(entry.count) + " of signal " + std::string(signal.name) +
           ", which the amplifier has once, allowed: 1" +
           (entry.signal == ValveSignal::enable ? " (signal enable_section is one for each section)"
                                                : "");
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

void visit(fields::Visitor& v, RegisterBit& p) {
  std::size_t section = p.section ? *p.section + 1 : 0;
  v.required("bit");
  v.integer("bit", p.bit, IntegerRule{0, 15}, "Number of the bit; 0 is the least significant.");
  v.required("signal");
  v.choice("signal", p.signal, signal_choices(), "What the bit carries.");
  v.integer("section", section, IntegerRule{0, kValveSections},
            "Section that it speaks of, from 1; 0 = all.");
  v.boolean("inverted", p.inverted, "A bit of 0 means yes.");
  p.section = section == 0 ? std::nullopt : std::optional(section - 1);
}

void visit(fields::Visitor& v, RegisterTranslation& p) {
  v.required("count");
  v.number("count", p.count, kCount, "Count in the register.");
  v.required("value");
  v.number("value", p.value, kCount, "Value of the signal that the count represents.");
}

void visit(fields::Visitor& v, ValveRegister& p) {
  std::array<double, 2> range{p.lower, p.upper};
  double initial = p.initial.value_or(std::nan(""));
  RangeRule rule = !p.clip ? RangeRule::of_map : *p.clip ? RangeRule::clip : RangeRule::refuse;
  std::size_t section = p.section + 1;
  v.required("name");
  v.text("name", p.name, "Name of the register, a field term in snake_case.");
  v.required("table");
  v.choice("table", p.table, kTables, "Table that the register is in, one of four.");
  v.required("address");
  v.integer("address", p.address, IntegerRule{0, 65535},
            "Address of the first, from 0, as on the wire.");
  v.required("signal");
  v.choice("signal", p.signal, signal_choices(), "What the register carries.");
  v.text("content", p.content, "Characters that it reads as, of signal text.");
  // What table and signal leave no choice of need not be written.
  const ValveRegister untold{};
  const bool is_text = p.signal == ValveSignal::text;
  if (p.format == untold.format && (is_bit_table(p.table) || is_text)) {
    p.format = is_text ? RegisterFormat::text : RegisterFormat::bit;
  }
  if (is_text && p.count == untold.count) {
    p.count =
        static_cast<std::uint16_t>(std::clamp<std::size_t>((p.content.size() + 1) / 2, 1, 125));
  }
  v.integer("count", p.count, IntegerRule{1, 125},
            "How many equal registers, one per section; of a text by its content.");
  v.integer("stride", p.stride, IntegerRule{0, 1000},
            "Addresses from one register of the row to the next; 0 = no gap.");
  v.choice("format", p.format, kFormatChoices,
           "How the count is coded; of coils and discrete inputs bit, of signal text text.");
  v.choice("word_order", p.order, kOrders, "Order of the words of two registers.");
  v.choice("byte_order", p.bytes, kByteOrders, "Order of the bytes of each register.");
  v.choice("access", p.writable, kAccess, "What the master may do.");
  v.text("unit", p.unit, "Unit of the value, which is count x scale + offset.");
  v.number("scale", p.scale, plain().between(-1e9, 1e9), "Value of one count, in the unit.");
  v.number("offset", p.offset, plain().between(-1e9, 1e9), "Value of count 0, in the unit.");
  v.numbers("range", range, kCount, "Least and greatest count that may be written.");
  v.number_list("also", p.also, kCount, "Counts outside the range that are allowed, too.");
  v.number_list("except", p.except, kCount, "Counts inside the range that are not allowed.");
  v.choice("out_of_range", rule, kRangeRules,
           "What happens to a value out of range, in place of the map's rule.");
  v.number("initial", initial, kCount, "Count at power-up.");
  v.integer("section", section, IntegerRule{1, kValveSections},
            "Section of the first register in the row, from 1.");
  v.list("bits", p.bits, "What each bit carries, of signal bits.");
  v.list("values", p.values, "Counts that stand for other values of the signal.");
  v.text("text", p.text, "What it means, one line.");
  p.lower = range[0];
  p.upper = range[1];
  p.initial = std::isnan(initial) ? std::nullopt : std::optional(initial);
  p.clip = rule == RangeRule::of_map ? std::nullopt : std::optional(rule == RangeRule::clip);
  p.section = section - 1;
}

void visit(fields::Visitor& v, ValveMap& p) {
  int mirror = p.input_mirror ? *p.input_mirror : -1;
  std::vector<double> functions(p.functions.begin(), p.functions.end());
  v.text("name", p.name, "Name of the map.");
  v.text("text", p.text, "One line about the map.");
  v.text("vendor", p.vendor, "Vendor, in the identification; 1 .. 60 characters.");
  v.text("product_code", p.product_code,
         "Product code, in the identification; 1 .. 60 characters.");
  v.text("revision", p.revision, "Revision, in the identification; 1 .. 60 characters.");
  v.text("product_name", p.product_name,
         "Product's name, in the identification; 1 .. 60 characters.");
  v.choice("out_of_range", p.clip, kMapRules, "What happens to values out of range.");
  v.choice("watchdog_feed", p.watchdog_feed, kFeeds, "What shows that the master is alive.");
  v.boolean("watchdog_recovers", p.watchdog_recovers, "The next feed ends a trip.");
  v.boolean("always_enabled", p.always_enabled, "Enabled from power-up on.");
  v.number_list(
      "functions", functions, plain().between(1, 127),
      "Function codes that it has, others answer exception 01; empty = all that are for its "
      "tables, or for none.");
  for (const double code : functions) {
    v.check(is_function(code), "functions", "no function of a valve driver", number(code),
            kFunctionNames);
  }
  v.choice("gaps", p.gaps_read_zero, kGaps, "What addresses between registers answer.");
  v.integer("input_mirror", mirror, IntegerRule{-1, 65535},
            "Address from which input registers are readable as holding ones; -1 = nowhere.");
  v.required("registers");
  v.list("registers", p.registers, "Registers of all four tables.");
  p.functions.clear();
  for (const double code : functions) {
    if (is_function(code)) {
      p.functions.push_back(static_cast<std::uint8_t>(code));
    }
  }
  p.input_mirror = mirror < 0 ? std::nullopt : std::optional(static_cast<std::uint16_t>(mirror));
}

namespace {

bool writes(const ValveRegister& entry, ValveSignal signal) {
  return entry.writable &&
         (entry.signal == signal ||
          std::ranges::find(entry.bits, signal, &RegisterBit::signal) != entry.bits.end());
}

/// Every register can be read, and every one that is to be written, written.
void require_functions(const ValveMap& map) {
  const auto has_one = [&](const auto& codes) {
    return map.functions.empty() || std::ranges::any_of(codes, [&](std::uint8_t code) {
             return std::ranges::find(map.functions, code) != map.functions.end();
           });
  };
  for (const ValveRegister& entry : map.registers) {
    const TableFunctions& functions = kTableFunctions[static_cast<std::size_t>(entry.table)];
    const bool mirrored = entry.table == ModbusTable::input_registers && map.input_mirror &&
                          has_one(kTableFunctions[2].read);
    const bool readable = has_one(functions.read) || mirrored;
    if (!readable || (entry.writable && !has_one(functions.write))) {
      throw std::invalid_argument("valve map " + quoted(map.name) + ": register " +
                                  quoted(entry.name) + ": none of the map's functions " +
                                  (readable ? "writes" : "reads") + " table " +
                                  name_of(entry.table));
    }
  }
}

}  // namespace

bool has_function(const ValveMap& map, std::uint8_t function) {
  if (!map.functions.empty() || function == 0) {
    return std::ranges::find(map.functions, function) != map.functions.end();
  }
  bool of_a_table = false;
  for (std::size_t i = 0; i < kTableFunctions.size(); ++i) {
    const auto& [read, write] = kTableFunctions[i];
    if (std::ranges::find(read, function) == read.end() &&
        std::ranges::find(write, function) == write.end()) {
      continue;
    }
    of_a_table = true;
    const auto table = static_cast<ModbusTable>(i);
    const bool mirror = table == ModbusTable::holding_registers && map.input_mirror;
    if (mirror ||
        std::ranges::find(map.registers, table, &ValveRegister::table) != map.registers.end()) {
      return true;
    }
  }
  return !of_a_table;
}

bool enabled_by_section(const ValveMap& map) {
  const auto any = [&](ValveSignal signal) {
    return std::ranges::any_of(map.registers,
                               [&](const ValveRegister& entry) { return writes(entry, signal); });
  };
  return !map.always_enabled && !any(ValveSignal::enable) && any(ValveSignal::enable_section);
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
  bool enable = map.always_enabled || enabled_by_section(map);
  std::map<std::pair<ModbusTable, unsigned>, const ValveRegister*> owners;
  for (const ValveRegister& entry : map.registers) {
    const bool writable_table =
        entry.table == ModbusTable::coils || entry.table == ModbusTable::holding_registers;
    if (const std::string fault = fault_of(entry, writable_table); !fault.empty()) {
      refuse("register " + quoted(entry.name) + ": " + fault);
    }
    enable = enable || writes(entry, ValveSignal::enable);
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
  require_functions(map);
  if (!enable) {
    refuse(
        "nothing enables the outputs: bind signal enable or enable_section to a register, a bit or "
        "a coil, or say always_enabled: true");
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
  const bool any =
      entry.format == RegisterFormat::f32 && entry.greatest() == format_info(entry.format).greatest;
  cell(is_text ? quoted(entry.content)
       : any   ? std::string("any")
               : number(entry.least()) + " .. " + number(entry.greatest()));
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

#include "hil/files/valve_map_file.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "fields/visitor.h"
#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"

namespace rigwire::hil {

using namespace emulators;

namespace {

enum class RangeRule { of_map, refuse, clip };

constexpr std::array<fields::Choice<ModbusTable>, 4> kTables{
    {{ModbusTable::coils, "coil", "Functions 1, 5, 15."},
     {ModbusTable::discrete_inputs, "discrete", "Function 2."},
     {ModbusTable::holding_registers, "holding", "Functions 3, 6, 16, 22, 23."},
     {ModbusTable::input_registers, "input", "Function 4."}}};
constexpr std::array<fields::Choice<RegisterFormat>, 7> kFormats{
    {{RegisterFormat::bit, "bit", "Of coils and discrete inputs."},
     {RegisterFormat::u16, "u16", ""},
     {RegisterFormat::s16, "s16", ""},
     {RegisterFormat::u32, "u32", "Two registers."},
     {RegisterFormat::s32, "s32", "Two registers."},
     {RegisterFormat::f32, "f32", "Two registers, IEEE 754."},
     {RegisterFormat::text, "text", "Two characters per register."}}};
constexpr std::array<fields::Choice<WordOrder>, 2> kOrders{
    {{WordOrder::high_first, "high_first", ""}, {WordOrder::low_first, "low_first", ""}}};
constexpr std::array<fields::Choice<bool>, 2> kAccess{{{false, "read", ""}, {true, "write", ""}}};
constexpr std::array<fields::Choice<bool>, 2> kMapRules{
    {{false, "refuse", "Exception 03."}, {true, "clip", "Held at the limit."}}};
constexpr std::array<fields::Choice<RangeRule>, 3> kRangeRules{{{RangeRule::of_map, "map", ""},
                                                                {RangeRule::refuse, "refuse", ""},
                                                                {RangeRule::clip, "clip", ""}}};
constexpr std::array<fields::Choice<bool>, 2> kGaps{
    {{false, "refuse", "Exception 02."}, {true, "zero", "Read 0."}}};
constexpr std::array<fields::Choice<WatchdogFeed>, 4> kFeeds{
    {{WatchdogFeed::any_request, "any_request", "Every request that is served."},
     {WatchdogFeed::heartbeat_change, "heartbeat_change", "A changed heartbeat."},
     {WatchdogFeed::any_write, "any_write", "Every write that is carried out."},
     {WatchdogFeed::command_write, "command_write", "A write that has a command in it."}}};

constexpr std::size_t kSignalCount = static_cast<std::size_t>(ValveSignal::text) + 1;

std::array<fields::Choice<ValveSignal>, kSignalCount> signal_choices() {
  std::array<fields::Choice<ValveSignal>, kSignalCount> choices{};
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const ValveSignalInfo& row = valve_signals()[i];
    choices[i] = {row.signal, row.name, row.text};
  }
  return choices;
}

const fields::IntegerRule kSection{0, 8};
const fields::NumberRule kCount = fields::plain().between(-4294967295.0, 4294967295.0);

}  // namespace
}  // namespace rigwire::hil

namespace rigwire::emulators {

using namespace hil;

inline void visit(fields::Visitor& v, RegisterBit& p) {
  std::size_t section = p.section ? *p.section + 1 : 0;
  v.required("bit");
  v.integer("bit", p.bit, fields::IntegerRule{0, 15}, "0 is the least significant.");
  v.required("signal");
  v.choice("signal", p.signal, signal_choices(), "What it carries.");
  v.integer("section", section, kSection, "Whose, from 1; 0 = all.");
  v.boolean("inverted", p.inverted, "0 means yes.");
  p.section = section == 0 ? std::nullopt : std::optional(section - 1);
}

inline void visit(fields::Visitor& v, RegisterTranslation& p) {
  v.required("count");
  v.number("count", p.count, kCount, "In the register.");
  v.required("value");
  v.number("value", p.value, kCount, "Of the signal.");
}

inline void visit(fields::Visitor& v, ValveRegister& p) {
  std::array<double, 2> range{p.lower, p.upper};
  double initial = p.initial.value_or(std::nan(""));
  RangeRule rule = RangeRule::of_map;
  std::size_t section = p.section + 1;
  v.required("name");
  v.text("name", p.name, "Field term in snake_case.");
  v.required("table");
  v.choice("table", p.table, kTables, "Which of the four tables.");
  v.required("address");
  v.integer("address", p.address, fields::IntegerRule{0, 65535}, "From 0, as on the wire.");
  v.integer("count", p.count, fields::IntegerRule{1, 125}, "Of equal registers, one per section.");
  v.integer("stride", p.stride, fields::IntegerRule{0, 1000}, "From one to the next; 0 = no gap.");
  v.choice("format", p.format, kFormats, "How it is coded.");
  v.choice("word_order", p.order, kOrders, "Of two registers.");
  v.choice("access", p.writable, kAccess, "Of the master.");
  v.text("unit", p.unit, "Of value = count x scale + offset.");
  v.number("scale", p.scale, fields::plain().between(-1e9, 1e9), "Of a count.");
  v.number("offset", p.offset, fields::plain().between(-1e9, 1e9), "Of count 0.");
  v.numbers("range", range, kCount, "Counts that may be written.");
  v.number_list("also", p.also, kCount, "Counts outside the range that are allowed, too.");
  v.number_list("except", p.except, kCount, "Counts inside the range that are not.");
  v.choice("out_of_range", rule, kRangeRules, "In place of the map's rule.");
  v.number("initial", initial, kCount, "Count at power-up.");
  v.required("signal");
  v.choice("signal", p.signal, signal_choices(), "What it carries.");
  v.integer("section", section, fields::IntegerRule{1, 8}, "Of the first in the row, from 1.");
  v.list("bits", p.bits, "Of signal bits.");
  v.list("values", p.values, "Counts that stand for other values of the signal.");
  v.text("content", p.content, "Of signal text.");
  v.text("text", p.text, "What it means, one line.");
  p.lower = range[0];
  p.upper = range[1];
  p.initial = std::isnan(initial) ? std::nullopt : std::optional(initial);
  p.clip = rule == RangeRule::of_map ? std::nullopt : std::optional(rule == RangeRule::clip);
  p.section = section - 1;
}

inline void visit(fields::Visitor& v, ValveMap& p) {
  int mirror = p.input_mirror ? *p.input_mirror : -1;
  v.text("name", p.name, "Of the map.");
  v.text("text", p.text, "One line about it.");
  v.text("vendor", p.vendor, "Identification, 1 .. 60 characters.");
  v.text("product_code", p.product_code, "Identification.");
  v.text("revision", p.revision, "Identification.");
  v.text("product_name", p.product_name, "Identification.");
  v.choice("out_of_range", p.clip, kMapRules, "What happens to values out of range.");
  v.choice("watchdog_feed", p.watchdog_feed, kFeeds, "What shows that the master is alive.");
  v.boolean("watchdog_recovers", p.watchdog_recovers, "The next feed ends a trip.");
  v.boolean("always_enabled", p.always_enabled, "From power-up on.");
  v.choice("gaps", p.gaps_read_zero, kGaps, "Addresses between registers.");
  v.integer("input_mirror", mirror, fields::IntegerRule{-1, 65535},
            "Input registers as holding ones from here on; -1 = no.");
  v.required("registers");
  v.list("registers", p.registers, "Of all four tables.");
  p.input_mirror = mirror < 0 ? std::nullopt : std::optional(static_cast<std::uint16_t>(mirror));
}

}  // namespace rigwire::emulators

namespace rigwire::hil {
namespace {

/// Keeps the reader from checking the map as a whole: its faults belong to single registers.
struct ValveMapFile {
  ValveMap map;
};

inline void visit(fields::Visitor& v, ValveMapFile& p) {
  visit(v, p.map);
}

void check_registers(const ValveMap& map, const Origins& origins, Problems& problems) {
  std::map<std::pair<ModbusTable, unsigned>, std::string> owners;
  for (std::size_t i = 0; i < map.registers.size(); ++i) {
    const ValveRegister& entry = map.registers[i];
    const std::string path = fmt::format("registers.{}", i);
    const auto report = [&](const std::string& key, const std::string& what) {
      problems.add(
          {origins.nearest(path + key), path + key, what, "\"" + entry.name + "\"", {}, {}});
    };
    const bool writable_table =
        entry.table == ModbusTable::coils || entry.table == ModbusTable::holding_registers;
    if (const std::string fault = fault_of(entry, writable_table); !fault.empty()) {
      report("", fault);
      continue;
    }
    for (unsigned address : addresses_of(entry)) {
      const auto [owner, fresh] = owners.emplace(std::pair(entry.table, address), entry.name);
      if (!fresh) {
        report(".address", fmt::format("{} address {} belongs to \"{}\" already",
                                       name_of(entry.table), address, owner->second));
        break;
      }
    }
  }
}

ValveMap read_valve_map(const Value& document, Problems problems) {
  ValveMapFile file;
  Origins origins;
  if (problems.empty()) {
    read(document, file, problems, origins);
  }
  if (problems.empty()) {
    check_registers(file.map, origins, problems);
  }
  if (problems.empty()) {
    try {
      validate(file.map);
    } catch (const std::invalid_argument& error) {
      problems.add({document.where, "", error.what(), {}, {}, {}});
    }
  }
  problems.throw_if_any();
  return file.map;
}

}  // namespace

ValveMap load_valve_map(const std::string& file) {
  Problems problems;
  const Value document = load_document(file, problems);
  return read_valve_map(document, std::move(problems));
}

ValveMap parse_valve_map(const std::string& text, const std::string& name) {
  Problems problems;
  const Value document = parse_document(text, name, ".", problems);
  return read_valve_map(document, std::move(problems));
}

}  // namespace rigwire::hil

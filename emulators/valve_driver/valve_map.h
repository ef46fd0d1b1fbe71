// A valve driver's registers as data: which address carries which quantity, how it is coded, and
// what is refused. One description serves the wire, the device page, `rigwire describe` and the
// tests; docs/your-own-valve.md shows how a user writes one in YAML (hil/files/valve_map_file.h).
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "emulators/valve_driver/valve_signal.h"
#include "fields/rules.h"
#include "protocols/modbus/constants.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::emulators {

using ModbusTable = protocols::modbus::Table;
/// Encoding of a value in registers; `text` is two characters per register, high byte first.
enum class RegisterFormat : std::uint8_t { bit, u16, s16, u32, s32, f32, text };
/// Word of a two-register value at the lower address.
enum class WordOrder : std::uint8_t { high_first, low_first };
/// Byte of a register that comes first on the wire. Modbus sends the high byte first (V1.1b3,
/// section 4.2), but some devices pass on a little-endian memory.
enum class ByteOrder : std::uint8_t { high_first, low_first };

/// What feeds the watchdog.
enum class WatchdogFeed : std::uint8_t {
  any_request = 0,       ///< Every request to this unit that is answered without an exception.
  heartbeat_change = 1,  ///< Only a write that changes the heartbeat.
  any_write = 2,         ///< Every write that is carried out.
  command_write = 3,     ///< Only a write that has a command in it.
};

/// A bit of a register.
struct RegisterBit {
  std::uint8_t bit = 0;  ///< 0 .. 15.
  ValveSignal signal = ValveSignal::constant;
  std::optional<std::size_t> section;  ///< From 0; without: all of them.
  bool inverted = false;
};

void visit(fields::Visitor& v, RegisterBit& p);

/// A count that stands for another value of the signal (a maker's own fault codes, 0xA5 for on).
struct RegisterTranslation {
  double count = 0.0;
  double value = 0.0;
};

void visit(fields::Visitor& v, RegisterTranslation& p);

/// One register, or a row of equal ones. Value of the signal = (count * scale + offset) in `unit`.
struct ValveRegister {
  std::string name;  ///< Field term in snake_case.
  ModbusTable table = ModbusTable::holding_registers;
  std::uint16_t address = 0;  ///< Address of the first, counted from 0.
  std::uint16_t count = 1;    ///< Number in the row; of a text, its registers.
  std::uint16_t stride = 0;   ///< Registers from one to the next; 0: no gap.
  RegisterFormat format = RegisterFormat::u16;
  WordOrder order = WordOrder::high_first;
  ByteOrder bytes = ByteOrder::high_first;
  bool writable = false;
  std::string unit;
  double scale = 1.0;
  double offset = 0.0;
  // Limits of the counts. NaN: what the format can carry (0 .. all bits used, if there are bits);
  // for a register that the master writes, also no more than the amplifier accepts.
  double lower = std::numeric_limits<double>::quiet_NaN();
  double upper = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> also;       ///< Allowed besides the range.
  std::vector<double> except;     ///< Not allowed, although in the range.
  std::optional<bool> clip;       ///< Overrides the map's rule.
  std::optional<double> initial;  ///< Count at power-up; empty: the amplifier's.
  ValveSignal signal = ValveSignal::stored;
  std::size_t section = 0;  ///< Section of the first in the row.
  std::vector<RegisterBit> bits;
  std::vector<RegisterTranslation> values;
  std::string content;  ///< Characters of a text.
  std::string text;     ///< What it means, one line.

  [[nodiscard]] std::uint16_t words() const;  ///< Registers of one value.
  [[nodiscard]] std::uint16_t step() const { return stride == 0 ? words() : stride; }
  [[nodiscard]] double least() const;     ///< `lower`, or its default.
  [[nodiscard]] double greatest() const;  ///< `upper`, or its default.
  [[nodiscard]] bool allows(double count) const;
};

void visit(fields::Visitor& v, ValveRegister& p);

struct ValveMap {
  std::string name = "rigwire";
  std::string text;
  // Identification (functions 17 and 43/14), each 1 .. 60 characters.
  std::string vendor = "Rigwire";
  std::string product_code = "RW-HVD8";
  std::string revision = "1.0";
  std::string product_name = "Hydraulic valve driver";
  bool clip = false;  ///< Values out of range: held at the limit, or refused with exception 03.
  WatchdogFeed watchdog_feed = WatchdogFeed::any_request;
  /// After a trip the next feed ends it, as process actuators do; else it is latched as a fault.
  bool watchdog_recovers = false;
  /// Enabled from power-up on; a map without an enable signal must say so.
  bool always_enabled = false;
  /// Function codes that the device has; others answer exception 01. Empty: those of the emulator's
  /// that reach one of its tables, or none in particular.
  std::vector<std::uint8_t> functions;
  bool gaps_read_zero = false;  ///< Between a table's first and last register; else exception 02.
  std::optional<std::uint16_t>
      input_mirror;  ///< Input registers, readable as holding ones from here.
  std::vector<ValveRegister> registers;
};

void visit(fields::Visitor& v, ValveMap& p);
/// Throws std::invalid_argument that names the register and what is wrong: overlaps, units that do
/// not belong to the signal, ranges that the format cannot carry, what cannot be written or read,
/// sections that are not there, functions that leave a table out of reach.
/// Does not check the rules of visit(): a count that is not given is NaN.
void validate(const ValveMap& map);
/// Whether a device with this map has the function, whatever the request.
[[nodiscard]] bool has_function(const ValveMap& map, std::uint8_t function);
/// What is wrong with one register by itself; empty when nothing is.
[[nodiscard]] std::string fault_of(const ValveRegister& entry, bool writable_table);

/// Whether the master enables the sections one by one, and nothing else does.
[[nodiscard]] bool enabled_by_section(const ValveMap& map);

/// Every address that a row takes. Precondition: it has no fault.
[[nodiscard]] std::vector<unsigned> addresses_of(const ValveRegister& entry);

/// One line of a table in Markdown: address, name, format, unit per count, range, at power-up,
/// text.
[[nodiscard]] std::string markdown_row(const ValveRegister& entry);
/// The whole description as the device pages print it.
[[nodiscard]] std::string markdown_table(const ValveMap& map);

[[nodiscard]] const char* name_of(ModbusTable table);
[[nodiscard]] const char* name_of(RegisterFormat format);

}  // namespace rigwire::emulators

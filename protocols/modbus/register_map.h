// One table that says which registers a device has. The server, `rigwire describe`, the device page
// and the tests all read it, so that they cannot disagree.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rigwire::protocols::modbus {

enum class Table : std::uint8_t { coils, discrete_inputs, holding_registers, input_registers };
enum class Access : std::uint8_t { read, read_write };

/// How the counts lie in registers. Two-register values have the high word at the lower address.
enum class Format : std::uint8_t { bit, u16, s16, s32 };

/// One register, or a row of equal registers (one per valve section).
struct RegisterEntry {
  std::string_view name;  ///< Field term in snake_case.
  Table table = Table::holding_registers;
  std::uint16_t address = 0;  ///< Of the first, counted from 0.
  std::uint16_t count = 1;    ///< How many in the row.
  std::uint16_t stride = 1;   ///< Registers from one to the next.
  Format format = Format::u16;
  Access access = Access::read;
  std::string_view unit;       ///< Empty for bare numbers.
  double scale = 1.0;          ///< Units per count.
  std::int32_t lower = 0;      ///< Least count.
  std::int32_t upper = 65535;  ///< Greatest count.
  std::int32_t initial = 0;    ///< Count at power-up.
  std::string_view text;       ///< What it means, one line.
};

/// Where an address falls in a map.
struct RegisterPlace {
  const RegisterEntry* entry = nullptr;
  std::uint16_t index = 0;  ///< In the row, from 0.
  std::uint16_t word = 0;   ///< Of a two-register value: 0 high, 1 low.
};

/// Registers that one value of this format takes.
[[nodiscard]] constexpr std::uint16_t words_of(Format format) {
  return format == Format::s32 ? 2 : 1;
}

/// The entry that owns an address; nothing for a reserved address.
[[nodiscard]] std::optional<RegisterPlace> find_register(std::span<const RegisterEntry> map,
                                                         Table table, std::uint16_t address);

/// The entry of that name; nullptr when there is none.
[[nodiscard]] const RegisterEntry* find_register(std::span<const RegisterEntry> map,
                                                 std::string_view name);

/// A physical value as counts, rounded to nearest and held within the entry's range. Precondition:
/// value is finite.
[[nodiscard]] std::int32_t to_counts(const RegisterEntry& entry, double value);

/// The number that one 16-bit register carries, by the entry's sign.
[[nodiscard]] std::int32_t signed_value(const RegisterEntry& entry, std::uint16_t raw);

/// Counts as a physical value.
[[nodiscard]] double to_physical(const RegisterEntry& entry, std::int32_t counts);

/// One line of a table in Markdown: address, name, unit per count, range, initial value, text.
[[nodiscard]] std::string markdown_row(const RegisterEntry& entry);

}  // namespace rigwire::protocols::modbus

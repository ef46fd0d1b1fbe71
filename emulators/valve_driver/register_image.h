// The registers of a map as the wire sees them: what lies at an address, what the master wrote
// there, and how a count lies in words. Knows nothing of what the values mean.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/valve_driver/valve_map.h"

namespace rigwire::emulators {

using RegisterWords = std::array<std::uint16_t, 2>;

/// The word with its bytes in the register's order; its own inverse.
[[nodiscard]] std::uint16_t in_order(const ValveRegister& entry, std::uint16_t word);
/// A count in the words of one value, the nearest that the format can carry; NaN as 0 (f32: as
/// NaN).
[[nodiscard]] RegisterWords encode_count(const ValveRegister& entry, double count);
/// Nothing for a float that is no finite number.
[[nodiscard]] std::optional<double> decode_count(const ValveRegister& entry,
                                                 const RegisterWords& words);

class RegisterImage {
 public:
  struct Place {
    const ValveRegister* entry = nullptr;
    std::uint16_t index = 0;  ///< Position in the row.
    std::uint16_t word = 0;   ///< Word of the value.
    std::size_t cell = 0;     ///< Cell of the value's first word.
  };

  /// `map` must outlive the image and is valid.
  explicit RegisterImage(const ValveMap& map);

  /// Nothing where no register lies.
  [[nodiscard]] std::optional<Place> find(ModbusTable table, std::size_t address) const;
  /// Whether the addresses lie from 0 to the last register of a table.
  [[nodiscard]] bool within(ModbusTable table, std::size_t address, std::size_t count) const;
  [[nodiscard]] bool has(ModbusTable table) const { return !cells(table).empty(); }
  /// One past the last register.
  [[nodiscard]] std::size_t end(ModbusTable table) const;
  /// The cell of a row's value.
  [[nodiscard]] std::size_t cell_of(const ValveRegister& entry, std::size_t index) const;

  [[nodiscard]] RegisterWords words(const Place& place) const;
  [[nodiscard]] RegisterWords words(const ValveRegister& entry, std::size_t index) const;
  void set(const ValveRegister& entry, std::size_t index, const RegisterWords& words);
  /// What is stored; 0 for a float that is none.
  [[nodiscard]] double count(const ValveRegister& entry, std::size_t index) const;

 private:
  struct Cell {
    std::uint16_t address = 0;
    std::uint16_t index = 0;
    std::uint16_t word = 0;
    const ValveRegister* entry = nullptr;
    std::uint16_t value = 0;
  };
  [[nodiscard]] const std::vector<Cell>& cells(ModbusTable table) const {
    return cells_[static_cast<std::size_t>(table)];
  }
  [[nodiscard]] const Cell* cell_at(ModbusTable table, std::size_t address) const;

  std::array<std::vector<Cell>, 4> cells_;  ///< By table, ascending by address.
};

}  // namespace rigwire::emulators

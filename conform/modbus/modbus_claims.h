// What a Modbus server claims of itself: what its profile says and the suite holds it to.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocols/modbus/constants.h"
#include "protocols/modbus/rtu.h"

namespace rigwire::conform {

/// Addresses as on the wire, from 0, both ends included.
struct AddressRange {
  std::uint16_t first = 0;
  std::uint16_t last = 0;

  [[nodiscard]] bool holds(std::uint32_t address) const {
    return address >= first && address <= last;
  }
  [[nodiscard]] std::size_t size() const { return std::size_t{last} - first + 1U; }
  friend bool operator==(const AddressRange&, const AddressRange&) = default;
};

/// Records of a file, 0 to 9999.
struct RecordRange {
  std::uint16_t file = 1;
  AddressRange records;

  friend bool operator==(const RecordRange&, const RecordRange&) = default;
};

struct ModbusClaims {
  std::uint8_t unit = 1;
  std::vector<std::uint8_t> functions;  ///< Function codes that it has.
  /// Ranges that can be read, by Table; sorted and disjoint.
  std::array<std::vector<AddressRange>, 4> tables;
  /// Ranges that may be written without moving anything; each takes any value, or one inverted bit.
  std::vector<AddressRange> writable_coils;
  std::vector<AddressRange> writable_registers;
  std::vector<RecordRange> files;  ///< Records that function 20 reads.
  /// Records that may be written like writable_registers.
  std::vector<RecordRange> writable_files;
  std::vector<std::uint16_t> queues;  ///< Addresses that function 24 reads.
  /// An answer comes within this in 99 of 100.
  std::chrono::milliseconds answer_within{100};
  /// Timeout of an answer.
  std::chrono::milliseconds patience{1000};
  protocols::modbus::SerialCharacter character = protocols::modbus::SerialCharacter::even_8e1;

  [[nodiscard]] bool has(std::uint8_t function) const {
    return std::ranges::find(functions, function) != functions.end();
  }
  [[nodiscard]] const std::vector<AddressRange>& table(protocols::modbus::Table table) const {
    return tables[static_cast<std::size_t>(table)];
  }
  [[nodiscard]] bool claims(protocols::modbus::Table table, std::uint32_t address) const;
  /// The lowest address that is not in the table, beginning with the one after its last; nothing
  /// where it has all.
  [[nodiscard]] std::optional<std::uint16_t> outside(protocols::modbus::Table table) const;
};

}  // namespace rigwire::conform

// One entry of an object dictionary, and the values that fit into it. A device's dictionary is one
// table of these; server, documentation, message layouts and tests read the same rows.
//
// Source: CiA 301 V4.2.0, 7.4.7 (data types), 7.4.3 (access).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "protocols/canopen/sdo.h"

namespace rigwire::protocols::canopen {

/// With the numbers that the standard gives them.
enum class DataType : std::uint8_t {
  integer16 = 0x03,
  integer32 = 0x04,
  unsigned8 = 0x05,
  unsigned16 = 0x06,
  unsigned32 = 0x07,
  visible_string = 0x09,  ///< The value lives with the device.
  domain = 0x0F,          ///< Too; of any length.
};

enum class Access : std::uint8_t { constant, read_only, read_write };

/// Marks of an entry.
struct EntryFlag {
  static constexpr std::uint8_t kMappable = 1;   ///< May be mapped to a transmit PDO.
  static constexpr std::uint8_t kAddNodeId = 2;  ///< The default is `initial` + node-ID.
  static constexpr std::uint8_t kStored = 4;     ///< "Save" writes it down.
};

struct ObjectEntry {
  ObjectAddress address = {};
  std::string_view name = {};
  DataType type = DataType::unsigned32;
  Access access = Access::read_only;
  std::int64_t initial = 0;
  std::int64_t lower = 0;  ///< Limit of the values that may be written.
  std::int64_t upper = 0;
  std::uint8_t flags = 0;
  std::string_view unit = {};

  [[nodiscard]] constexpr bool has(std::uint8_t flag) const { return (flags & flag) != 0; }
};

/// Rows of a table: what never changes, what the device alone changes, what a client may write.
[[nodiscard]] constexpr ObjectEntry constant_entry(std::uint16_t index, std::uint8_t sub,
                                                   std::string_view name, DataType type,
                                                   std::int64_t value, std::uint8_t flags = 0) {
  return {{index, sub}, name, type, Access::constant, value, value, value, flags, ""};
}
[[nodiscard]] constexpr ObjectEntry live_entry(std::uint16_t index, std::uint8_t sub,
                                               std::string_view name, DataType type,
                                               std::string_view unit = "", std::uint8_t flags = 0) {
  return {{index, sub}, name, type, Access::read_only, 0, 0, 0, flags, unit};
}
[[nodiscard]] constexpr ObjectEntry setting_entry(std::uint16_t index, std::uint8_t sub,
                                                  std::string_view name, DataType type,
                                                  std::int64_t initial, std::int64_t lower,
                                                  std::int64_t upper,
                                                  std::uint8_t flags = EntryFlag::kStored,
                                                  std::string_view unit = "") {
  return {{index, sub}, name, type, Access::read_write, initial, lower, upper, flags, unit};
}

/// The order of a dictionary's table.
[[nodiscard]] constexpr bool precedes(const ObjectEntry& a, const ObjectEntry& b) {
  return a.address.index != b.address.index ? a.address.index < b.address.index
                                            : a.address.sub < b.address.sub;
}
[[nodiscard]] constexpr bool is_sorted(std::span<const ObjectEntry> table) {
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (!precedes(table[i - 1], table[i])) {
      return false;
    }
  }
  return true;
}

/// The row of an address in a sorted table; null when there is none.
[[nodiscard]] const ObjectEntry* find(std::span<const ObjectEntry> table, ObjectAddress address);
/// Whether any sub-index of the object exists.
[[nodiscard]] bool has_object(std::span<const ObjectEntry> table, std::uint16_t index);

/// Bytes of a number; 0 for strings and domains.
[[nodiscard]] constexpr std::size_t size_of(DataType type) {
  switch (type) {
    case DataType::unsigned8:
      return 1;
    case DataType::integer16:
    case DataType::unsigned16:
      return 2;
    case DataType::integer32:
    case DataType::unsigned32:
      return 4;
    case DataType::visible_string:
    case DataType::domain:
      break;
  }
  return 0;
}
[[nodiscard]] constexpr bool is_signed(DataType type) {
  return type == DataType::integer16 || type == DataType::integer32;
}

/// Least significant byte first. Precondition: bytes.size() == size_of(type).
void store(DataType type, std::span<std::uint8_t> bytes, std::int64_t value);
[[nodiscard]] std::int64_t load(DataType type, std::span<const std::uint8_t> bytes);

/// A PDO mapping entry: index, sub-index, bits.
[[nodiscard]] constexpr std::uint32_t mapping_of(const ObjectEntry& entry) {
  return (static_cast<std::uint32_t>(entry.address.index) << 16U) |
         (static_cast<std::uint32_t>(entry.address.sub) << 8U) |
         static_cast<std::uint32_t>(8 * size_of(entry.type));
}

}  // namespace rigwire::protocols::canopen

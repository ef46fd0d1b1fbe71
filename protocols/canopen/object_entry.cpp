#include "protocols/canopen/object_entry.h"

#include <algorithm>
#include <cassert>

namespace rigwire::protocols::canopen {

const ObjectEntry* find(std::span<const ObjectEntry> table, ObjectAddress address) {
  const auto found = std::lower_bound(table.begin(), table.end(), address,
                                      [](const ObjectEntry& entry, ObjectAddress wanted) {
                                        return precedes(entry, ObjectEntry{wanted});
                                      });
  return found != table.end() && found->address == address ? &*found : nullptr;
}

bool has_object(std::span<const ObjectEntry> table, std::uint16_t index) {
  const auto found = std::lower_bound(table.begin(), table.end(), ObjectAddress{index, 0},
                                      [](const ObjectEntry& entry, ObjectAddress wanted) {
                                        return precedes(entry, ObjectEntry{wanted});
                                      });
  return found != table.end() && found->address.index == index;
}

void store(DataType type, std::span<std::uint8_t> bytes, std::int64_t value) {
  assert(bytes.size() == size_of(type));
  (void)type;
  auto rest = static_cast<std::uint64_t>(value);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(rest & 0xFFU);
    rest >>= 8U;
  }
}

std::int64_t load(DataType type, std::span<const std::uint8_t> bytes) {
  assert(bytes.size() == size_of(type));
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    value = (value << 8U) | bytes[i];
  }
  const auto bits = static_cast<unsigned>(8 * bytes.size());
  if (is_signed(type) && ((value >> (bits - 1)) & 1U) != 0) {
    value |= ~std::uint64_t{0} << bits;
  }
  return static_cast<std::int64_t>(value);
}

}  // namespace rigwire::protocols::canopen

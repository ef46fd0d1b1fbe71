// Where each configuration item lives in the state of one type of receiver.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "emulators/ublox/key_bindings.h"

namespace rigwire::emulators {

/// Reads and writes items of one type of receiver by their index in configuration_keys().
class UbloxKeyMap {
 public:
  explicit UbloxKeyMap(const UbloxProfile& profile);

  /// Whether the item is part of the state; the others are the caller's to keep.
  [[nodiscard]] bool bound(std::size_t index) const;
  /// Precondition of both: bound(index).
  [[nodiscard]] std::uint64_t read(const UbloxConfigurationState& state, std::size_t index) const;
  void write(UbloxConfigurationState& state, std::size_t index, std::uint64_t value) const;

 private:
  struct Entry {
    const UbloxKeyBinding* field = nullptr;
    std::int16_t message = -1;  ///< Index in UbloxProfile::messages.
    std::uint8_t port = 0;
  };

  std::vector<Entry> entries_;
};

}  // namespace rigwire::emulators

// Where each configuration item lives in the state of one type of receiver: which items and which
// fields of the older CFG messages are the same thing.
//
// Source: u-blox F9 HPG 1.50 interface description, UBXDOC-963802114-12815, section 6.10 "Legacy
// UBX message fields reference". Time pulse: CFG-TP-PERIOD and LEN are the fields of CFG-TP5
// whatever its flags say; FREQ and DUTY are separate. CFG-PRT, CFG-RATE and the others keep their
// meaning on a ZED-F9P; either way of writing is seen by the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "emulators/ublox/configuration_state.h"

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
  /// A field, or the rate of a message over a port.
  struct Entry {
    std::uint64_t (*read)(const UbloxConfigurationState& state) = nullptr;
    void (*write)(UbloxConfigurationState& state, std::uint64_t value) = nullptr;
    std::int16_t message = -1;  ///< Index in UbloxProfile::messages.
    std::uint8_t port = 0;
  };

  std::vector<Entry> entries_;
};

}  // namespace rigwire::emulators

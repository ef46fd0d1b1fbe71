// The values of a node's object dictionary: what they are at power-on, what may be written, what
// outlives the supply. The rows are the device's table (protocols/canopen).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "emulators/nonvolatile_memory.h"
#include "protocols/canopen/object_entry.h"

namespace rigwire::emulators {

class ObjectDictionary {
 public:
  /// `table` must be sorted and outlive the dictionary. Values are those of delivery.
  ObjectDictionary(std::span<const protocols::canopen::ObjectEntry> table, std::uint8_t node_id);

  [[nodiscard]] std::span<const protocols::canopen::ObjectEntry> table() const { return table_; }
  [[nodiscard]] const protocols::canopen::ObjectEntry* find(
      protocols::canopen::ObjectAddress address) const {
    return protocols::canopen::find(table_, address);
  }
  [[nodiscard]] bool has_object(std::uint16_t index) const {
    return protocols::canopen::has_object(table_, index);
  }

  /// Precondition of both: the address is in the table.
  [[nodiscard]] std::int64_t value(protocols::canopen::ObjectAddress address) const {
    return values_[row(address)];
  }
  void set(protocols::canopen::ObjectAddress address, std::int64_t value) {
    values_[row(address)] = value;
  }
  /// Updates the entries that contain the node-ID: their values at delivery and, unless a client
  /// set them, their present values.
  void set_node_id(std::uint8_t node_id);
  /// Returns the delivered value of a numeric entry as an electronic data sheet
  /// (protocols/canopen/eds.h) writes it.
  [[nodiscard]] std::string delivered_text(const protocols::canopen::ObjectEntry& entry) const;
  /// Sets the value of an entry at delivery, and its present value.
  void set_delivered(protocols::canopen::ObjectAddress address, std::int64_t value);

  /// Returns the values to keep, to be passed to load(). An entry that follows the node-ID is left
  /// out while it does.
  [[nodiscard]] std::vector<std::uint8_t> saved() const;
  /// Resets all entries of `first`..`last` to their values at delivery, then applies those saved in
  /// `block`; a saved value that does not fit is ignored.
  void load(std::span<const std::uint8_t> block, std::uint16_t first, std::uint16_t last);

 private:
  [[nodiscard]] std::size_t row(protocols::canopen::ObjectAddress address) const;

  std::span<const protocols::canopen::ObjectEntry> table_;
  std::uint8_t node_id_;
  std::vector<std::int64_t> delivered_;
  std::vector<std::int64_t> values_;
};

}  // namespace rigwire::emulators

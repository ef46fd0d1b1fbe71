// Counts each identifier on a CAN bus, and keeps its newest frame.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "protocols/can/frame.h"
#include "protocols/can/message.h"

namespace rigwire::hil {

/// Returns the identifier as tools write it: three hexadecimal digits, or eight for 29 bits.
[[nodiscard]] std::string identifier_text(const protocols::can::Frame& frame);

class IdentifierCounts {
 public:
  void take(const protocols::can::Frame& frame, bool of_client);
  /// Returns {"identifiers": [{"id", "count", "size", "from", "text"}, ...]}, the more urgent
  /// first; `text` is the content of the newest frame (hil/stream/wire_reading.h), as far as these
  /// messages of the bus describe it.
  [[nodiscard]] std::string json(std::span<const protocols::can::OwnedMessage> messages) const;

 private:
  struct Identifier {
    std::uint64_t count = 0;
    protocols::can::Frame newest;
    bool of_client = false;
  };
  std::map<std::pair<std::uint32_t, bool>, Identifier> identifiers_;  ///< In order of arbitration.
};

}  // namespace rigwire::hil

// The messages of this folder in the common form (protocols/can/message.h), made from the
// tables that encoder and decoder use. Physical values are those of the structures' members: SI
// units, angles and curvatures left positive. The document's units and signs are SAE's.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "protocols/can/message.h"
#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// Who sends a message to whom, as its identifier and its table say.
struct LayoutEnds {
  std::string_view sender;  ///< Name of a device; empty: whoever controls it.
  std::uint8_t source = j1939::kNullAddress;
  std::uint8_t destination = j1939::kGlobalAddress;
};

/// The message of that group without its signals.
[[nodiscard]] can::OwnedMessage begin_layout(const Group& group, const LayoutEnds& ends);

/// `group` where the period is another than that of Message::kGroup.
template <class Message>
[[nodiscard]] can::OwnedMessage layout(const LayoutEnds& ends,
                                       const Group& group = Message::kGroup) {
  can::OwnedMessage message = begin_layout(group, ends);
  for (const Parameter<Message>& row : Message::parameters()) {
    message.signals.push_back(can::owned(row.signal));
  }
  return message;
}

/// Appends those of several messages, each with its own period.
template <class... Messages>
void append_layouts(std::vector<can::OwnedMessage>& list, const LayoutEnds& ends) {
  (list.push_back(layout<Messages>(ends)), ...);
}

/// DM1 or DM2 with at most one code, which is one frame.
[[nodiscard]] can::OwnedMessage trouble_layout(const Group& group, const LayoutEnds& ends);

}  // namespace rigwire::protocols::vehicle

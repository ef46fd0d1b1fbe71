// The messages of this folder in the common form (protocols/can/message_layout.h), made from the
// tables that encoder and decoder use. Physical values are those of the structures' members: SI
// units, angles and curvatures left positive. The document's units and signs are SAE's.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "protocols/can/message_layout.h"
#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// Who sends a message to whom, as its identifier and its table say.
struct LayoutEnds {
  std::string_view sender;  ///< Name of a device; empty: whoever controls it.
  std::uint8_t source = j1939::kNullAddress;
  std::uint8_t destination = j1939::kGlobalAddress;
};

/// "relative, front left" as relative_front_left.
[[nodiscard]] std::string snake_case(std::string_view words);

// The parts that no message changes.
[[nodiscard]] can::MessageLayout begin_layout(const Group& group, const LayoutEnds& ends);
[[nodiscard]] can::SignalLayout number_layout(const j1939::Field& field, double sign,
                                              const SaeUnit& sae);
[[nodiscard]] can::SignalLayout switch_layout(const j1939::Field& field);
[[nodiscard]] can::SignalLayout code_layout(const j1939::Field& field);

/// `group` where the period is another than that of Message::kGroup.
template <class Message>
[[nodiscard]] can::MessageLayout layout(const LayoutEnds& ends,
                                        const Group& group = Message::kGroup) {
  can::MessageLayout message = begin_layout(group, ends);
  for (const Parameter<Message>& row : Message::parameters()) {
    message.fields.push_back(row.number != nullptr  ? number_layout(row.field, row.sign, row.sae)
                             : row.state != nullptr ? switch_layout(row.field)
                                                    : code_layout(row.field));
  }
  return message;
}

/// Appends those of several messages, each with its own period.
template <class... Messages>
void append_layouts(std::vector<can::MessageLayout>& list, const LayoutEnds& ends) {
  (list.push_back(layout<Messages>(ends)), ...);
}

/// DM1 or DM2 with at most one code, which is one frame.
[[nodiscard]] can::MessageLayout trouble_layout(const Group& group, const LayoutEnds& ends);

}  // namespace rigwire::protocols::vehicle

#include "protocols/vehicle/message.h"

#include "protocols/j1939/message.h"

namespace rigwire::protocols::vehicle {

std::optional<Malformed> refuse(const can::Frame& frame, std::uint32_t pgn) {
  const auto identifier = j1939::identify(frame);
  if (!identifier || identifier->pgn != pgn) {
    return Malformed{"another parameter group, or no 29-bit data frame", 0};
  }
  if (frame.length != kMessageBytes) {
    return Malformed{"the message has exactly 8 bytes", frame.length};
  }
  return std::nullopt;
}

can::Frame finish(const Group& group, std::uint8_t source, std::uint8_t destination,
                  const Payload& payload) {
  return j1939::make_frame({group.priority, group.pgn, destination, source}, payload);
}

}  // namespace rigwire::protocols::vehicle

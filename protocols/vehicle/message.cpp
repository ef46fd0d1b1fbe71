#include "protocols/vehicle/message.h"

#include <cmath>

#include "protocols/j1939/message.h"

namespace rigwire::protocols::vehicle {

void put_number(const j1939::Field& field, Payload& payload, double value) {
  if (std::isinf(value)) {
    j1939::put_raw(field, payload, j1939::error_value(field.width));
  } else {
    j1939::encode(field, payload, value);
  }
}

double get_number(const j1939::Field& field, std::span<const std::uint8_t> payload) {
  const j1939::Reading reading = j1939::decode(field, payload);
  if (reading.valid()) {
    return reading.value;
  }
  return reading.availability == j1939::Availability::error ? kError : kNotAvailable;
}

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

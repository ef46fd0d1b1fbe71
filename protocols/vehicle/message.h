// Messages of a vehicle's J1939 and ISO 11783 bus as tables: one row for each parameter, shared by
// encoder and decoder. The other headers of this folder hold one table per message.
//
// A message is a structure of plain members with
//   static constexpr Group kGroup        its number, priority and period;
//   static constexpr auto parameters()   its rows, which tie a Field to a member.
// Members are in SI units, angles and curvatures left positive; the rows hold scale and sign of the
// wire. Every message of this folder is one frame of exactly eight bytes; bits without a row are
// sent as ones. docs/devices/vehicle-gateway.md lists the bytes and the sources.
//
// Sources: SAE J1939 digital annex, October 2020 (positions, scales); SAE J1939-71, 5.1.4 (ranges);
// ISO 11783-7 as shown by isobus.net and the Danfoss PVED-CL protocol description.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>

#include "protocols/can/frame.h"
#include "protocols/j1939/field.h"
#include "protocols/j1939/identifier.h"
#include "protocols/result.h"

namespace rigwire::protocols::vehicle {

inline constexpr std::size_t kMessageBytes = 8;
using Payload = std::array<std::uint8_t, kMessageBytes>;

/// Numbers that are no measurement. Decoders give kNotAvailable for indicator values, too.
inline constexpr double kNotAvailable = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kError = std::numeric_limits<double>::infinity();

/// Parameters of two bits.
enum class Switch : std::uint8_t { off = 0, on = 1, error = 2, not_available = 3 };

[[nodiscard]] constexpr Switch to_switch(bool on) {
  return on ? Switch::on : Switch::off;
}

/// Raw value of a code (parameters()) that is not available; 8 bits and shorter ones.
[[nodiscard]] constexpr std::uint8_t code_not_available(unsigned width) {
  return static_cast<std::uint8_t>((1U << width) - 1U);
}

// Units on the wire, in SI.
inline constexpr double kPercent = 0.01;
inline constexpr double kKilometrePerHour_mps = 1.0 / 3.6;
inline constexpr double kRevolutionPerMinute_radps = 2.0 * std::numbers::pi / 60.0;
inline constexpr double kLitrePerHour_m3ps = 1e-3 / 3600.0;
inline constexpr double kDegree_rad = std::numbers::pi / 180.0;

/// Number and manner of a message.
struct Group {
  std::string_view name;
  std::uint32_t pgn = 0;
  std::uint8_t priority = 6;            ///< By default; receivers ignore it.
  std::chrono::milliseconds period{0};  ///< 0: on request or on change.
};

/// A unit that SAE J1939 gives a parameter in, and its size in the SI unit.
struct SaeUnit {
  std::string_view unit{};
  double size = 1.0;
};

/// One row: a field and the member that holds its value. Exactly one of the pointers is set.
template <class Message>
struct Parameter {
  j1939::Field field;
  double Message::*number = nullptr;      ///< A measurement; see kNotAvailable, kError.
  Switch Message::*state = nullptr;       ///< Two bits.
  std::uint8_t Message::*code = nullptr;  ///< 1 .. 8 bits as they are; all ones: not available.
  double sign = 1.0;                      ///< -1: positive on the wire is negative here.
  SaeUnit sae{};                          ///< Of a number, where it is not the field's unit.
};

/// Where a parameter begins: byte and bit, both counted from 1 as in the standard.
struct Position {
  unsigned byte = 1;
  unsigned bit = 1;

  [[nodiscard]] constexpr std::uint8_t lowest() const {
    return static_cast<std::uint8_t>(8 * (byte - 1) + bit - 1);
  }
};

inline constexpr SaeUnit kInRpm{"rpm", kRevolutionPerMinute_radps};
inline constexpr SaeUnit kInPercent{"%", kPercent};
inline constexpr SaeUnit kInKilopascal{"kPa", 1000.0};
inline constexpr SaeUnit kInKilometrePerHour{"km/h", kKilometrePerHour_mps};
inline constexpr SaeUnit kInDegree{"deg", kDegree_rad};
inline constexpr SaeUnit kPerKilometre{"1/km", 1e-3};
inline constexpr SaeUnit kInHour{"h", 3600.0};
inline constexpr SaeUnit kInMinute{"min", 60.0};

/// One count, the value of raw 0, and the unit that both are in; `sae` where the standard's unit is
/// another one.
struct Scale {
  double count = 1.0;
  double offset = 0.0;
  std::string_view unit;
  SaeUnit sae{};
};

/// A measurement over the whole valid range of its width.
template <class Message>
[[nodiscard]] constexpr Parameter<Message> number(std::string_view name, std::uint16_t spn,
                                                  Position position, std::uint8_t width,
                                                  const Scale& scale, double Message::*member) {
  const double upper = scale.offset + j1939::greatest_valid(width) * scale.count;
  return {{name, spn, position.lowest(), width, scale.count, scale.offset, scale.offset, upper,
           scale.unit},
          member,
          nullptr,
          nullptr,
          1.0,
          scale.sae};
}
/// The same with the opposite sign on the wire.
template <class Message>
[[nodiscard]] constexpr Parameter<Message> mirrored(Parameter<Message> parameter) {
  parameter.sign = -1.0;
  return parameter;
}
template <class Message>
[[nodiscard]] constexpr Parameter<Message> state(std::string_view name, std::uint16_t spn,
                                                 Position position, Switch Message::*member) {
  return {{name, spn, position.lowest(), 2, 1.0, 0.0, 0.0, 1.0, ""}, nullptr, member};
}
template <class Message>
[[nodiscard]] constexpr Parameter<Message> code(std::string_view name, std::uint16_t spn,
                                                Position position, std::uint8_t width,
                                                std::uint8_t Message::*member) {
  const double greatest = code_not_available(width);
  return {
      {name, spn, position.lowest(), width, 1.0, 0.0, 0.0, greatest, ""}, nullptr, nullptr, member};
}

/// Whether every row lies within the message, is of a width that its kind can have, and shares no
/// bit with another row.
template <class Message>
[[nodiscard]] constexpr bool is_well_formed() {
  std::uint64_t taken = 0;
  for (const Parameter<Message>& row : Message::parameters()) {
    const j1939::Field& field = row.field;
    const unsigned end = static_cast<unsigned>(field.bit) + field.width;
    const bool width_ok = row.code != nullptr ? field.width >= 1 && field.width <= 8
                                              : j1939::is_well_formed(field, kMessageBytes);
    const int members = (row.number != nullptr) + (row.state != nullptr) + (row.code != nullptr);
    if (!width_ok || end > 8 * kMessageBytes || members != 1) {
      return false;
    }
    const std::uint64_t bits = ((std::uint64_t{1} << field.width) - 1U) << field.bit;
    if ((taken & bits) != 0) {
      return false;
    }
    taken |= bits;
  }
  return true;
}

// The parts of encoder and decoder that no message changes.
void put_number(const j1939::Field& field, Payload& payload, double value);
[[nodiscard]] double get_number(const j1939::Field& field, std::span<const std::uint8_t> payload);
/// Why the frame is not a message of this group; nothing when it is.
[[nodiscard]] std::optional<Malformed> refuse(const can::Frame& frame, std::uint32_t pgn);
[[nodiscard]] can::Frame finish(const Group& group, std::uint8_t source, std::uint8_t destination,
                                const Payload& payload);

/// The frame of a message. Numbers beyond the range of their field are clamped to it, NaN is sent
/// as not available and an infinite number as error. `destination` counts where the group has one.
template <class Message>
[[nodiscard]] can::Frame encode(const Message& message, std::uint8_t source,
                                std::uint8_t destination = j1939::kGlobalAddress) {
  static constexpr auto kRows = Message::parameters();
  Payload payload;
  payload.fill(0xFF);
  for (const Parameter<Message>& row : kRows) {
    if (row.number != nullptr) {
      put_number(row.field, payload, row.sign * message.*row.number);
    } else if (row.state != nullptr) {
      j1939::put_raw(row.field, payload, static_cast<std::uint32_t>(message.*row.state));
    } else {
      j1939::put_raw(row.field, payload, message.*row.code);
    }
  }
  return finish(Message::kGroup, source, destination, payload);
}

/// Malformed unless the frame is a 29-bit data frame of that group with eight bytes. Who sent it
/// and to whom: j1939::identify.
template <class Message>
[[nodiscard]] Decoded<Message> decode(const can::Frame& frame) {
  if (const auto refusal = refuse(frame, Message::kGroup.pgn)) {
    return *refusal;
  }
  static constexpr auto kRows = Message::parameters();
  // Known here, so that no code is made for numbers of a message that has none (GCC 12 warns of
  // it).
  static constexpr bool kNumbers = std::any_of(
      kRows.begin(), kRows.end(), [](const auto& row) { return row.number != nullptr; });
  const auto payload = frame.payload();
  Message message;
  for (const Parameter<Message>& row : kRows) {
    if (kNumbers && row.number != nullptr) {
      const double value = get_number(row.field, payload);
      message.*row.number = value == kError ? kError : row.sign * value;
    } else if (row.state != nullptr) {
      message.*row.state = static_cast<Switch>(j1939::get_raw(row.field, payload));
    } else {
      message.*row.code = static_cast<std::uint8_t>(j1939::get_raw(row.field, payload));
    }
  }
  return {message, kMessageBytes};
}

}  // namespace rigwire::protocols::vehicle

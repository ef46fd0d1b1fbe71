// Messages of a vehicle's J1939 and ISO 11783 bus as tables: one row for each parameter, shared by
// encoder and decoder. The other headers of this folder hold one table per message.
//
// A message is a structure of plain members with
//   static constexpr Group kGroup        its number, priority and period;
//   static constexpr auto parameters()   its rows, which tie a signal to a member.
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
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocols/can/frame.h"
#include "protocols/can/message.h"
#include "protocols/can/signal.h"
#include "protocols/j1939/identifier.h"
#include "protocols/result.h"

namespace rigwire::protocols::vehicle {

inline constexpr std::size_t kMessageBytes = 8;
using Payload = std::array<std::uint8_t, kMessageBytes>;

/// Numbers that are no measurement. Decoders give kNotAvailable for indicator values, too.
inline constexpr double kNotAvailable = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kError = std::numeric_limits<double>::infinity();

/// Returns `value`, or kError if it is not finite.
[[nodiscard]] inline double reading(double value) {
  return std::isfinite(value) ? value : kError;
}
/// Returns the absolute value, or kError if it is not finite.
[[nodiscard]] inline double magnitude(double value) {
  return reading(std::abs(value));
}

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
  std::uint8_t fill = 0xFF;             ///< What bits hold that have no row.
};

/// Whether `pgn` is the message's group.
template <class Message>
[[nodiscard]] constexpr bool is(std::uint32_t pgn) {
  return Message::kGroup.pgn == pgn;
}

/// A unit that SAE J1939 gives a parameter in, and its size in the SI unit.
struct SaeUnit {
  std::string_view unit{};
  double size = 1.0;
};

/// One row: a signal and the member that holds its value. Exactly one of the pointers is set.
template <class Message>
struct Parameter {
  can::Signal signal;
  double Message::*number = nullptr;      ///< A measurement; see kNotAvailable, kError.
  Switch Message::*state = nullptr;       ///< Two bits.
  std::uint8_t Message::*code = nullptr;  ///< 1 .. 8 bits as they are; all ones: not available.
};

/// Where a parameter begins: byte and bit, both counted from 1 as in the standard.
struct Position {
  unsigned byte = 1;
  unsigned bit = 1;

  [[nodiscard]] constexpr std::uint16_t lowest() const {
    return static_cast<std::uint16_t>(8 * (byte - 1) + bit - 1);
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
[[nodiscard]] constexpr can::Signal number_signal(std::string_view name, std::uint32_t spn,
                                                  Position position, std::uint8_t width,
                                                  const Scale& scale) {
  can::Signal signal;
  signal.bit = position.lowest();
  signal.width = width;
  signal.reserved = can::Reserved::j1939;
  signal.scale = scale.count;
  signal.offset = scale.offset;
  signal.name = name;
  signal.unit = scale.unit;
  signal.spn = spn;
  signal.document_unit = !scale.sae.unit.empty() ? scale.sae.unit
                         : scale.unit != "1"     ? scale.unit
                                                 : std::string_view();
  signal.document_size = scale.sae.size;
  return can::unlimited(signal);
}
/// A raw value, with names for some.
[[nodiscard]] constexpr can::Signal code_signal(std::string_view name, std::uint32_t spn,
                                                Position position, std::uint8_t width,
                                                std::span<const can::NamedValue> values) {
  can::Signal signal;
  signal.bit = position.lowest();
  signal.width = width;
  signal.upper = static_cast<double>(can::greatest_raw(width));
  signal.name = name;
  signal.spn = spn;
  signal.values = values;
  return signal;
}

inline constexpr std::array<can::NamedValue, 4> kSwitchValues{
    {{0, "off"}, {1, "on"}, {2, "error"}, {3, "not available"}}};
/// All ones, by width.
inline constexpr auto kCodeValues = [] {
  std::array<can::NamedValue, 9> values{};
  for (unsigned width = 0; width < values.size(); ++width) {
    values[width] = {code_not_available(width), "not available"};
  }
  return values;
}();

template <class Message>
[[nodiscard]] constexpr Parameter<Message> number(std::string_view name, std::uint32_t spn,
                                                  Position position, std::uint8_t width,
                                                  const Scale& scale, double Message::*member) {
  return {number_signal(name, spn, position, width, scale), member};
}
/// Returns the parameter with the opposite sign on the wire.
template <class Message>
[[nodiscard]] constexpr Parameter<Message> mirrored(Parameter<Message> parameter) {
  can::Signal& signal = parameter.signal;
  signal.scale = -signal.scale;
  signal.offset = -signal.offset;
  const double lower = -signal.upper;
  signal.upper = -signal.lower;
  signal.lower = lower;
  signal.document_size = -signal.document_size;
  return parameter;
}
template <class Message>
[[nodiscard]] constexpr Parameter<Message> state(std::string_view name, std::uint32_t spn,
                                                 Position position, Switch Message::*member) {
  return {code_signal(name, spn, position, 2, kSwitchValues), nullptr, member};
}
/// `values` where more than "not available" has a name.
template <class Message>
[[nodiscard]] constexpr Parameter<Message> code(std::string_view name, std::uint32_t spn,
                                                Position position, std::uint8_t width,
                                                std::uint8_t Message::*member,
                                                std::span<const can::NamedValue> values = {}) {
  return {code_signal(name, spn, position, width,
                      values.empty() ? std::span(&kCodeValues[width], 1) : values),
          nullptr, nullptr, member};
}

/// The row of a number.
template <class Message>
[[nodiscard]] constexpr can::Signal signal_of(double Message::*number) {
  for (const Parameter<Message>& row : Message::parameters()) {
    if (row.number == number) {
      return row.signal;
    }
  }
  return {};
}

/// Whether every row lies within the message, is of a width that its kind can have, and shares no
/// bit with another row.
template <class Message>
[[nodiscard]] constexpr bool is_well_formed() {
  std::array<std::uint8_t, kMessageBytes> taken{};
  for (const Parameter<Message>& row : Message::parameters()) {
    const int members = (row.number != nullptr) + (row.state != nullptr) + (row.code != nullptr);
    if (members != 1 || (row.number == nullptr && row.signal.width > 8) ||
        !can::defect(row.signal, kMessageBytes).empty()) {
      return false;
    }
    for (std::size_t byte = 0; byte < kMessageBytes; ++byte) {
      const std::uint8_t bits = can::bits_in(row.signal, byte);
      if ((taken[byte] & bits) != 0) {
        return false;
      }
      taken[byte] |= bits;
    }
  }
  return true;
}

/// The rows of a message. One whose rows are not well formed does not compile.
template <class Message>
inline constexpr auto kRows = [] {
  static_assert(is_well_formed<Message>());
  return Message::parameters();
}();

// The parts of encoder and decoder that no message changes.
/// Why the frame is not a message of this group; nothing when it is.
[[nodiscard]] std::optional<Malformed> refuse(const can::Frame& frame, std::uint32_t pgn);
[[nodiscard]] can::Frame finish(const Group& group, std::uint8_t source, std::uint8_t destination,
                                const Payload& payload);

/// The frame of a message. Numbers beyond the range of their signal are clamped to it, NaN is sent
/// as not available and an infinite number as error. `destination` counts where the group has one;
/// `group` where its number or priority is another than that of Message::kGroup.
template <class Message>
[[nodiscard]] can::Frame encode(const Message& message, std::uint8_t source,
                                std::uint8_t destination = j1939::kGlobalAddress,
                                const Group& group = Message::kGroup) {
  Payload payload;
  payload.fill(group.fill);
  for (const Parameter<Message>& row : kRows<Message>) {
    if (row.number != nullptr) {
      can::put(row.signal, payload, message.*row.number);
    } else if (row.state != nullptr) {
      can::put_raw(row.signal, payload, static_cast<std::uint64_t>(message.*row.state));
    } else {
      can::put_raw(row.signal, payload, message.*row.code);
    }
  }
  return finish(group, source, destination, payload);
}

/// Malformed unless the frame is a 29-bit data frame of that group with eight bytes. Numbers that
/// are none: kError, kNotAvailable. Source and destination: j1939::identify.
template <class Message>
[[nodiscard]] Decoded<Message> decode(const can::Frame& frame,
                                      std::uint32_t pgn = Message::kGroup.pgn) {
  if (const auto refusal = refuse(frame, pgn)) {
    return *refusal;
  }
  // Known here, so that no code is made for numbers of a message that has none (GCC 12 warns of
  // it).
  static constexpr bool kNumbers =
      std::any_of(kRows<Message>.begin(), kRows<Message>.end(),
                  [](const auto& row) { return row.number != nullptr; });
  const auto payload = frame.payload();
  Message message;
  for (const Parameter<Message>& row : kRows<Message>) {
    if (kNumbers && row.number != nullptr) {
      message.*row.number = can::get(row.signal, payload).number();
    } else if (row.state != nullptr) {
      message.*row.state = static_cast<Switch>(can::get_raw(row.signal, payload));
    } else {
      message.*row.code = static_cast<std::uint8_t>(can::get_raw(row.signal, payload));
    }
  }
  return {message, kMessageBytes};
}

// The messages of this folder in the common form (protocols/can/message.h), made from the tables
// that encoder and decoder use. Physical values are those of the structures' members: SI units,
// angles and curvatures left positive. The document's units and signs are SAE's.

/// Sender and receiver of a message, for its identifier and its table.
struct LayoutEnds {
  std::string_view sender;  ///< Name of a device; empty: the controlling device.
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
  for (const Parameter<Message>& row : kRows<Message>) {
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

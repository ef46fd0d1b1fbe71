// How the messages of a bus are laid out, in one form for every family of messages: what the DBC
// file is written from, and what the device pages list.
//
// A family (protocols/vehicle, protocols/openimu, ...) gives its messages as
// std::span<const MessageLayout>, made from the tables that its codecs use, never typed twice.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rigwire::protocols::can {

enum class ByteOrder : std::uint8_t { little_endian, big_endian };

/// One named value of a signal.
struct NamedValue {
  std::uint64_t raw = 0;
  std::string text;
};

struct SignalLayout {
  std::string name;  ///< Field term in snake_case, unique within its message.
  /// Of the least significant bit; byte k has bits 8 k (least significant) .. 8 k + 7.
  std::uint16_t bit = 0;
  std::uint16_t width = 8;  ///< 1 .. 64.
  ByteOrder order = ByteOrder::little_endian;
  bool is_signed = false;
  double scale = 1.0;  ///< Physical = raw * scale + offset.
  double offset = 0.0;
  double lower = 0.0;  ///< Physical, of the valid range.
  double upper = 0.0;
  std::string unit;  ///< Of the physical value; empty for bare numbers.
  /// The unit that the document gives it in, where that is another one, and its size in `unit`;
  /// negative where its sign is the other one, too.
  std::string document_unit;
  double document_size = 1.0;
  std::vector<NamedValue> values;
  std::string text;       ///< What it means; source (SPN, document).
  std::uint32_t spn = 0;  ///< Suspect parameter number of J1939; 0: none.
};

struct MessageLayout {
  std::string name;             ///< Field term in snake_case, unique on a bus.
  std::uint32_t id = 0;         ///< As sent by `sender`; 29 bits when `extended`.
  bool extended = false;        ///< 29-bit identifier.
  bool j1939 = false;           ///< The identifier is priority, parameter group and source.
  std::uint8_t length = 8;      ///< Bytes.
  std::uint32_t period_ms = 0;  ///< 0: on request or on change.
  std::string sender;           ///< The device's name; empty: whoever controls it.
  std::string text;             ///< What it is; source.
  std::vector<SignalLayout> fields;
};

}  // namespace rigwire::protocols::can

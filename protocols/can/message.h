// A CAN message as a table of signals: what encoders, decoders, the DBC file and the device pages
// are made from. A family (protocols/vehicle, protocols/xsens, ...) gives its messages once; those
// of a file are of the same form with texts of their own.
//
// Multiplexing: a signal may be there only at some raw values of another one, its multiplexor,
// which may be multiplexed itself. Signals that are never there together may share bits.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/can/frame.h"
#include "protocols/can/signal.h"

namespace rigwire::protocols::can {

template <class Keep>
struct BasicMessage {
  typename Keep::Text name;     ///< Field term, unique on a bus.
  std::uint32_t id = 0;         ///< Identifier as sent by `sender`; 29 bits if `extended`.
  bool extended = false;        ///< 29-bit identifier.
  bool j1939 = false;           ///< The identifier is priority, parameter group and source.
  std::uint16_t length = 8;     ///< Bytes; more than eight go by a transport.
  std::uint8_t fill = 0;        ///< Value of bits that no signal uses.
  std::uint32_t period_ms = 0;  ///< 0: on request or on change, or not known.
  typename Keep::Text sender;   ///< Name of a device; empty: the controlling device.
  typename Keep::Text text;     ///< What it is; source.
  typename Keep::template List<BasicSignal<Keep>> signals;
};
using Message = BasicMessage<Borrowed>;
using OwnedMessage = BasicMessage<Owned>;

/// What is wrong with a message, and with which of its signals.
struct Defect {
  std::string_view what;
  std::size_t signal = 0;
};

/// Whether `signal` depends on itself, or on a signal that does not exist.
template <class Keep>
[[nodiscard]] constexpr bool is_lost(const BasicMessage<Keep>& message, std::size_t signal) {
  for (std::size_t steps = 0; signal < message.signals.size(); ++steps) {
    if (message.signals[signal].multiplexor == kNoMultiplexor) {
      return false;
    }
    if (steps == message.signals.size()) {
      return true;
    }
    signal = message.signals[signal].multiplexor;
  }
  return true;
}

/// Why a signal of the message cannot be coded; nothing when all can. Signals that share bits are
/// no such defect: overlap() finds them.
template <class Keep>
[[nodiscard]] constexpr std::optional<Defect> defect(const BasicMessage<Keep>& message) {
  for (std::size_t i = 0; i < message.signals.size(); ++i) {
    if (const std::string_view what = defect(message.signals[i], message.length); !what.empty()) {
      return Defect{what, i};
    }
    if (is_lost(message, i)) {
      return Defect{"the multiplexor is no other signal of the message", i};
    }
  }
  return std::nullopt;
}

/// Whether two signals of a message without defect are never there together: somewhere on their
/// ways up they want different values of one multiplexor.
template <class Keep>
[[nodiscard]] constexpr bool exclude_each_other(const BasicMessage<Keep>& message, std::size_t one,
                                                std::size_t other) {
  const auto disjoint = [](const auto& a, const auto& b) {
    for (const RawRange& of_a : a) {
      for (const RawRange& of_b : b) {
        if (of_a.first <= of_b.last && of_b.first <= of_a.last) {
          return false;
        }
      }
    }
    return true;
  };
  for (std::size_t a = one; message.signals[a].multiplexor != kNoMultiplexor;
       a = message.signals[a].multiplexor) {
    for (std::size_t b = other; message.signals[b].multiplexor != kNoMultiplexor;
         b = message.signals[b].multiplexor) {
      if (message.signals[a].multiplexor == message.signals[b].multiplexor &&
          disjoint(message.signals[a].present_at, message.signals[b].present_at)) {
        return true;
      }
    }
  }
  return false;
}

/// Two signals of a message without defect that share a bit and can be there together.
template <class Keep>
[[nodiscard]] constexpr std::optional<std::pair<std::size_t, std::size_t>> overlap(
    const BasicMessage<Keep>& message) {
  for (std::size_t b = 1; b < message.signals.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      for (std::size_t byte = 0; byte < message.length; ++byte) {
        if ((bits_in(message.signals[a], byte) & bits_in(message.signals[b], byte)) != 0 &&
            !exclude_each_other(message, a, b)) {
          return std::pair{a, b};
        }
      }
    }
  }
  return std::nullopt;
}

/// Whether every signal can be coded, and no two share a bit while both are there.
template <class Keep>
[[nodiscard]] constexpr bool well_formed(const BasicMessage<Keep>& message) {
  return !defect(message) && !overlap(message);
}

/// Whether a payload of the message has that signal, as its multiplexors in it say.
template <class Keep>
[[nodiscard]] bool is_present(const BasicMessage<Keep>& message, std::size_t signal,
                              std::span<const std::uint8_t> payload) {
  if (is_lost(message, signal)) {
    return false;
  }
  while (message.signals[signal].multiplexor != kNoMultiplexor) {
    const auto& row = message.signals[signal];
    const Coding& multiplexor = message.signals[row.multiplexor];
    const std::uint64_t raw = get_raw(multiplexor, payload);
    bool there = false;
    for (const RawRange& range : row.present_at) {
      there = there || (raw >= range.first && raw <= range.last);
    }
    if (!there || !fits(multiplexor, payload.size())) {
      return false;
    }
    signal = row.multiplexor;
  }
  return true;
}

/// The value of one signal; not available where the payload does not have it.
template <class Keep>
[[nodiscard]] Reading get(const BasicMessage<Keep>& message, std::size_t signal,
                          std::span<const std::uint8_t> payload) {
  return is_present(message, signal, payload) ? get(message.signals[signal], payload) : Reading{};
}

/// Writes all signals, those first on which others depend; what by then is not present is left out.
/// `values` are physical ones in the order of the signals; those that are missing leave their bits
/// as they are.
template <class Keep>
void put(const BasicMessage<Keep>& message, std::span<std::uint8_t> payload,
         std::span<const double> values) {
  const std::size_t count = std::min(values.size(), message.signals.size());
  for (std::size_t depth = 0, written = 0; depth <= count && written < count; ++depth) {
    for (std::size_t i = 0; i < count; ++i) {
      std::size_t above = 0;
      for (std::size_t at = i; above <= depth && at < message.signals.size() &&
                               message.signals[at].multiplexor != kNoMultiplexor;
           ++above) {
        at = message.signals[at].multiplexor;
      }
      if (above == depth) {
        ++written;
        if (is_present(message, i, payload)) {
          put(message.signals[i], payload, values[i]);
        }
      }
    }
  }
}

/// The frame of a message of at most eight bytes; of a longer one the first eight.
template <class Keep>
[[nodiscard]] Frame encode(const BasicMessage<Keep>& message, std::span<const double> values) {
  Frame frame;
  frame.id = message.id;
  frame.extended = message.extended;
  frame.length = static_cast<std::uint8_t>(std::min<std::size_t>(message.length, 8));
  const auto payload = std::span(frame.data).first(frame.length);
  std::fill(payload.begin(), payload.end(), message.fill);
  put(message, payload, values);
  return frame;
}

/// "relative, front left" as relative_front_left.
[[nodiscard]] std::string snake_case(std::string_view words);

/// A row with texts of its own, as DBC files and descriptions have it: the name in snake_case, no
/// unit for "1", SPN as text where there is none, and the reserved patterns named (up to 16 bits:
/// greater ones do not fit the readers' integers).
[[nodiscard]] OwnedSignal owned(const Signal& signal);
[[nodiscard]] OwnedMessage owned(const Message& message);

}  // namespace rigwire::protocols::can

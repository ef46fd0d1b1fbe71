// Shared by the chapters of the suite velodyne: what a case needs, and the report of the first
// packet that is wrong.
#pragma once

#include <array>
#include <cstdio>
#include <optional>
#include <string>

#include "conform/velodyne/velodyne_suite.h"

namespace rigwire::conform {

inline std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

/// "0x37"
inline std::string byte_text(unsigned value) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%02X", value);
  return text.data();
}

/// The fault that a check found; nullopt: none.
using Wrong = std::optional<std::string>;

/// Checks each of `packets` and shows the first that is wrong. `check` returns a Wrong.
template <class Packets, class Check>
void each(Trial& trial, const Packets& packets, const char* expected, const Check& check) {
  for (const auto& packet : packets) {
    if (Wrong wrong = check(packet)) {
      trial.received(packet.datagram().bytes, *wrong);
      trial.expect(false, expected, std::move(*wrong));
      return;
    }
  }
  trial.expect(true, expected, "");
}

// --- what a case needs ---

inline std::string nothing(const VelodyneLog&, const VelodyneClaims&) {
  return {};
}
inline std::string a_model(const VelodyneLog& log, const VelodyneClaims&) {
  return log.model() == nullptr ? "the model is in doubt: claim one" : "";
}
inline std::string all_round(const VelodyneLog& log, const VelodyneClaims& claims) {
  return !claims.all_round() ? "its view is narrowed" : a_model(log, claims);
}
inline std::string factory_bytes(const VelodyneLog& log, const VelodyneClaims&) {
  return log.model() != nullptr && log.model()->status_channel
             ? "its last two bytes are a status channel"
             : "";
}
inline std::string two_returns(const VelodyneLog& log, const VelodyneClaims& claims) {
  return log.model() != nullptr && !log.dual() ? "it sends one return" : a_model(log, claims);
}
inline std::string one_return(const VelodyneLog& log, const VelodyneClaims& claims) {
  return log.dual() ? "it sends two returns" : a_model(log, claims);
}
inline std::string position_packets(const VelodyneLog& log, const VelodyneClaims&) {
  const bool none = log.model() != nullptr &&
                    log.model()->position_layout == protocols::velodyne::PositionLayout::none;
  return none ? "the model has no position packets" : "";
}

}  // namespace rigwire::conform

// What a receiver reports of its chip and its memory: SEC-UNIQID (class 0x27) and LOG-INFO (class
// 0x21), in wire units. u-blox 8 and later.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 32.14.5 "UBX-LOG-INFO" and
// 32.19.1 "UBX-SEC-UNIQID".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// SEC-UNIQID.
struct SecUniqid {
  static constexpr MessageId kId{0x27, 0x03};
  static constexpr std::size_t kLength = 4 /*version*/ + 5 /*number*/;

  std::uint8_t version = 1;
  std::array<std::uint8_t, 5> number{};

  static constexpr auto fields(auto& m) { return std::tie(m.version, gap<3>, m.number); }
};

/// Class of the data logger's messages; LOG-CREATE, LOG-ERASE and LOG-RETRIEVE among them are
/// acknowledged.
inline constexpr std::uint8_t kClassLog = 0x21;
inline constexpr MessageId kLogErase{kClassLog, 0x03};
inline constexpr MessageId kLogCreate{kClassLog, 0x07};
inline constexpr MessageId kLogRetrieve{kClassLog, 0x09};

/// LOG-INFO. The date of the oldest and the newest entry is left out.
struct LogInfo {
  static constexpr MessageId kId{kClassLog, 0x08};
  static constexpr std::size_t kLength =
      8 /*version, capacity*/ + 8 /*reserved*/ + 12 /*log*/ + 16 /*dates*/ + 4 /*state*/;

  std::uint8_t version = 1;
  std::uint32_t capacity_bytes = 0;        ///< Capacity of the file store.
  std::array<std::uint8_t, 8> reserved{};  ///< Not zero as delivered.
  std::uint32_t greatest_log_bytes = 0;
  std::uint32_t log_bytes = 0;
  std::uint32_t entries = 0;
  std::uint8_t status = 0;  ///< b3 recording, b4 inactive (no log), b5 circular.

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, gap<3>, m.capacity_bytes, m.reserved, m.greatest_log_bytes,
                    m.log_bytes, m.entries, gap<16>, m.status, gap<3>);
  }
};

}  // namespace rigwire::protocols::ubx

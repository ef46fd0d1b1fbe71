// Active diagnostic trouble codes (DM1) and the broadcast transport that carries more than one.
//
// Sources: SAE J1939-73, 5.7.1 (DM1: lamps, codes); J1939-21, 5.10 (broadcast announce, data
// transfer). DM1 payload: lamps, flash codes (all ones: not flashing), then four bytes per code. A
// payload of up to 8 bytes is one frame, filled with ones; a longer one is announced (TP.CM, PGN
// 60416, control 32) and sent in packets of seven bytes (TP.DT, PGN 60160).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "protocols/can/frame.h"
#include "protocols/result.h"

namespace rigwire::protocols::vehicle {

inline constexpr std::uint32_t kDm1Pgn = 65226;
inline constexpr std::uint32_t kTransportManagementPgn = 60416;
inline constexpr std::uint32_t kTransportDataPgn = 60160;

/// Failure mode identifiers that this project sends.
enum class FailureMode : std::uint8_t {
  abnormal_update_rate = 9,
  received_data_in_error = 19,
  condition_exists = 31,
};

struct TroubleCode {
  std::uint32_t spn = 0;          ///< 19 bits.
  std::uint8_t failure_mode = 0;  ///< 5 bits.
  std::uint8_t occurrences = 0;   ///< 7 bits; 127 not available.

  friend bool operator==(const TroubleCode&, const TroubleCode&) = default;
};

struct Lamps {
  bool malfunction = false;
  bool red_stop = false;
  bool amber_warning = false;
  bool protect = false;

  friend bool operator==(const Lamps&, const Lamps&) = default;
};

inline constexpr std::size_t kLampBytes = 2;
inline constexpr std::size_t kCodeBytes = 4;
inline constexpr std::size_t kGreatestCodes = 8;  ///< What the types below hold.

/// A DM1 payload: `size` bytes of `bytes` are it, before filling up to a frame.
struct TroubleReport {
  std::array<std::uint8_t, kLampBytes + kGreatestCodes * kCodeBytes> bytes{};
  std::size_t size = 0;

  [[nodiscard]] std::span<const std::uint8_t> payload() const {
    return std::span(bytes).first(size);
  }
};

/// Codes beyond kGreatestCodes are left out. Without codes one of zeros is sent.
[[nodiscard]] TroubleReport make_trouble_report(const Lamps& lamps,
                                                std::span<const TroubleCode> codes);

/// What a DM1 payload says.
struct TroubleCodes {
  Lamps lamps;
  std::array<TroubleCode, kGreatestCodes> codes{};
  std::size_t count = 0;  ///< Codes of zeros are not counted.
};
/// Incomplete below six bytes; codes beyond kGreatestCodes are left out.
[[nodiscard]] Decoded<TroubleCodes> decode_trouble_report(std::span<const std::uint8_t> payload);

/// Frames that carry a report: 1 for up to eight bytes, else the announcement and its packets.
[[nodiscard]] std::size_t report_frames(const TroubleReport& report);
/// Frame `index` of them. Precondition: index < report_frames(report).
[[nodiscard]] can::Frame report_frame(const TroubleReport& report, std::size_t index,
                                      std::uint8_t source);

}  // namespace rigwire::protocols::vehicle

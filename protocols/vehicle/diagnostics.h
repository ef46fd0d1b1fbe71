// Diagnostic trouble codes: the active ones (DM1), those that were active (DM2), and the requests
// that clear them (DM3, DM11).
//
// Source: SAE J1939-73, 5.7.1 to 5.7.3, 5.7.11. Payload of DM1 and DM2: lamps, flash codes (all
// ones: not flashing), then four bytes per code; without a code one of zeros. It is filled with
// ones to the eight bytes of a frame; with two codes or more it is longer and sent by transport
// (protocols/j1939/transport.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "protocols/result.h"

namespace rigwire::protocols::vehicle {

inline constexpr std::uint32_t kDm1Pgn = 65226;   ///< FECA, every second and on change.
inline constexpr std::uint32_t kDm2Pgn = 65227;   ///< FECB, on request.
inline constexpr std::uint32_t kDm3Pgn = 65228;   ///< FECC: a request for it clears DM2.
inline constexpr std::uint32_t kDm11Pgn = 65235;  ///< FED3: a request for it clears DM1.
inline constexpr std::uint8_t kTroublePriority = 6;

/// Failure mode identifiers that this project sends.
enum class FailureMode : std::uint8_t {
  above_normal = 0,
  erratic = 2,
  voltage_low = 4,
  current_low = 5,
  current_high = 6,
  mechanical = 7,
  abnormal_update_rate = 9,
  out_of_calibration = 13,
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

/// A payload of DM1 or DM2: `size` bytes of `bytes` are it, eight or more.
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

/// What such a payload says.
struct TroubleCodes {
  Lamps lamps;
  std::array<TroubleCode, kGreatestCodes> codes{};
  std::size_t count = 0;  ///< Codes of zeros are not counted.
};
/// Incomplete below six bytes; codes beyond kGreatestCodes are left out.
[[nodiscard]] Decoded<TroubleCodes> decode_trouble_report(std::span<const std::uint8_t> payload);

}  // namespace rigwire::protocols::vehicle

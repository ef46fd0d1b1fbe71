// The status channel of an HDL-64E: the last two bytes of each data packet, a type and a value.
//
// Sixteen packets are a cycle: hour, minute, second, day, month, year of the time in UTC, GPS
// state, temperature, firmware version (types H M S D N Y G T V), then seven bytes of the record
// that status_record.h describes (types '1' to '7', and some of their own). 260 cycles or 4160
// packets carry all of it.
//
// Source: HDL-64E S3 user's manual 63-HDL64ES3 Rev. K, appendix E, pages 33 to 37. The S2.1 differs
// in the check and has no type W.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "protocols/velodyne/status_record.h"

namespace rigwire::protocols::velodyne {

inline constexpr std::size_t kStatusLiveValues = 9;
inline constexpr std::size_t kStatusPieceSize = 7;
inline constexpr std::size_t kStatusCycle = kStatusLiveValues + kStatusPieceSize;
inline constexpr std::size_t kStatusPeriod = kStatusRecordSize / kStatusPieceSize * kStatusCycle;
static_assert(kStatusCycle == 16 && kStatusPeriod == 4160);

/// Factory bytes of one packet.
struct StatusByte {
  std::uint8_t type = 0;
  std::uint8_t value = 0;

  friend bool operator==(const StatusByte&, const StatusByte&) = default;
};

enum class StatusGps : std::uint8_t {
  none = 0,
  pulse = 'P',     ///< Pulse per second alone.
  sentence = 'V',  ///< Sentence alone.
  pulse_and_sentence = 'A',
};

/// What changes from cycle to cycle.
struct StatusLive {
  std::uint8_t hour = 0;  ///< UTC.
  std::uint8_t minute = 0;
  std::uint8_t second = 0;
  std::uint8_t day = 1;
  std::uint8_t month = 1;
  std::uint8_t year = 0;  ///< From 2000.
  StatusGps gps = StatusGps::none;
  std::uint8_t temperature_c = 40;
  std::uint8_t version = 0x40;

  friend bool operator==(const StatusLive&, const StatusLive&) = default;
};

/// Says what each packet carries.
class StatusChannel {
 public:
  /// Validates the record's calibration, throws as validate() does.
  explicit StatusChannel(const StatusRecord& record);

  /// Applies a changed speed, view or warning; the calibration stays. Does not allocate.
  void update(const StatusRecord& record);

  /// Returns the status byte of packet number `packet` since power-up.
  [[nodiscard]] StatusByte at(std::uint64_t packet, const StatusLive& live) const;

 private:
  StatusFormat format_;
  std::array<std::uint8_t, kStatusRecordSize> bytes_{};
};

/// Puts the pieces together again. Packets come in order; a lost one makes it wait for the next
/// start of a record.
class StatusReader {
 public:
  /// The record, with the packet that completes it.
  std::optional<StatusRecord> add(const StatusByte& status);

  /// The latest values received; gps holds whatever byte came.
  [[nodiscard]] const StatusLive& live() const { return live_; }
  /// Records that were complete but did not pass their check, or broke off.
  [[nodiscard]] std::uint64_t rejected() const { return rejected_; }

 private:
  [[nodiscard]] bool take_live(const StatusByte& status);
  void break_off();

  StatusLive live_;
  std::array<std::uint8_t, kStatusRecordSize> bytes_{};
  std::size_t size_ = 0;      ///< Bytes of the record so far.
  std::size_t in_cycle_ = 0;  ///< Pieces since the last version byte.
  std::size_t live_run_ = 0;  ///< Live values since the last piece.
  std::uint64_t rejected_ = 0;
};

}  // namespace rigwire::protocols::velodyne

// The NMEA 0183 sentence: '$', address, comma-separated fields, '*', two hexadecimal digits, CR LF.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 31.1 "NMEA Protocol Overview";
// checksum: exclusive or of all characters between '$' and '*'.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "protocols/result.h"

namespace rigwire::protocols::nmea {

/// Longest sentence that is taken, from '$' to LF. NMEA 0183 allows 82 characters; u-blox
/// receivers take and print longer ones.
inline constexpr std::size_t kMaximumSentence = 256;

/// Room for a sentence that is written; PUBX,03 needs most.
inline constexpr std::size_t kLongestWritten = 1024;

/// Most fields after the address that a view keeps.
inline constexpr std::size_t kMaximumFields = 32;

/// A checked sentence; texts point into the bytes it was decoded from.
struct SentenceView {
  /// Talker and type, for example "GPRMC", or "PUBX".
  std::string_view address;
  std::size_t field_count = 0;
  std::array<std::string_view, kMaximumFields> fields{};

  /// The text of a field; empty beyond the last one.
  [[nodiscard]] std::string_view field(std::size_t index) const {
    return index < std::min(field_count, kMaximumFields) ? fields[index] : std::string_view{};
  }
  /// The last three characters of a standard address ("RMC"); all of a proprietary one.
  [[nodiscard]] std::string_view type() const;
};

[[nodiscard]] std::uint8_t checksum(std::string_view between_dollar_and_star);

/// Decodes the sentence that starts at bytes[0] == '$' and ends with LF (a CR before it is taken
/// too). Malformed: no '$', a byte outside printable ASCII, no or wrong checksum, too long, too
/// many fields. Incomplete: no LF yet. After malformed, go on at find_start(bytes, 1).
[[nodiscard]] Decoded<SentenceView> decode_sentence(std::span<const std::uint8_t> bytes);

/// Offset of the first '$' at or after `from`; bytes.size() when there is none.
[[nodiscard]] std::size_t find_start(std::span<const std::uint8_t> bytes, std::size_t from);

/// Whole numbers next to each other, as "082307.00" is made of.
class Digits {
 public:
  /// With zeros in front up to so many digits, a minus sign before them and counted among them, as
  /// printf has it.
  Digits& put(int digits, std::int64_t value);
  Digits& point() { return letter('.'); }
  Digits& letter(char c);
  [[nodiscard]] std::string_view text() const { return {characters_.data(), size_}; }

 private:
  std::array<char, 64> characters_{};
  std::size_t size_ = 0;
};

/// A sentence being written. Text beyond kLongestWritten is cut (no sentence of ours comes near
/// it).
class Sentence {
 public:
  explicit Sentence(std::string_view address);

  Sentence& field(std::string_view text);
  Sentence& empty() { return field({}); }
  /// With so many decimals, exactly rounded. What rounds to zero has no minus sign.
  Sentence& decimal(int decimals, double value);
  /// With zeros in front up to so many digits.
  Sentence& number(int digits, int value);
  /// Capital digits.
  Sentence& hexadecimal(int value);

  /// Adds checksum and line end on first use. The view lives as long as the sentence.
  std::string_view text();
  std::span<const std::uint8_t> bytes();

 private:
  void append(std::string_view text);

  std::array<char, kLongestWritten> characters_{};
  std::size_t size_ = 0;
  bool finished_ = false;
};

}  // namespace rigwire::protocols::nmea

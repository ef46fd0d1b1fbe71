// What a receiver of NMEA 0183 said over a while, sentence by sentence and epoch by epoch: what the
// cases of the suite `nmea` look at.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/gnss_stream/splitter.h"

namespace rigwire::conform {

/// A line that begins with $ or !.
struct NmeaSentence {
  std::chrono::nanoseconds at{};    ///< When its end came, from the begin of listening.
  std::string text;                 ///< Without CR and LF.
  bool carriage_return = false;     ///< CR before LF.
  std::string talker;               ///< "GN"; of a proprietary sentence "P".
  std::string type;                 ///< "RMC"; of a proprietary sentence what follows the P.
  std::vector<std::string> fields;  ///< After the type, before the asterisk.
  std::string check;                ///< Checksum as received; empty: none.
  std::uint8_t right_check = 0;     ///< Correct checksum of its content.

  [[nodiscard]] const std::string& field(std::size_t index) const;
  [[nodiscard]] std::optional<double> number(std::size_t index) const;
};

/// Sentences of one instant of navigation, in the order in which they came.
struct NmeaEpoch {
  std::string time;  ///< hhmmss.ss of the first that has one.
  std::vector<const NmeaSentence*> sentences;

  /// The first of that type; null without.
  [[nodiscard]] const NmeaSentence* find(std::string_view type) const;
};

class NmeaLog {
 public:
  /// Bytes as they came; may end within a line. Messages of UBX and RTCM 3 between the sentences
  /// are passed over.
  void add(std::chrono::nanoseconds at, std::span<const std::uint8_t> bytes);
  /// More came than is kept: listening ended there. `allowed` says how much may come.
  void overflow(std::string allowed) { overflow_ = std::move(allowed); }
  /// Empty: everything that came is here.
  [[nodiscard]] const std::string& overflow() const { return overflow_; }
  /// To be called once, when listening ends: groups what came.
  void close();

  [[nodiscard]] const std::vector<NmeaSentence>& sentences() const { return sentences_; }
  /// Whole ones: neither the first nor the last, which may have begun or end outside.
  [[nodiscard]] const std::vector<NmeaEpoch>& epochs() const { return epochs_; }
  [[nodiscard]] std::chrono::nanoseconds span() const { return span_; }

 private:
  void add_piece(std::chrono::nanoseconds at, std::span<const std::uint8_t> bytes,
                 const protocols::gnss_stream::Splitter::Content& content);

  protocols::gnss_stream::Splitter splitter_;
  std::string line_;
  bool in_line_ = false;
  std::vector<NmeaSentence> sentences_;
  std::vector<NmeaEpoch> epochs_;
  std::chrono::nanoseconds span_{};
  std::string overflow_;
};

/// Returns the index of the field with the time of day; nullopt if the type has none.
[[nodiscard]] std::optional<std::size_t> time_field(std::string_view type);

}  // namespace rigwire::conform

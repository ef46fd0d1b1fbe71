#include "conform/nmea/nmea_log.h"

#include <array>
#include <cctype>
#include <charconv>
#include <variant>

namespace rigwire::conform {

namespace gnss_stream = protocols::gnss_stream;

namespace {

const std::string kNothing;

struct TimeField {
  std::string_view type;
  std::size_t index;
};
constexpr std::array<TimeField, 8> kTimes{{{"RMC", 0},
                                           {"GGA", 0},
                                           {"GNS", 0},
                                           {"GLL", 4},
                                           {"ZDA", 0},
                                           {"GST", 0},
                                           {"GBS", 0},
                                           {"GRS", 0}}};

NmeaSentence take_apart(std::chrono::nanoseconds at, const std::string& line,
                        bool carriage_return) {
  NmeaSentence sentence;
  sentence.at = at;
  sentence.carriage_return = carriage_return;
  const std::size_t star = line.rfind('*');
  const std::string body = line.substr(1, star == std::string::npos ? star : star - 1);
  sentence.check = star == std::string::npos ? "" : line.substr(star + 1);
  for (const char c : body) {
    sentence.right_check =
        static_cast<std::uint8_t>(sentence.right_check ^ static_cast<std::uint8_t>(c));
  }
  std::size_t begin = body.find(',');
  const std::string address = body.substr(0, begin);
  const std::size_t talker = address.starts_with('P') ? 1 : 2;
  sentence.talker = address.substr(0, talker);
  sentence.type = address.size() > talker ? address.substr(talker) : "";
  while (begin != std::string::npos) {
    const std::size_t end = body.find(',', begin + 1);
    sentence.fields.push_back(
        body.substr(begin + 1, end == std::string::npos ? end : end - begin - 1));
    begin = end;
  }
  sentence.text = line;
  return sentence;
}

}  // namespace

std::optional<std::size_t> time_field(std::string_view type) {
  for (const TimeField& each : kTimes) {
    if (each.type == type) {
      return each.index;
    }
  }
  return std::nullopt;
}

const std::string& NmeaSentence::field(std::size_t index) const {
  return index < fields.size() ? fields[index] : kNothing;
}

std::optional<double> NmeaSentence::number(std::size_t index) const {
  const std::string& written = field(index);
  double value = 0.0;
  const char* const end = written.data() + written.size();
  const auto [after, error] = std::from_chars(written.data(), end, value);
  return error == std::errc() && after == end ? std::optional(value) : std::nullopt;
}

const NmeaSentence* NmeaEpoch::find(std::string_view type) const {
  for (const NmeaSentence* each : sentences) {
    if (each->type == type) {
      return each;
    }
  }
  return nullptr;
}

void NmeaLog::add(std::chrono::nanoseconds at, std::span<const std::uint8_t> bytes) {
  span_ = at;
  splitter_.take(
      bytes, [&](std::span<const std::uint8_t> piece,
                 const gnss_stream::Splitter::Content& content) { add_piece(at, piece, content); });
}

void NmeaLog::add_piece(std::chrono::nanoseconds at, std::span<const std::uint8_t> bytes,
                        const gnss_stream::Splitter::Content& content) {
  constexpr std::size_t kLongest = 1024;
  constexpr std::size_t kAddress = 6;  // with the sign in front
  if (std::holds_alternative<protocols::ubx::FrameView>(content) ||
      std::holds_alternative<protocols::rtcm3::FrameView>(content)) {
    return;  // a message of another protocol on the same line
  }
  for (const std::uint8_t byte : bytes) {
    const char c = static_cast<char>(byte);
    if (!in_line_) {
      in_line_ = c == '$' || c == '!';
      line_ = in_line_ ? std::string(1, c) : std::string();
      continue;
    }
    // No address has such letters: bytes of another protocol.
    if (line_.size() < kAddress && c != ',' && std::isalnum(byte) == 0) {
      in_line_ = c == '$' || c == '!';
      line_ = in_line_ ? std::string(1, c) : std::string();
      continue;
    }
    if (c != '\n') {
      line_ += c;
      in_line_ = line_.size() < kLongest;
      continue;
    }
    in_line_ = false;
    const bool carriage_return = line_.ends_with('\r');
    if (carriage_return) {
      line_.pop_back();
    }
    sentences_.push_back(take_apart(at, line_, carriage_return));
  }
}

void NmeaLog::close() {
  splitter_.flush(
      [&](std::span<const std::uint8_t> piece, const gnss_stream::Splitter::Content& content) {
        add_piece(span_, piece, content);
      });
  std::vector<NmeaEpoch> all;
  for (const NmeaSentence& sentence : sentences_) {
    const auto field = time_field(sentence.type);
    const std::string time = field ? sentence.field(*field) : "";
    if (!time.empty() && (all.empty() || all.back().time != time)) {
      all.push_back({time, {}});
    }
    if (!all.empty()) {
      all.back().sentences.push_back(&sentence);
    }
  }
  if (all.size() > 2) {
    epochs_.assign(all.begin() + 1, all.end() - 1);
  }
}

}  // namespace rigwire::conform

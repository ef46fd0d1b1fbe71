#include "protocols/velodyne/status_channel.h"

#include <algorithm>
#include <string_view>

namespace rigwire::protocols::velodyne {
namespace {

constexpr std::string_view kStart = "UNIT#";

/// The live values in their order.
struct LiveField {
  char type;
  std::uint8_t StatusLive::*value;  ///< Null: the GPS state.
};
constexpr std::array<LiveField, kStatusLiveValues> kLiveFields{{
    {'H', &StatusLive::hour},
    {'M', &StatusLive::minute},
    {'S', &StatusLive::second},
    {'D', &StatusLive::day},
    {'N', &StatusLive::month},
    {'Y', &StatusLive::year},
    {'G', nullptr},
    {'T', &StatusLive::temperature_c},
    {'V', &StatusLive::version},
}};

/// Types of the record's bytes: the place in the cycle, but for a few.
constexpr std::size_t kCycles = kStatusRecordSize / kStatusPieceSize;
constexpr std::size_t kParameterCycle = kCycles - 3;
constexpr std::array<std::uint8_t, kStatusPieceSize> kParameterTypes{0xFE, 0xFF, 0xFC, 0xFD,
                                                                     0xFA, 0xFB, '7'};
constexpr std::uint8_t kEchoesType = 0xF9;
constexpr std::uint8_t kPowerType = 0xF8;

std::uint8_t piece_type(StatusFormat format, std::size_t cycle, std::size_t place) {
  if (cycle == kParameterCycle) {
    return kParameterTypes[place];
  }
  if (cycle == kCycles - 1 && place == 2) {
    return kEchoesType;
  }
  if (cycle == kCycles - 1 && place == 4) {
    return kPowerType;
  }
  const bool reserved = cycle > 0 && cycle < kCycles - 4 && cycle % 4 == 0;
  if (reserved && place == 0 && format == StatusFormat::s3) {
    return 'W';
  }
  return static_cast<std::uint8_t>('1' + place);
}

bool is_piece_type(std::uint8_t type, std::size_t place) {
  const auto other = static_cast<std::uint8_t>('1' + place);
  return type == other || type == kParameterTypes[place] || (type == 'W' && place == 0) ||
         (type == kEchoesType && place == 2) || (type == kPowerType && place == 4);
}

}  // namespace

StatusChannel::StatusChannel(const StatusRecord& record) : format_(record.format) {
  validate(record.calibration);
  encode(record, bytes_);
}

void StatusChannel::update(const StatusRecord& record) {
  format_ = record.format;
  encode(record, bytes_);
}

StatusByte StatusChannel::at(std::uint64_t packet, const StatusLive& live) const {
  const auto index = static_cast<std::size_t>(packet % kStatusPeriod);
  const std::size_t cycle = index / kStatusCycle;
  const std::size_t place = index % kStatusCycle;
  if (place < kStatusLiveValues) {
    const LiveField& field = kLiveFields[place];
    return {static_cast<std::uint8_t>(field.type),
            field.value == nullptr ? static_cast<std::uint8_t>(live.gps) : live.*field.value};
  }
  const std::size_t piece = place - kStatusLiveValues;
  return {piece_type(format_, cycle, piece), bytes_[cycle * kStatusPieceSize + piece]};
}

bool StatusReader::take_live(const StatusByte& status) {
  const auto* field =
      std::ranges::find(kLiveFields, static_cast<char>(status.type), &LiveField::type);
  if (field == kLiveFields.end()) {
    return false;
  }
  if (field->value == nullptr) {
    live_.gps = static_cast<StatusGps>(status.value);
  } else {
    live_.*field->value = status.value;
  }
  const auto place = static_cast<std::size_t>(field - kLiveFields.begin());
  if (place != live_run_ || (place == 0 && in_cycle_ != kStatusPieceSize)) {
    break_off();
  }
  live_run_ = place + 1;
  in_cycle_ = 0;
  return true;
}

void StatusReader::break_off() {
  rejected_ += size_ > kStart.size() ? 1 : 0;
  size_ = 0;
}

std::optional<StatusRecord> StatusReader::add(const StatusByte& status) {
  if (take_live(status)) {
    return std::nullopt;
  }
  if (live_run_ != kStatusLiveValues && in_cycle_ == 0) {
    break_off();
  }
  live_run_ = 0;
  if (in_cycle_ >= kStatusPieceSize || !is_piece_type(status.type, in_cycle_)) {
    break_off();
    in_cycle_ = std::min(in_cycle_ + 1, kStatusPieceSize);
    return std::nullopt;
  }
  const std::size_t place = in_cycle_++;
  if (size_ < kStart.size()) {
    // A record starts with a cycle.
    const bool fits = size_ == place && status.value == static_cast<std::uint8_t>(kStart[size_]);
    if (!fits) {
      size_ = 0;
      return std::nullopt;
    }
  }
  bytes_[size_++] = status.value;
  if (size_ < kStatusRecordSize) {
    return std::nullopt;
  }
  size_ = 0;
  Decoded<StatusRecord> decoded = decode_status_record(bytes_);
  if (!decoded.ok()) {
    ++rejected_;
    return std::nullopt;
  }
  return decoded.value();
}

}  // namespace rigwire::protocols::velodyne

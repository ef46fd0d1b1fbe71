#include "emulators/ublox/sbas_reception.h"

#include <algorithm>

#include "fields/constants.h"

namespace rigwire::emulators {
namespace {

namespace sbas = protocols::sbas;

/// Epochs lie within so much of the full second.
constexpr std::int64_t kSbasTolerance_ns = 1'000'000;
/// Messages that one epoch brings at most of one satellite: epochs are up to 65 s apart.
constexpr std::int64_t kSbasMostSeconds = 66;
/// Channels after those that GPS may take.
constexpr std::uint8_t kFirstChannel = 32;

}  // namespace

SbasReception::SbasReception() {
  messages_.reserve(static_cast<std::size_t>(kSbasMostSeconds) * 8);
}

void SbasReception::begin() {
  channels_ = {};
  messages_.clear();
  seconds_done_ = -1;
}

// Lists the messages of the whole seconds since the last update, at most kSbasMostSeconds. A
// satellite's first message is the one that begins after it was acquired.
void SbasReception::update(const GnssSample& sample, const GpsTime& now) {
  const std::int64_t now_ns = now.week * kWeek_s * kSecond_ns + now.time_of_week_ns;
  messages_.clear();
  gps_.reset();
  for (std::size_t i = 0; sample.navigation != nullptr && i < gps_.size(); ++i) {
    gps_.set(i, sample.navigation->ephemerides[i].has_value());
  }
  std::bitset<kSatellites> tracked;
  for (const SatelliteView& view : sample.satellites) {
    if (view.system == GnssSystem::sbas && view.tracked && view.number >= kFirstPrn &&
        view.number < kFirstPrn + kSatellites) {
      tracked.set(view.number - std::size_t{kFirstPrn});
    }
  }
  for (std::size_t i = 0; i < kSatellites; ++i) {
    Channel& channel = channels_[i];
    if (tracked[i] && !channel.tracked) {
      channel.first_whole_s = (now_ns - kSbasTolerance_ns + kSecond_ns - 1) / kSecond_ns;
    }
    channel.tracked = tracked[i];
  }
  const std::int64_t seconds = (now_ns + kSbasTolerance_ns) / kSecond_ns;
  const std::int64_t from =
      seconds_done_ < 0 ? seconds : std::max(seconds_done_, seconds - kSbasMostSeconds);
  for (std::int64_t second = from; second < seconds; ++second) {
    for (std::size_t i = 0; i < kSatellites; ++i) {
      if (channels_[i].tracked && second >= channels_[i].first_whole_s) {
        messages_.push_back({static_cast<std::uint8_t>(kFirstPrn + i),
                             static_cast<std::uint8_t>(kFirstChannel + i), message_at(second)});
      }
    }
  }
  seconds_done_ = seconds;
}

sbas::Message SbasReception::message_at(std::int64_t second) const {
  constexpr std::uint8_t kMaskIssue = 1;
  constexpr std::int64_t kMinute_s = 60;
  constexpr std::int64_t kMaskAt_s = 12;
  constexpr std::int64_t kDegradationAt_s = 42;
  constexpr std::int64_t kFastCycle_s = 6;
  constexpr std::int64_t kIssues = 3;
  constexpr std::uint8_t kErrorIndex = 4;
  const auto of_week = static_cast<std::uint32_t>(second % kWeek_s);
  if (second % kMinute_s == kMaskAt_s) {
    return sbas::mask_message(of_week, gps_, kMaskIssue);
  }
  if (second % kMinute_s == kDegradationAt_s) {
    return sbas::degradation_message(of_week, kMaskIssue);
  }
  const auto block = static_cast<std::uint8_t>(second % 3);
  const std::size_t begun = block * sbas::kFastCorrections;
  if (block == 2 || begun >= gps_.count()) {
    return sbas::null_message(of_week);
  }
  std::array<sbas::FastCorrection, sbas::kFastCorrections> corrections{};
  const std::size_t count = std::min(gps_.count() - begun, corrections.size());
  const auto monitored = std::span(corrections).first(count);
  std::ranges::fill(monitored, sbas::FastCorrection{0, kErrorIndex});
  const auto issue = static_cast<std::uint8_t>(second / kFastCycle_s % kIssues);
  return sbas::fast_corrections(of_week, block, monitored, issue, kMaskIssue);
}

}  // namespace rigwire::emulators

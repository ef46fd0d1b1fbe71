#include "emulators/ublox/subframe_reception.h"

#include <algorithm>

#include "emulators/gps_broadcast.h"
#include "fields/constants.h"

namespace rigwire::emulators {
namespace {

namespace gps = protocols::gps;

constexpr std::int64_t kWeek_ns = gps::kWeekSeconds * kSecond_ns;
constexpr std::int64_t kStep_ns = gps::kStepSeconds * kSecond_ns;
/// Epochs lie within so much of the full second.
constexpr std::int64_t kTolerance_ns = 1'000'000;
/// Subframes that one epoch brings at most of one satellite: epochs are up to 60 s apart.
constexpr std::int64_t kMostSteps = 11;

constexpr std::uint8_t kAllThree = 0b111;

}  // namespace

SubframeReception::SubframeReception() {
  subframes_.reserve(static_cast<std::size_t>(kMostSteps) * gps::kSatellites);
}

void SubframeReception::begin(bool ephemerides_remembered, bool almanac_remembered) {
  channels_ = {};
  subframes_.clear();
  steps_done_ = -1;
  const bool never_heard = navigation_ == nullptr;
  recall_ephemerides_ = never_heard && ephemerides_remembered;
  recall_almanac_ = never_heard && almanac_remembered;
  if (!ephemerides_remembered) {
    ephemerides_ = {};
  }
  if (!almanac_remembered) {
    almanacs_ = {};
    ionosphere_utc_.reset();
    health_.reset();
  }
}

void SubframeReception::update(const GnssSample& sample, const GpsTime& now) {
  const std::int64_t now_ns = now.week * kWeek_ns + now.time_of_week_ns;
  subframes_.clear();
  new_ephemerides_.reset();
  new_almanacs_.reset();
  take_navigation(sample, now_ns);
  track(sample, now_ns);
  const std::int64_t steps = (now_ns + kTolerance_ns) / kStep_ns;
  if (navigation_ != nullptr && steps_done_ >= 0) {
    for (std::int64_t step = std::max(steps_done_, steps - kMostSteps); step < steps; ++step) {
      for (std::size_t prn = 1; prn <= gps::kSatellites; ++prn) {
        receive(prn, step);
      }
    }
  }
  steps_done_ = steps;
  last_ns_ = now_ns;
}

// Takes the sample's broadcast data. An unchanged pointer means that nothing changed.
void SubframeReception::take_navigation(const GnssSample& sample, std::int64_t now_ns) {
  if (sample.navigation == navigation_) {
    return;
  }
  const bool first = navigation_ == nullptr;
  navigation_ = sample.navigation;
  if (navigation_ == nullptr) {
    return;
  }
  before_ = now_;
  before_until_ns_ = first ? -1 : std::min(last_ns_, now_ns);
  now_ = to_message(*navigation_);
  recall();
}

void SubframeReception::recall() {
  if (recall_ephemerides_) {
    for (std::size_t i = 0; i < gps::kSatellites; ++i) {
      if (!ephemerides_[i]) {
        ephemerides_[i] = now_.ephemerides[i];
      }
    }
  }
  if (recall_almanac_ && !health_) {
    almanacs_ = now_.almanacs;
    ionosphere_utc_ = now_.ionosphere_utc;
    health_ = now_.health;
  }
  recall_ephemerides_ = false;
  recall_almanac_ = false;
}

void SubframeReception::track(const GnssSample& sample, std::int64_t now_ns) {
  std::bitset<gps::kSatellites> tracked;
  for (const SatelliteView& view : sample.satellites) {
    if (view.system == GnssSystem::gps && view.tracked && view.number >= 1 &&
        view.number <= gps::kSatellites) {
      tracked.set(view.number - 1U);
    }
  }
  for (std::size_t i = 0; i < gps::kSatellites; ++i) {
    if (!tracked[i]) {
      channels_[i] = {};
    }
  }
  for (std::size_t i = 0; i < gps::kSatellites; ++i) {
    Channel& channel = channels_[i];
    if (tracked[i] && !channel.tracked) {
      channel.number = free_channel();
      channel.tracked = true;
      channel.first_whole_step = (now_ns - kTolerance_ns + kStep_ns - 1) / kStep_ns;
    }
  }
}

std::uint8_t SubframeReception::free_channel() const {
  std::uint8_t number = 0;
  while (std::ranges::any_of(channels_, [number](const Channel& channel) {
    return channel.tracked && channel.number == number;
  })) {
    ++number;
  }
  return number;
}

void SubframeReception::receive(std::size_t prn, std::int64_t step) {
  const Channel& channel = channels_[prn - 1];
  if (!channel.tracked || step < channel.first_whole_step) {
    return;
  }
  const gps::Step begun{static_cast<std::int32_t>(step / gps::kStepsPerWeek),
                        static_cast<std::uint32_t>(step % gps::kStepsPerWeek)};
  const gps::Broadcast& broadcast = step * kStep_ns <= before_until_ns_ ? before_ : now_;
  const auto number = static_cast<std::uint8_t>(prn);
  subframes_.push_back({number, channel.number, begun, gps::subframe_at(broadcast, number, begun)});
  hear(prn, gps::scheduled(begun.step), broadcast);
}

void SubframeReception::hear(std::size_t prn, const gps::ScheduledSubframe& place,
                             const gps::Broadcast& broadcast) {
  if (place.subframe_id > 3) {
    hear_page(place, broadcast);
    return;
  }
  const auto& sent = broadcast.ephemerides[prn - 1];
  Channel& channel = channels_[prn - 1];
  if (!sent) {
    channel.subframes_heard = 0;
    return;
  }
  if (channel.issue != sent->issue_of_clock) {
    channel.subframes_heard = 0;
    channel.issue = sent->issue_of_clock;
  }
  channel.subframes_heard |= static_cast<std::uint8_t>(1U << (place.subframe_id - 1U));
  auto& known = ephemerides_[prn - 1];
  if (channel.subframes_heard == kAllThree && known != sent) {
    known = sent;
    new_ephemerides_.set(prn - 1);
  }
}

void SubframeReception::hear_page(const gps::ScheduledSubframe& place,
                                  const gps::Broadcast& broadcast) {
  const std::uint8_t id = gps::page_id_of(place.subframe_id, place.page);
  if (id == gps::kPageIonosphereUtc) {
    ionosphere_utc_ = broadcast.ionosphere_utc;
  } else if (id == gps::kPageHealthOfFirst || id == gps::kPageHealthOfLast) {
    health_ = broadcast.health;
  } else if (id >= 1 && id <= gps::kSatellites) {
    auto& known = almanacs_[id - 1U];
    if (known != broadcast.almanacs[id - 1U]) {
      known = broadcast.almanacs[id - 1U];
      new_almanacs_.set(id - 1U);
    }
  }
}

}  // namespace rigwire::emulators

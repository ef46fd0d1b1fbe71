#include "emulators/ublox/page_reception.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "emulators/gps_broadcast.h"
#include "fields/constants.h"
#include "protocols/beidou/subframe.h"
#include "protocols/galileo/page.h"
#include "protocols/glonass/string.h"
#include "protocols/gps/cnav.h"
#include "sim/samples/gnss_carriers.h"

namespace rigwire::emulators {
namespace {

namespace beidou = protocols::beidou;
namespace galileo = protocols::galileo;
namespace glonass = protocols::glonass;
namespace gps = protocols::gps;

constexpr std::int64_t kMoscow_s = 3 * 3'600;
/// Epochs lie within so much of the full second.
constexpr std::int64_t kTolerance_ns = 1'000'000;
/// Seconds that one epoch looks back at most: epochs are up to 65 s apart.
constexpr std::int64_t kMostSeconds = 66;

/// Numbers of a system's satellites, and whether the data of both carriers are of this file.
struct Numbers {
  GnssSystem system;
  std::uint8_t greatest;
  bool both;
};
constexpr std::array<Numbers, 4> kNumbers{{{GnssSystem::gps, gps::kSatellites, false},
                                           {GnssSystem::galileo, 36, true},
                                           {GnssSystem::beidou, 63, true},
                                           {GnssSystem::glonass, 24, true}}};

/// How the data of a carrier are divided: parts of so many seconds, the first of which begins so
/// many after the week of GPS does (GLONASS: by leap seconds later).
struct Division {
  std::int64_t part_s;
  std::int64_t begins_s;
};

Division division_of(GnssSystem system, bool second, std::int32_t leap_seconds) {
  switch (system) {
    case GnssSystem::gps:
      return {gps::kCnavSeconds, 0};
    case GnssSystem::galileo:
      return {galileo::kPageSeconds, second ? galileo::kE5bBegins_s : galileo::kE1Begins_s};
    case GnssSystem::beidou:
      return {beidou::kSubframeSeconds, beidou::kBehindGps_s % beidou::kSubframeSeconds};
    default:
      return {glonass::kStringSeconds, leap_seconds % glonass::kStringSeconds};
  }
}

template <class Set>
const Set* set_of(const std::vector<Set>& sets, std::uint8_t number, std::uint8_t Set::*member) {
  const auto found = std::ranges::find(sets, number, member);
  return found == sets.end() ? nullptr : &*found;
}

// What begins at `begun_s`, seconds of GPS time.

std::optional<ReceivedPage> gps_page(const GpsNavigation& navigation, std::uint8_t number,
                                     std::int64_t begun_s) {
  if (!navigation.ephemerides[number - 1U]) {
    return std::nullopt;
  }
  const gps::CnavTime time{static_cast<std::int32_t>(begun_s / kWeek_s),
                           static_cast<std::uint32_t>(begun_s % kWeek_s)};
  const std::uint8_t type = gps::cnav_type_at(time.second);
  constexpr std::uint8_t kOfAlmanacs = 31;
  gps::Broadcast broadcast;
  if (type == kOfAlmanacs) {
    broadcast = to_message(navigation);
  } else {
    broadcast.ephemerides[number - 1U] = to_message(*navigation.ephemerides[number - 1U]);
    broadcast.ionosphere_utc = to_message(navigation.ionosphere, navigation.utc);
  }
  const gps::CnavMessage message = gps::cnav_message(type, broadcast, number, time);
  ReceivedPage received{.count = message.size()};
  std::ranges::copy(message, received.words.begin());
  return received;
}

std::optional<ReceivedPage> galileo_page(const GpsNavigation& navigation, std::uint8_t number,
                                         bool second, std::int64_t begun_s) {
  const GpsEphemeris* const sent = set_of(navigation.galileo, number, &GpsEphemeris::prn);
  if (sent == nullptr) {
    return std::nullopt;
  }
  const std::int64_t of_frame_s =
      (begun_s - (second ? galileo::kE5bBegins_s : galileo::kE1Begins_s)) % galileo::kFrameSeconds;
  const auto since_frame_s = static_cast<std::uint32_t>(of_frame_s);
  const std::uint8_t type =
      second ? galileo::type_on_e5b(since_frame_s) : galileo::type_on_e1(since_frame_s);
  const galileo::PageTime time{static_cast<std::int32_t>(begun_s / kWeek_s),
                               static_cast<std::uint32_t>(begun_s % kWeek_s)};
  const galileo::Page page = galileo::page_of(galileo::word(
      type, to_message(*sent), to_message(navigation.ionosphere, navigation.utc), time));
  ReceivedPage received{.count = page.size() + 1};
  std::ranges::copy(page, received.words.begin());
  return received;
}

std::optional<ReceivedPage> beidou_page(const GpsNavigation& navigation, std::uint8_t number,
                                        std::int64_t begun_s) {
  const GpsEphemeris* const sent = set_of(navigation.beidou, number, &GpsEphemeris::prn);
  const std::int64_t own_s = begun_s - beidou::kBehindGps_s;
  const auto of_week_s = static_cast<std::uint32_t>(own_s % kWeek_s);
  const std::uint8_t id = beidou::id_at(of_week_s);
  if (sent == nullptr || id > 3) {
    return std::nullopt;
  }
  const beidou::Subframe subframe =
      beidou::subframe(id, to_message(*sent), to_message(navigation.ionosphere, navigation.utc),
                       {static_cast<std::int32_t>(own_s / kWeek_s), of_week_s});
  ReceivedPage received{.count = subframe.size()};
  std::ranges::copy(subframe, received.words.begin());
  return received;
}

std::optional<ReceivedPage> glonass_page(const GpsNavigation& navigation, std::uint8_t number,
                                         std::int64_t begun_s, std::int32_t leap_seconds) {
  const GlonassEphemeris* const sent = set_of(navigation.glonass, number, &GlonassEphemeris::slot);
  const std::int64_t own_s = begun_s - leap_seconds + kMoscow_s;
  const std::int64_t of_frame_s = own_s % glonass::kFrameSeconds;
  const auto string_number = static_cast<std::uint8_t>(of_frame_s / glonass::kStringSeconds + 1);
  constexpr std::uint8_t kLastWithoutAlmanac = 5;
  if (sent == nullptr || string_number > kLastWithoutAlmanac) {
    return std::nullopt;
  }
  const std::int64_t frame_s = own_s - of_frame_s;
  // Days since the one that the set's middle is in: a frame of the evening may refer to tomorrow.
  const auto of_day_s = static_cast<std::uint32_t>(frame_s % kDay_s);
  constexpr std::int64_t kHalfDay_s = kDay_s / 2;
  const bool tomorrow = of_day_s - std::int64_t{sent->time_of_day_s} > kHalfDay_s;
  const bool yesterday = sent->time_of_day_s - std::int64_t{of_day_s} > kHalfDay_s;
  const std::int32_t day = sent->day - (tomorrow ? 1 : 0) + (yesterday ? 1 : 0);
  glonass::Ephemeris e{.slot = sent->slot,
                       .time_of_day_s = sent->time_of_day_s,
                       .position_m = sent->position_m,
                       .velocity_mps = sent->velocity_mps,
                       .acceleration_mps2 = sent->acceleration_mps2,
                       .clock_correction_s = sent->clock_correction_s};
  const glonass::String string =
      glonass::string(string_number, e,
                      {of_day_s, static_cast<std::uint16_t>(std::max(day, 1)),
                       static_cast<std::uint8_t>(std::max(sent->four_years, 1))});
  const std::int64_t frame = frame_s / glonass::kFrameSeconds;
  const auto superframe = static_cast<std::uint32_t>(frame / glonass::kFramesOfSuperframe);
  const auto of_superframe = static_cast<std::uint32_t>(frame % glonass::kFramesOfSuperframe) + 1U;
  ReceivedPage received{.count = string.size() + 1};
  std::ranges::copy(string, received.words.begin());
  received.words[string.size()] = superframe << 16U | of_superframe;
  return received;
}

}  // namespace

PageReception::PageReception() {
  for (const Numbers& of : kNumbers) {
    for (int number = 1; number <= of.greatest; ++number) {
      for (const bool second : {false, true}) {
        if (second || of.both) {
          channels_.push_back({of.system, static_cast<std::uint8_t>(number), second});
        }
      }
    }
  }
  constexpr std::size_t kTracked = 64;
  pages_.reserve(kTracked * kMostSeconds / glonass::kStringSeconds);
}

void PageReception::begin() {
  for (Channel& channel : channels_) {
    channel.tracked = false;
  }
  pages_.clear();
  seconds_done_ = -1;
}

void PageReception::track(const GnssSample& sample, std::int64_t now_ns) {
  auto measured = sample.measurements.begin();
  // Both are by system, number and carrier.
  for (Channel& channel : channels_) {
    const auto before = [&](const GnssMeasurement& m) {
      return std::tuple(m.system, m.number, m.second) <
             std::tuple(channel.system, channel.number, channel.second);
    };
    while (measured != sample.measurements.end() && before(*measured)) {
      ++measured;
    }
    const bool tracked = measured != sample.measurements.end() &&
                         measured->system == channel.system && measured->number == channel.number &&
                         measured->second == channel.second;
    if (tracked && (!channel.tracked || measured->slipped)) {
      channel.whole_from_s = (now_ns - kTolerance_ns + kSecond_ns - 1) / kSecond_ns;
    }
    channel.tracked = tracked;
  }
}

void PageReception::update(const GnssSample& sample, const GpsTime& now,
                           std::int32_t leap_seconds) {
  const std::int64_t now_ns = now.week * kWeek_s * kSecond_ns + now.time_of_week_ns;
  const std::int64_t seconds = (now_ns + kTolerance_ns) / kSecond_ns;
  pages_.clear();
  track(sample, now_ns);
  if (sample.navigation != now_) {
    before_ = now_ != nullptr ? now_ : sample.navigation;
    before_until_s_ = seconds_done_;
    now_ = sample.navigation;
  }
  const std::int64_t from =
      seconds_done_ < 0 ? seconds : std::max(seconds_done_, seconds - kMostSeconds);
  for (std::int64_t second = from; now_ != nullptr && second < seconds; ++second) {
    for (const Channel& channel : channels_) {
      if (channel.tracked) {
        hear(channel, second + 1, leap_seconds);
      }
    }
  }
  seconds_done_ = seconds;
}

/// What ends at `second`.
void PageReception::hear(const Channel& channel, std::int64_t second, std::int32_t leap_seconds) {
  const Division division = division_of(channel.system, channel.second, leap_seconds);
  const std::int64_t begun_s = second - division.part_s;
  if ((begun_s - division.begins_s) % division.part_s != 0 || begun_s < channel.whole_from_s) {
    return;
  }
  const GpsNavigation* const navigation =
      (begun_s <= before_until_s_ && before_ != nullptr ? before_ : now_).get();
  if (navigation == nullptr) {
    return;
  }
  std::optional<ReceivedPage> page;
  switch (channel.system) {
    case GnssSystem::gps:
      page = gps_page(*navigation, channel.number, begun_s);
      break;
    case GnssSystem::galileo:
      page = galileo_page(*navigation, channel.number, channel.second, begun_s);
      break;
    case GnssSystem::beidou:
      page = beidou_page(*navigation, channel.number, begun_s);
      break;
    default:
      page = glonass_page(*navigation, channel.number, begun_s, leap_seconds);
      break;
  }
  if (page) {
    page->system = channel.system;
    page->number = channel.number;
    page->second = channel.second;
    pages_.push_back(*page);
  }
}

}  // namespace rigwire::emulators

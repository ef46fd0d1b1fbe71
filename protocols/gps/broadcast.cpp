#include "protocols/gps/broadcast.h"

#include <cassert>
#include <cmath>

namespace rigwire::protocols::gps {
namespace {

constexpr std::uint32_t kSubframes = 5;
constexpr std::uint32_t kPages = 25;
constexpr std::uint8_t kDoNotUse = 0x3F;
constexpr std::uint8_t kBlockTwoAntiSpoof = 0b1001;

void put_page(SubframeData& data, const Broadcast& broadcast, const ScheduledSubframe& place) {
  const std::uint8_t id = page_id_of(place.subframe_id, place.page);
  if (id == kPageIonosphereUtc) {
    put_ionosphere_utc(data, broadcast.ionosphere_utc);
  } else if (id == kPageHealthOfFirst) {
    put_health_of_first(data, broadcast.health);
  } else if (id == kPageHealthOfLast) {
    put_health_of_last(data, broadcast.health);
  } else if (id >= 1 && id <= kSatellites) {
    const auto& almanac = broadcast.almanacs[id - 1U];
    if (almanac) {
      put_almanac(data, *almanac);
    } else {
      put_filler(data, kPageDummy);
    }
  } else {
    put_filler(data, id);
  }
}

}  // namespace

ScheduledSubframe scheduled(std::uint32_t step) {
  return {static_cast<std::uint8_t>(step % kSubframes + 1U),
          static_cast<std::uint8_t>(step / kSubframes % kPages + 1U)};
}

// Chooses one almanac time for all satellites, then reduces each ephemeris to an almanac at that
// time (reduced()) and copies its health.
void derive_almanac(Broadcast& broadcast) {
  constexpr double kDay_s = 86'400.0;
  constexpr double kAlmanacStep_s = 4096.0;
  const Ephemeris* earliest = nullptr;
  const auto before = [](const Ephemeris& a, const Ephemeris& b) {
    return a.week < b.week || (a.week == b.week && a.ephemeris_time_s < b.ephemeris_time_s);
  };
  for (const auto& ephemeris : broadcast.ephemerides) {
    if (ephemeris && (earliest == nullptr || before(*ephemeris, *earliest))) {
      earliest = &*ephemeris;
    }
  }
  broadcast.almanacs.fill(std::nullopt);
  broadcast.health = {};
  broadcast.health.health.fill(kDoNotUse);
  if (earliest == nullptr) {
    return;
  }
  const double noon_s = (std::floor(earliest->ephemeris_time_s / kDay_s) + 0.5) * kDay_s;
  broadcast.health.week = earliest->week;
  broadcast.health.almanac_time_s = std::round(noon_s / kAlmanacStep_s) * kAlmanacStep_s;
  for (std::size_t i = 0; i < kSatellites; ++i) {
    const auto& ephemeris = broadcast.ephemerides[i];
    if (ephemeris) {
      broadcast.almanacs[i] =
          reduced(*ephemeris, broadcast.health.week, broadcast.health.almanac_time_s);
      broadcast.health.health[i] = ephemeris->health;
      broadcast.health.configuration[i] = kBlockTwoAntiSpoof;
    }
  }
}

Subframe subframe_at(const Broadcast& broadcast, std::uint8_t prn, const Step& time) {
  assert(prn >= 1 && prn <= kSatellites && time.step < kStepsPerWeek);
  const ScheduledSubframe place = scheduled(time.step);
  SubframeData data;
  set_head(data, {.next_step = (time.step + 1U) % kStepsPerWeek, .subframe_id = place.subframe_id});
  if (place.subframe_id > 3) {
    put_page(data, broadcast, place);
  } else if (const auto& ephemeris = broadcast.ephemerides[prn - 1U]; ephemeris) {
    put_ephemeris(data, place.subframe_id, *ephemeris, time.week);
  } else {
    put_filler(data, kPageDummy);
  }
  return encode_subframe(data);
}

}  // namespace rigwire::protocols::gps

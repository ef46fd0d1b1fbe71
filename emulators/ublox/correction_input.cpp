#include "emulators/ublox/correction_input.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "emulators/ublox/correction_signals.h"
#include "fields/constants.h"

namespace rigwire::emulators {
namespace {

namespace rtcm3 = protocols::rtcm3;

constexpr std::int64_t kDay_ms = 86'400'000;
constexpr std::int64_t kWeek_ms = 7 * kDay_ms;
/// The corrections of a station whose clock is ahead of the receiver's by more are rejected.
constexpr Duration kAhead = std::chrono::milliseconds{100};
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The instant nearest to `now` whose time of week is that, within a cycle of so many milliseconds.
SimTime nearest(const Calendar& calendar, SimTime now, std::int64_t time_ms,
                std::int64_t cycle_ms) {
  const std::int64_t now_ns = calendar.gps(now).time_of_week_ns;
  const std::int64_t cycle_ns = cycle_ms * kMillisecond_ns;
  std::int64_t behind_ns = (now_ns - time_ms * kMillisecond_ns) % cycle_ns;
  behind_ns += behind_ns < -cycle_ns / 2 ? cycle_ns : behind_ns > cycle_ns / 2 ? -cycle_ns : 0;
  return now - Duration{behind_ns};
}

/// What `of` makes of the leap seconds of now, or, if that lies ahead, of those before: it was
/// measured within a leap second that is over.
template <class Of>
std::optional<SimTime> by_leap_seconds(const Calendar& calendar, SimTime now, Of of) {
  const std::optional<SimTime> measured = of(calendar.leap_seconds(now));
  return measured && *measured > now + kAhead
             ? of(calendar.leap_seconds(now - std::chrono::seconds{1}))
             : measured;
}

std::uint16_t station_of(const rtcm3::Message& message) {
  return std::visit([](const auto& m) { return m.station; }, message);
}

const UbloxCorrectionSignal* signal_of(rtcm3::MsmSystem system, std::uint8_t number) {
  const auto* const found =
      std::ranges::find_if(kCorrectionSignals, [&](const UbloxCorrectionSignal& s) {
        return s.message == system && s.lowest <= number && number <= s.highest;
      });
  return found == kCorrectionSignals.end() ? nullptr : found;
}

void add(GnssCorrections& epoch, const UbloxCorrectionSignal& signal, std::uint8_t number,
         std::optional<int> channel, const rtcm3::SignalObservation& o, double modulus_m = 0.0) {
  // The first code on a carrier counts.
  const bool there = std::ranges::any_of(epoch.signals, [&](const GnssCorrections::Signal& s) {
    return s.system == signal.system && s.number == number && s.second == signal.second;
  });
  if (!there && (o.range_m || o.phase_m)) {
    epoch.signals.push_back({signal.system, number, signal.second, o.range_m.value_or(kNone),
                             o.phase_m.value_or(kNone), wavelength_m(signal, channel).value_or(0.0),
                             modulus_m});
  }
}

}  // namespace

void UbloxCorrectionInput::forget() {
  place_.reset();
  moving_.reset();
  open_.reset();
  newest_.reset();
  base_.reset();
}

bool UbloxCorrectionInput::take(SimTime now, const rtcm3::FrameView& frame,
                                const UbloxCorrectionRules& rules) {
  const auto message = rtcm3::decode_message(frame.payload);
  if (!message.ok()) {
    return false;
  }
  using Filter = UbloxCorrectionRules::Filter;
  if (rules.filter != Filter::off && station_of(*message) != rules.station) {
    return false;
  }
  rules_ = rules;
  if (const auto* place = std::get_if<rtcm3::AntennaPosition>(&*message)) {
    return take(*place);
  }
  if (const auto* moving = std::get_if<rtcm3::MovingBase>(&*message)) {
    return take(*moving, now);
  }
  if (const auto* signals = std::get_if<rtcm3::MultipleSignals>(&*message)) {
    return take(*signals, now);
  }
  if (const auto* observations = std::get_if<rtcm3::LegacyObservations>(&*message)) {
    return take(*observations, now);
  }
  return true;
}

bool UbloxCorrectionInput::take(const rtcm3::AntennaPosition& m) {
  place_ = m;
  // The reference point is the antenna's foot; measurements are of its top.
  if (m.antenna_height_m) {
    auto& p = place_->position_m;
    const double radius_m = std::hypot(p[0], p[1], p[2]);
    for (double& axis : p) {
      axis += radius_m > 0.0 ? axis / radius_m * *m.antenna_height_m : 0.0;
    }
  }
  moving_.reset();
  return true;
}

bool UbloxCorrectionInput::take(const rtcm3::MovingBase& m, SimTime now) {
  if (m.time_of_week_ms >= kWeek_ms) {
    return false;
  }
  moving_ = UbloxBase{m.station, nearest(calendar_, now, m.time_of_week_ms, kWeek_ms), m.position_m,
                      m.velocity_mps, true};
  return true;
}

GnssCorrections* UbloxCorrectionInput::epoch_of(std::uint16_t station,
                                                std::optional<SimTime> measured) {
  if (open_ && (!measured || *measured != open_->measured || station != open_station_)) {
    close();  // its last message was lost
  }
  if (!measured) {
    return nullptr;
  }
  const bool moves = moving_ && moving_->station == station && moving_->measured == *measured;
  if (!moves && (!place_ || place_->station != station)) {
    return nullptr;
  }
  if (!open_) {
    open_.emplace();
    open_->measured = *measured;
    open_->moving = moves;
    const auto& p = moves ? moving_->position_E_m : place_->position_m;
    open_->station_E_m = {p[0], p[1], p[2]};
    open_station_ = station;
  }
  return &*open_;
}

void UbloxCorrectionInput::close() {
  open_->largest_age = rules_.largest_age;
  open_->floating_only = rules_.floating_only;
  base_ = UbloxBase{open_station_,
                    open_->measured,
                    {open_->station_E_m.x, open_->station_E_m.y, open_->station_E_m.z},
                    {},
                    open_->moving};
  if (open_->moving && moving_ && moving_->measured == open_->measured) {
    base_->velocity_E_mps = moving_->velocity_E_mps;
  }
  // An older one that comes late says nothing new.
  if (newest_ == nullptr || newest_->measured < open_->measured) {
    newest_ = std::make_shared<const GnssCorrections>(std::move(*open_));
  }
  open_.reset();
}

bool UbloxCorrectionInput::take(const rtcm3::MultipleSignals& m, SimTime now) {
  const auto measured = by_leap_seconds(calendar_, now, [&](int leap_seconds) {
    const auto time_ms = rtcm3::gps_time_of_week_ms(m.system, m.epoch, leap_seconds);
    return time_ms ? std::optional(nearest(calendar_, now, *time_ms, kWeek_ms)) : std::nullopt;
  });
  if (measured && *measured > now + kAhead) {
    return false;
  }
  GnssCorrections* const epoch = epoch_of(m.station, measured);
  if (epoch == nullptr) {
    return false;
  }
  for (const auto& cell : std::span(m.cells).first(m.count)) {
    if (const UbloxCorrectionSignal* const signal = signal_of(m.system, cell.signal)) {
      const auto channel = m.channels[cell.satellite - 1U];
      add(*epoch, *signal, cell.satellite, channel ? std::optional<int>(*channel) : std::nullopt,
          cell.observation);
    }
  }
  if (!m.more) {
    close();
  }
  return true;
}

bool UbloxCorrectionInput::take(const rtcm3::LegacyObservations& m, SimTime now) {
  constexpr std::int64_t kMoscow_ms = 3 * 3'600'000;
  const SimTime measured = *by_leap_seconds(calendar_, now, [&](int leap_seconds) {
    const std::int64_t time_ms =
        m.glonass ? std::int64_t{m.time_ms} - kMoscow_ms + std::int64_t{leap_seconds} * 1000
                  : std::int64_t{m.time_ms};
    return std::optional(nearest(calendar_, now, time_ms, m.glonass ? kDay_ms : kWeek_ms));
  });
  GnssCorrections* const epoch = measured > now + kAhead ? nullptr : epoch_of(m.station, measured);
  if (epoch == nullptr) {
    return false;
  }
  const auto system = m.glonass ? rtcm3::MsmSystem::glonass : rtcm3::MsmSystem::gps;
  constexpr std::uint8_t kFirst = 2;
  constexpr std::uint8_t kSecond = 8;
  constexpr std::uint8_t kGreatestGps = 32;  // higher numbers are SBAS satellites
  for (const auto& s : std::span(m.satellites).first(m.count)) {
    if (!m.glonass && s.number > kGreatestGps) {
      continue;
    }
    const std::optional<int> channel = s.channel;  // of GLONASS; the others have none
    const double modulus_m = m.extended ? 0.0 : rtcm3::legacy_modulus_m(m.glonass);
    add(*epoch, *signal_of(system, kFirst), s.number, channel, s.first, modulus_m);
    add(*epoch, *signal_of(system, kSecond), s.number, channel, s.second, modulus_m);
  }
  if (!m.more) {
    close();
  }
  return true;
}

}  // namespace rigwire::emulators

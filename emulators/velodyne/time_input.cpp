#include "emulators/velodyne/time_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using velodyne::PulseState;

constexpr Duration kSecond = std::chrono::seconds{1};
/// Without a pulse for so long the input is absent.
constexpr Duration kPulseMissing = std::chrono::milliseconds{1500};
constexpr Duration kSentencesMissing = std::chrono::milliseconds{2500};
/// 72 characters of 10 bits at 9600 baud.
constexpr Duration kTransmission = std::chrono::milliseconds{75};
/// A receiver that has not measured for so long, or for two and a half of its own periods, is
/// silent.
constexpr Duration kReceiverSilent = std::chrono::seconds{2};

bool is_finite(const GnssSample& sample) {
  return std::isfinite(sample.latitude_deg) && std::isfinite(sample.longitude_deg) &&
         std::isfinite(sample.velocity_ned_mps.x) && std::isfinite(sample.velocity_ned_mps.y);
}

}  // namespace

TimeInput::TimeInput(const VelodyneSettings& settings, const VelodyneFaults& faults,
                     const Calendar& calendar)
    : settings_(settings),
      faults_(faults),
      calendar_(calendar),
      sentence_complete_after_(settings.pulse_length + settings.sentence_delay + kTransmission) {}

void TimeInput::power_up(SimTime now, SensorClock& clock) {
  state_ = PulseState::absent;
  said_.reset();
  timed_pulse_ = kNever;
  next_sentence_ = kNever;
  next_second_ = calendar_.align_to_gps(now, kSecond);
  if (settings_.time_source != VelodyneTimeSource::ideal) {
    clock.power_up(now);
    return;
  }
  clock.set(now, calendar_.nanoseconds_of_hour(now));
  state_ = PulseState::locked;
  last_pulse_ = next_second_ - kSecond;
  good_since_ = last_pulse_ - settings_.pulse_qualifier_delay;
  const bool on_its_way = last_pulse_ + sentence_complete_after_ > now;
  next_sentence_ = on_its_way ? last_pulse_ + sentence_complete_after_ : kNever;
  write_sentence(on_its_way ? last_pulse_ - kSecond : last_pulse_);
}

void TimeInput::observe(const GnssSample& sample) {
  if (heard_) {
    heard_period_ = std::max(sample.time - *heard_, Duration{0});
  }
  heard_ = sample.time;
  fix_ = {};
  fix_.valid =
      (sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d) && is_finite(sample);
  if (!fix_.valid) {
    return;
  }
  const Vector3& v = sample.velocity_ned_mps;
  fix_.latitude_deg = std::clamp(sample.latitude_deg, -90.0, 90.0);
  fix_.longitude_deg = std::clamp(sample.longitude_deg, -180.0, 180.0);
  fix_.speed_mps = std::hypot(v.x, v.y);
  const double course_deg = std::atan2(v.y, v.x) * 180.0 / std::numbers::pi;
  fix_.course_deg = course_deg < 0.0 ? course_deg + 360.0 : course_deg;
}

SimTime TimeInput::next_event() const {
  return std::min(next_second_, next_sentence_);
}

void TimeInput::handle_event(SensorClock& clock) {
  if (next_sentence_ <= next_second_) {
    const SimTime of_pulse = next_sentence_ - sentence_complete_after_;
    next_sentence_ = kNever;
    write_sentence(of_pulse);
    if (fix_.valid || !settings_.sentence_needs_valid ||
        settings_.time_source == VelodyneTimeSource::ideal) {
      timed_pulse_ = of_pulse;
    }
    return;
  }
  const SimTime second = next_second_;
  next_second_ += kSecond;
  if (sentence_arrives(second)) {
    next_sentence_ = second + sentence_complete_after_;
  }
  if (pulse_arrives(second)) {
    handle_pulse(second, clock);
  }
}

bool TimeInput::receiver_speaks(SimTime now) const {
  return heard_ && now - *heard_ <= std::max(kReceiverSilent, heard_period_ * 5 / 2);
}

bool TimeInput::pulse_arrives(SimTime now) const {
  if (faults_.first<PulseLossFault>(now) != nullptr) {
    return false;
  }
  switch (settings_.time_source) {
    case VelodyneTimeSource::none:
      return false;
    case VelodyneTimeSource::receiver:
      return receiver_speaks(now) && (fix_.valid || settings_.pulse_without_fix);
    case VelodyneTimeSource::pulse_only:
    case VelodyneTimeSource::ideal:
      break;
  }
  return true;
}

bool TimeInput::sentence_arrives(SimTime now) const {
  if (faults_.first<SentenceLossFault>(now) != nullptr) {
    return false;
  }
  return settings_.time_source == VelodyneTimeSource::ideal ||
         (settings_.time_source == VelodyneTimeSource::receiver && receiver_speaks(now));
}

void TimeInput::handle_pulse(SimTime pulse, SensorClock& clock) {
  const PulseState before = state(pulse);
  last_pulse_ = pulse;
  if (faults_.first<PulseNoiseFault>(pulse) != nullptr) {
    state_ = PulseState::error;
    return;
  }
  if (before == PulseState::absent || before == PulseState::error) {
    good_since_ = pulse;
  }
  const bool receiver_good = fix_.valid || !settings_.pulse_needs_valid_receiver ||
                             settings_.time_source == VelodyneTimeSource::ideal;
  const bool locked = receiver_good && pulse - good_since_ >= settings_.pulse_qualifier_delay;
  state_ = locked ? PulseState::locked : PulseState::synchronizing;
  if (!locked) {
    return;
  }
  if (timed_pulse_ == pulse - kSecond) {
    clock.set(pulse, calendar_.nanoseconds_of_hour(pulse));
  } else {
    clock.set_to_whole_second(pulse);
  }
}

PulseState TimeInput::state(SimTime now) const {
  return state_ == PulseState::absent || now - last_pulse_ >= kPulseMissing ? PulseState::absent
                                                                            : state_;
}

std::optional<SimTime> TimeInput::last_pulse(SimTime now) const {
  return state(now) == PulseState::absent ? std::nullopt : std::optional(last_pulse_);
}

bool TimeInput::sentences_arrive(SimTime now) const {
  return said_ && now - sentence_at_ <= kSentencesMissing;
}

std::string_view TimeInput::sentence() {
  if (!said_) {
    return {};
  }
  if (!text_) {
    text_.emplace(*said_);
  }
  return text_->view();
}

void TimeInput::write_sentence(SimTime of_pulse) {
  const UtcTime utc = calendar_.utc(of_pulse);
  sentence_at_ = of_pulse + sentence_complete_after_;
  text_.reset();
  said_ = velodyne::RecommendedMinimum{.year = utc.year,
                                       .month = utc.month,
                                       .day = utc.day,
                                       .hour = utc.hour,
                                       .minute = utc.minute,
                                       .second = utc.second,
                                       .time_form = settings_.sentence_tenths
                                                        ? velodyne::NmeaTimeForm::tenths
                                                        : velodyne::NmeaTimeForm::whole_seconds,
                                       .valid = fix_.valid,
                                       .latitude_deg = fix_.latitude_deg,
                                       .longitude_deg = fix_.longitude_deg,
                                       .speed_mps = fix_.speed_mps,
                                       .course_deg = fix_.course_deg};
}

std::string TimeInput::position() const {
  if (!said_ || !said_->valid) {
    return {};
  }
  const auto minutes = [](double degrees) { return std::fmod(std::abs(degrees), 1.0) * 60.0; };
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%02d %07.4f%c %03d %07.4f%c",
                static_cast<int>(std::abs(said_->latitude_deg)), minutes(said_->latitude_deg),
                said_->latitude_deg < 0.0 ? 'S' : 'N',
                static_cast<int>(std::abs(said_->longitude_deg)), minutes(said_->longitude_deg),
                said_->longitude_deg < 0.0 ? 'W' : 'E');
  return text.data();
}

}  // namespace rigwire::emulators

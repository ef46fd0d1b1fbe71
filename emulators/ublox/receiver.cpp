#include "emulators/ublox/receiver.h"

#include <algorithm>

#include "protocols/ubx/monitor.h"
#include "protocols/ubx/version.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

/// Broadcast orbits are good for so long: IS-GPS-200, section 20.3.4.4.
constexpr Duration kOrbitLife = 4h;

const UbloxSettings& validated(const UbloxSettings& settings) {
  validate(settings);
  return settings;
}

std::vector<std::uint8_t> version_of(const UbloxProfile& profile) {
  return ubx::version_payload({std::string(profile.software),
                               std::string(profile.hardware),
                               {profile.extensions.begin(), profile.extensions.end()}});
}

}  // namespace

UbloxReceiver::UbloxReceiver(const UbloxSettings& settings, const Calendar& calendar,
                             ByteOutput& output)
    : settings_(validated(settings)),
      faults_(settings_.faults),
      profile_(*settings_.profile),
      calendar_(calendar),
      configuration_(settings_),
      quality_(output, settings_.noise_seed),
      transmitter_(quality_, settings_.transmit_buffer_bytes, settings_.baud),
      navigator_(settings_, calendar),
      raw_(calendar, profile_.generation),
      version_(version_of(profile_)) {
  start(kStart, settings_.time_to_first_fix == 0s ? UbloxMemory::everything() : UbloxMemory{});
}

void UbloxReceiver::start(SimTime now, const UbloxMemory& memory) {
  running_ = false;
  navigating_ = true;
  ready_ = now + settings_.start_up;
  input_size_ = 0;
  in_garbage_ = false;
  overflow_to_report_ = false;
  port_ = {};
  antenna_ = supervise(AntennaState::ok, configuration_.present().antenna);
  mark_ = {};
  transmitter_.clear();
  set_baud(configuration_.uart().baud);
  navigator_.power_on(now);
  begin_navigation(now, memory);
  plan_from(ready_);
}

void UbloxReceiver::begin_navigation(SimTime now, const UbloxMemory& memory) {
  pending_count_ = 0;
  navigator_.begin(now, memory, configuration_);
  raw_.begin(memory.ephemerides, memory.almanac);
}

void UbloxReceiver::power(SimTime now, bool on) {
  advance(now);
  if (on == powered_) {
    return;
  }
  powered_ = on;
  if (!on) {
    off_since_ = now;
    running_ = false;
    pending_count_ = 0;
    plan_ = {};
    transmitter_.clear();
    return;
  }
  UbloxMemory memory;
  if (settings_.backup_battery) {
    memory = UbloxMemory::everything();
    memory.ephemerides = now - off_since_ < kOrbitLife;
  } else {
    configuration_.forget();
  }
  configuration_.reload();
  start(now, memory);
}

void UbloxReceiver::set_client(SimTime now, const SerialClient& client) {
  advance(now);
  quality_.set_client_baud(client.present ? client.baud : 0);
}

void UbloxReceiver::set_baud(std::uint32_t baud) {
  transmitter_.set_baud(baud);
  quality_.set_device_baud(baud);
}

void UbloxReceiver::plan_from(SimTime now) {
  if (!navigating_ || !powered_) {
    plan_ = {};
    return;
  }
  const Duration period = std::chrono::milliseconds{configuration_.rate().measurement_period_ms};
  constexpr std::uint16_t kUtc = 0;
  const Duration behind = configuration_.rate().time_reference == kUtc
                              ? std::chrono::seconds{calendar_.leap_seconds(now)}
                              : 0s;
  plan_ = {calendar_.align_to_gps(now - behind, period) + behind, period};
}

SimTime UbloxReceiver::next_event() const {
  if (!powered_) {
    return kNever;
  }
  SimTime next = transmitter_.next_event();
  if (!running_) {
    next = std::min(next, ready_);
  }
  if (pending_count_ > 0) {
    next = std::min(next, pending_[pending_head_].time + settings_.solution_latency);
  }
  return next;
}

void UbloxReceiver::advance(SimTime now) {
  for (SimTime event = next_event(); event <= now; event = next_event()) {
    follow_line_noise(event);
    transmitter_.advance(event);
    if (overflow_to_report_ && transmitter_.room() * 2 >= transmitter_.capacity()) {
      overflow_to_report_ = false;
      send_text(event, nmea::TextKind::error, "txbuf alloc");
    }
    if (!running_ && ready_ <= event) {
      running_ = true;
      greet(event);
    }
    if (pending_count_ > 0 && pending_[pending_head_].time + settings_.solution_latency <= event) {
      solve(event);
    }
  }
}

void UbloxReceiver::update(const GnssSample& sample) {
  advance(sample.time);
  if (!running_ || !navigating_ || pending_count_ == kPending) {
    ++counters_.samples_refused;
    return;
  }
  pending_[(pending_head_ + pending_count_) % kPending] = sample;
  ++pending_count_;
  advance(sample.time);
}

void UbloxReceiver::greet(SimTime now) {
  if (settings_.start_banner) {
    for (const auto line : profile_.banner) {
      send_text(now, nmea::TextKind::notice, line);
    }
  }
  const std::size_t awake = message_index(profile_, ubx::MonRxr::kId);
  if (awake < profile_.messages.size() && configuration_.message_rate(awake) > 0) {
    send_message(now, profile_.messages[awake]);
  }
}

void UbloxReceiver::follow_line_noise(SimTime now) {
  const auto* const noise = faults_.first<UartNoiseFault>(now);
  quality_.set_bit_error_rate(noise == nullptr ? 0.0 : noise->bit_error_rate);
}

void UbloxReceiver::solve(SimTime now) {
  std::swap(latest_, pending_[pending_head_]);
  pending_head_ = (pending_head_ + 1) % kPending;
  --pending_count_;
  UbloxNavigationFaults faults;
  faults.frozen = faults_.first<FrozenFixFault>(latest_.time) != nullptr;
  if (const auto* leap = faults_.first<WrongLeapSecondFault>(latest_.time)) {
    faults.leap_error_s = leap->seconds;
  }
  const ubx::CfgRate& rate = configuration_.rate();
  constexpr std::int64_t kMillisecond_ns = 1'000'000;
  const std::int64_t measurement = (calendar_.gps(latest_.time).time_of_week_ns + kMillisecond_ns) /
                                   (std::int64_t{rate.measurement_period_ms} * kMillisecond_ns);
  const bool navigates = measurement % rate.navigation_ratio == 0;
  if (navigates) {
    navigator_.take(latest_, configuration_, faults);
  }
  const UbloxSolution& s = navigator_.solution();
  raw_.update(latest_, {s.time_known, s.date_known, s.leap_known, s.leap_seconds, s.week_shift,
                        s.since_start_ms});
  watch_antenna(now);
  publish(now, navigates);
  if (navigates) {
    ++counters_.epochs;
    ++epoch_number_;
  }
}

void UbloxReceiver::watch_antenna(SimTime now) {
  const UbloxAntenna seen = supervise(latest_.radio.antenna, configuration_.present().antenna);
  if (seen.status != antenna_.status) {
    send_text(now, nmea::TextKind::notice, seen.text);
  }
  antenna_ = seen;
}

void UbloxReceiver::external_interrupt(SimTime now, bool rising) {
  advance(now);
  if (!running_) {
    return;
  }
  mark_.rose |= rising;
  mark_.fell |= !rising;
  mark_.fresh = true;
  (rising ? mark_.rising : mark_.falling) = calendar_.gps(now);
  mark_.count = static_cast<std::uint16_t>(mark_.count + (rising ? 1 : 0));
}

}  // namespace rigwire::emulators

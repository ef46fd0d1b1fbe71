#include "emulators/ublox/receiver.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocols/ubx/version.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

constexpr double kDegree = std::numbers::pi / 180.0;
// Course is frozen below this speed or above this uncertainty.
constexpr double kFrozenSpeed_mps = 0.1;
constexpr double kFrozenCourse_deg = 15.0;
// How the position accuracy decays without a fix.
constexpr double kDriftingAccuracy_mps = 10.0;
// Shares of the time to first fix in a recorded cold start: 111 and 117 of 370 epochs.
constexpr double kTimeShare = 0.300;
constexpr double kDateShare = 0.316;

constexpr std::array kQuantities{
    Quantity{"latitude", "deg", -90.0, 90.0, 1e-7},
    Quantity{"longitude", "deg", -180.0, 180.0, 1e-7},
    Quantity{"height above ellipsoid", "m", -2'147'483.0, 2'147'483.0, 1e-3},
    Quantity{"velocity north, east, down", "m/s", -2'147'483.0, 2'147'483.0, 1e-3},
    Quantity{"heading of motion", "deg", 0.0, 360.0, 1e-5},
    Quantity{"horizontal accuracy", "m", 0.0, 4'294'967.0, 1e-3},
    Quantity{"dilution", "1", 0.0, 99.99, 0.01},
    Quantity{"latitude (NMEA)", "deg", -90.0, 90.0, 1e-5 / 60.0},
    Quantity{"longitude (NMEA)", "deg", -180.0, 180.0, 1e-5 / 60.0},
    Quantity{"height above mean sea level (NMEA)", "m", -99'999.9, 99'999.9, 0.1},
};

const UbloxSettings& validated(const UbloxSettings& settings) {
  validate(settings);
  return settings;
}

std::uint32_t milliseconds(Duration span) {
  return static_cast<std::uint32_t>(span / 1ms);
}

std::vector<std::uint8_t> version_of(const UbloxProfile& profile) {
  return ubx::version_payload({std::string(profile.software),
                               std::string(profile.hardware),
                               {profile.extensions.begin(), profile.extensions.end()}});
}

Duration share(Duration whole, double part) {
  return from_seconds(to_seconds(whole) * part);
}

}  // namespace

UbloxReceiver::UbloxReceiver(const UbloxSettings& settings, const Calendar& calendar,
                             ByteOutput& output)
    : settings_(validated(settings)),
      calendar_(calendar),
      configuration_(settings_),
      transmitter_(output, settings_.transmit_buffer_bytes, settings_.baud),
      version_(version_of(*settings_.profile)) {
  start(kStart, settings_.time_to_first_fix);
}

void UbloxReceiver::start(SimTime now, Duration time_to_first_fix) {
  running_ = false;
  navigating_ = true;
  powered_ = now;
  ready_ = now + settings_.start_up;
  input_size_ = 0;
  in_garbage_ = false;
  overflow_to_report_ = false;
  transmitter_.clear();
  begin_navigation(now, time_to_first_fix);
  plan_from(ready_);
}

void UbloxReceiver::begin_navigation(SimTime now, Duration time_to_first_fix) {
  searching_ = now;
  time_to_first_fix_ = time_to_first_fix;
  pending_count_ = 0;
  const bool hot = time_to_first_fix == 0s;
  if (!hot) {
    solution_ = {};
    last_fix_ = kNever;
  }
  solution_.first_fix_ms = 0;
  solution_.time_known = hot;
  solution_.date_known = hot;
  solution_.orbits_known = hot;
  set_time(solution_, calendar_, now);
}

void UbloxReceiver::plan_from(SimTime now) {
  const Duration period = std::chrono::milliseconds{configuration_.rate().measurement_period_ms};
  plan_ = navigating_ ? SamplePlan{calendar_.align_to_gps(now, period), period} : SamplePlan{};
}

SimTime UbloxReceiver::next_event() const {
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
    transmitter_.advance(event);
    if (overflow_to_report_ && transmitter_.room() * 2 >= settings_.transmit_buffer_bytes) {
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
    for (const auto line : settings_.profile->banner) {
      send_text(now, nmea::TextKind::notice, line);
    }
  }
}

void UbloxReceiver::solve(SimTime now) {
  const GnssSample& sample = pending_[pending_head_];
  const Duration age = sample.time - searching_;
  const bool tracking = configuration_.gps_enabled() &&
                        std::ranges::any_of(sample.satellites, &SatelliteView::tracked);
  UbloxSolution& s = solution_;
  s.time_known |= tracking && age >= share(time_to_first_fix_, kTimeShare);
  s.date_known |= tracking && age >= share(time_to_first_fix_, kDateShare);
  s.orbits_known |= tracking && age >= time_to_first_fix_;
  s.since_start_ms = milliseconds(sample.time - powered_);
  set_time(s, calendar_, sample.time);

  int dimensions = sample.fix == GnssFix::three_d ? 3 : sample.fix == GnssFix::two_d ? 2 : 0;
  const auto& limits = configuration_.navigation();
  constexpr std::uint8_t kOnly2d = 1;
  constexpr std::uint8_t kOnly3d = 2;
  if (limits.fix_mode == kOnly2d) {
    dimensions = std::min(dimensions, 2);
  }
  const double accuracy_m = std::hypot(sample.horizontal_accuracy_m, sample.vertical_accuracy_m);
  if (!s.orbits_known || !tracking || (limits.fix_mode == kOnly3d && dimensions == 2) ||
      sample.position_dilution * 10.0 > limits.position_dilution_mask_e1 ||
      accuracy_m > limits.position_accuracy_mask_m) {
    dimensions = 0;
  }
  if (configuration_.gps_enabled()) {
    s.satellites = sample.satellites;
  } else {
    s.satellites.clear();
  }
  take_position(sample, dimensions);
  pending_head_ = (pending_head_ + 1) % kPending;
  --pending_count_;
  ++counters_.epochs;
  publish(now);
  ++epoch_number_;
}

void UbloxReceiver::take_position(const GnssSample& sample, int dimensions) {
  UbloxSolution& s = solution_;
  s.dimensions = dimensions;
  s.clock_bias_s = sample.clock_bias_s;
  s.clock_drift = sample.clock_drift;
  s.geoid_separation_m = sample.geoid_separation_m;
  if (dimensions == 0) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    s.horizontal_dilution = s.vertical_dilution = s.position_dilution = s.time_dilution = kNone;
    s.satellites_used = 0;
    s.velocity_ned_mps = {};
    s.heading_frozen = true;
    s.heading_accuracy_deg = 180.0;
    if (last_fix_ != kNever) {
      const double grown_m =
          kDriftingAccuracy_mps * to_seconds(Duration{std::chrono::milliseconds{
                                      configuration_.rate().measurement_period_ms}});
      s.horizontal_accuracy_m += grown_m;
      s.vertical_accuracy_m += grown_m;
    }
    return;
  }
  if (s.first_fix_ms == 0) {
    s.first_fix_ms = std::max(1U, s.since_start_ms);
  }
  last_fix_ = sample.time;
  s.has_position = true;
  s.latitude_deg = sample.latitude_deg;
  s.longitude_deg = sample.longitude_deg;
  s.ellipsoid_height_m = sample.ellipsoid_height_m;
  s.velocity_ned_mps = sample.velocity_ned_mps;
  s.horizontal_accuracy_m = sample.horizontal_accuracy_m;
  s.vertical_accuracy_m = sample.vertical_accuracy_m;
  s.speed_accuracy_mps = sample.speed_accuracy_mps;
  s.time_accuracy_s = sample.time_accuracy_s;
  s.horizontal_dilution = sample.horizontal_dilution;
  s.vertical_dilution = sample.vertical_dilution;
  s.position_dilution = sample.position_dilution;
  s.time_dilution = sample.time_dilution;
  s.satellites_used =
      static_cast<int>(std::ranges::count(sample.satellites, true, &SatelliteView::used));

  const Vector3& v = sample.velocity_ned_mps;
  const double speed_mps = std::hypot(v.x, v.y);
  const double axis_mps = sample.speed_accuracy_mps / std::numbers::sqrt3;
  const double uncertainty_deg = std::atan2(axis_mps, speed_mps) / kDegree;
  s.heading_frozen = speed_mps < kFrozenSpeed_mps || uncertainty_deg > kFrozenCourse_deg;
  if (s.heading_frozen) {
    s.heading_accuracy_deg = 180.0;
  } else {
    s.heading_accuracy_deg = uncertainty_deg;
    s.heading_deg = std::atan2(v.y, v.x) / kDegree;
    if (s.heading_deg < 0.0) {
      s.heading_deg += 360.0;
    }
  }
}

bool UbloxReceiver::speaks(std::uint16_t protocol) const {
  return (configuration_.uart().output_protocols & protocol) != 0;
}

std::string_view UbloxReceiver::talker() const {
  return configuration_.gps_enabled() ? "GP" : "GL";
}

void UbloxReceiver::publish(SimTime now) {
  const auto messages = settings_.profile->messages;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const std::uint8_t rate = configuration_.message_rate(i);
    if (rate != 0 && epoch_number_ % rate == 0) {
      send_message(now, messages[i]);
    }
  }
}

void UbloxReceiver::send_message(SimTime now, const UbloxMessage& message) {
  if (message.sentence) {
    send_sentence(now, message.name);
  } else if (speaks(ubx::kProtocolUbx)) {
    std::array<std::uint8_t, kLongestSolutionFrame> frame{};
    const std::size_t size = encode(message.id, frame);
    send(now, std::span(frame).first(size));
  }
}

std::size_t UbloxReceiver::encode(ubx::MessageId id, std::span<std::uint8_t> out) const {
  const UbloxProfile& profile = *settings_.profile;
  const std::size_t own = profile.encode == nullptr ? 0 : profile.encode(solution_, id, out);
  return own > 0 ? own : encode_solution(solution_, profile, id, out);
}

void UbloxReceiver::send_sentence(SimTime now, std::string_view name) {
  if (!speaks(ubx::kProtocolNmea)) {
    return;
  }
  constexpr std::uint8_t kVersion23 = 0x23;
  const bool with_mode = configuration_.nmea().version >= kVersion23;
  const nmea::Epoch epoch = nmea_epoch(solution_, talker(), with_mode, in_view_);
  if (name == "GSV") {
    for (int page = 1; page <= nmea::gsv_pages(epoch); ++page) {
      send(now, nmea::write_gsv(epoch, page).bytes());
    }
    return;
  }
  using Writer = nmea::Sentence (*)(const nmea::Epoch&);
  constexpr std::array<std::pair<std::string_view, Writer>, 6> kWriters{{
      {"RMC", nmea::write_rmc},
      {"VTG", nmea::write_vtg},
      {"GGA", nmea::write_gga},
      {"GSA", nmea::write_gsa},
      {"GLL", nmea::write_gll},
      {"ZDA", nmea::write_zda},
  }};
  for (const auto& [type, write] : kWriters) {
    if (type == name) {
      send(now, write(epoch).bytes());
    }
  }
}

void UbloxReceiver::send_text(SimTime now, nmea::TextKind kind, std::string_view text) {
  if (speaks(ubx::kProtocolNmea) && configuration_.text_enabled(1, static_cast<unsigned>(kind))) {
    send(now, nmea::write_txt(talker(), kind, text).bytes());
  }
}

void UbloxReceiver::send(SimTime now, std::span<const std::uint8_t> message) {
  if (!message.empty() && !transmitter_.enqueue(now, message)) {
    overflow_to_report_ = true;
  }
}

std::span<const Quantity> UbloxReceiver::quantities() const {
  return kQuantities;
}

double UbloxReceiver::nominal_rate_hz() const {
  double per_epoch = 0.0;
  const auto messages = settings_.profile->messages;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (const std::uint8_t rate = configuration_.message_rate(i); rate > 0) {
      const std::size_t sentences =
          messages[i].name == "GSV" ? std::max<std::size_t>(1, (in_view_.size() + 3) / 4) : 1;
      per_epoch += static_cast<double>(sentences) / rate;
    }
  }
  return plan_.first == kNever ? 0.0 : per_epoch / to_seconds(plan_.period);
}

UbloxCounters UbloxReceiver::counters() const {
  UbloxCounters counters = counters_;
  counters.messages_sent = transmitter_.messages_sent();
  counters.messages_lost = transmitter_.messages_lost();
  return counters;
}

}  // namespace rigwire::emulators

#include "emulators/xsens/mti_600.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/constants.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

namespace xsens = protocols::xsens;
using fields::in;
using xsens::MessageId;
using xsens::StatusBit;

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kPeriod_s = 1.0 / kMtiSamplesPerSecond;

bool finite(const Triad& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/// Clamps, and gives the mark of each clamped component, the x component's mark being `first`.
std::uint32_t clamp(Triad& values, double range, std::uint32_t first) {
  std::uint32_t marks = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(values[i]) > range) {
      marks |= first << i;
      values[i] = std::clamp(values[i], -range, range);
    }
  }
  return marks;
}

/// Sent even when the elements have failed.
bool is_housekeeping(MessageId id) {
  return id == MessageId::sample_time || id == MessageId::group_counter || id == MessageId::utc ||
         id == MessageId::status_word;
}

/// What the unit's 400 samples a second give.
constexpr std::array<fields::Choice<std::uint16_t>, 16> kRates{{{0, "off", "Not sent."},
                                                                {400, "1 Hz", ""},
                                                                {200, "2 Hz", ""},
                                                                {100, "4 Hz", ""},
                                                                {80, "5 Hz", ""},
                                                                {50, "8 Hz", ""},
                                                                {40, "10 Hz", ""},
                                                                {25, "16 Hz", ""},
                                                                {20, "20 Hz", ""},
                                                                {16, "25 Hz", ""},
                                                                {10, "40 Hz", ""},
                                                                {8, "50 Hz", ""},
                                                                {5, "80 Hz", ""},
                                                                {4, "100 Hz", ""},
                                                                {2, "200 Hz", ""},
                                                                {1, "400 Hz", ""}}};

constexpr std::array<fields::Choice<MtiSampleTime>, 2> kSampleTimes{
    {{MtiSampleTime::ticks_100us, "100us", "Ticks of 100 us, as the maker's documents say today."},
     {MtiSampleTime::microseconds, "us", "Microseconds, as the older xsens.dbc says."}}};

void refuse(const std::string& what) {
  throw std::invalid_argument("Xsens MTi-600: " + what);
}

}  // namespace

Mti600::Mti600(const MtiSettings& settings, const Calendar& calendar, FrameOutput& output)
    : settings_(checked(settings)),
      calendar_(calendar),
      output_(output),
      supply_(settings.supply),
      filter_(settings.heading_rad) {}

SamplePlan Mti600::sample_plan() const {
  return {kStart + settings_.supply.power_on + settings_.start_up, kTick};
}

std::span<const Quantity> Mti600::quantities() const {
  static const auto kQuantities = [] {
    const auto angles = xsens::message(MessageId::euler_angles).signals;
    const auto rates = xsens::message(MessageId::rate_of_turn).signals;
    const auto forces = xsens::message(MessageId::acceleration).signals;
    return std::array{
        within(quantity(angles[0]), -180.0, 180.0), within(quantity(angles[1]), -90.0, 90.0),
        within(quantity(angles[2]), -180.0, 180.0), quantity(rates[0], "rate of turn x"),
        quantity(rates[1], "rate of turn y"),       quantity(rates[2], "rate of turn z"),
        quantity(forces[0], "acceleration x"),      quantity(forces[1], "acceleration y"),
        quantity(forces[2], "acceleration z")};
  }();
  return kQuantities;
}

double Mti600::nominal_rate_hz() const {
  double sum = 0.0;
  for (const MtiOutput& output : settings_.outputs) {
    sum += output.divider == 0 ? 0.0 : double{kMtiSamplesPerSecond} / output.divider;
  }
  return sum;
}

std::vector<protocols::can::OwnedMessage> Mti600::messages(std::string_view name) const {
  constexpr double kPeriod_ms = 1e3 / kMtiSamplesPerSecond;
  std::vector<protocols::can::OwnedMessage> list;
  for (auto& layout :
       xsens::layouts(settings_.extended, 1.0 / ticks_per_second(settings_.sample_time))) {
    for (const MtiOutput& output : settings_.outputs) {
      if (static_cast<std::uint32_t>(output.id) == layout.id) {
        layout.sender = name;
        layout.period_ms = static_cast<std::uint32_t>(std::lround(kPeriod_ms * output.divider));
        list.push_back(std::move(layout));
        break;
      }
    }
  }
  return list;
}

void Mti600::advance(SimTime now) {
  while (supply_.next_change() <= now) {
    const SimTime instant = supply_.next_change();
    supply_.change();
    restart(instant);
  }
}

void Mti600::restart(SimTime now) {
  filter_.reset();
  ready_at_ = supply_.on() ? now + settings_.start_up : kNever;
  ticks_ = 0;
  group_ = 0;
  velocity_increment_mps_ = {};
  orientation_increment_ = {1.0, 0.0, 0.0, 0.0};
}

void Mti600::receive(SimTime now, const protocols::can::Frame& frame) {
  advance(now);
  received_.bytes += frame.length <= 8 ? frame.payload().size() : 0U;
  ++(frame.length <= 8 ? received_.ignored : received_.malformed);
}

void Mti600::update(const ImuSample& sample) {
  advance(sample.time);
  if (sample.time < ready_at_) {
    return;
  }
  const auto triad = [](const Vector3& v) { return Triad{v.x, v.y, v.z}; };
  rate_radps_ = triad(sample.angular_rate_radps);
  force_mps2_ = triad(sample.specific_force_mps2);
  failed_ = !finite(rate_radps_) || !finite(force_mps2_);
  status_ = 0;
  if (!failed_) {
    status_ = StatusBit::kSelfTest;
    status_ |= clamp(force_mps2_, settings_.acceleration_range_mps2, StatusBit::kClipAccelerationX);
    status_ |= clamp(rate_radps_, settings_.rate_range_radps, StatusBit::kClipRateX);
    if (status_ != StatusBit::kSelfTest) {
      status_ |= StatusBit::kClipping;
    }
    filter_.step(rate_radps_, force_mps2_, kPeriod_s);
    if (!filter_.initialising()) {
      status_ |= StatusBit::kFilterValid;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      // Velocity increment: sum of specific force; orientation increment: product of rotations.
      velocity_increment_mps_[i] += force_mps2_[i] * kPeriod_s;
    }
    orientation_increment_ =
        product(orientation_increment_,
                from_rotation_vector({rate_radps_[0] * kPeriod_s, rate_radps_[1] * kPeriod_s,
                                      rate_radps_[2] * kPeriod_s}));
  }
  if (overflowed_) {
    overflowed_ = false;
    const std::array code{xsens::kOutputBufferOverflow};
    output_.send(sample.time + settings_.processing_delay,
                 xsens::encode(MessageId::error, code, settings_.extended));
  }
  for (const MtiOutput& output : settings_.outputs) {
    if (output.divider != 0 && ticks_ % output.divider == 0 &&
        (!failed_ || is_housekeeping(output.id)) &&
        pace_.has_time(sample.time, static_cast<std::uint32_t>(output.id))) {
      send(sample, output);
    }
  }
  ++ticks_;
}

void Mti600::send(const ImuSample& sample, const MtiOutput& output) {
  const auto emit = [&](std::span<const double> values) {
    output_.send(sample.time + settings_.processing_delay,
                 xsens::encode(output.id, values, settings_.extended));
  };
  switch (output.id) {
    case MessageId::sample_time: {
      // Wraps with 32 bits: after 119 hours, of microseconds after 71.6 minutes.
      const auto ticks = (sample.time - ready_at_) / (Duration{std::chrono::seconds{1}} /
                                                      ticks_per_second(settings_.sample_time));
      emit(std::array{static_cast<double>(static_cast<std::uint32_t>(ticks))});
      break;
    }
    case MessageId::group_counter:
      emit(std::array{static_cast<double>(group_++)});
      break;
    case MessageId::utc: {
      const UtcTime utc = calendar_.utc(sample.time);
      const auto ticks = utc.nanosecond / 100'000;
      emit(std::array{static_cast<double>(utc.year % 100), double(utc.month), double(utc.day),
                      double(utc.hour), double(utc.minute), double(utc.second),
                      static_cast<double>(ticks) * 1e-4});
      break;
    }
    case MessageId::status_word:
      emit(std::array{static_cast<double>(status_)});
      break;
    case MessageId::quaternion:
      emit(filter_.attitude());
      break;
    case MessageId::euler_angles: {
      const RollPitchYawAngles angles = euler(filter_.attitude());
      emit(std::array{angles.roll_rad * kDegrees, angles.pitch_rad * kDegrees,
                      angles.yaw_rad * kDegrees});
      break;
    }
    case MessageId::velocity_increment: {
      const Triad& v = velocity_increment_mps_;
      const unsigned exponent =
          xsens::increment_exponent(std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}));
      const auto mantissa = [exponent](double value) {
        return std::ldexp(value, static_cast<int>(exponent));
      };
      emit(std::array{mantissa(v[0]), mantissa(v[1]), mantissa(v[2]),
                      static_cast<double>(exponent)});
      velocity_increment_mps_ = {};
      break;
    }
    case MessageId::orientation_increment:
      emit(orientation_increment_);
      orientation_increment_ = {1.0, 0.0, 0.0, 0.0};
      break;
    case MessageId::rate_of_turn:
    case MessageId::rate_of_turn_fast:
      emit(rate_radps_);
      break;
    case MessageId::acceleration:
    case MessageId::acceleration_fast:
      emit(force_mps2_);
      break;
    case MessageId::free_acceleration: {
      // Free acceleration: specific force in the local frame, gravity taken off.
      Triad free = rotate(filter_.attitude(), force_mps2_);
      free[2] -= kGravity_mps2;
      emit(free);
      break;
    }
    case MessageId::magnetic_field: {
      Triad field{sample.magnetic_field_t.x, sample.magnetic_field_t.y, sample.magnetic_field_t.z};
      if (finite(field)) {
        status_ |= clamp(field, settings_.magnetic_range_t, StatusBit::kClipFieldX);
        for (double& component : field) {
          component /= settings_.magnetic_reference_t;
        }
        emit(field);
      }
      break;
    }
    case MessageId::temperature:
      emit(std::array{sample.temperature_c});
      break;
    case MessageId::pressure:
      emit(std::array{settings_.pressure_pa});
      break;
    default:
      break;
  }
}

// Keys and checks of the unit's settings.

void visit(fields::Visitor& v, MtiSettings& p) {
  v.group(
      "outputs",
      [&p](fields::Visitor& w) {
        for (MtiOutput& output : p.outputs) {
          w.choice(protocols::xsens::message(output.id).name, output.divider, kRates,
                   "How often this message is sent.");
        }
      },
      "Messages and their rates.");
  v.choice("sample_time", p.sample_time, kSampleTimes, "What the sample time (005) counts.");
  v.boolean("extended", p.extended, "29-bit identifiers instead of 11-bit ones.");
  v.number("heading", p.heading_rad, in("deg").between(-360, 360),
           "Heading of the unit's filter at power-on, from east, left positive; nothing corrects "
           "it.");
  v.number("rate_range", p.rate_range_radps, in("deg/s").above(0).at_most(4000),
           "Angular rate beyond which the reading is clamped and marked.");
  v.number("acceleration_range", p.acceleration_range_mps2, in("m/s2").above(0).at_most(1000),
           "Acceleration beyond which the reading is clamped and marked.");
  visit(v, p.supply);
  v.duration("start_up", p.start_up, {0, 60'000'000'000}, "From power-on to the first sample.");
  v.duration("processing_delay", p.processing_delay, {0, 1'000'000'000},
             "From a sample to its messages.");
}

void validate(const MtiSettings& settings) {
  for (std::size_t i = 0; i < kMtiOutputs.size(); ++i) {
    if (settings.outputs[i].id != kMtiOutputs[i].id) {
      refuse("outputs are not in the order of kMtiOutputs");
    }
  }
  fields::check(settings);
  validate(settings.supply);
  if (!(settings.magnetic_range_t > 0.0) || !(settings.magnetic_reference_t > 0.0)) {
    refuse("magnetic range and reference must be greater than 0");
  }
  if (!(settings.pressure_pa >= 0.0) || settings.pressure_pa > 125000.0) {
    refuse("pressure is " + std::to_string(settings.pressure_pa) + " Pa, allowed is 0 .. 125000");
  }
}

}  // namespace rigwire::emulators

#include "emulators/openimu/openimu335ri.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "protocols/j1939/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
using openimu::FigureOfMerit;
using protocols::can::Frame;

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::uint16_t kAceinna = 823;
constexpr std::uint8_t kInertialFunction = 131;
constexpr Duration kClaimStep = std::chrono::milliseconds{5};
constexpr Duration kClaimRepeat300 = std::chrono::seconds{1};

void refuse(const std::string& what) {
  throw std::invalid_argument("OpenIMU: " + what);
}

std::uint64_t make_name(std::uint32_t serial) {
  j1939::Name name;
  name.identity = serial & 0x1FFFFFU;
  name.manufacturer = kAceinna;
  name.function = kInertialFunction;
  name.arbitrary_address = true;
  return pack(name);
}

AddressPolicy make_policy(const OpenImuSettings& settings) {
  AddressPolicy policy;
  policy.preferred = settings.source_address;
  policy.name = make_name(settings.serial);
  policy.first_claim = kStart + settings.power_on;
  if (settings.variant == OpenImuVariant::openimu335ri) {
    policy.first_claim += (settings.serial & 0x1FU) * kClaimStep;
  } else {
    policy.repeat = kClaimRepeat300;
  }
  policy.answer_delay = settings.processing_delay;
  return policy;
}

const OpenImuSettings& checked(const OpenImuSettings& settings) {
  validate(settings);
  return settings;
}

std::array<bool, 3> clamp(Triad& values, double range) {
  std::array<bool, 3> saturated{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    saturated[i] = std::abs(values[i]) > range;
    values[i] = std::clamp(values[i], -range, range);
  }
  return saturated;
}

/// The flag that belongs to each field of a message with these axes.
bool flag_of(const openimu::AxisMap& axes, std::size_t field, const std::array<bool, 3>& flags) {
  return flags[axes[field].axis];
}

constexpr Quantity rate_quantity(std::string_view name) {
  return {name, "deg/s", -openimu::kRateLimit_dps, openimu::kRateLimit_dps,
          openimu::kRateScale_dps};
}
constexpr Quantity acceleration_quantity(std::string_view name) {
  return {name, "m/s2", openimu::kAccelerationLower_mps2, openimu::kAccelerationUpper_mps2,
          openimu::kAccelerationScale_mps2};
}
constexpr std::array<Quantity, 8> kQuantities{{
    {"pitch", "deg", -90.0, 90.0, openimu::kSlopeScale_deg},
    {"roll", "deg", -180.0, 180.0, openimu::kSlopeScale_deg},
    rate_quantity("pitch rate"),
    rate_quantity("roll rate"),
    rate_quantity("yaw rate"),
    acceleration_quantity("lateral acceleration"),
    acceleration_quantity("longitudinal acceleration"),
    acceleration_quantity("vertical acceleration"),
}};

}  // namespace

void validate(const OpenImuSettings& settings) {
  const OpenImuConfiguration& configuration = settings.configuration;
  const auto number = [](auto value) { return std::to_string(value); };
  if (settings.source_address < kFirstPoolAddress || settings.source_address > kLastPoolAddress) {
    refuse("source_address is " + number(settings.source_address) + ", allowed is 128 .. 247");
  }
  if (settings.serial == 0 || settings.serial > 0x1FFFFFU) {
    refuse("serial is " + number(settings.serial) + ", allowed is 1 .. 2097151");
  }
  if ((configuration.packet_mask & ~openimu::PacketBit::kAll) != 0) {
    refuse("packet_mask is " + number(configuration.packet_mask) +
           ", allowed are sums of 1 (slope), 2 (angular rate), 4 (acceleration)");
  }
  if (!openimu::is_rate_divider(configuration.rate_divider)) {
    refuse("rate_divider is " + number(configuration.rate_divider) +
           ", allowed are 0, 1, 2, 4, 5, 10, 20, 25, 50 (rate = 100 Hz / divider, 0 is off)");
  }
  for (const std::uint8_t cut_off :
       {configuration.rate_cut_off_hz, configuration.acceleration_cut_off_hz}) {
    if (!openimu::is_cut_off(cut_off)) {
      refuse("cut-off is " + number(cut_off) + " Hz, allowed are 0 (off), 2, 5, 10, 25, 40, 50");
    }
  }
  if (!openimu::orientation_axes(configuration.orientation)) {
    refuse("orientation is " + number(configuration.orientation) +
           ", allowed are the 24 right-handed codes 0 .. 364");
  }
  if (((configuration.behaviour ^ openimu::Behaviour::kDefault) & ~kChangeableBehaviour) != 0) {
    refuse("behaviour is " + number(configuration.behaviour) +
           ", allowed are 49736 (0xC248) and that with the bits 8, 64, 512 cleared");
  }
  if (!(settings.rate_range_radps > 0.0) || !(settings.acceleration_range_mps2 > 0.0)) {
    refuse("rate_range_radps and acceleration_range_mps2 must be greater than 0, found " +
           number(settings.rate_range_radps) + " and " + number(settings.acceleration_range_mps2));
  }
  if (settings.power_on < Duration{0}) {
    refuse("power_on is negative");
  }
  if (settings.processing_delay < Duration{0} || settings.processing_delay >= OpenImu::kTick) {
    refuse("processing_delay is " + number(settings.processing_delay.count()) +
           " ns, allowed is 0 .. 4999999");
  }
}

OpenImu::OpenImu(const OpenImuSettings& settings, FrameOutput& output)
    : settings_(checked(settings)),
      output_(output),
      configuration_(settings.configuration),
      saved_(settings.configuration),
      address_(make_policy(settings), output),
      rate_filter_(configuration_.rate_cut_off_hz, openimu::kTicksPerSecond),
      force_filter_(configuration_.acceleration_cut_off_hz, openimu::kTicksPerSecond) {}

void OpenImu::advance(SimTime now) {
  address_.advance(now);
}

SamplePlan OpenImu::sample_plan() const {
  return {kStart + settings_.power_on, kTick};
}

std::span<const Quantity> OpenImu::quantities() const {
  return kQuantities;
}

void OpenImu::rebuild_filters() {
  rate_filter_ = LowPass(configuration_.rate_cut_off_hz, openimu::kTicksPerSecond);
  force_filter_ = LowPass(configuration_.acceleration_cut_off_hz, openimu::kTicksPerSecond);
}

void OpenImu::update(const ImuSample& sample) {
  advance(sample.time);
  const openimu::AxisMap housing = *openimu::orientation_axes(configuration_.orientation);
  const auto to_device = [&housing](const Vector3& v) {
    return openimu::map_axes(housing,
                             openimu::map_axes(openimu::kForwardLeftUpToDevice, {v.x, v.y, v.z}));
  };
  Triad rate = to_device(sample.angular_rate_radps);
  Triad force = to_device(sample.specific_force_mps2);
  const auto finite = [](const Triad& v) {
    return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
  };
  latest_.fault = !finite(rate) || !finite(force);
  if (latest_.fault) {
    latest_.rate_radps.fill(std::numeric_limits<double>::quiet_NaN());
    latest_.specific_force_mps2.fill(std::numeric_limits<double>::quiet_NaN());
  } else {
    latest_.rate_saturated = clamp(rate, settings_.rate_range_radps);
    latest_.force_saturated = clamp(force, settings_.acceleration_range_mps2);
    latest_.rate_radps = rate_filter_.filter(rate);
    latest_.specific_force_mps2 = force_filter_.filter(force);
    for (std::size_t i = 0; i < 3; ++i) {
      // What the message cannot carry is saturated as well.
      latest_.rate_saturated[i] =
          latest_.rate_saturated[i] ||
          std::abs(latest_.rate_radps[i]) * kDegrees > openimu::kRateLimit_dps;
    }
    tilt_.step(latest_.rate_radps, latest_.specific_force_mps2, to_seconds(kTick));
  }
  const unsigned period = 2U * configuration_.rate_divider;
  if (address_.held() && period != 0 && ticks_ % period == 0) {
    send_packets(sample.time, configuration_.packet_mask);
  }
  ++ticks_;
}

FigureOfMerit OpenImu::merit(bool saturated) const {
  if (settings_.variant == OpenImuVariant::openimu300ri) {
    return FigureOfMerit::not_available;
  }
  if (latest_.fault) {
    return FigureOfMerit::error;
  }
  return saturated ? FigureOfMerit::degraded : FigureOfMerit::functional;
}

double OpenImu::latency_ms() const {
  return settings_.variant == OpenImuVariant::openimu335ri
             ? to_seconds(settings_.processing_delay) * 1e3
             : 0.0;
}

void OpenImu::send(SimTime now, const Frame& frame) {
  output_.send(now + settings_.processing_delay, frame);
}

double OpenImu::nominal_rate_hz() const {
  if (configuration_.rate_divider == 0) {
    return 0.0;
  }
  const int messages = std::popcount(configuration_.packet_mask);
  return static_cast<double>(openimu::kTicksPerSecond) / 2.0 / configuration_.rate_divider *
         messages;
}

void OpenImu::send_packets(SimTime now, std::uint16_t mask) {
  const std::uint8_t source = address_.address();
  if ((mask & openimu::PacketBit::kSlope) != 0) {
    const auto any = [](const std::array<bool, 3>& flags) {
      return std::any_of(flags.begin(), flags.end(), [](bool flag) { return flag; });
    };
    const FigureOfMerit slope_merit =
        merit(tilt_.initialising() || any(latest_.rate_saturated) || any(latest_.force_saturated));
    openimu::Slope slope;
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    slope.pitch_deg = {latest_.fault ? unknown : tilt_.pitch_rad() * kDegrees, slope_merit};
    slope.roll_deg = {latest_.fault ? unknown : tilt_.roll_rad() * kDegrees, slope_merit};
    if (!openimu::pitch_first(configuration_.behaviour)) {
      std::swap(slope.pitch_deg, slope.roll_deg);
    }
    slope.latency_ms = latency_ms();
    send(now, openimu::encode(slope, source));
  }
  if ((mask & openimu::PacketBit::kAngularRate) != 0) {
    const openimu::AxisMap axes = openimu::rate_axes(configuration_.behaviour);
    const Triad rate = openimu::map_axes(axes, latest_.rate_radps);
    const auto measurement = [&](std::size_t i) {
      return openimu::Measurement{rate[i] * kDegrees,
                                  merit(flag_of(axes, i, latest_.rate_saturated))};
    };
    send(now, openimu::encode(openimu::AngularRate{measurement(0), measurement(1), measurement(2),
                                                   latency_ms()},
                              source));
  }
  if ((mask & openimu::PacketBit::kAcceleration) != 0) {
    const openimu::AxisMap axes = openimu::acceleration_axes(configuration_.behaviour);
    const Triad force = openimu::map_axes(axes, latest_.specific_force_mps2);
    const auto measurement = [&](std::size_t i) {
      return openimu::Measurement{force[i], merit(flag_of(axes, i, latest_.force_saturated))};
    };
    send(now, openimu::encode(openimu::Acceleration{measurement(0), measurement(1), measurement(2),
                                                    latency_ms()},
                              source));
  }
}

std::uint16_t OpenImu::status_word() const {
  using Bit = openimu::StatusBit;
  const auto any = [](const std::array<bool, 3>& flags) {
    return flags[0] || flags[1] || flags[2];
  };
  unsigned word = 0;
  if (latest_.fault) {
    word |= static_cast<unsigned>(Bit::kMaster | Bit::kSensor);
  }
  if (tilt_.initialising()) {
    word |= static_cast<unsigned>(Bit::kAlgorithmInitialising | Bit::kHighGain);
  }
  if (any(latest_.rate_saturated) || any(latest_.force_saturated)) {
    word |= static_cast<unsigned>(Bit::kOverRange);
  }
  return static_cast<std::uint16_t>(word);
}

}  // namespace rigwire::emulators

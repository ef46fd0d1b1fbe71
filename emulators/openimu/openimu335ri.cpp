#include "emulators/openimu/openimu335ri.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "protocols/j1939/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
using protocols::can::Frame;

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kGaussPerTesla = 1e4;
constexpr std::uint16_t kAceinna = 823;
constexpr std::uint8_t kInertialFunction = 131;
constexpr Duration kClaimRepeat300 = std::chrono::seconds{1};
constexpr unsigned kLongestClaimDelay = 31;
/// Of a trouble message that goes on; the firmware counts 2000 ticks.
constexpr Duration kTroublePeriod = std::chrono::seconds{10};
constexpr std::uint8_t kMostOccurrences = 126;

std::uint64_t make_name(std::uint32_t serial) {
  j1939::Name name;
  name.identity = serial & 0x1FFFFFU;
  name.manufacturer = kAceinna;
  name.function = kInertialFunction;
  name.arbitrary_address = true;
  return pack(name);
}

Duration claim_delay(const OpenImuSettings& settings) {
  if (settings.variant == OpenImuVariant::openimu300ri) {
    return Duration{0};
  }
  const unsigned ticks = settings.serial & kLongestClaimDelay;
  return (ticks == 0 ? kLongestClaimDelay : ticks) * OpenImu::kTick;
}

/// As the firmware does it rather than SAE J1939-81 (docs/devices/openimu335ri.md).
J1939AddressPolicy make_policy(const OpenImuSettings& settings) {
  J1939AddressPolicy policy;
  policy.preferred = settings.source_address;
  policy.name = make_name(settings.serial);
  policy.arbitrary_address = true;
  policy.silent_after_claim = false;
  policy.says_cannot_claim = false;
  policy.first_claim = kNever;
  policy.answer_delay = settings.processing_delay;
  if (settings.variant == OpenImuVariant::openimu335ri) {
    policy.reclaim_delay = claim_delay(settings);
    policy.gives_way = true;
  } else {
    policy.repeat = kClaimRepeat300;
  }
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

using protocols::vehicle::signal_of;
constexpr std::array kQuantities{
    within(quantity(signal_of(&openimu::Slope::pitch_deg)), -90.0, 90.0),
    within(quantity(signal_of(&openimu::Slope::roll_deg)), -180.0, 180.0),
    quantity(signal_of(&openimu::AngularRate::pitch_dps)),
    quantity(signal_of(&openimu::AngularRate::roll_dps)),
    quantity(signal_of(&openimu::AngularRate::yaw_dps)),
    quantity(signal_of(&openimu::Acceleration::lateral_mps2)),
    quantity(signal_of(&openimu::Acceleration::longitudinal_mps2)),
    quantity(signal_of(&openimu::Acceleration::vertical_mps2)),
};

}  // namespace

OpenImu::OpenImu(const OpenImuSettings& settings, NonvolatileMemory& memory, FrameOutput& output)
    : settings_(checked(settings)),
      memory_(memory),
      output_(output),
      configuration_(settings.configuration),
      saved_{settings.source_address, settings.configuration},
      supply_(settings.supply),
      address_(make_policy(settings), output),
      rate_filter_(configuration_.rate_cut_off_hz, openimu::kTicksPerSecond),
      force_filter_(configuration_.acceleration_cut_off_hz, openimu::kTicksPerSecond) {}

OpenImu::OpenImu(const OpenImuSettings& settings, FrameOutput& output)
    : OpenImu(settings, own_memory_, output) {}

void OpenImu::start(SimTime now) {
  const auto content = memory_.content();
  const auto memory = unsealed(content, settings_.variant);
  memory_damaged_ = !content.empty() && !memory;
  saved_ = memory ? *memory : OpenImuMemory{settings_.source_address, settings_.configuration};
  configuration_ = saved_.configuration;
  held_address_ = saved_.address;
  new_address_.reset();
  rebuild_filters();
  tilt_.reset();
  latest_ = {};
  ticks_ = 0;
  restart_ = next_trouble_ = kNever;
  address_.restart(saved_.address, now + claim_delay(settings_));
}

void OpenImu::switch_supply(SimTime now) {
  supply_.change();
  if (supply_.on()) {
    start(now);
  } else {
    restart_ = next_trouble_ = kNever;
    address_.restart(saved_.address, kNever);
  }
}

SimTime OpenImu::next_event() const {
  return std::min({supply_.next_change(), restart_, next_trouble_, address_.next_event()});
}

void OpenImu::advance(SimTime now) {
  for (SimTime instant = next_event(); instant <= now; instant = next_event()) {
    if (instant == supply_.next_change()) {
      switch_supply(instant);
    } else if (instant == restart_) {
      start(instant);
    } else if (instant == next_trouble_) {
      next_trouble_ += kTroublePeriod;
      send_trouble(instant);
    } else {
      address_.advance(instant);
    }
  }
  if (address_.held() && address_.address() != held_address_) {
    held_address_ = saved_.address = address_.address();
    (void)remember();
  }
}

void OpenImu::controller(SimTime now, const protocols::can::ControllerReport& report) {
  advance(now);
  // A lost claim of the 300RI is mended by the next one.
  if (report.restarted && !is_300()) {
    address_.on_restart(now);
  }
}

bool OpenImu::remember() {
  return memory_.store(sealed(saved_));
}

SamplePlan OpenImu::sample_plan() const {
  return {kStart + settings_.supply.power_on, kTick};
}

std::span<const Quantity> OpenImu::quantities() const {
  return kQuantities;
}

void OpenImu::rebuild_filters() {
  rate_filter_ = LowPass(configuration_.rate_cut_off_hz, openimu::kTicksPerSecond);
  force_filter_ = LowPass(configuration_.acceleration_cut_off_hz, openimu::kTicksPerSecond);
}

double OpenImu::no_number() const {
  return is_300() ? protocols::vehicle::kNotAvailable : protocols::vehicle::kError;
}

void OpenImu::sense(const ImuSample& sample) {
  const openimu::AxisMap housing = *openimu::orientation_axes(configuration_.orientation);
  const auto to_device = [&housing](const Vector3& v) {
    return openimu::map_axes(housing,
                             openimu::map_axes(openimu::kForwardLeftUpToDevice, {v.x, v.y, v.z}));
  };
  Triad rate = to_device(sample.angular_rate_radps);
  Triad force = to_device(sample.specific_force_mps2);
  latest_.magnetic_field_gauss = to_device(sample.magnetic_field_t);
  for (double& component : latest_.magnetic_field_gauss) {
    component *= kGaussPerTesla;
  }
  const auto finite = [](const Triad& v) {
    return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
  };
  latest_.fault = !finite(rate) || !finite(force);
  if (latest_.fault) {
    latest_.rate_radps.fill(no_number());
    latest_.specific_force_mps2.fill(no_number());
    return;
  }
  latest_.rate_saturated = clamp(rate, settings_.rate_range_radps);
  latest_.force_saturated = clamp(force, settings_.acceleration_range_mps2);
  latest_.rate_radps = rate_filter_.filter(rate);
  latest_.specific_force_mps2 = force_filter_.filter(force);
  tilt_.step(latest_.rate_radps, latest_.specific_force_mps2, to_seconds(kTick));
}

void OpenImu::update(const ImuSample& sample) {
  advance(sample.time);
  if (!supply_.on()) {
    return;
  }
  const bool had_fault = latest_.fault;
  sense(sample);
  if (latest_.fault && !had_fault && !is_300() && configuration_.trouble.second_failure != 0xFF) {
    troubles_ = std::min<std::uint8_t>(static_cast<std::uint8_t>(troubles_ + 1), kMostOccurrences);
    next_trouble_ = sample.time + kTroublePeriod;
    send_trouble(sample.time);
  } else if (!latest_.fault) {
    next_trouble_ = kNever;
  }
  const unsigned period = 2U * configuration_.rate_divider;
  if (address_.held() && period != 0 && ticks_ % period == 0) {
    send_packets(sample.time, configuration_.packet_mask);
  }
  ++ticks_;
}

void OpenImu::send(SimTime now, const Frame& frame) {
  output_.send(now + settings_.processing_delay, is_300() ? frame : openimu::filled_up(frame));
}

double OpenImu::nominal_rate_hz() const {
  if (configuration_.rate_divider == 0) {
    return 0.0;
  }
  const int messages = std::popcount(configuration_.packet_mask);
  return static_cast<double>(openimu::kTicksPerSecond) / 2.0 / configuration_.rate_divider *
         messages;
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
  if (memory_damaged_) {
    word |= static_cast<unsigned>(Bit::kMaster | Bit::kHardware | Bit::kMemory);
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

#include "emulators/openimu/openimu335ri.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "protocols/bytes.h"
#include "protocols/j1939/message.h"
#include "protocols/vehicle/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
using openimu::Command;
using openimu::FigureOfMerit;
using openimu::PacketBit;
using protocols::can::Frame;

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kGaussPerTesla = 1e4;
constexpr std::uint16_t kAceinna = 823;
constexpr std::uint8_t kInertialFunction = 131;
constexpr Duration kClaimRepeat300 = std::chrono::seconds{1};
constexpr unsigned kLongestClaimDelay = 31;
/// Period of a trouble message while the trouble lasts; the firmware counts 2000 ticks.
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

/// Returns the address policy of the firmware, which differs from SAE J1939-81
/// (docs/devices/openimu335ri.md).
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

bool any(const std::array<bool, 3>& flags) {
  return flags[0] || flags[1] || flags[2];
}

constexpr std::uint32_t kEcuFormat = 253;  ///< The 300RI answers every group of this PDU format.

bool is_bank(std::uint32_t pgn) {
  return pgn == openimu::kBank0Pgn || pgn == openimu::kBank1Pgn || pgn == openimu::kBank2Pgn;
}
bool is_aiding(std::uint32_t pgn) {
  return pgn == openimu::kTransmissionPgn || pgn == openimu::kWheelSpeedPgn ||
         pgn == openimu::kVehicleSpeedPgn;
}

/// From the answer to the restart.
constexpr Duration kRestartDelay = std::chrono::milliseconds{50};

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
    send_packets(sample.time, packets_due(sample.time));
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

// The OpenIMU's data messages, and its trouble codes.

std::vector<protocols::can::OwnedMessage> OpenImu::messages(std::string_view name) const {
  const OpenImuConfiguration& c = settings_.configuration;
  const protocols::vehicle::LayoutEnds sent{name, settings_.source_address};
  std::vector<protocols::can::OwnedMessage> list;
  const auto append = [&]<class Message>(const Message& /*kind*/, std::uint16_t bit) {
    constexpr std::chrono::milliseconds kFastest{10};
    protocols::vehicle::Group group = Message::kGroup;
    if ((c.packet_mask & bit) != 0) {
      group.period = kFastest * c.rate_divider;
    }
    list.push_back(protocols::vehicle::layout<Message>(sent, group));
    list.back().text = "ACEINNA OpenIMU, J1939";
  };
  append(openimu::Slope{}, PacketBit::kSlope);
  append(openimu::AngularRate{}, PacketBit::kAngularRate);
  append(openimu::Acceleration{}, PacketBit::kAcceleration);
  if (is_300()) {
    append(openimu::MagneticField{}, PacketBit::kMagneticField);
  } else {
    append(openimu::Slope1{}, PacketBit::kSlope1);
    append(openimu::FineRate{}, PacketBit::kFineRate);
  }
  return list;
}

std::uint8_t OpenImu::merit(bool saturated) const {
  if (is_300()) {
    return FigureOfMerit::kNotAvailable;
  }
  if (latest_.fault) {
    return FigureOfMerit::kError;
  }
  return saturated ? FigureOfMerit::kDegraded : FigureOfMerit::kFunctional;
}

void OpenImu::put(double value, bool saturated, double limit, double& number,
                  std::uint8_t& figure) const {
  number = value;
  figure = merit(saturated);
  // The 335RI says "error" of a value that its message cannot carry, and sends the limit.
  if (!is_300() && std::isfinite(value) && std::abs(value) > limit) {
    number = std::clamp(value, -limit, limit);
    figure = FigureOfMerit::kError;
  }
}

double OpenImu::latency_ms() const {
  return is_300() ? 0.0 : to_seconds(settings_.processing_delay) * 1e3;
}

template <class Message>
void OpenImu::put_rates(Message& message) const {
  const openimu::AxisMap axes = openimu::rate_axes(configuration_.behaviour);
  const auto put_axis = [&](std::size_t axis, double& number, std::uint8_t& figure) {
    put(latest_.rate_radps[axis] * kDegrees, latest_.rate_saturated[axis],
        openimu::kRateRange_dps.upper, number, figure);
  };
  put_axis(axes[0].axis, message.pitch_dps, message.pitch_merit);
  put_axis(axes[1].axis, message.roll_dps, message.roll_merit);
  put_axis(axes[2].axis, message.yaw_dps, message.yaw_merit);
}

void OpenImu::send_slopes(SimTime now, std::uint16_t mask) {
  const bool doubtful =
      tilt_.initialising() || any(latest_.rate_saturated) || any(latest_.force_saturated);
  const double pitch_deg = latest_.fault ? no_number() : tilt_.pitch_rad() * kDegrees;
  const double roll_deg = latest_.fault ? no_number() : tilt_.roll_rad() * kDegrees;
  if ((mask & PacketBit::kSlope) != 0) {
    openimu::Slope slope;
    put(pitch_deg, doubtful, openimu::kSlopeRange_deg.upper, slope.pitch_deg, slope.pitch_merit);
    put(roll_deg, doubtful, openimu::kSlopeRange_deg.upper, slope.roll_deg, slope.roll_merit);
    slope.latency_ms = latency_ms();
    if (!openimu::pitch_first(configuration_.behaviour)) {
      std::swap(slope.pitch_deg, slope.roll_deg);
    }
    send(now, openimu::encode(slope, address_.address(), configuration_.slope_priority));
  }
  if ((mask & PacketBit::kSlope1) != 0) {
    constexpr double kLimit = openimu::kSlope1Range_deg.upper;
    openimu::Slope1 slope;
    put(pitch_deg, doubtful, kLimit, slope.pitch_deg, slope.pitch_merit);
    put(roll_deg, doubtful, kLimit, slope.roll_deg, slope.roll_merit);
    put(latest_.rate_radps[1] * kDegrees, latest_.rate_saturated[1], kLimit, slope.pitch_rate_dps,
        slope.pitch_rate_merit);
    slope.latency_ms = latency_ms();
    send(now, openimu::encode(slope, address_.address(), configuration_.slope_priority));
  }
}

std::uint16_t OpenImu::packets_due(SimTime now) {
  unsigned mask = configuration_.packet_mask;
  for (unsigned bit = 0; bit < 16; ++bit) {
    if ((mask >> bit & 1U) != 0 && !pace_.has_time(now, bit)) {
      mask &= ~(1U << bit);
    }
  }
  return static_cast<std::uint16_t>(mask);
}

void OpenImu::send_packets(SimTime now, std::uint16_t mask) {
  if ((configuration_.behaviour & openimu::Behaviour::kRunAlgorithm) != 0) {
    send_slopes(now, mask);
  }
  if ((mask & PacketBit::kAngularRate) != 0) {
    openimu::AngularRate rate;
    put_rates(rate);
    rate.latency_ms = latency_ms();
    send(now, openimu::encode(rate, address_.address(), configuration_.rate_priority));
  }
  if (!is_300() && (mask & PacketBit::kFineRate) != 0) {
    openimu::FineRate rate;
    put_rates(rate);
    send(now, openimu::encode(rate, address_.address(), configuration_.rate_priority,
                              pgn_of(configuration_.commands, openimu::Command::fine_rate)));
  }
  if ((mask & PacketBit::kAcceleration) != 0) {
    send_acceleration(now);
  }
  if (is_300() && (mask & PacketBit::kMagneticField) != 0) {
    const Triad& field = latest_.magnetic_field_gauss;
    send(now,
         openimu::encode(openimu::MagneticField{field[0], field[1], field[2]}, address_.address()));
  }
}

void OpenImu::send_acceleration(SimTime now) {
  const openimu::AxisMap axes = openimu::acceleration_axes(configuration_.behaviour);
  const Triad force = openimu::map_axes(axes, latest_.specific_force_mps2);
  const auto figure = [&](std::size_t i) { return merit(latest_.force_saturated[axes[i].axis]); };
  openimu::Acceleration acceleration{force[0], force[1], force[2], figure(0), figure(1), figure(2)};
  acceleration.latency_ms = latency_ms();
  send(now,
       openimu::encode(acceleration, address_.address(), configuration_.acceleration_priority));
}

void OpenImu::send_trouble(SimTime now) {
  if (!address_.held()) {
    return;
  }
  const TroubleCode& trouble = configuration_.trouble;
  std::array<std::uint8_t, 8> payload{};
  payload.fill(0xFF);
  payload[0] = trouble.lamps;
  payload[1] = trouble.flashing;
  protocols::store_little<std::uint16_t>(payload, 2,
                                         static_cast<std::uint16_t>(trouble.parameter & 0xFFFFU));
  payload[4] = static_cast<std::uint8_t>((trouble.second_failure & 0x1FU) |
                                         (((trouble.parameter >> 16U) & 7U) << 5U));
  payload[5] = troubles_;
  send(now, j1939::make_frame({openimu::kSettingsPriority, openimu::kActiveTroublePgn,
                               j1939::kGlobalAddress, address_.address()},
                              payload));
}

// The OpenIMU's ear: frames that reach it, and the requests that it answers.

void OpenImu::receive(SimTime now, const Frame& frame) {
  advance(now);
  if (frame.length > 8) {
    ++received_.malformed;
    return;
  }
  received_.bytes += frame.payload().size();
  const auto identifier = j1939::identify(frame);
  if (!identifier || !supply_.on()) {
    ++received_.ignored;
  } else if (identifier->pgn == j1939::kAddressClaimedPgn) {
    const auto name = j1939::decode_address_claim(frame);
    if (!name.ok()) {
      ++received_.malformed;
      return;
    }
    ++received_.accepted;
    address_.on_claim(now, identifier->source, *name);
  } else if (identifier->pgn == j1939::kRequestPgn) {
    receive_request(now, frame);
  } else if (is_bank(identifier->pgn)) {
    receive_bank(now, identifier->pgn, frame.payload());
  } else if (openimu::setting_kind(identifier->pgn, configuration_.commands)) {
    receive_setting(now, frame);
  } else if (!is_300() && identifier->pgn == openimu::kClearTroublePgn) {
    clear_trouble(now, identifier->source);
  } else if (!is_300() && is_aiding(identifier->pgn)) {
    ++(frame.length == 8 ? received_.accepted : received_.malformed);
    aiding_messages_ += frame.length == 8 ? 1U : 0U;
  } else {
    ++received_.ignored;
  }
}

void OpenImu::receive_request(SimTime now, const Frame& frame) {
  const auto request = j1939::decode_request(frame);
  if (!request.ok()) {
    ++received_.malformed;
    return;
  }
  const j1939::Identifier identifier = *j1939::identify(frame);
  const bool global = identifier.destination == j1939::kGlobalAddress;
  if (!address_.held() || (!global && identifier.destination != address_.address())) {
    ++received_.ignored;
    return;
  }
  std::uint32_t pgn = *request;
  if ((configuration_.behaviour & openimu::Behaviour::kSwapRequestPgn) == 0) {
    // Legacy order: page, PDU format, PDU specific.
    pgn = ((frame.data[0] & 3U) << 16U) | (static_cast<std::uint32_t>(frame.data[1]) << 8U) |
          frame.data[2];
  }
  ++(answer(now, pgn, identifier.source) ? received_.accepted : received_.ignored);
}

bool OpenImu::answer(SimTime now, std::uint32_t pgn, std::uint8_t requester) {
  if (pgn == j1939::kAddressClaimedPgn) {
    address_.on_request(now);
    return true;
  }
  if (pgn == openimu::kEcuIdentificationPgn || (is_300() && ((pgn >> 8U) & 0xFFU) == kEcuFormat)) {
    std::array<std::uint8_t, 8> payload{};
    protocols::store_little<std::uint64_t>(payload, 0, address_.name());
    send(now, j1939::make_frame({openimu::kSettingsPriority, openimu::kEcuIdentificationPgn,
                                 j1939::kGlobalAddress, address_.address()},
                                payload));
    return true;
  }
  if (pgn == openimu::kSoftwareVersionPgn) {
    send(now, j1939::make_frame(
                  {openimu::kSettingsPriority, pgn, j1939::kGlobalAddress, address_.address()},
                  settings_.software_version));
    return true;
  }
  return answer_data(now, pgn) || answer_status(now, pgn) || answer_setting(now, pgn, requester);
}

// Sends the data message that a request names, if the variant has it. Returns false for other
// groups.
bool OpenImu::answer_data(SimTime now, std::uint32_t pgn) {
  using Bit = openimu::PacketBit;
  std::uint16_t packet = 0;
  switch (pgn) {
    case openimu::kSlopePgn:
      packet = Bit::kSlope;
      break;
    case openimu::kAngularRatePgn:
      packet = Bit::kAngularRate;
      break;
    case openimu::kAccelerationPgn:
      packet = Bit::kAcceleration;
      break;
    case openimu::kSlope1Pgn:
      packet = Bit::kSlope1;
      break;
    case openimu::kMagneticRequestPgn:
    case openimu::kMagneticFieldPgn:
      packet = is_300() ? Bit::kMagneticField : std::uint16_t{0};
      break;
    default:
      if (!is_300() && pgn == pgn_of(configuration_.commands, Command::fine_rate)) {
        packet = Bit::kFineRate;
      }
  }
  packet &= packets_of(settings_.variant);
  if (packet != 0) {
    send_packets(now, packet);
  }
  return packet != 0;
}

bool OpenImu::answer_status(SimTime now, std::uint32_t pgn) {
  const auto command = openimu::command_of(configuration_.commands, pgn);
  std::array<std::uint8_t, 4> payload{};
  std::size_t length = 2;
  if (command == Command::master_status) {
    // The 335RI adds the checksum of its application, which is not there.
    protocols::store_little<std::uint16_t>(payload, 0, status_word());
    length = is_300() ? 2 : 4;
  } else if (command == Command::hardware_status && !is_300()) {
    payload[0] = memory_damaged_ ? 1 : 0;
  } else if (command == Command::software_status && !is_300()) {
    length = 4;
  } else {
    return false;
  }
  send(now, j1939::make_frame(
                {openimu::kSettingsPriority, pgn, j1939::kGlobalAddress, address_.address()},
                std::span(payload).first(length)));
  return true;
}

// Sends the present value of the setting that a request names, in the form of the variant's
// firmware (protocols/openimu/settings.h). Returns false for other groups.
bool OpenImu::answer_setting(SimTime now, std::uint32_t pgn, std::uint8_t requester) {
  const auto kind = openimu::setting_kind(pgn, configuration_.commands);
  if (!kind) {
    return false;
  }
  const OpenImuConfiguration& c = configuration_;
  openimu::Setting setting;
  setting.kind = *kind;
  switch (*kind) {
    case Command::packet_rate:
      setting.first = c.rate_divider;
      break;
    case Command::packet_mask:
      setting.word = c.packet_mask;
      setting.first = static_cast<std::uint8_t>(c.rate_priority | (c.acceleration_priority << 2U) |
                                                (c.slope_priority << 4U));
      break;
    case Command::filters:
      setting.first = c.rate_cut_off_hz;
      setting.second = c.acceleration_cut_off_hz;
      break;
    case Command::orientation:
      setting.word = c.orientation;
      break;
    case Command::behaviour:
      setting.word = c.behaviour;
      break;
    case Command::trouble_code:
      if (is_300()) {
        return false;
      }
      setting.more = {c.trouble.lamps,
                      c.trouble.flashing,
                      static_cast<std::uint8_t>(c.trouble.parameter & 0xFFU),
                      static_cast<std::uint8_t>((c.trouble.parameter >> 8U) & 0xFFU),
                      static_cast<std::uint8_t>(c.trouble.parameter >> 16U),
                      c.trouble.first_failure,
                      c.trouble.second_failure};
      break;
    default:
      return false;
  }
  send(now, is_300() ? openimu::make_setting_answer_300(setting, address_.address(), c.commands)
                     : openimu::make_setting_answer_335(setting, address_.address(), requester,
                                                        c.commands));
  return true;
}

void OpenImu::clear_trouble(SimTime now, std::uint8_t requester) {
  if (!address_.held()) {
    ++received_.ignored;
    return;
  }
  const bool refused = refusal_.holds(now);
  ++(refused ? received_.ignored : received_.accepted);
  troubles_ = refused ? troubles_ : std::uint8_t{0};
  // Aceinna's order is the standard's, with group function 0, sent to everybody.
  const j1939::Acknowledgement done{
      refused ? j1939::Acknowledge::negative : j1939::Acknowledge::positive, 0, requester,
      openimu::kClearTroublePgn};
  send(now, j1939::make_acknowledgement(address_.address(), j1939::kGlobalAddress, done));
}

// What a client sets in an OpenIMU, and what it makes it do.

void OpenImu::receive_setting(SimTime now, const Frame& frame) {
  const auto setting = openimu::decode_setting(frame, configuration_.commands);
  if (!setting.ok()) {
    ++received_.malformed;
    return;
  }
  const bool meant = address_.held() && setting->address == address_.address();
  const bool taken = meant && apply(now, *setting, j1939::identify(frame)->source);
  ++(taken ? received_.accepted : received_.ignored);
}

void OpenImu::receive_bank(SimTime now, std::uint32_t pgn, std::span<const std::uint8_t> payload) {
  constexpr std::size_t kBankBytes = 8;
  if (payload.size() != kBankBytes) {
    ++received_.malformed;
    return;
  }
  const bool meant = address_.held() && payload[0] == address_.address();
  const bool taken =
      meant && !refusal_.holds(now) &&
      openimu::apply_bank(configuration_.commands, pgn, payload.subspan(1), is_300());
  ++(taken ? received_.accepted : received_.ignored);
}

std::string_view OpenImu::tell(SimTime now, const openimu::Setting& setting) {
  advance(now);
  if (!address_.held()) {
    return "it has no supply, or no address yet";
  }
  return apply(now, setting, address_.address()) ? "" : "it refuses the parameter group";
}

std::span<const LiveSetting<OpenImu, OpenImuSettings>> OpenImu::live_settings() {
  using Row = LiveSetting<OpenImu, OpenImuSettings>;
  using Settings = OpenImuSettings;
  static constexpr std::array<Row, 5> kRows{{
      {"rate", "packet rate (FF55)",
       [](OpenImu& imu, SimTime now, const Settings& wanted) {
         return imu.tell(
             now, {.kind = Command::packet_rate, .first = wanted.configuration.rate_divider});
       }},
      {"packets", "packet types (FF56)",
       [](OpenImu& imu, SimTime now, const Settings& wanted) {
         return imu.tell(now,
                         {.kind = Command::packet_mask, .word = wanted.configuration.packet_mask});
       }},
      {"rate_filter", "digital filters (FF57)",
       [](OpenImu& imu, SimTime now, const Settings& wanted) {
         return imu.tell(now, {.kind = Command::filters,
                               .first = wanted.configuration.rate_cut_off_hz,
                               .second = imu.configuration_.acceleration_cut_off_hz});
       }},
      {"acceleration_filter", "digital filters (FF57)",
       [](OpenImu& imu, SimTime now, const Settings& wanted) {
         return imu.tell(now, {.kind = Command::filters,
                               .first = imu.configuration_.rate_cut_off_hz,
                               .second = wanted.configuration.acceleration_cut_off_hz});
       }},
      {"orientation", "orientation (FF58)",
       [](OpenImu& imu, SimTime now, const Settings& wanted) {
         return imu.tell(now,
                         {.kind = Command::orientation, .word = wanted.configuration.orientation});
       }},
  }};
  return kRows;
}

bool OpenImu::apply(SimTime now, const openimu::Setting& setting, std::uint8_t requester) {
  if (refusal_.holds(now)) {
    if (setting.kind == Command::reset_algorithm || setting.kind == Command::save_configuration) {
      send(now, openimu::make_outcome(setting.kind, address_.address(), requester, false,
                                      configuration_.commands));
    }
    return false;
  }
  switch (setting.kind) {
    case Command::reset_algorithm:
    case Command::save_configuration:
      return apply_command(now, setting, requester);
    case Command::packet_rate:
      if (!openimu::is_rate_divider(setting.first)) {
        return false;
      }
      configuration_.rate_divider = setting.first;
      return true;
    case Command::packet_mask:
      configuration_.packet_mask =
          static_cast<std::uint16_t>(setting.word & packets_of(settings_.variant));
      if (!is_300()) {
        apply_priorities(setting);
      }
      return true;
    case Command::filters:
      if (!openimu::is_cut_off(setting.first) || !openimu::is_cut_off(setting.second)) {
        return false;
      }
      configuration_.rate_cut_off_hz = setting.first;
      configuration_.acceleration_cut_off_hz = setting.second;
      rebuild_filters();
      return true;
    case Command::orientation:
      if (!openimu::orientation_axes(setting.word)) {
        return false;
      }
      configuration_.orientation = setting.word;
      rebuild_filters();
      tilt_.reset();
      return true;
    case Command::behaviour:
      apply_behaviour(setting);
      return true;
    case Command::trouble_code:
      if (is_300()) {
        return false;
      }
      configuration_.trouble = {setting.more[0], setting.more[1],
                                (setting.more[2] | (std::uint32_t{setting.more[3]} << 8U) |
                                 (std::uint32_t{setting.more[4]} << 16U)) &
                                    0x7FFFFU,
                                setting.more[5], setting.more[6]};
      return true;
    case Command::magnetic_alignment:
      if (!is_300()) {
        return false;
      }
      // No alignment takes place: always idle, nothing estimated.
      send(now, openimu::make_alignment_answer({.command = setting.first}, address_.address(),
                                               configuration_.commands));
      return true;
    default:
      return false;
  }
}

bool OpenImu::apply_command(SimTime now, const openimu::Setting& setting, std::uint8_t requester) {
  const bool restarts = setting.first != 0;
  if (restarts && is_300()) {
    return false;
  }
  bool done = true;
  if (setting.kind == Command::reset_algorithm) {
    tilt_.reset();
  } else {
    saved_.configuration = configuration_;
    saved_.address = new_address_.value_or(saved_.address);
    done = remember();
  }
  send(now, openimu::make_outcome(setting.kind, address_.address(), requester, done,
                                  configuration_.commands));
  if (restarts) {
    restart_ = now + kRestartDelay;
  }
  return true;
}

void OpenImu::apply_priorities(const openimu::Setting& setting) {
  const auto take = [&setting](std::uint8_t& priority, unsigned position) {
    constexpr unsigned kMeant = 3;
    if (((setting.second >> position) & kMeant) == kMeant) {
      priority = static_cast<std::uint8_t>((setting.first >> position) & 3U);
    }
  };
  take(configuration_.rate_priority, 0);
  take(configuration_.acceleration_priority, 2);
  take(configuration_.slope_priority, 4);
}

void OpenImu::apply_behaviour(const openimu::Setting& setting) {
  unsigned word = setting.word;
  if (!is_300()) {
    const unsigned cleared = setting.more[0] | (static_cast<unsigned>(setting.more[1]) << 8U);
    word = (configuration_.behaviour | setting.word) & ~cleared;
    const std::uint8_t address = setting.more[2];
    if (address >= kFirstArbitraryAddress && address <= kLastArbitraryAddress) {
      new_address_ = address;
    }
  }
  configuration_.behaviour = static_cast<std::uint16_t>(
      (word & kChangeableBehaviour) | (openimu::Behaviour::kDefault & ~kChangeableBehaviour));
}

}  // namespace rigwire::emulators

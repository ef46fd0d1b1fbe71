// The OpenIMU's data messages, and its trouble codes.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "emulators/openimu/openimu335ri.h"
#include "protocols/bytes.h"
#include "protocols/j1939/message.h"
#include "protocols/vehicle/layouts.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
using openimu::FigureOfMerit;
using openimu::PacketBit;

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

bool any(const std::array<bool, 3>& flags) {
  return flags[0] || flags[1] || flags[2];
}

}  // namespace

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

}  // namespace rigwire::emulators

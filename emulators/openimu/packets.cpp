// The OpenIMU's data messages, and its trouble codes.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "emulators/openimu/openimu335ri.h"
#include "protocols/bytes.h"
#include "protocols/j1939/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
using openimu::FigureOfMerit;
using openimu::Measurement;
using openimu::PacketBit;

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

bool any(const std::array<bool, 3>& flags) {
  return flags[0] || flags[1] || flags[2];
}

/// The 335RI says "error" of a value that its message cannot carry, and sends the limit.
Measurement limited(Measurement measurement, double limit) {
  if (measurement.merit != FigureOfMerit::not_available && std::abs(measurement.value) > limit) {
    measurement = {std::clamp(measurement.value, -limit, limit), FigureOfMerit::error};
  }
  return measurement;
}

}  // namespace

std::vector<protocols::can::MessageLayout> OpenImu::messages(std::string_view name) const {
  struct Kind {
    std::uint32_t pgn;
    std::uint16_t of_300;  ///< Its bit in the packet mask; 0: not sent.
    std::uint16_t of_335;
  };
  constexpr std::array<Kind, 6> kKinds{
      {{openimu::kSlopePgn, PacketBit::kSlope, PacketBit::kSlope},
       {openimu::kAngularRatePgn, PacketBit::kAngularRate, PacketBit::kAngularRate},
       {openimu::kAccelerationPgn, PacketBit::kAcceleration, PacketBit::kAcceleration},
       {openimu::kMagneticFieldPgn, PacketBit::kMagneticField, 0},
       {openimu::kSlope1Pgn, 0, PacketBit::kSlope1},
       {openimu::kFineRatePgn, 0, PacketBit::kFineRate}}};
  constexpr std::uint32_t kFastest_ms = 10;
  std::vector<protocols::can::MessageLayout> list;
  for (auto& layout : openimu::layouts(settings_.source_address)) {
    const std::uint32_t pgn = j1939::unpack(layout.id).pgn;
    const auto* kind =
        std::find_if(kKinds.begin(), kKinds.end(), [pgn](const Kind& k) { return k.pgn == pgn; });
    const std::uint16_t bit = is_300() ? kind->of_300 : kind->of_335;
    if (bit != 0) {
      layout.sender = name;
      if ((settings_.configuration.packet_mask & bit) != 0) {
        layout.period_ms = kFastest_ms * settings_.configuration.rate_divider;
      }
      list.push_back(std::move(layout));
    }
  }
  return list;
}

FigureOfMerit OpenImu::merit(bool saturated) const {
  if (is_300()) {
    return FigureOfMerit::not_available;
  }
  if (latest_.fault) {
    return FigureOfMerit::error;
  }
  return saturated ? FigureOfMerit::degraded : FigureOfMerit::functional;
}

double OpenImu::latency_ms() const {
  return is_300() ? 0.0 : to_seconds(settings_.processing_delay) * 1e3;
}

Measurement OpenImu::rate_measurement(std::size_t axis) const {
  return limited({latest_.rate_radps[axis] * kDegrees, merit(latest_.rate_saturated[axis])},
                 openimu::kRateLimit_dps);
}

void OpenImu::send_packets(SimTime now, std::uint16_t mask) {
  const bool algorithm = (configuration_.behaviour & openimu::Behaviour::kRunAlgorithm) != 0;
  if ((mask & (PacketBit::kSlope | PacketBit::kSlope1)) != 0 && algorithm) {
    const FigureOfMerit state =
        merit(tilt_.initialising() || any(latest_.rate_saturated) || any(latest_.force_saturated));
    const Measurement pitch{latest_.fault ? kUnknown : tilt_.pitch_rad() * kDegrees, state};
    const Measurement roll{latest_.fault ? kUnknown : tilt_.roll_rad() * kDegrees, state};
    if ((mask & PacketBit::kSlope) != 0) {
      openimu::Slope slope{pitch, roll, 0, 0, latency_ms()};
      if (!openimu::pitch_first(configuration_.behaviour)) {
        std::swap(slope.pitch_deg, slope.roll_deg);
      }
      send(now, openimu::encode(slope, address_.address(), configuration_.slope_priority));
    }
    if ((mask & PacketBit::kSlope1) != 0) {
      const Measurement rate{latest_.rate_radps[1] * kDegrees, merit(latest_.rate_saturated[1])};
      send(now, openimu::encode(
                    openimu::Slope1{limited(pitch, openimu::kSlope1Limit_deg),
                                    limited(roll, openimu::kSlope1Limit_deg),
                                    limited(rate, openimu::kSlope1Limit_deg), 0, latency_ms()},
                    address_.address(), configuration_.slope_priority));
    }
  }
  if ((mask & PacketBit::kAngularRate) != 0) {
    send_rate(now);
  }
  if (!is_300() && (mask & PacketBit::kFineRate) != 0) {
    const openimu::AxisMap axes = openimu::rate_axes(configuration_.behaviour);
    send(now, openimu::encode(
                  openimu::FineRate{rate_measurement(axes[0].axis), rate_measurement(axes[1].axis),
                                    rate_measurement(axes[2].axis)},
                  address_.address(), configuration_.rate_priority,
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

void OpenImu::send_rate(SimTime now) {
  const openimu::AxisMap axes = openimu::rate_axes(configuration_.behaviour);
  send(now, openimu::encode(
                openimu::AngularRate{rate_measurement(axes[0].axis), rate_measurement(axes[1].axis),
                                     rate_measurement(axes[2].axis), latency_ms()},
                address_.address(), configuration_.rate_priority));
}

void OpenImu::send_acceleration(SimTime now) {
  const openimu::AxisMap axes = openimu::acceleration_axes(configuration_.behaviour);
  const Triad force = openimu::map_axes(axes, latest_.specific_force_mps2);
  const auto measurement = [&](std::size_t i) {
    return Measurement{force[i], merit(latest_.force_saturated[axes[i].axis])};
  };
  send(now, openimu::encode(
                openimu::Acceleration{measurement(0), measurement(1), measurement(2), latency_ms()},
                address_.address(), configuration_.acceleration_priority));
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

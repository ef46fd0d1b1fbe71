#include "protocols/openimu/messages.h"

#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "protocols/j1939/message.h"

namespace rigwire::protocols::openimu {
namespace {

using j1939::Field;

constexpr std::size_t kMessageBytes = 8;
constexpr std::uint32_t kVariableRepetitionRate = 2;  // as both firmwares send it

constexpr Field two_bits(std::string_view name, std::uint8_t bit) {
  return {name, 0, bit, 2, 1.0, 0.0, 0.0, 1.0, ""};
}
constexpr std::array<Field, 2> kSlopeCompensation{
    {two_bits("pitch compensation", 48), two_bits("roll compensation", 52)}};
constexpr std::array<Field, 2> kSlopeMerit{
    {two_bits("pitch figure of merit", 50), two_bits("roll figure of merit", 54)}};
constexpr std::array<Field, 3> kTriadMerit{
    {two_bits("merit 1", 48), two_bits("merit 2", 50), two_bits("merit 3", 52)}};
constexpr Field kRepetitionRate = two_bits("support variable repetition rate", 54);

constexpr bool well_formed(std::span<const Field> fields) {
  for (const Field& field : fields) {
    if (!j1939::is_well_formed(field)) {
      return false;
    }
  }
  return true;
}
static_assert(well_formed(kSlopeFields) && well_formed(kRateFields) &&
              well_formed(kAccelerationFields) && j1939::is_well_formed(kLatencyField));

using Payload = std::array<std::uint8_t, kMessageBytes>;

void put(Payload& payload, const Field& field, const Field& merit, const Measurement& measurement) {
  if (measurement.merit == FigureOfMerit::error) {
    j1939::put_raw(field, payload, j1939::error_value(field.width));
  } else {
    j1939::encode(field, payload, measurement.value);
  }
  j1939::put_raw(merit, payload, static_cast<std::uint32_t>(measurement.merit));
}

Measurement get(std::span<const std::uint8_t> payload, const Field& field, const Field& merit) {
  const j1939::Reading reading = j1939::decode(field, payload);
  return {reading.valid() ? reading.value : std::numeric_limits<double>::quiet_NaN(),
          static_cast<FigureOfMerit>(j1939::get_raw(merit, payload))};
}

double get_latency(std::span<const std::uint8_t> payload) {
  const j1939::Reading reading = j1939::decode(kLatencyField, payload);
  return reading.valid() ? reading.value : std::numeric_limits<double>::quiet_NaN();
}

can::Frame finish(std::uint8_t priority, std::uint32_t pgn, std::uint8_t source,
                  const Payload& payload) {
  return j1939::make_frame({priority, pgn, j1939::kGlobalAddress, source}, payload);
}

std::optional<Malformed> refuse(const can::Frame& frame, std::uint32_t pgn) {
  const auto identifier = j1939::identify(frame);
  if (!identifier || identifier->pgn != pgn) {
    return Malformed{"another parameter group, or no 29-bit data frame", 0};
  }
  if (frame.length != kMessageBytes) {
    return Malformed{"the message has exactly 8 bytes", frame.length};
  }
  return std::nullopt;
}

}  // namespace

can::Frame encode(const Slope& slope, std::uint8_t source) {
  Payload payload{};
  put(payload, kSlopeFields[0], kSlopeMerit[0], slope.pitch_deg);
  put(payload, kSlopeFields[1], kSlopeMerit[1], slope.roll_deg);
  j1939::put_raw(kSlopeCompensation[0], payload, slope.pitch_compensation);
  j1939::put_raw(kSlopeCompensation[1], payload, slope.roll_compensation);
  j1939::encode(kLatencyField, payload, slope.latency_ms);
  return finish(kSlopePriority, kSlopePgn, source, payload);
}

can::Frame encode(const AngularRate& rate, std::uint8_t source) {
  Payload payload{};
  put(payload, kRateFields[0], kTriadMerit[0], rate.pitch_dps);
  put(payload, kRateFields[1], kTriadMerit[1], rate.roll_dps);
  put(payload, kRateFields[2], kTriadMerit[2], rate.yaw_dps);
  j1939::encode(kLatencyField, payload, rate.latency_ms);
  return finish(kAngularRatePriority, kAngularRatePgn, source, payload);
}

can::Frame encode(const Acceleration& acceleration, std::uint8_t source) {
  Payload payload{};
  put(payload, kAccelerationFields[0], kTriadMerit[0], acceleration.lateral_mps2);
  put(payload, kAccelerationFields[1], kTriadMerit[1], acceleration.longitudinal_mps2);
  put(payload, kAccelerationFields[2], kTriadMerit[2], acceleration.vertical_mps2);
  j1939::put_raw(kRepetitionRate, payload, kVariableRepetitionRate);
  j1939::encode(kLatencyField, payload, acceleration.latency_ms);
  return finish(kAccelerationPriority, kAccelerationPgn, source, payload);
}

Decoded<Slope> decode_slope(const can::Frame& frame) {
  if (const auto refusal = refuse(frame, kSlopePgn)) {
    return *refusal;
  }
  const auto payload = frame.payload();
  Slope slope;
  slope.pitch_deg = get(payload, kSlopeFields[0], kSlopeMerit[0]);
  slope.roll_deg = get(payload, kSlopeFields[1], kSlopeMerit[1]);
  slope.pitch_compensation =
      static_cast<std::uint8_t>(j1939::get_raw(kSlopeCompensation[0], payload));
  slope.roll_compensation =
      static_cast<std::uint8_t>(j1939::get_raw(kSlopeCompensation[1], payload));
  slope.latency_ms = get_latency(payload);
  return {slope, kMessageBytes};
}

Decoded<AngularRate> decode_angular_rate(const can::Frame& frame) {
  if (const auto refusal = refuse(frame, kAngularRatePgn)) {
    return *refusal;
  }
  const auto payload = frame.payload();
  return {AngularRate{get(payload, kRateFields[0], kTriadMerit[0]),
                      get(payload, kRateFields[1], kTriadMerit[1]),
                      get(payload, kRateFields[2], kTriadMerit[2]), get_latency(payload)},
          kMessageBytes};
}

Decoded<Acceleration> decode_acceleration(const can::Frame& frame) {
  if (const auto refusal = refuse(frame, kAccelerationPgn)) {
    return *refusal;
  }
  const auto payload = frame.payload();
  return {Acceleration{get(payload, kAccelerationFields[0], kTriadMerit[0]),
                       get(payload, kAccelerationFields[1], kTriadMerit[1]),
                       get(payload, kAccelerationFields[2], kTriadMerit[2]), get_latency(payload)},
          kMessageBytes};
}

}  // namespace rigwire::protocols::openimu

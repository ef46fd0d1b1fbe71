#include "protocols/openimu/messages.h"

#include <algorithm>
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
constexpr std::array<Field, 3> kFineMerit{
    {two_bits("merit 1", 57), two_bits("merit 2", 59), two_bits("merit 3", 61)}};
constexpr Field kSlope1Compensation = two_bits("compensation", 54);
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
              well_formed(kAccelerationFields) && well_formed(kMagneticFields) &&
              well_formed(kSlope1Fields) && j1939::is_well_formed(kLatencyField));

using Payload = std::array<std::uint8_t, kMessageBytes>;

void put(Payload& payload, const Field& field, const Field& merit, const Measurement& measurement) {
  if (std::isnan(measurement.value) && measurement.merit == FigureOfMerit::error) {
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

can::Frame encode(const Slope& slope, std::uint8_t source, std::uint8_t priority) {
  Payload payload{};
  put(payload, kSlopeFields[0], kSlopeMerit[0], slope.pitch_deg);
  put(payload, kSlopeFields[1], kSlopeMerit[1], slope.roll_deg);
  j1939::put_raw(kSlopeCompensation[0], payload, slope.pitch_compensation);
  j1939::put_raw(kSlopeCompensation[1], payload, slope.roll_compensation);
  j1939::encode(kLatencyField, payload, slope.latency_ms);
  return finish(priority, kSlopePgn, source, payload);
}

can::Frame encode(const AngularRate& rate, std::uint8_t source, std::uint8_t priority) {
  Payload payload{};
  put(payload, kRateFields[0], kTriadMerit[0], rate.pitch_dps);
  put(payload, kRateFields[1], kTriadMerit[1], rate.roll_dps);
  put(payload, kRateFields[2], kTriadMerit[2], rate.yaw_dps);
  j1939::encode(kLatencyField, payload, rate.latency_ms);
  return finish(priority, kAngularRatePgn, source, payload);
}

can::Frame encode(const Acceleration& acceleration, std::uint8_t source, std::uint8_t priority) {
  Payload payload{};
  put(payload, kAccelerationFields[0], kTriadMerit[0], acceleration.lateral_mps2);
  put(payload, kAccelerationFields[1], kTriadMerit[1], acceleration.longitudinal_mps2);
  put(payload, kAccelerationFields[2], kTriadMerit[2], acceleration.vertical_mps2);
  j1939::put_raw(kRepetitionRate, payload, kVariableRepetitionRate);
  j1939::encode(kLatencyField, payload, acceleration.latency_ms);
  return finish(priority, kAccelerationPgn, source, payload);
}

can::Frame encode(const MagneticField& field, std::uint8_t source) {
  Payload payload{};
  j1939::encode(kMagneticFields[0], payload, field.x_gauss);
  j1939::encode(kMagneticFields[1], payload, field.y_gauss);
  j1939::encode(kMagneticFields[2], payload, field.z_gauss);
  return finish(kMagneticFieldPriority, kMagneticFieldPgn, source, payload);
}

can::Frame encode(const Slope1& slope, std::uint8_t source, std::uint8_t priority) {
  Payload payload{};
  put(payload, kSlope1Fields[0], kTriadMerit[0], slope.pitch_deg);
  put(payload, kSlope1Fields[1], kTriadMerit[1], slope.roll_deg);
  put(payload, kSlope1Fields[2], kTriadMerit[2], slope.pitch_rate_dps);
  j1939::put_raw(kSlope1Compensation, payload, slope.compensation);
  j1939::encode(kLatencyField, payload, slope.latency_ms);
  return finish(priority, kSlope1Pgn, source, payload);
}

can::Frame encode(const FineRate& rate, std::uint8_t source, std::uint8_t priority,
                  std::uint32_t pgn) {
  Payload payload{};
  put(payload, kFineRateFields[0], kFineMerit[0], rate.pitch_dps);
  put(payload, kFineRateFields[1], kFineMerit[1], rate.roll_dps);
  put(payload, kFineRateFields[2], kFineMerit[2], rate.yaw_dps);
  return finish(priority, pgn, source, payload);
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

Decoded<MagneticField> decode_magnetic_field(const can::Frame& frame) {
  if (const auto refusal = refuse(frame, kMagneticFieldPgn)) {
    return *refusal;
  }
  const auto value = [&](std::size_t i) {
    const j1939::Reading reading = j1939::decode(kMagneticFields[i], frame.payload());
    return reading.valid() ? reading.value : std::numeric_limits<double>::quiet_NaN();
  };
  return {MagneticField{value(0), value(1), value(2)}, kMessageBytes};
}

Decoded<Slope1> decode_slope1(const can::Frame& frame) {
  if (const auto refusal = refuse(frame, kSlope1Pgn)) {
    return *refusal;
  }
  const auto payload = frame.payload();
  return {Slope1{get(payload, kSlope1Fields[0], kTriadMerit[0]),
                 get(payload, kSlope1Fields[1], kTriadMerit[1]),
                 get(payload, kSlope1Fields[2], kTriadMerit[2]),
                 static_cast<std::uint8_t>(j1939::get_raw(kSlope1Compensation, payload)),
                 get_latency(payload)},
          kMessageBytes};
}

Decoded<FineRate> decode_fine_rate(const can::Frame& frame, std::uint32_t pgn) {
  if (const auto refusal = refuse(frame, pgn)) {
    return *refusal;
  }
  const auto payload = frame.payload();
  return {FineRate{get(payload, kFineRateFields[0], kFineMerit[0]),
                   get(payload, kFineRateFields[1], kFineMerit[1]),
                   get(payload, kFineRateFields[2], kFineMerit[2])},
          kMessageBytes};
}

std::vector<can::MessageLayout> layouts(std::uint8_t source) {
  using Fields = std::span<const Field>;
  struct Row {
    const char* name;
    std::uint8_t priority;
    std::uint32_t pgn;
    std::array<Fields, 3> fields;
    bool latency;
  };
  const std::array<Row, 6> rows{{
      {"slope_sensor_2",
       kSlopePriority,
       kSlopePgn,
       {kSlopeFields, kSlopeCompensation, kSlopeMerit},
       true},
      {"angular_rate", kAngularRatePriority, kAngularRatePgn, {kRateFields, kTriadMerit}, true},
      {"acceleration",
       kAccelerationPriority,
       kAccelerationPgn,
       {kAccelerationFields, kTriadMerit, Fields(&kRepetitionRate, 1)},
       true},
      {"magnetic_field", kMagneticFieldPriority, kMagneticFieldPgn, {kMagneticFields}, false},
      {"slope_sensor_1",
       kSlopePriority,
       kSlope1Pgn,
       {kSlope1Fields, kTriadMerit, Fields(&kSlope1Compensation, 1)},
       true},
      {"fine_angular_rate",
       kAngularRatePriority,
       kFineRatePgn,
       {kFineRateFields, kFineMerit},
       false},
  }};
  std::vector<can::MessageLayout> list;
  for (const Row& row : rows) {
    can::MessageLayout message;
    message.name = row.name;
    message.id =
        j1939::pack(j1939::Identifier{row.priority, row.pgn, j1939::kGlobalAddress, source});
    message.extended = message.j1939 = true;
    message.text = "ACEINNA OpenIMU, J1939";
    const auto append = [&message](const Field& field) {
      can::SignalLayout signal;
      signal.name = field.name;
      std::replace(signal.name.begin(), signal.name.end(), ' ', '_');
      signal.bit = field.bit;
      signal.width = field.width;
      signal.scale = field.scale;
      signal.offset = field.offset;
      signal.lower = field.lower;
      signal.upper = field.width == 2 ? 3.0 : field.upper;
      signal.unit = field.unit;
      if (field.name.starts_with("merit") || field.name.ends_with("merit")) {
        signal.values = {{0, "functional"}, {1, "degraded"}, {2, "error"}, {3, "not available"}};
      }
      message.fields.push_back(std::move(signal));
    };
    for (const Fields fields : row.fields) {
      std::for_each(fields.begin(), fields.end(), append);
    }
    if (row.latency) {
      append(kLatencyField);
    }
    list.push_back(std::move(message));
  }
  return list;
}

}  // namespace rigwire::protocols::openimu

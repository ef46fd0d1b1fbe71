#include "protocols/xsens/messages.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

namespace rigwire::protocols::xsens {
namespace {

constexpr double power_of_two(int exponent) {
  double value = 1.0;
  for (int i = 0; i < exponent; ++i) {
    value /= 2.0;
  }
  return value;
}

constexpr Field number(std::string_view name, std::uint8_t byte, std::uint8_t bytes,
                       double scale = 1.0, std::string_view unit = "") {
  return {name, byte, bytes, false, scale, unit};
}
constexpr Field fraction(std::string_view name, std::uint8_t byte, double scale,
                         std::string_view unit = "", std::uint8_t bytes = 2) {
  return {name, byte, bytes, true, scale, unit};
}
constexpr std::array<Field, 3> triad(double scale, std::string_view unit) {
  return {{fraction("x", 0, scale, unit), fraction("y", 2, scale, unit),
           fraction("z", 4, scale, unit)}};
}
constexpr std::array<Field, 4> quaternion() {
  constexpr double kScale = 1.0 / 32767.0;
  return {{fraction("q0", 0, kScale), fraction("q1", 2, kScale), fraction("q2", 4, kScale),
           fraction("q3", 6, kScale)}};
}

constexpr std::array kError{number("error_code", 0, 1)};
constexpr std::array kWarning{number("warning_code", 0, 1)};
constexpr std::array kSampleTime{number("timestamp", 0, 4)};
constexpr std::array kGroupCounter{number("counter", 0, 2)};
constexpr std::array kUtc{number("year", 0, 1, 1.0, "a"),
                          number("month", 1, 1),
                          number("day", 2, 1),
                          number("hour", 3, 1, 1.0, "h"),
                          number("minute", 4, 1, 1.0, "min"),
                          number("second", 5, 1, 1.0, "s"),
                          number("fraction", 6, 2, 1e-4, "s")};
constexpr std::array kStatusWord{number("status", 0, 4)};
constexpr std::array<Field, 4> kQuaternion = quaternion();
constexpr std::array kEulerAngles{fraction("roll", 0, power_of_two(7), "deg"),
                                  fraction("pitch", 2, power_of_two(7), "deg"),
                                  fraction("yaw", 4, power_of_two(7), "deg")};
constexpr std::array kVelocityIncrement{fraction("x", 0, 1.0), fraction("y", 2, 1.0),
                                        fraction("z", 4, 1.0), number("exponent", 6, 1)};
constexpr std::array<Field, 3> kRate = triad(power_of_two(9), "rad/s");
constexpr std::array<Field, 3> kAcceleration = triad(power_of_two(8), "m/s2");
constexpr std::array<Field, 3> kMagneticField = triad(power_of_two(10), "");
constexpr std::array kTemperature{fraction("temperature", 0, power_of_two(8), "degC")};
constexpr std::array kPressure{number("pressure", 0, 4, power_of_two(15), "Pa")};
constexpr std::array kLatitudeLongitude{fraction("latitude", 0, power_of_two(24), "deg", 4),
                                        fraction("longitude", 4, power_of_two(23), "deg", 4)};
constexpr std::array kAltitude{fraction("altitude", 0, power_of_two(15), "m", 4)};
constexpr std::array kPosition{fraction("position", 0, power_of_two(8), "m", 4)};
constexpr std::array<Field, 3> kVelocity = triad(power_of_two(6), "m/s");
constexpr std::array kReceiverStatus{number("fix_type", 0, 1), number("satellites", 1, 1),
                                     number("flags", 2, 1), number("valid", 3, 1),
                                     number("satellites_seen", 4, 1)};
constexpr std::array kReceiverDilution{
    number("position_dilution", 0, 2, 0.01), number("time_dilution", 2, 2, 0.01),
    number("vertical_dilution", 4, 2, 0.01), number("horizontal_dilution", 6, 2, 0.01)};

constexpr std::array<Message, 26> kMessages{{
    {MessageId::error, "error", 1, kError},
    {MessageId::warning, "warning", 1, kWarning},
    {MessageId::sample_time, "sample_time", 4, kSampleTime},
    {MessageId::group_counter, "group_counter", 2, kGroupCounter},
    {MessageId::utc, "utc", 8, kUtc},
    {MessageId::status_word, "status_word", 4, kStatusWord},
    {MessageId::quaternion, "quaternion", 8, kQuaternion},
    {MessageId::euler_angles, "euler_angles", 6, kEulerAngles},
    {MessageId::velocity_increment, "velocity_increment", 7, kVelocityIncrement},
    {MessageId::rate_of_turn, "rate_of_turn", 6, kRate},
    {MessageId::orientation_increment, "orientation_increment", 8, kQuaternion},
    {MessageId::acceleration, "acceleration", 6, kAcceleration},
    {MessageId::free_acceleration, "free_acceleration", 6, kAcceleration},
    {MessageId::magnetic_field, "magnetic_field", 6, kMagneticField},
    {MessageId::temperature, "temperature", 2, kTemperature},
    {MessageId::pressure, "pressure", 4, kPressure},
    {MessageId::rate_of_turn_fast, "rate_of_turn_fast", 6, kRate},
    {MessageId::acceleration_fast, "acceleration_fast", 6, kAcceleration},
    {MessageId::latitude_longitude, "latitude_longitude", 8, kLatitudeLongitude},
    {MessageId::altitude, "altitude", 4, kAltitude},
    {MessageId::position_x, "position_x", 4, kPosition},
    {MessageId::position_y, "position_y", 4, kPosition},
    {MessageId::position_z, "position_z", 4, kPosition},
    {MessageId::velocity, "velocity", 6, kVelocity},
    {MessageId::receiver_status, "receiver_status", 5, kReceiverStatus},
    {MessageId::receiver_dilution, "receiver_dilution", 8, kReceiverDilution},
}};

constexpr bool well_formed() {
  std::uint8_t previous = 0;
  for (const Message& row : kMessages) {
    unsigned end = 0;
    for (const Field& field : row.fields) {
      if (field.byte != end) {
        return false;  // fields follow each other without gap
      }
      end += field.bytes;
    }
    if (end != row.length || row.fields.size() > kMaximumFields ||
        static_cast<std::uint8_t>(row.id) <= previous) {
      return false;
    }
    previous = static_cast<std::uint8_t>(row.id);
  }
  return true;
}
static_assert(well_formed());

double counts(const Field& field) {
  return std::ldexp(1.0, 8 * field.bytes);
}

}  // namespace

std::span<const Message> messages() {
  return kMessages;
}

const Message* find(std::uint32_t id) {
  const auto* found = std::find_if(kMessages.begin(), kMessages.end(), [id](const Message& row) {
    return static_cast<std::uint32_t>(row.id) == id;
  });
  return found == kMessages.end() ? nullptr : found;
}

const Message& message(MessageId id) {
  const Message* found = find(static_cast<std::uint32_t>(id));
  assert(found != nullptr);
  return *found;
}

double lower(const Field& field) {
  return field.is_signed ? -0.5 * counts(field) * field.scale : 0.0;
}

double upper(const Field& field) {
  return ((field.is_signed ? 0.5 : 1.0) * counts(field) - 1.0) * field.scale;
}

can::Frame encode(MessageId id, std::span<const double> values, bool extended) {
  const Message& row = message(id);
  assert(values.size() == row.fields.size());
  can::Frame frame;
  frame.id = static_cast<std::uint32_t>(id);
  frame.extended = extended;
  frame.length = row.length;
  for (std::size_t i = 0; i < row.fields.size(); ++i) {
    const Field& field = row.fields[i];
    const double held = std::clamp(values[i], lower(field), upper(field));
    auto raw = static_cast<std::uint64_t>(std::llround(held / field.scale));
    for (unsigned byte = field.bytes; byte-- > 0;) {
      frame.data[field.byte + byte] = static_cast<std::uint8_t>(raw & 0xFFU);
      raw >>= 8U;
    }
  }
  return frame;
}

Decoded<Reading> decode(const can::Frame& frame) {
  Reading reading;
  reading.message = frame.remote ? nullptr : find(frame.id);
  if (reading.message == nullptr || frame.length > 8) {
    return Malformed{"no data frame of the MTi-600 series", 0};
  }
  if (frame.length < reading.message->length) {
    return Malformed{"shorter than the message", frame.length};
  }
  for (std::size_t i = 0; i < reading.message->fields.size(); ++i) {
    const Field& field = reading.message->fields[i];
    std::uint64_t raw = 0;
    for (unsigned byte = 0; byte < field.bytes; ++byte) {
      raw = (raw << 8U) | frame.data[field.byte + byte];
    }
    auto value = static_cast<double>(raw);
    if (field.is_signed && value >= 0.5 * counts(field)) {
      value -= counts(field);
    }
    reading.values[i] = value * field.scale;
  }
  return {reading, frame.length};
}

unsigned increment_exponent(double greatest_mps) {
  constexpr unsigned kUsual = 17;
  unsigned exponent = kUsual;
  while (exponent > 0 && std::round(std::ldexp(greatest_mps, static_cast<int>(exponent))) > 32767) {
    --exponent;
  }
  return exponent;
}

std::vector<can::MessageLayout> layouts(bool extended, double tick_s) {
  std::vector<can::MessageLayout> list;
  for (const Message& row : kMessages) {
    can::MessageLayout layout;
    layout.name = row.name;
    layout.id = static_cast<std::uint32_t>(row.id);
    layout.extended = extended;
    layout.length = row.length;
    layout.text = "Xsens MT1604P";
    for (const Field& field : row.fields) {
      can::SignalLayout signal;
      signal.name = field.name;
      // The least significant bit of a big-endian number is bit 0 of its last byte.
      signal.bit = static_cast<std::uint16_t>(8 * (field.byte + field.bytes - 1));
      signal.width = static_cast<std::uint16_t>(8 * field.bytes);
      signal.order = can::ByteOrder::big_endian;
      signal.is_signed = field.is_signed;
      const bool ticks = row.id == MessageId::sample_time;
      signal.scale = ticks ? tick_s : field.scale;
      signal.lower = ticks ? lower(field) * tick_s : lower(field);
      signal.upper = ticks ? upper(field) * tick_s : upper(field);
      signal.unit = ticks ? "s" : field.unit;
      layout.fields.push_back(std::move(signal));
    }
    list.push_back(std::move(layout));
  }
  return list;
}

}  // namespace rigwire::protocols::xsens

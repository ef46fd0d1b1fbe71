#include "protocols/xsens/messages.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace rigwire::protocols::xsens {
namespace {

using can::Signal;

constexpr double power_of_two(int exponent) {
  double value = 1.0;
  for (int i = 0; i < exponent; ++i) {
    value /= 2.0;
  }
  return value;
}

/// A big-endian number of `bytes` bytes from `byte` on, over its whole range.
constexpr Signal number(std::string_view name, unsigned byte, unsigned bytes, double scale = 1.0,
                        std::string_view unit = "", bool is_signed = false) {
  Signal signal;
  signal.bit = static_cast<std::uint16_t>(8 * byte + 7);
  signal.width = static_cast<std::uint16_t>(8 * bytes);
  signal.order = can::ByteOrder::big_endian;
  signal.is_signed = is_signed;
  signal.scale = scale;
  signal.name = name;
  signal.unit = unit;
  return can::unlimited(signal);
}
constexpr Signal fraction(std::string_view name, unsigned byte, double scale,
                          std::string_view unit = "", unsigned bytes = 2) {
  return number(name, byte, bytes, scale, unit, true);
}
constexpr std::array<Signal, 3> triad(double scale, std::string_view unit) {
  return {fraction("x", 0, scale, unit), fraction("y", 2, scale, unit),
          fraction("z", 4, scale, unit)};
}
constexpr std::array<Signal, 4> quaternion() {
  constexpr double kScale = 1.0 / 32767.0;
  return {fraction("q0", 0, kScale), fraction("q1", 2, kScale), fraction("q2", 4, kScale),
          fraction("q3", 6, kScale)};
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
constexpr std::array<Signal, 4> kQuaternion = quaternion();
constexpr std::array kEulerAngles{fraction("roll", 0, power_of_two(7), "deg"),
                                  fraction("pitch", 2, power_of_two(7), "deg"),
                                  fraction("yaw", 4, power_of_two(7), "deg")};
constexpr std::array kVelocityIncrement{fraction("x", 0, 1.0), fraction("y", 2, 1.0),
                                        fraction("z", 4, 1.0), number("exponent", 6, 1)};
constexpr std::array<Signal, 3> kRate = triad(power_of_two(9), "rad/s");
constexpr std::array<Signal, 3> kAcceleration = triad(power_of_two(8), "m/s2");
constexpr std::array<Signal, 3> kMagneticField = triad(power_of_two(10), "");
constexpr std::array kTemperature{fraction("temperature", 0, power_of_two(8), "degC")};
constexpr std::array kPressure{number("pressure", 0, 4, power_of_two(15), "Pa")};
constexpr std::array kLatitudeLongitude{fraction("latitude", 0, power_of_two(24), "deg", 4),
                                        fraction("longitude", 4, power_of_two(23), "deg", 4)};
constexpr std::array kAltitude{fraction("altitude", 0, power_of_two(15), "m", 4)};
constexpr std::array kPosition{fraction("position", 0, power_of_two(8), "m", 4)};
constexpr std::array<Signal, 3> kVelocity = triad(power_of_two(6), "m/s");
constexpr std::array kReceiverStatus{number("fix_type", 0, 1), number("satellites", 1, 1),
                                     number("flags", 2, 1), number("valid", 3, 1),
                                     number("satellites_seen", 4, 1)};
constexpr std::array kReceiverDilution{
    number("position_dilution", 0, 2, 0.01), number("time_dilution", 2, 2, 0.01),
    number("vertical_dilution", 4, 2, 0.01), number("horizontal_dilution", 6, 2, 0.01)};

constexpr Message row(MessageId id, std::string_view name, std::span<const Signal> signals) {
  Message message;
  message.name = name;
  message.id = static_cast<std::uint32_t>(id);
  message.length = 0;
  for (const Signal& signal : signals) {
    message.length = static_cast<std::uint16_t>(message.length + signal.width / 8U);
  }
  message.text = "Xsens MT1604P";
  message.signals = signals;
  return message;
}
constexpr std::array kMessages{
    row(MessageId::error, "error", kError),
    row(MessageId::warning, "warning", kWarning),
    row(MessageId::sample_time, "sample_time", kSampleTime),
    row(MessageId::group_counter, "group_counter", kGroupCounter),
    row(MessageId::utc, "utc", kUtc),
    row(MessageId::status_word, "status_word", kStatusWord),
    row(MessageId::quaternion, "quaternion", kQuaternion),
    row(MessageId::euler_angles, "euler_angles", kEulerAngles),
    row(MessageId::velocity_increment, "velocity_increment", kVelocityIncrement),
    row(MessageId::rate_of_turn, "rate_of_turn", kRate),
    row(MessageId::orientation_increment, "orientation_increment", kQuaternion),
    row(MessageId::acceleration, "acceleration", kAcceleration),
    row(MessageId::free_acceleration, "free_acceleration", kAcceleration),
    row(MessageId::magnetic_field, "magnetic_field", kMagneticField),
    row(MessageId::temperature, "temperature", kTemperature),
    row(MessageId::pressure, "pressure", kPressure),
    row(MessageId::rate_of_turn_fast, "rate_of_turn_fast", kRate),
    row(MessageId::acceleration_fast, "acceleration_fast", kAcceleration),
    row(MessageId::latitude_longitude, "latitude_longitude", kLatitudeLongitude),
    row(MessageId::altitude, "altitude", kAltitude),
    row(MessageId::position_x, "position_x", kPosition),
    row(MessageId::position_y, "position_y", kPosition),
    row(MessageId::position_z, "position_z", kPosition),
    row(MessageId::velocity, "velocity", kVelocity),
    row(MessageId::receiver_status, "receiver_status", kReceiverStatus),
    row(MessageId::receiver_dilution, "receiver_dilution", kReceiverDilution),
};

/// In the order of their identifiers; their signals lie within them, so follow each other.
constexpr bool is_table(std::span<const Message> messages) {
  std::uint32_t previous = 0;
  return std::all_of(messages.begin(), messages.end(), [&previous](const Message& message) {
    return message.id > std::exchange(previous, message.id) && can::well_formed(message) &&
           message.length <= 8 && message.signals.size() <= kMaximumSignals;
  });
}
static_assert(is_table(kMessages));

}  // namespace

std::span<const Message> messages() {
  return kMessages;
}

const Message* find(std::uint32_t id) {
  const auto* found = std::find_if(kMessages.begin(), kMessages.end(),
                                   [id](const Message& message) { return message.id == id; });
  return found == kMessages.end() ? nullptr : found;
}

const Message& message(MessageId id) {
  const Message* found = find(static_cast<std::uint32_t>(id));
  assert(found != nullptr);
  return *found;
}

can::Frame encode(MessageId id, std::span<const double> values, bool extended) {
  can::Frame frame = can::encode(message(id), values);
  frame.extended = extended;
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
  for (std::size_t i = 0; i < reading.message->signals.size(); ++i) {
    reading.values[i] = can::get(reading.message->signals[i], frame.payload()).value;
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

std::vector<can::OwnedMessage> layouts(bool extended, double tick_s) {
  std::vector<can::OwnedMessage> list;
  for (const Message& row : kMessages) {
    can::OwnedMessage& message = list.emplace_back(can::owned(row));
    message.extended = extended;
    if (row.id == static_cast<std::uint32_t>(MessageId::sample_time)) {
      can::OwnedSignal& ticks = message.signals.front();
      ticks.scale = tick_s;
      ticks.unit = "s";
      ticks = can::unlimited(ticks);
    }
  }
  return list;
}

}  // namespace rigwire::protocols::xsens

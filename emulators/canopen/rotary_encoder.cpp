#include "emulators/canopen/rotary_encoder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fields/check.h"
#include "fields/constants.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
namespace object = protocols::canopen::object;
using canopen::EncoderAlarm;
using canopen::EncoderOperation;
using canopen::ObjectAddress;
using fields::IntegerRule;

namespace {

constexpr std::uint32_t kSingleTurn = 0x0001'0196;  // profile 406
constexpr std::uint32_t kMultiTurn = 0x0002'0196;
constexpr std::uint16_t kHardwareError = 0x5000;
constexpr std::uint8_t kEncoderGenericError = 0x81;  // bit 0 generic, bit 7 of the maker
constexpr const char* kEncoderVendorName = "Rigwire";

constexpr std::array<fields::Choice<bool>, 2> kDirections{
    {{false, "clockwise", "Seen against the axis; as delivered by every maker."},
     {true, "counter_clockwise", "The sense of rotation of positive angles."}}};

}  // namespace

RotaryEncoder::RotaryEncoder(const RotaryEncoderSettings& settings, NonvolatileMemory& memory,
                             FrameOutput& output)
    : CanopenDevice(checked(settings), canopen::rotary_encoder_objects(), memory, output),
      settings_(settings) {
  const std::int64_t range = steps() * settings_.revolutions;
  dictionary_.set_delivered(object::kOperatingParameters,
                            settings_.counter_clockwise ? EncoderOperation::kCounterClockwise : 0);
  dictionary_.set_delivered(object::kUnitsPerRevolution, steps());
  dictionary_.set_delivered(object::kTotalRange, range);
  dictionary_.set_delivered(object::kSingleTurnResolution, steps());
  dictionary_.set_delivered(object::kRevolutions, settings_.revolutions);
  dictionary_.set_delivered(object::kEncoderSerial, settings_.serial);
  deliver(settings_, settings_.revolutions > 1 ? kMultiTurn : kSingleTurn,
          settings_.resolution_bits, "cia406-encoder.eds", "Absolute rotary encoder, CiA 406",
          kEncoderVendorName);
  const double step_rad = kTurn / static_cast<double>(steps());
  const double speed_radps = step_rad * std::numeric_limits<std::int16_t>::max();
  quantities_ = {{{"position", "rad", 0.0, kTurn * settings_.revolutions, step_rad},
                  {"speed", "rad/s", -speed_radps, speed_radps, step_rad}}};
}

std::vector<protocols::can::OwnedMessage> RotaryEncoder::messages(std::string_view name) const {
  if (settings_.node.node_id == canopen::kNoNodeId) {
    return {};
  }
  return sent_by(name, settings_, true, canopen::rotary_encoder_layouts(settings_.node.node_id));
}

void RotaryEncoder::switched(SimTime now) {
  powered_since_ = now;
  faulty_ = false;
  evaluate();
}

void RotaryEncoder::advance(SimTime now) {
  CanopenDevice::advance(now);
  now_ = now;
}

void RotaryEncoder::written(SimTime now) {
  evaluate();
  node_.changed(now);
}

void RotaryEncoder::update(const EncoderSample& sample) {
  advance(sample.time);
  const bool faulty = !std::isfinite(sample.angle_rad) || !std::isfinite(sample.rate_radps);
  if (!faulty) {
    angle_rad_ = sample.angle_rad;
    rate_radps_ = sample.rate_radps;
    evaluate();
  }
  if (node_.state() == canopen::NodeState::initialising) {
    faulty_ = false;  // reported after the boot-up message
  } else if (faulty != faulty_) {
    faulty_ = faulty;
    node_.report_error(sample.time, faulty ? kHardwareError : 0, faulty ? kEncoderGenericError : 0);
  }
  node_.changed(sample.time);
}

std::span<const LiveSetting<RotaryEncoder, RotaryEncoderSettings>> RotaryEncoder::live_settings() {
  using Row = LiveSetting<RotaryEncoder, RotaryEncoderSettings>;
  static constexpr auto& kOfAll = kCanopenLiveSettings<RotaryEncoder, RotaryEncoderSettings>;
  static constexpr std::array<Row, 4> kRows{{
      kOfAll[0],
      kOfAll[1],
      kOfAll[2],
      {"direction", "SDO, object 6000",
       [](RotaryEncoder& encoder, SimTime now, const RotaryEncoderSettings& wanted) {
         const std::int64_t present = encoder.dictionary_.value(object::kOperatingParameters);
         const std::int64_t others = present & ~EncoderOperation::kCounterClockwise;
         return encoder.configure(
             now, object::kOperatingParameters,
             others | (wanted.counter_clockwise ? EncoderOperation::kCounterClockwise : 0));
       }},
  }};
  return kRows;
}

RotaryEncoder::Scale RotaryEncoder::scale() const {
  const std::int64_t operation = dictionary_.value(object::kOperatingParameters);
  if ((operation & EncoderOperation::kScaling) == 0) {
    return {operation, steps(), steps() * settings_.revolutions};
  }
  return {operation, dictionary_.value(object::kUnitsPerRevolution),
          dictionary_.value(object::kTotalRange)};
}

std::int64_t RotaryEncoder::units(const Scale& scale) const {
  const double sign = (scale.operation & EncoderOperation::kCounterClockwise) != 0 ? 1.0 : -1.0;
  // Steps of the disc from its offset, in the direction of count, modulo the revolutions.
  const double exact =
      sign * (angle_rad_ - settings_.offset_rad) / kTurn * static_cast<double>(steps());
  const std::int64_t step = modulo(std::llround(exact), steps() * settings_.revolutions);
  // CiA 406 scaling: measuring units per revolution, modulo the total range.
  return modulo(step * scale.units_per_revolution / steps(), scale.total_range);
}

void RotaryEncoder::evaluate() {
  const Scale present = scale();
  const std::int64_t offset = dictionary_.value(object::kOffset);
  position_ = static_cast<std::uint32_t>(modulo(units(present) + offset, present.total_range));
}

std::optional<std::int64_t> RotaryEncoder::live(ObjectAddress address) const {
  constexpr std::int64_t kTenthOfAnHour_s = 360;
  if (address == object::kPosition) {
    return position_;
  }
  if (address == object::kSpeed) {
    const Scale present = scale();
    const double sign = (present.operation & EncoderOperation::kCounterClockwise) != 0 ? 1.0 : -1.0;
    // Measuring units per second.
    const double speed =
        sign * rate_radps_ / kTurn * static_cast<double>(present.units_per_revolution);
    return std::llround(std::clamp(speed, -32768.0, 32767.0));
  }
  if (address == object::kOperatingStatus) {
    return dictionary_.value(object::kOperatingParameters);
  }
  if (address == object::kAlarms) {
    return faulty_ ? EncoderAlarm::kPosition : 0;
  }
  if (address == object::kOperatingTime) {
    return (now_ - powered_since_) / std::chrono::seconds{kTenthOfAnHour_s};
  }
  if (address == object::kCyclicTimer) {
    return dictionary_.value({object::kTransmitPdo, canopen::kPdoEventTimer_ms});
  }
  return std::nullopt;
}

std::string_view RotaryEncoder::text(ObjectAddress address) const {
  if (address == object::kDeviceName) {
    return settings_.revolutions > 1 ? "Multi-turn absolute encoder"
                                     : "Single-turn absolute encoder";
  }
  return address == object::kHardwareVersion ? "1.00" : "1.0.0";
}

std::optional<canopen::SdoAbort> RotaryEncoder::write(ObjectAddress address, std::int64_t value) {
  if (address == object::kCyclicTimer) {
    dictionary_.set({object::kTransmitPdo, canopen::kPdoEventTimer_ms}, value);
  } else if (address == object::kUnitsPerRevolution && value > steps()) {
    return canopen::SdoAbort::value_too_high;
  } else if (address == object::kTotalRange && value > steps() * settings_.revolutions) {
    return canopen::SdoAbort::value_too_high;
  } else if (address == object::kPreset) {
    const Scale present = scale();
    if (value >= present.total_range) {
      return canopen::SdoAbort::value_too_high;
    }
    dictionary_.set(object::kOffset, value - units(present));
    position_ = static_cast<std::uint32_t>(value);
  }
  return std::nullopt;
}

// Keys and checks of the encoder's settings.

void visit(fields::Visitor& v, RotaryEncoderSettings& p) {
  visit_canopen(v, p);
  v.integer("resolution", p.resolution_bits, IntegerRule{13, 16}, "Bits per revolution.");
  v.integer("revolutions", p.revolutions, IntegerRule{1, 32768},
            "Number of distinguishable revolutions; 1 = a single-turn encoder.");
  v.choice("direction", p.counter_clockwise, kDirections, "Direction in which the code rises.");
  v.number("offset", p.offset_rad, fields::in("deg").between(-360, 360),
           "Angle at which the code is 0.");
  v.duration("sampling", p.sampling, {100'000, 1'000'000'000},
             "Time between two readings of the disc.");
  visit(v, p.supply);
}

void validate(const RotaryEncoderSettings& settings) {
  fields::check(settings);
  validate_canopen(settings);
}

}  // namespace rigwire::emulators

#include "emulators/canopen/inclinometer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
namespace object = protocols::canopen::object;
using canopen::ObjectAddress;
using canopen::QuadrantCorrection;
using canopen::SdoAbort;
using canopen::SlopeObjects;
using canopen::SlopeOperation;
using fields::IntegerRule;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint32_t kDeviceTypeWord = 0x0004'019A;  // two axes of 32 bits, profile 410
constexpr std::uint8_t kGenericError = 0x01;
constexpr const char* kVendorName = "ifm electronic";
constexpr std::int64_t kTurn_mdeg = 360'000;
constexpr std::array<std::uint16_t, 2> kEmergencies{canopen::kLongitudinalError,
                                                    canopen::kLateralError};

double radians(double resolution_mdeg) {
  return resolution_mdeg * 1e-3 * kPi / 180.0;
}

std::int64_t least(canopen::DataType type) {
  return type == canopen::DataType::integer16 ? std::numeric_limits<std::int16_t>::min()
                                              : std::numeric_limits<std::int32_t>::min();
}

std::int64_t most(canopen::DataType type) {
  return type == canopen::DataType::integer16 ? std::numeric_limits<std::int16_t>::max()
                                              : std::numeric_limits<std::int32_t>::max();
}

}  // namespace

Inclinometer::Inclinometer(const InclinometerSettings& settings, NonvolatileMemory& memory,
                           FrameOutput& output)
    : CanopenDevice(checked(settings), canopen::inclinometer_objects(), memory, output),
      settings_(settings) {
  dictionary_.set_delivered(object::kQuadrantCorrection, settings_.quadrants);
  dictionary_.set_delivered(object::kFilterStep, settings_.filter_step);
  dictionary_.set_delivered(object::kSlopeResolution, settings_.resolution_mdeg);
  deliver(settings_, kDeviceTypeWord, settings_.product, "cia410-inclinometer.eds",
          "Two-axis inclinometer, CiA 410", kVendorName);
  // What the 16-bit slopes carry: the quadrants, the range, and the counts of their type.
  const double count_rad = radians(settings_.resolution_mdeg);
  const double widest_rad = settings_.quadrants == QuadrantCorrection::kOff ? kPi / 2.0 : kPi;
  const double carried_rad = count_rad * std::numeric_limits<std::int16_t>::max();
  const bool full = settings_.quadrants == QuadrantCorrection::kFullTurn;
  const double upper_rad =
      std::min(full ? 2.0 * kPi : std::min(widest_rad, settings_.range_rad), carried_rad);
  const double lower_rad = full ? 0.0 : -upper_rad;
  quantities_ = {{{"slope_longitudinal", "rad", lower_rad, upper_rad, count_rad},
                  {"slope_lateral", "rad", lower_rad, upper_rad, count_rad}}};
}

std::vector<protocols::can::OwnedMessage> Inclinometer::messages(std::string_view name) const {
  if (settings_.node.node_id == canopen::kNoNodeId) {
    return {};
  }
  return sent_by(name, settings_, settings_.transmission_type >= canopen::kOnChange,
                 canopen::inclinometer_layouts(settings_.node.node_id, settings_.resolution_mdeg));
}

std::span<const LiveSetting<Inclinometer, InclinometerSettings>> Inclinometer::live_settings() {
  using Row = LiveSetting<Inclinometer, InclinometerSettings>;
  using Settings = InclinometerSettings;
  static constexpr auto& kOfAll = kCanopenLiveSettings<Inclinometer, Settings>;
  static constexpr std::array<Row, 6> kRows{{
      kOfAll[0],
      kOfAll[1],
      kOfAll[2],
      {"resolution", "SDO, object 6000",
       [](Inclinometer& device, SimTime now, const Settings& wanted) {
         return device.configure(now, object::kSlopeResolution, wanted.resolution_mdeg);
       }},
      {"filter", "SDO, object 2043",
       [](Inclinometer& device, SimTime now, const Settings& wanted) {
         return device.configure(now, object::kFilterStep, wanted.filter_step);
       }},
      {"quadrants", "SDO, object 2040",
       [](Inclinometer& device, SimTime now, const Settings& wanted) {
         return device.configure(now, object::kQuadrantCorrection, wanted.quadrants);
       }},
  }};
  return kRows;
}

void Inclinometer::switched(SimTime /*now*/) {
  settled_ = false;
  up_ = {0.0, 0.0, 1.0};
  errors_ = {};
}

void Inclinometer::update(const ImuSample& sample) {
  advance(sample.time);
  if (!node_.powered()) {
    return;
  }
  const auto& f = sample.specific_force_mps2;
  const bool number = std::isfinite(f.x) && std::isfinite(f.y) && std::isfinite(f.z);
  if (number) {
    filter(sample.time, {f.x, f.y, f.z});
  }
  const bool direction =
      number && std::hypot(filtered_[0], filtered_[1], filtered_[2]) >= kLeastForce_mps2;
  if (direction) {
    up_ = filtered_;
  }
  report(sample.time, {!direction || std::abs(angle_rad(0)) > settings_.range_rad,
                       !direction || std::abs(angle_rad(1)) > settings_.range_rad});
  node_.changed(sample.time);
}

void Inclinometer::filter(SimTime now, const Force& force) {
  const auto step = static_cast<std::size_t>(dictionary_.value(object::kFilterStep));
  const double cut_off_hz = canopen::kFilterCutOffs_hz[step];
  if (!settled_ || cut_off_hz == 0.0) {
    filtered_ = force;
  } else {
    // Exact for the input held since the last sample; a convex sum, so that nothing overflows.
    const double elapsed_s = to_seconds(now - filtered_at_);
    const double rest = std::exp(-2.0 * kPi * cut_off_hz * elapsed_s);
    for (std::size_t i = 0; i < filtered_.size(); ++i) {
      filtered_[i] = (1.0 - rest) * input_[i] + rest * filtered_[i];
    }
  }
  settled_ = true;
  filtered_at_ = now;
  input_ = force;
}

double Inclinometer::angle_rad(std::size_t axis) const {
  const double across = std::hypot(up_[1 - axis], up_[2]);
  const bool corrected = dictionary_.value(object::kQuadrantCorrection) != QuadrantCorrection::kOff;
  return std::atan2(up_[axis], corrected && up_[2] < 0.0 ? -across : across);
}

std::int64_t Inclinometer::measured(const SlopeObjects& slope) const {
  const std::int64_t resolution = dictionary_.value(object::kSlopeResolution);
  const double limited =
      std::clamp(angle_rad(slope.axis), -settings_.range_rad, settings_.range_rad);
  std::int64_t counts = std::llround(limited / radians(static_cast<double>(resolution)));
  if ((dictionary_.value(slope.address(canopen::kSlopeOperation)) & SlopeOperation::kInversion) !=
      0) {
    counts = -counts;
  }
  const bool full = dictionary_.value(object::kQuadrantCorrection) == QuadrantCorrection::kFullTurn;
  return full ? modulo(counts, kTurn_mdeg / resolution) : counts;
}

std::int64_t Inclinometer::value(const SlopeObjects& slope) const {
  std::int64_t counts = measured(slope);
  if ((dictionary_.value(slope.address(canopen::kSlopeOperation)) & SlopeOperation::kScaling) !=
      0) {
    counts += dictionary_.value(slope.address(canopen::kSlopeOffset)) +
              dictionary_.value(slope.address(canopen::kSlopeDifferentialOffset));
  }
  return std::clamp(counts, least(slope.type), most(slope.type));
}

void Inclinometer::report(SimTime now, const std::array<bool, kAxes>& errors) {
  if (node_.state() == canopen::NodeState::initialising) {
    errors_ = {};  // reported after the boot-up message
    return;
  }
  const std::array<bool, kAxes> before = errors_;
  errors_ = errors;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (errors[axis] && !before[axis]) {
      node_.report_error(now, kEmergencies[axis], kGenericError);
    }
  }
  const bool left = errors[0] || errors[1];
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (!errors[axis] && before[axis]) {
      node_.report_error(now, 0, left ? kGenericError : 0);
    }
  }
}

std::optional<std::int64_t> Inclinometer::live(ObjectAddress address) const {
  for (const SlopeObjects& slope : canopen::kSlopes) {
    if (address == slope.address(canopen::kSlopeValue)) {
      return value(slope);
    }
  }
  return std::nullopt;
}

std::string_view Inclinometer::text(ObjectAddress address) const {
  if (address == object::kDeviceName) {
    return "JN2101";
  }
  return address == object::kHardwareVersion ? "1.0" : "100";
}

std::optional<SdoAbort> Inclinometer::write(ObjectAddress address, std::int64_t value) {
  if (address == object::kSlopeResolution && !canopen::is_slope_resolution(value)) {
    return SdoAbort::value_range;
  }
  for (const SlopeObjects& slope : canopen::kSlopes) {
    if (address == slope.address(canopen::kSlopePreset)) {
      return preset(slope, value);
    }
  }
  return std::nullopt;
}

std::optional<SdoAbort> Inclinometer::preset(const SlopeObjects& slope, std::int64_t wanted) {
  if (errors_[slope.axis]) {
    return SdoAbort::not_in_this_state;
  }
  const std::int64_t offset = wanted - measured(slope) -
                              dictionary_.value(slope.address(canopen::kSlopeDifferentialOffset));
  if (offset > most(slope.type)) {
    return SdoAbort::value_too_high;
  }
  if (offset < least(slope.type)) {
    return SdoAbort::value_too_low;
  }
  dictionary_.set(slope.address(canopen::kSlopeOffset), offset);
  return std::nullopt;
}

// Keys and checks of the inclinometer's settings.

void visit(fields::Visitor& v, InclinometerSettings& p) {
  visit_canopen(v, p);
  v.integer(
      "resolution", p.resolution_mdeg,
      IntegerRule{canopen::kSlopeResolutions_mdeg.front(), canopen::kSlopeResolutions_mdeg.back()},
      "Thousandths of a degree in one count of a slope: 1, 10, 100 or 1000.");
  v.check(canopen::is_slope_resolution(p.resolution_mdeg), "resolution", "not a power of ten",
          std::to_string(p.resolution_mdeg), "1, 10, 100, 1000");
  v.integer("filter", p.filter_step, IntegerRule{0, canopen::kFilterCutOffs_hz.size() - 1},
            "Low-pass on the force: 0 = none, 1 .. 4 = cut off at 10, 5, 1, 0.5 Hz.");
  v.integer("quadrants", p.quadrants, IntegerRule{0, canopen::QuadrantCorrection::kFullTurn},
            "Range of slopes: 0 = -90 .. 90, 1 = -180 .. 180, 2 = 0 .. 360 deg.");
  v.number("range", p.range_rad, fields::in("deg").above(0).at_most(180),
           "Greatest slope to either side; an axis beyond it is not valid.");
  v.integer("product", p.product, IntegerRule{0, 0xFFFFFFFF},
            "Product code in its identity object.");
  v.duration("sampling", p.sampling, {100'000, 1'000'000'000},
             "Time between two readings of the force.");
  visit(v, p.supply);
}

void validate(const InclinometerSettings& settings) {
  fields::check(settings);
  validate_canopen(settings);
}

}  // namespace rigwire::emulators

// What goes wrong with what a device measures: one quantity of its samples is not what it is, and
// everything that the device makes of it follows.
//
//   faults:
//     - {type: offset, at: 10 s, for: 5 s, quantity: rate_z, value: 0.02, ramp: 2 s}
//     - {type: stuck, at: 20 s, for: 5 s, quantity: force_x}
//
// Values are in the quantity's SI unit. Faults act in the order of the list, each on what those
// before it left.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "emulators/random_bits.h"
#include "fields/rules.h"
#include "fields/visitor.h"
#include "sim/samples/encoder_sample.h"
#include "sim/samples/fault_book.h"
#include "sim/samples/imu_sample.h"
#include "sim/samples/joystick_sample.h"
#include "sim/samples/power_unit_sample.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::emulators {

template <class Sample>
struct FaultyQuantity {
  fields::Named named;  ///< With its unit.
  double& (*of)(Sample&);
};

/// What of a sample a fault can be of. Without a specialisation: nothing.
template <class Sample>
struct QuantitiesOf {};

template <>
struct QuantitiesOf<ImuSample> {
  static constexpr std::array<FaultyQuantity<ImuSample>, 7> kAll{{
      {{"force_x", "Specific force, forward, m/s2."},
       [](ImuSample& s) -> double& { return s.specific_force_mps2.x; }},
      {{"force_y", "Specific force, to the left, m/s2."},
       [](ImuSample& s) -> double& { return s.specific_force_mps2.y; }},
      {{"force_z", "Specific force, up, m/s2."},
       [](ImuSample& s) -> double& { return s.specific_force_mps2.z; }},
      {{"rate_x", "Rate of roll, rad/s."},
       [](ImuSample& s) -> double& { return s.angular_rate_radps.x; }},
      {{"rate_y", "Rate of pitch, rad/s."},
       [](ImuSample& s) -> double& { return s.angular_rate_radps.y; }},
      {{"rate_z", "Rate of yaw, rad/s."},
       [](ImuSample& s) -> double& { return s.angular_rate_radps.z; }},
      {{"temperature", "Temperature of the sensor, degC."},
       [](ImuSample& s) -> double& { return s.temperature_c; }},
  }};
};
template <>
struct QuantitiesOf<EncoderSample> {
  static constexpr std::array<FaultyQuantity<EncoderSample>, 2> kAll{{
      {{"angle", "Angle of the shaft, rad."},
       [](EncoderSample& s) -> double& { return s.angle_rad; }},
      {{"rate", "Rate of the shaft, rad/s."},
       [](EncoderSample& s) -> double& { return s.rate_radps; }},
  }};
};
template <>
struct QuantitiesOf<PowerUnitSample> {
  static constexpr std::array<FaultyQuantity<PowerUnitSample>, 5> kAll{{
      {{"engine_speed", "rad/s."},
       [](PowerUnitSample& s) -> double& { return s.engine.speed_radps; }},
      {{"coolant", "Temperature, degC."},
       [](PowerUnitSample& s) -> double& { return s.engine.coolant_c; }},
      {{"oil_pressure", "Oil pressure of the engine, Pa."},
       [](PowerUnitSample& s) -> double& { return s.engine.oil_pressure_pa; }},
      {{"fuel_level", "0 .. 1."},
       [](PowerUnitSample& s) -> double& { return s.engine.fuel_level_share; }},
      {{"dial", "0 idle .. 1 greatest speed."},
       [](PowerUnitSample& s) -> double& { return s.dial_share; }},
  }};
};
template <>
struct QuantitiesOf<VehicleSample> {
  static constexpr std::array<FaultyQuantity<VehicleSample>, 10> kAll{{
      {{"engine_speed", "rad/s."},
       [](VehicleSample& s) -> double& { return s.engine.speed_radps; }},
      {{"coolant", "Temperature, degC."},
       [](VehicleSample& s) -> double& { return s.engine.coolant_c; }},
      {{"front_left_wheel", "Rate of the wheel, rad/s."},
       [](VehicleSample& s) -> double& { return s.wheel_rate_radps[0]; }},
      {{"front_right_wheel", "Rate of the wheel, rad/s."},
       [](VehicleSample& s) -> double& { return s.wheel_rate_radps[1]; }},
      {{"rear_left_wheel", "Rate of the wheel, rad/s."},
       [](VehicleSample& s) -> double& { return s.wheel_rate_radps[2]; }},
      {{"rear_right_wheel", "Rate of the wheel, rad/s."},
       [](VehicleSample& s) -> double& { return s.wheel_rate_radps[3]; }},
      {{"front_steer", "Angle of the equivalent wheel, rad."},
       [](VehicleSample& s) -> double& { return s.front_steer_rad; }},
      {{"rear_steer", "Angle of the equivalent wheel, rad."},
       [](VehicleSample& s) -> double& { return s.rear_steer_rad; }},
      {{"odometry_speed", "Speed by the machine's kinematic model, m/s."},
       [](VehicleSample& s) -> double& { return s.odometry.speed_mps; }},
      {{"odometry_curvature", "Curvature of the path, 1/m."},
       [](VehicleSample& s) -> double& { return s.odometry.curvature_1pm; }},
  }};
};
template <>
struct QuantitiesOf<JoystickSample> {
  static constexpr std::array<FaultyQuantity<JoystickSample>, kJoystickAxes> kAll{{
      {{"left_x", "Left stick, of full travel."},
       [](JoystickSample& s) -> double& { return s.axes[0]; }},
      {{"left_y", "Left stick, of full travel."},
       [](JoystickSample& s) -> double& { return s.axes[1]; }},
      {{"right_x", "Right stick, of full travel."},
       [](JoystickSample& s) -> double& { return s.axes[2]; }},
      {{"right_y", "Right stick, of full travel."},
       [](JoystickSample& s) -> double& { return s.axes[3]; }},
      {{"left_pedal", "Left pedal, of full travel."},
       [](JoystickSample& s) -> double& { return s.axes[4]; }},
      {{"right_pedal", "Right pedal, of full travel."},
       [](JoystickSample& s) -> double& { return s.axes[5]; }},
      {{"dial", "Dial, of full travel."}, [](JoystickSample& s) -> double& { return s.axes[6]; }},
  }};
};

template <class Sample>
concept HasQuantities = requires {
  QuantitiesOf<Sample>::kAll;
};

/// One quantity of that sample.
template <HasQuantities Sample>
struct OneQuantity {
  std::size_t quantity = 0;  ///< Place in QuantitiesOf<Sample>::kAll.
};
template <class Sample>
void visit_quantity(fields::Visitor& v, OneQuantity<Sample>& p) {
  std::array<fields::Named, QuantitiesOf<Sample>::kAll.size()> names;
  std::ranges::transform(QuantitiesOf<Sample>::kAll, names.begin(), &FaultyQuantity<Sample>::named);
  v.pick("quantity", p.quantity, names, "What is measured wrongly.");
}

template <class Sample>
struct OffsetFault : OneQuantity<Sample> {
  static constexpr fields::Named kNamed{"offset", "A quantity is measured beside what it is."};

  double value = 0.0;
  Duration ramp{0};

  void grow(double share) { value *= share; }
};
template <class Sample>
struct ScaleFault : OneQuantity<Sample> {
  static constexpr fields::Named kNamed{"scale", "A quantity is measured with a wrong factor."};

  double factor = 1.0;
  Duration ramp{0};

  void grow(double share) { factor = 1.0 + share * (factor - 1.0); }
};
template <class Sample>
struct StuckFault : OneQuantity<Sample> {
  static constexpr fields::Named kNamed{"stuck", "A quantity stays what it was."};
};
template <class Sample>
struct NoisierFault : OneQuantity<Sample> {
  static constexpr fields::Named kNamed{"noisier", "White noise on top of the sensor's own."};

  double deviation = 0.0;
  Duration ramp{0};

  void grow(double share) { deviation *= share; }
};
template <class Sample>
struct SaturatedFault : OneQuantity<Sample> {
  static constexpr fields::Named kNamed{"saturated", "A quantity goes no further than a limit."};

  double limit = 0.0;
};
template <class Sample>
struct DeadZoneFault : OneQuantity<Sample> {
  static constexpr fields::Named kNamed{"dead_zone", "A quantity near zero is measured as zero."};

  double width = 0.0;
};

template <class Sample>
void visit(fields::Visitor& v, OffsetFault<Sample>& p) {
  visit_quantity(v, p);
  v.required("value");
  v.number("value", p.value, fields::plain(), "How far it is off, in its SI unit.");
  visit_ramp(v, p.ramp);
}
template <class Sample>
void visit(fields::Visitor& v, ScaleFault<Sample>& p) {
  visit_quantity(v, p);
  v.required("factor");
  v.number("factor", p.factor, fields::plain(), "What is measured of what it is.");
  visit_ramp(v, p.ramp);
}
template <class Sample>
void visit(fields::Visitor& v, StuckFault<Sample>& p) {
  visit_quantity(v, p);
}
template <class Sample>
void visit(fields::Visitor& v, NoisierFault<Sample>& p) {
  visit_quantity(v, p);
  v.required("deviation");
  v.number("deviation", p.deviation, fields::plain().above(0),
           "Standard deviation of each sample, in its SI unit.");
  visit_ramp(v, p.ramp);
}
template <class Sample>
void visit(fields::Visitor& v, SaturatedFault<Sample>& p) {
  visit_quantity(v, p);
  v.required("limit");
  v.number("limit", p.limit, fields::plain().at_least(0), "Greatest amount, in its SI unit.");
}
template <class Sample>
void visit(fields::Visitor& v, DeadZoneFault<Sample>& p) {
  visit_quantity(v, p);
  v.required("width");
  v.number("width", p.width, fields::plain().above(0),
           "Amount below which nothing is measured, in its SI unit.");
}

template <class Sample>
struct SampleFault {
  FaultPeriod when;
  std::variant<OffsetFault<Sample>, ScaleFault<Sample>, StuckFault<Sample>, NoisierFault<Sample>,
               SaturatedFault<Sample>, DeadZoneFault<Sample>>
      what;
};
template <class Sample>
void visit(fields::Visitor& v, SampleFault<Sample>& p) {
  visit_fault(v, p);
}

/// Applies the faults to samples, one after the other as they come.
template <HasQuantities Sample>
class FaultySamples {
 public:
  FaultySamples(std::vector<SampleFault<Sample>> faults, std::uint64_t seed)
      : faults_(std::move(faults)), random_(seed) {}

  using Id = typename FaultBook<SampleFault<Sample>>::Id;
  Id begin(const SampleFault<Sample>& fault) { return faults_.add(fault); }
  /// Ends a fault from `now` on. Returns false if there is none of that number or it is over.
  bool end(Id id, SimTime now) { return faults_.end(id, now); }

  /// Applies the faults that hold at sample.time. Precondition: it does not decrease from call to
  /// call.
  void lay_over(Sample& sample) {
    for (const auto& entry : faults_.list()) {
      if (entry.fault.when.holds(sample.time)) {
        std::visit([&](const auto& what) { act(entry.id, entry.fault.when, what, sample); },
                   entry.fault.what);
      }
    }
  }

 private:
  template <class What>
  [[nodiscard]] static double& value_of(const What& what, Sample& sample) {
    return QuantitiesOf<Sample>::kAll[what.quantity].of(sample);
  }
  void act(Id, const FaultPeriod& when, const OffsetFault<Sample>& what, Sample& sample) {
    value_of(what, sample) += grown(what, when, sample.time).value;
  }
  void act(Id, const FaultPeriod& when, const ScaleFault<Sample>& what, Sample& sample) {
    value_of(what, sample) *= grown(what, when, sample.time).factor;
  }
  void act(Id id, const FaultPeriod& when, const StuckFault<Sample>& what, Sample& sample) {
    double& value = value_of(what, sample);
    const auto [held, fresh] = stuck_.try_emplace(id, when.began(sample.time), value);
    if (!fresh && held->second.first != when.began(sample.time)) {
      held->second = {when.began(sample.time), value};
    }
    value = held->second.second;
  }
  void act(Id, const FaultPeriod& when, const NoisierFault<Sample>& what, Sample& sample) {
    value_of(what, sample) += grown(what, when, sample.time).deviation * random_.normal();
  }
  void act(Id, const FaultPeriod&, const SaturatedFault<Sample>& what, Sample& sample) {
    double& value = value_of(what, sample);
    value = std::clamp(value, -what.limit, what.limit);
  }
  void act(Id, const FaultPeriod&, const DeadZoneFault<Sample>& what, Sample& sample) {
    double& value = value_of(what, sample);
    value = std::abs(value) < what.width ? 0.0 : value;
  }

  FaultBook<SampleFault<Sample>> faults_;
  RandomBits random_;
  std::map<Id, std::pair<SimTime, double>> stuck_;  ///< Since when, and at what.
};

}  // namespace rigwire::emulators

#include "emulators/dbc_node/quantities.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace rigwire::emulators {
namespace {

using fields::Dimension;

constexpr double kDegree_rad = std::numbers::pi / 180.0;

template <auto kMember>
double member(const auto& sample) {
  return static_cast<double>(sample.*kMember);
}
template <auto kOuter, auto kInner>
double member(const auto& sample) {
  return static_cast<double>((sample.*kOuter).*kInner);
}
template <auto kArray, std::size_t kIndex>
double element(const auto& sample) {
  return static_cast<double>((sample.*kArray)[kIndex]);
}

constexpr std::array kJoint{
    SampleQuantity<EncoderSample>{"angle", Dimension::angle, "Not wrapped.",
                                  member<&EncoderSample::angle_rad>},
    SampleQuantity<EncoderSample>{"rate", Dimension::angular_rate, "",
                                  member<&EncoderSample::rate_radps>},
};

/// Nose up positive, from the direction of the specific force: exact at rest.
double pitch(const ImuSample& sample) {
  const Vector3& f = sample.specific_force_mps2;
  return std::atan2(f.x, std::hypot(f.y, f.z));
}
/// Left side up positive.
double roll(const ImuSample& sample) {
  return std::atan2(sample.specific_force_mps2.y, sample.specific_force_mps2.z);
}

using Imu = SampleQuantity<ImuSample>;
constexpr std::array kInertial{
    Imu{"pitch", Dimension::angle, "Nose up positive; of the force, so exact at rest.", pitch},
    Imu{"roll", Dimension::angle, "Left side up positive; of the force, so exact at rest.", roll},
    Imu{"acceleration_x", Dimension::acceleration, "Specific force, forward; g upward at rest.",
        member<&ImuSample::specific_force_mps2, &Vector3::x>},
    Imu{"acceleration_y", Dimension::acceleration, "To the left.",
        member<&ImuSample::specific_force_mps2, &Vector3::y>},
    Imu{"acceleration_z", Dimension::acceleration, "Upward.",
        member<&ImuSample::specific_force_mps2, &Vector3::z>},
    Imu{"rate_x", Dimension::angular_rate, "About the forward axis.",
        member<&ImuSample::angular_rate_radps, &Vector3::x>},
    Imu{"rate_y", Dimension::angular_rate, "About the left axis: nose down positive.",
        member<&ImuSample::angular_rate_radps, &Vector3::y>},
    Imu{"rate_z", Dimension::angular_rate, "About the upward axis: to the left positive.",
        member<&ImuSample::angular_rate_radps, &Vector3::z>},
    Imu{"temperature", Dimension::temperature, "Temperature of the sensor.",
        member<&ImuSample::temperature_c>},
};

bool has_position(const GnssSample& sample) {
  return sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d;
}
template <auto kMember>
double of_position(const GnssSample& sample) {
  return has_position(sample) ? sample.*kMember : kNotMeasured;
}
template <auto kMember>
double of_degrees(const GnssSample& sample) {
  return of_position<kMember>(sample) * kDegree_rad;
}
template <auto kComponent>
double of_velocity(const GnssSample& sample) {
  return has_position(sample) ? sample.velocity_ned_mps.*kComponent : kNotMeasured;
}

using Fix = SampleQuantity<GnssSample>;
constexpr std::array kSatellites{
    Fix{"latitude", Dimension::angle, "WGS-84, north positive.",
        of_degrees<&GnssSample::latitude_deg>},
    Fix{"longitude", Dimension::angle, "East positive.", of_degrees<&GnssSample::longitude_deg>},
    Fix{"ellipsoid_height", Dimension::length, "Above the WGS-84 ellipsoid.",
        of_position<&GnssSample::ellipsoid_height_m>},
    Fix{"height", Dimension::length, "Above mean sea level.",
        [](const GnssSample& s) {
          return has_position(s) ? s.ellipsoid_height_m - s.geoid_separation_m : kNotMeasured;
        }},
    Fix{"velocity_north", Dimension::speed, "", of_velocity<&Vector3::x>},
    Fix{"velocity_east", Dimension::speed, "", of_velocity<&Vector3::y>},
    Fix{"velocity_down", Dimension::speed, "", of_velocity<&Vector3::z>},
    Fix{"speed", Dimension::speed, "Over the ground.",
        [](const GnssSample& s) {
          return has_position(s) ? std::hypot(s.velocity_ned_mps.x, s.velocity_ned_mps.y)
                                 : kNotMeasured;
        }},
    Fix{"course", Dimension::angle, "Over the ground, clockwise from north, 0 .. 360 deg.",
        [](const GnssSample& s) {
          const double course = std::atan2(s.velocity_ned_mps.y, s.velocity_ned_mps.x);
          return !has_position(s) ? kNotMeasured
                                  : course + (course < 0.0 ? 2.0 * std::numbers::pi : 0.0);
        }},
    Fix{"horizontal_accuracy", Dimension::length, "Its own estimate, 1 sigma.",
        of_position<&GnssSample::horizontal_accuracy_m>},
    Fix{"horizontal_dilution", Dimension::none, "", member<&GnssSample::horizontal_dilution>},
    Fix{"fix", Dimension::none, "0 none, 2 two-dimensional, 3 three-dimensional.",
        [](const GnssSample& s) {
          return !has_position(s) ? 0.0 : s.fix == GnssFix::two_d ? 2.0 : 3.0;
        }},
    Fix{"carrier_solution", Dimension::none, "0 none, 1 floating, 2 fixed.",
        [](const GnssSample& s) { return static_cast<double>(s.carrier); }},
    Fix{"satellites_used", Dimension::none, "",
        [](const GnssSample& s) {
          return static_cast<double>(std::ranges::count_if(s.satellites, &SatelliteView::used));
        }},
};

// The sections of a valve block.
using Valve = SampleQuantity<ValveSample>;
using ValveMove = CommandQuantity<ValveCommand>;
constexpr std::array<std::string_view, kValveSections> kSpool{
    "spool_1", "spool_2", "spool_3", "spool_4", "spool_5", "spool_6", "spool_7", "spool_8"};
constexpr std::array<std::string_view, kValveSections> kPortA{
    "pressure_a_1", "pressure_a_2", "pressure_a_3", "pressure_a_4",
    "pressure_a_5", "pressure_a_6", "pressure_a_7", "pressure_a_8"};
constexpr std::array<std::string_view, kValveSections> kPortB{
    "pressure_b_1", "pressure_b_2", "pressure_b_3", "pressure_b_4",
    "pressure_b_5", "pressure_b_6", "pressure_b_7", "pressure_b_8"};
constexpr std::array<std::string_view, kValveSections> kOpening{
    "opening_1", "opening_2", "opening_3", "opening_4",
    "opening_5", "opening_6", "opening_7", "opening_8"};
constexpr std::array<std::string_view, kValveSections> kFloating{
    "floating_1", "floating_2", "floating_3", "floating_4",
    "floating_5", "floating_6", "floating_7", "floating_8"};

template <std::size_t... kIndex>
constexpr auto valve_rows(std::index_sequence<kIndex...> /*sections*/) {
  return std::array{
      Valve{kSpool[kIndex], Dimension::ratio, "Position of the section's spool, -1 .. 1.",
            element<&ValveSample::spool_position, kIndex>}...,
      Valve{kPortA[kIndex], Dimension::pressure, "Cylinder bottom side, or motor port A.",
            element<&ValveSample::port_a_pressure_pa, kIndex>}...,
      Valve{kPortB[kIndex], Dimension::pressure, "Cylinder rod side, or motor port B.",
            element<&ValveSample::port_b_pressure_pa, kIndex>}...,
      Valve{"supply_pressure", Dimension::pressure, "", member<&ValveSample::supply_pressure_pa>},
      Valve{"tank_pressure", Dimension::pressure, "", member<&ValveSample::tank_pressure_pa>},
      Valve{"oil_temperature", Dimension::temperature, "", member<&ValveSample::oil_temperature_c>},
      Valve{"swing_angle", Dimension::angle, "Upper structure, left positive.",
            member<&ValveSample::swing_angle_rad>},
      Valve{"swing_rate", Dimension::angular_rate, "", member<&ValveSample::swing_rate_radps>}};
}
template <std::size_t... kIndex>
constexpr auto valve_moves(std::index_sequence<kIndex...> /*sections*/) {
  return std::array{
      ValveMove{kOpening[kIndex], Dimension::ratio,
                "Place of the section's spool, -1 .. 1 of its travel.", 0.0,
                [](ValveCommand& c, double x) { c.opening[kIndex] = std::clamp(x, -1.0, 1.0); }}...,
      ValveMove{kFloating[kIndex], Dimension::none, "Not 0: both ports of the section to tank.",
                0.0, [](ValveCommand& c, double x) { c.floating[kIndex] = x != 0.0; }}...};
}
constexpr auto kValves = valve_rows(std::make_index_sequence<kValveSections>{});
constexpr auto kValveMoves = valve_moves(std::make_index_sequence<kValveSections>{});

// Engines, whatever they drive.
template <class Sample, auto kEngine>
constexpr auto engine_rows() {
  using Row = SampleQuantity<Sample>;
  return std::array{
      Row{"engine_speed", Dimension::angular_rate, "", member<kEngine, &EngineSample::speed_radps>},
      Row{"engine_torque", Dimension::torque, "At the crank.",
          member<kEngine, &EngineSample::torque_nm>},
      Row{"engine_full_load", Dimension::torque, "The most it could give at this speed.",
          member<kEngine, &EngineSample::full_load_nm>},
      Row{"coolant_temperature", Dimension::temperature, "",
          member<kEngine, &EngineSample::coolant_c>},
      Row{"engine_oil_temperature", Dimension::temperature, "",
          member<kEngine, &EngineSample::oil_c>},
      Row{"engine_oil_pressure", Dimension::pressure, "",
          member<kEngine, &EngineSample::oil_pressure_pa>},
      Row{"fuel_rate", Dimension::flow, "", member<kEngine, &EngineSample::fuel_rate_m3ps>},
      Row{"fuel_used", Dimension::volume, "Since the start of the run.",
          member<kEngine, &EngineSample::fuel_used_m3>},
      Row{"fuel_level", Dimension::ratio, "", member<kEngine, &EngineSample::fuel_level_share>},
      Row{"battery_voltage", Dimension::voltage, "", member<kEngine, &EngineSample::battery_v>}};
}
template <class Row, std::size_t kFirst, std::size_t kSecond>
constexpr std::array<Row, kFirst + kSecond> joined(const std::array<Row, kFirst>& first,
                                                   const std::array<Row, kSecond>& second) {
  return [&]<std::size_t... kA, std::size_t... kB>(std::index_sequence<kA...>,
                                                   std::index_sequence<kB...>) {
    return std::array<Row, kFirst + kSecond>{first[kA]..., second[kB]...};
  }
  (std::make_index_sequence<kFirst>{}, std::make_index_sequence<kSecond>{});
}

using Power = SampleQuantity<PowerUnitSample>;
constexpr auto kPowerUnit = joined(
    engine_rows<PowerUnitSample, &PowerUnitSample::engine>(),
    std::array{
        Power{"dial", Dimension::ratio, "The machine's own speed dial, 0 .. 1.",
              member<&PowerUnitSample::dial_share>},
        Power{"pump_pressure", Dimension::pressure, "", member<&PowerUnitSample::pump_pressure_pa>},
        Power{"pump_flow", Dimension::flow, "", member<&PowerUnitSample::pump_flow_m3ps>},
        Power{"pump_torque", Dimension::torque, "", member<&PowerUnitSample::pump_torque_nm>}});
constexpr std::array kPowerMoves{
    CommandQuantity<PowerUnitCommand>{"engine_speed", Dimension::angular_rate,
                                      "In place of the dial's; 0: the dial's.", 0.0,
                                      [](PowerUnitCommand& c, double x) {
                                        c.speed_radps = x > 0.0 ? std::optional(x) : std::nullopt;
                                      }},
    CommandQuantity<PowerUnitCommand>{
        "torque_limit", Dimension::ratio, "Share of the reference torque, 0 .. 1.", 1.0,
        [](PowerUnitCommand& c, double x) { c.torque_limit_share = std::clamp(x, 0.0, 1.0); }},
};

using Drive = SampleQuantity<VehicleSample>;
constexpr auto kVehicle =
    joined(engine_rows<VehicleSample, &VehicleSample::engine>(),
           std::array{Drive{"speed", Dimension::speed,
                            "Speed of the reference point, by wheels and steering.",
                            member<&VehicleSample::odometry, &OdometryReading::speed_mps>},
                      Drive{"ground_speed", Dimension::speed,
                            "Over the ground, where a radar is fitted.",
                            member<&VehicleSample::ground_speed_mps>},
                      Drive{"front_steer", Dimension::angle, "Left positive.",
                            member<&VehicleSample::front_steer_rad>},
                      Drive{"rear_steer", Dimension::angle, "Left positive.",
                            member<&VehicleSample::rear_steer_rad>},
                      Drive{"wheel_rate_1", Dimension::angular_rate, "Front left.",
                            element<&VehicleSample::wheel_rate_radps, 0>},
                      Drive{"wheel_rate_2", Dimension::angular_rate, "Front right.",
                            element<&VehicleSample::wheel_rate_radps, 1>},
                      Drive{"wheel_rate_3", Dimension::angular_rate, "Rear left.",
                            element<&VehicleSample::wheel_rate_radps, 2>},
                      Drive{"wheel_rate_4", Dimension::angular_rate, "Rear right.",
                            element<&VehicleSample::wheel_rate_radps, 3>},
                      Drive{"gear", Dimension::none, "Engaged; 0 neutral, reverse negative.",
                            member<&VehicleSample::gear>},
                      Drive{"brake", Dimension::ratio, "", member<&VehicleSample::brake_share>},
                      Drive{"parking_brake", Dimension::none, "1 set.",
                            member<&VehicleSample::parking_brake>},
                      Drive{"hydraulic_pressure", Dimension::pressure, "",
                            member<&VehicleSample::hydraulic_pressure_pa>},
                      Drive{"front_hitch", Dimension::ratio, "0 down .. 1 up.",
                            [](const VehicleSample& s) {
                              return s.hitch[0].present ? s.hitch[0].height_share : kNotMeasured;
                            }},
                      Drive{"rear_hitch", Dimension::ratio, "0 down .. 1 up.",
                            [](const VehicleSample& s) {
                              return s.hitch[1].present ? s.hitch[1].height_share : kNotMeasured;
                            }},
                      Drive{"front_shaft", Dimension::angular_rate, "Power take-off.",
                            [](const VehicleSample& s) {
                              return s.power_take_off[0].present ? s.power_take_off[0].speed_radps
                                                                 : kNotMeasured;
                            }},
                      Drive{"rear_shaft", Dimension::angular_rate, "Power take-off.",
                            [](const VehicleSample& s) {
                              return s.power_take_off[1].present ? s.power_take_off[1].speed_radps
                                                                 : kNotMeasured;
                            }}});

using DriveMove = CommandQuantity<VehicleCommand>;
constexpr std::array kVehicleMoves{
    DriveMove{"travel_speed", Dimension::speed,
              "Held by the machine's own controller, which shifts and releases the parking brake; "
              "reverse negative, 0 stops and holds.",
              0.0,
              [](VehicleCommand& c, double x) {
                c.travel_speed_mps = x;
                c.automatic_gear = true;
                c.parking_brake = x == 0.0;
              }},
    DriveMove{"engine_torque", Dimension::ratio, "The accelerator, 0 .. 1.", 0.0,
              [](VehicleCommand& c, double x) {
                c.engine_control = EngineControl::torque;
                c.engine_torque_share = std::clamp(x, 0.0, 1.0);
              }},
    DriveMove{"engine_speed", Dimension::angular_rate, "Speed that the governor holds.", 0.0,
              [](VehicleCommand& c, double x) {
                c.engine_control = EngineControl::speed;
                c.engine_speed_radps = std::max(x, 0.0);
              }},
    DriveMove{"gear", Dimension::none, "0 neutral, reverse negative.", 0.0,
              [](VehicleCommand& c, double x) {
                constexpr double kMostGears = 64.0;
                c.gear = static_cast<int>(std::lround(std::clamp(x, -kMostGears, kMostGears)));
              }},
    DriveMove{"brake", Dimension::ratio, "The service brake, 0 .. 1.", 0.0,
              [](VehicleCommand& c, double x) { c.brake_share = std::clamp(x, 0.0, 1.0); }},
    DriveMove{"parking_brake", Dimension::none, "Not 0: set.", 1.0,
              [](VehicleCommand& c, double x) { c.parking_brake = x != 0.0; }},
    DriveMove{"front_steer", Dimension::angle, "Left positive.", 0.0,
              [](VehicleCommand& c, double x) { c.front_steer_rad = x; }},
    DriveMove{"rear_steer", Dimension::angle, "Left positive.", 0.0,
              [](VehicleCommand& c, double x) { c.rear_steer_rad = x; }},
    DriveMove{"front_hitch", Dimension::ratio, "0 down .. 1 up.", 0.0,
              [](VehicleCommand& c, double x) { c.hitch_share[0] = std::clamp(x, 0.0, 1.0); }},
    DriveMove{"rear_hitch", Dimension::ratio, "0 down .. 1 up.", 0.0,
              [](VehicleCommand& c, double x) { c.hitch_share[1] = std::clamp(x, 0.0, 1.0); }},
};

template <class Backend>
void append(std::vector<NamedQuantity>& measured, std::vector<NamedQuantity>& moved) {
  using Of = Attachment<Backend>;
  for (std::size_t i = 0; i < Of::measured().size(); ++i) {
    const auto& row = Of::measured()[i];
    measured.push_back({Of::kName, row.name, row.dimension, row.text, i});
  }
  for (std::size_t i = 0; i < Of::commanded().size(); ++i) {
    const auto& row = Of::commanded()[i];
    moved.push_back({Of::kName, row.name, row.dimension, row.text, i, row.neutral});
  }
}

struct All {
  All() {
    append<EncoderBackend>(measured, moved);
    append<ImuBackend>(measured, moved);
    append<GnssBackend>(measured, moved);
    append<ValveBackend>(measured, moved);
    append<PowerUnitBackend>(measured, moved);
    append<VehicleBackend>(measured, moved);
  }
  std::vector<NamedQuantity> measured;
  std::vector<NamedQuantity> moved;
};

const All& all() {
  static const All kAll;
  return kAll;
}

}  // namespace

std::span<const SampleQuantity<EncoderSample>> Attachment<EncoderBackend>::measured() {
  return kJoint;
}
std::span<const SampleQuantity<ImuSample>> Attachment<ImuBackend>::measured() {
  return kInertial;
}
std::span<const SampleQuantity<GnssSample>> Attachment<GnssBackend>::measured() {
  return kSatellites;
}
std::span<const SampleQuantity<ValveSample>> Attachment<ValveBackend>::measured() {
  return kValves;
}
std::span<const CommandQuantity<ValveCommand>> Attachment<ValveBackend>::commanded() {
  return kValveMoves;
}
std::span<const SampleQuantity<PowerUnitSample>> Attachment<PowerUnitBackend>::measured() {
  return kPowerUnit;
}
std::span<const CommandQuantity<PowerUnitCommand>> Attachment<PowerUnitBackend>::commanded() {
  return kPowerMoves;
}
std::span<const SampleQuantity<VehicleSample>> Attachment<VehicleBackend>::measured() {
  return kVehicle;
}
std::span<const CommandQuantity<VehicleCommand>> Attachment<VehicleBackend>::commanded() {
  return kVehicleMoves;
}

std::span<const NamedQuantity> measured_quantities() {
  return all().measured;
}
std::span<const NamedQuantity> moved_quantities() {
  return all().moved;
}

std::string NamedQuantity::full_name() const {
  return std::string(attachment).append(1, '.').append(name);
}

const NamedQuantity* find_quantity(std::span<const NamedQuantity> among, std::string_view name) {
  const auto found = std::ranges::find(among, name, &NamedQuantity::full_name);
  return found == among.end() ? nullptr : &*found;
}

}  // namespace rigwire::emulators

#include "sim/samples/port_members.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <type_traits>

namespace rigwire {
namespace {

// Each structure once: `use(name, member)` for every member, in the order of the recording.

template <class Engine, class Use>
void each_of_engine(Engine& e, Use& use) {
  use("engine_speed_radps", e.speed_radps);
  use("engine_torque_nm", e.torque_nm);
  use("engine_friction_nm", e.friction_nm);
  use("engine_full_load_nm", e.full_load_nm);
  use("engine_desired_radps", e.desired_radps);
  use("coolant_c", e.coolant_c);
  use("oil_c", e.oil_c);
  use("oil_pressure_pa", e.oil_pressure_pa);
  use("fuel_pressure_pa", e.fuel_pressure_pa);
  use("coolant_level_share", e.coolant_level_share);
  use("oil_level_share", e.oil_level_share);
  use("fuel_level_share", e.fuel_level_share);
  use("fuel_rate_m3ps", e.fuel_rate_m3ps);
  use("fuel_used_m3", e.fuel_used_m3);
  use("battery_v", e.battery_v);
  use("battery_a", e.battery_a);
  use("alternator_a", e.alternator_a);
}

template <class Sample, class Use>
void each_of_valves(Sample& s, Use&& use) {
  use("spool_position", s.spool_position);
  use("port_a_pressure_pa", s.port_a_pressure_pa);
  use("port_b_pressure_pa", s.port_b_pressure_pa);
  use("supply_pressure_pa", s.supply_pressure_pa);
  use("tank_pressure_pa", s.tank_pressure_pa);
  use("swing_angle_rad", s.swing_angle_rad);
  use("swing_rate_radps", s.swing_rate_radps);
  use("oil_temperature_c", s.oil_temperature_c);
}

template <class Sample, class Use>
void each_of_vehicle(Sample& s, Use&& use) {
  each_of_engine(s.engine, use);
  use("drives", s.drives);
  use("gear", s.gear);
  use("gear_requested", s.gear_requested);
  use("crawler_group", s.crawler_group);
  use("gear_ratio", s.gear_ratio);
  use("shifting", s.shifting);
  use("driveline_engaged", s.driveline_engaged);
  use("input_shaft_radps", s.input_shaft_radps);
  use("output_shaft_radps", s.output_shaft_radps);
  use("clutch_slip_share", s.clutch_slip_share);
  use("wheel_rate_radps", s.wheel_rate_radps);
  use("wheel_radius_m", s.wheel_radius_m);
  use("front_steer_rad", s.front_steer_rad);
  use("rear_steer_rad", s.rear_steer_rad);
  use("brake_share", s.brake_share);
  use("parking_brake", s.parking_brake);
  use("lock", s.lock);
  use("tyre_pressure_pa", s.tyre_pressure_pa);
  use("tyre_pressure_target_pa", s.tyre_pressure_target_pa);
  use("hydraulic_pressure_pa", s.hydraulic_pressure_pa);
  use("vibration", s.vibration);
  use("edge_cutter_share", s.edge_cutter_share);
  use("spreader_rate_kgpm2", s.spreader_rate_kgpm2);
  use("hopper_mass_kg", s.hopper_mass_kg);
  use("odometry_speed_mps", s.odometry.speed_mps);
  use("odometry_curvature_1pm", s.odometry.curvature_1pm);
  use("odometry_slip_angle_rad", s.odometry.slip_angle_rad);
  use("ground_speed_mps", s.ground_speed_mps);
  use("travel_limit", s.travel_limit);
  use("front_hitch_present", s.hitch[0].present);
  use("front_hitch_share", s.hitch[0].height_share);
  use("rear_hitch_present", s.hitch[1].present);
  use("rear_hitch_share", s.hitch[1].height_share);
  use("front_shaft_present", s.power_take_off[0].present);
  use("front_shaft_engaged", s.power_take_off[0].engaged);
  use("front_shaft_radps", s.power_take_off[0].speed_radps);
  use("rear_shaft_present", s.power_take_off[1].present);
  use("rear_shaft_engaged", s.power_take_off[1].engaged);
  use("rear_shaft_radps", s.power_take_off[1].speed_radps);
}

template <class Sample, class Use>
void each_of_power_unit(Sample& s, Use&& use) {
  each_of_engine(s.engine, use);
  use("dial_radps", s.dial_radps);
  use("dial_share", s.dial_share);
  use("pump_pressure_pa", s.pump_pressure_pa);
  use("pump_flow_m3ps", s.pump_flow_m3ps);
  use("pump_torque_nm", s.pump_torque_nm);
}

/// Appends the members' names.
class Names {
 public:
  explicit Names(std::vector<PortMember>& members) : members_(members) {}

  template <class Value>
  void operator()(std::string_view name, const Value& /*value*/) {
    members_.push_back({name, 1, !std::is_same_v<Value, double>});
  }
  template <class Value, std::size_t kCount>
  void operator()(std::string_view name, const std::array<Value, kCount>& /*values*/) {
    members_.push_back({name, kCount, !std::is_same_v<Value, double>});
  }

 private:
  std::vector<PortMember>& members_;
};

class Numbers {
 public:
  explicit Numbers(std::vector<double>& numbers) : numbers_(numbers) {}

  template <class Value>
  void operator()(std::string_view /*name*/, const Value& value) {
    numbers_.push_back(static_cast<double>(value));
  }
  template <class Value, std::size_t kCount>
  void operator()(std::string_view name, const std::array<Value, kCount>& values) {
    for (const Value& value : values) {
      (*this)(name, value);
    }
  }

 private:
  std::vector<double>& numbers_;
};

class Taker {
 public:
  explicit Taker(std::span<const double> numbers) : numbers_(numbers) {}

  template <class Value>
  void operator()(std::string_view /*name*/, Value& value) {
    assert(!numbers_.empty());
    const double number = numbers_.front();
    numbers_ = numbers_.subspan(1);
    if constexpr (std::is_same_v<Value, double>) {
      value = number;
    } else if constexpr (std::is_same_v<Value, bool>) {
      value = std::isfinite(number) ? number >= 0.5 : value;
    } else if constexpr (std::is_enum_v<Value>) {
      constexpr double kMost = static_cast<double>(TravelLimit::braking);
      static_assert(std::is_same_v<Value, TravelLimit>);
      value = std::isfinite(number)
                  ? static_cast<Value>(std::lround(std::clamp(number, 0.0, kMost)))
                  : value;
    } else {
      constexpr double kMost = 1000.0;  // of a gear, by far
      value = std::isfinite(number)
                  ? static_cast<Value>(std::lround(std::clamp(number, -kMost, kMost)))
                  : value;
    }
  }
  template <class Value, std::size_t kCount>
  void operator()(std::string_view name, std::array<Value, kCount>& values) {
    for (Value& value : values) {
      (*this)(name, value);
    }
  }

 private:
  std::span<const double> numbers_;
};

}  // namespace

std::vector<PortMember> members_of(const ValveSample& sample) {
  std::vector<PortMember> members;
  each_of_valves(sample, Names(members));
  return members;
}

std::vector<PortMember> members_of(const VehicleSample& sample) {
  std::vector<PortMember> members;
  each_of_vehicle(sample, Names(members));
  return members;
}

std::vector<PortMember> members_of(const PowerUnitSample& sample) {
  std::vector<PortMember> members;
  each_of_power_unit(sample, Names(members));
  return members;
}

void append_numbers(const ValveSample& sample, std::vector<double>& numbers) {
  each_of_valves(sample, Numbers(numbers));
}

void append_numbers(const VehicleSample& sample, std::vector<double>& numbers) {
  each_of_vehicle(sample, Numbers(numbers));
}

void append_numbers(const PowerUnitSample& sample, std::vector<double>& numbers) {
  each_of_power_unit(sample, Numbers(numbers));
}

void take_numbers(std::span<const double> numbers, ValveSample& sample) {
  each_of_valves(sample, Taker(numbers));
}

void take_numbers(std::span<const double> numbers, VehicleSample& sample) {
  each_of_vehicle(sample, Taker(numbers));
}

void take_numbers(std::span<const double> numbers, PowerUnitSample& sample) {
  each_of_power_unit(sample, Taker(numbers));
}

}  // namespace rigwire

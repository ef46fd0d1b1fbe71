#include "sim/driveline/parameters.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr std::array<fields::Choice<AxleDrive>, 3> kAxleDrives{
    {{AxleDrive::rear, "rear", "Rear axle only."},
     {AxleDrive::switchable_front, "switchable_front",
      "Rear axle; the centre lock couples the front axle."},
     {AxleDrive::centre_differential, "centre_differential",
      "Both axles, equal torque; the centre lock couples them."}}};

constexpr auto kFront = static_cast<std::size_t>(Differential::front);
constexpr auto kCentre = static_cast<std::size_t>(Differential::centre);
constexpr auto kRear = static_cast<std::size_t>(Differential::rear);

std::string in_rpm(double rate_radps) {
  return in("rpm").print(rate_radps);
}

void check_gears(const std::vector<double>& ratios, const char* key, std::size_t least) {
  fields::require(ratios.size() >= least && ratios.size() <= 125, key,
                  std::to_string(ratios.size()) + " gears",
                  std::to_string(least) + " .. 125 gears");
}

// An automatic that closes below idle would stall the engine.
void check_clutch(const ClutchParameters& clutch, const EngineParameters& engine) {
  fields::require(
      clutch.open_radps > 0.5 * engine.idle_radps && clutch.open_radps < engine.maximum_radps,
      "clutch.open", in_rpm(clutch.open_radps),
      "between half of engine.idle, " + in_rpm(0.5 * engine.idle_radps) + ", and engine.maximum, " +
          in_rpm(engine.maximum_radps));
}

}  // namespace

std::vector<TorquePoint> unimog_full_load() {
  return {{rpm(600), 450.0},
          {rpm(1000), 760.0},
          {rpm(1200), 900.0},
          {rpm(1600), 900.0},
          {rpm(2200), 737.9}};
}

double EngineParameters::greatest_torque_nm() const {
  double greatest = 0.0;
  for (const TorquePoint& point : full_load) {
    greatest = std::max(greatest, point.torque_nm);
  }
  return greatest;
}

std::vector<double> GearboxParameters::geometric(int gears, double top, double step, int count) {
  std::vector<double> ratios;
  for (int gear = 0; gear < count; ++gear) {
    ratios.push_back(top * std::pow(step, gears - 1 - gear));
  }
  return ratios;
}

namespace {

/// Diesel of 0.85 litres and 17 kW on 12 V; estimates.
EngineConditionParameters utility_vehicle_engine() {
  EngineConditionParameters p;
  p.tank_m3 = 0.020;
  p.indicated_efficiency = 0.40;
  p.water_equivalent_kg = 12.0;
  p.closed_kpw = 0.15;
  p.open_kpw = 4.0e-3;
  p.oil_relief_pa = 3.5e5;
  p.fuel_pressure_pa = 3.0e4;
  p.charging_v = 14.2;
  p.rest_v = 12.6;
  p.consumers_a = 8.0;
  return p;
}

}  // namespace

CvtParameters::CvtParameters() {
  // 50.7 Nm at 3200 rpm are the maker's 17 kW.
  engine.full_load = {{rpm(1200), 44.0}, {rpm(2200), 56.0}, {rpm(3200), 50.7}};
  engine.inertia_kgm2 = 0.12;
  engine.drag_nm = 4.0;
  engine.drag_nmsprad = 0.02;
  engine.idle_radps = rpm(1250);
  engine.maximum_radps = rpm(3200);
  engine.cut_off_radps = rpm(3500);
  engine.governor_nmsprad = 6.0;
  engine.torque_lag_s = 0.1;
  engine.condition = utility_vehicle_engine();
  clutch.centrifugal = true;
  clutch.capacity_nm = 90.0;
  clutch.open_radps = rpm(1450);
  clutch.full_radps = rpm(2000);
  // Overall 40 (low, launch) to 7.6 (high, top).
  axles.drive = AxleDrive::switchable_front;
  axles.lockable = {false, true, true};
  axles.final_ratio = 9.5;
  axles.portal_ratio = 1.0;
  axles.output_inertia_kgm2 = 0.02;
  axles.output_drag_nmsprad = 0.005;
  variator.ranges = {40.0 / (2.8 * 9.5), 1.0};
  variator.reverse_range = variator.ranges.front();
}

void visit(fields::Visitor& v, TorquePoint& p) {
  v.number("speed", p.speed_radps, in("rpm").between(0, 1e5), "Speed of the crank.");
  v.number("torque", p.torque_nm, in("N m").between(0.01, 1e8), "Torque at full load.");
}

void visit(fields::Visitor& v, EngineParameters& p) {
  v.list("full_load", p.full_load, "Torque at full load by rising speed, linear between.");
  v.number("inertia", p.inertia_kgm2, in("kg m2").between(1e-6, 1e9),
           "Inertia of crank, flywheel and clutch disc.");
  v.number("drag", p.drag_nm, in("N m").between(0, 1e8), "Friction towards standstill.");
  v.number("drag_slope", p.drag_nmsprad, in("N m s/rad").between(0, 1e9),
           "Growth of friction by speed.");
  v.number("idle", p.idle_radps, in("rpm").between(0.1, 1e5), "Speed of the idle governor.");
  v.number("maximum", p.maximum_radps, in("rpm").between(0.1, 1e5),
           "Speed up to which torque is full.");
  v.number("cut_off", p.cut_off_radps, in("rpm").between(0.1, 1e5),
           "Speed from which on there is no torque.");
  v.number("governor", p.governor_nmsprad, in("N m s/rad").between(1e-6, 1e9),
           "Torque of the governor per missing speed.");
  v.number("governor_integral", p.governor_integral_s, in("s").between(0.001, 1e5),
           "Time in which the set-speed governor repeats its torque.");
  v.number("torque_lag", p.torque_lag_s, in("ms").between(0, 1e6),
           "Lag from accelerator to torque.");
  v.section("condition", p.condition, "Temperatures, pressures, fuel and battery.");
}

void visit(fields::Visitor& v, ClutchParameters& p) {
  v.boolean("centrifugal", p.centrifugal, "Closes by engine speed, not by the faster side's.");
  v.number("capacity", p.capacity_nm, in("N m").between(0.01, 1e8),
           "Torque that the closed clutch holds.");
  v.number("open", p.open_radps, in("rpm").between(0.1, 1e5),
           "Speed below which the clutch is open.");
  v.number("full", p.full_radps, in("rpm").between(0.1, 1e5),
           "Speed from which on the clutch is closed.");
}

void visit(fields::Visitor& v, AxleParameters& p) {
  v.choice("drive", p.drive, kAxleDrives, "Axles that the engine turns.");
  v.boolean("front_lock", p.lockable[kFront], "Whether the front differential has a lock.");
  v.boolean("centre_lock", p.lockable[kCentre], "Whether the axles can be coupled.");
  v.boolean("rear_lock", p.lockable[kRear], "Whether the rear differential has a lock.");
  v.number("lock_time", p.lock_time_s, in("ms").between(0, 1e6),
           "Time from a lock's request to its engagement.");
  v.number("lock_rate_difference", p.lock_rate_difference_radps, in("rad/s").between(0.001, 1e5),
           "Greater differences of wheel rates keep a lock from engaging.");
  v.number("final_ratio", p.final_ratio, plain().between(1e-6, 1e6),
           "Ratio from gearbox output to axle shaft.");
  v.number("portal_ratio", p.portal_ratio, plain().between(1e-6, 1e6),
           "Ratio from axle shaft to wheel; 1 without portals.");
  v.number("output_inertia", p.output_inertia_kgm2, in("kg m2").between(0, 1e9),
           "Inertia of shafts and bevel gears, at the gearbox's output.");
  v.number("output_drag", p.output_drag_nmsprad, in("N m s/rad").between(0, 1e9),
           "Oil drag at the gearbox's output.");
}

void visit(fields::Visitor& v, GearboxParameters& p) {
  v.number_list("forward", p.forward, plain().between(1e-6, 1e6),
                "Forward ratios, first gear first.");
  v.number_list("reverse", p.reverse, plain().between(1e-6, 1e6),
                "Reverse ratios, first gear first.");
  v.number("crawler_factor", p.crawler_factor, plain().between(0, 1e6),
           "Factor on every ratio in the crawler group; 0 = no such group.");
  v.number("ramp_down", p.ramp_down_s, in("ms").between(0, 1e6),
           "Time in which torque falls to zero before a shift.");
  v.number("synchronisation", p.synchronisation_s, in("ms").between(0, 1e6),
           "Time out of gear in a shift.");
  v.number("ramp_up", p.ramp_up_s, in("ms").between(0, 1e6),
           "Time in which torque comes back after a shift.");
  v.number("group_change", p.group_change_radps, in("rad/s").between(0.001, 1e5),
           "Mean wheel rate below which the group may change.");
}

void visit(fields::Visitor& v, GearedParameters& p) {
  v.section("engine", p.engine, "Combustion engine.");
  v.section("clutch", p.clutch, "Automated friction clutch.");
  v.section("gearbox", p.gearbox, "Step gearbox.");
  v.section("axles", p.axles, "From the gearbox's output to the wheels.");
}

void visit(fields::Visitor& v, VariatorParameters& p) {
  v.number("launch_ratio", p.launch_ratio, plain().between(1e-6, 1e6),
           "Ratio of the variator at standstill.");
  v.number("top_ratio", p.top_ratio, plain().between(1e-6, 1e6),
           "Ratio of the variator fully shifted.");
  v.number("shift_from", p.shift_from_radps, in("rpm").between(0.1, 1e5),
           "Engine speed up to which the launch ratio stays.");
  v.number("shift_to", p.shift_to_radps, in("rpm").between(0.1, 1e5),
           "Engine speed from which on the top ratio holds.");
  v.number("lag", p.lag_s, in("ms").between(0, 1e6), "Lag of the variator's sheaves.");
  v.number_list("ranges", p.ranges, plain().between(1e-6, 1e6),
                "Ratios of the range groups, gear 1 first.");
  v.number("reverse_range", p.reverse_range, plain().between(0, 1e6),
           "Ratio of the reverse group; 0 = no reverse.");
  v.number("range_change", p.range_change_radps, in("rad/s").between(0.001, 1e5),
           "Mean wheel rate below which the range may change.");
}

void visit(fields::Visitor& v, CvtParameters& p) {
  v.section("engine", p.engine, "Combustion engine.");
  v.section("clutch", p.clutch, "Centrifugal clutch.");
  v.section("variator", p.variator, "Belt variator and range groups.");
  v.section("axles", p.axles, "From the variator's output to the wheels.");
}

void visit(fields::Visitor& v, DrivelineParameters& p) {
  v.variant("type", p, "Kind of the drive line.");
}

void validate(const EngineParameters& p) {
  fields::check(p);
  fields::require(!p.full_load.empty(), "full_load", "no point", "at least one point");
  for (std::size_t i = 1; i < p.full_load.size(); ++i) {
    const double before_radps = p.full_load[i - 1].speed_radps;
    fields::require(p.full_load[i].speed_radps > before_radps,
                    "full_load." + std::to_string(i) + ".speed", in_rpm(p.full_load[i].speed_radps),
                    "above the point before, " + in_rpm(before_radps));
  }
  fields::require(p.maximum_radps > p.idle_radps, "maximum", in_rpm(p.maximum_radps),
                  "above idle, " + in_rpm(p.idle_radps));
  fields::require(p.cut_off_radps > p.maximum_radps, "cut_off", in_rpm(p.cut_off_radps),
                  "above maximum, " + in_rpm(p.maximum_radps));
}

void validate(const ClutchParameters& p) {
  fields::check(p);
  fields::require(p.full_radps > p.open_radps, "full", in_rpm(p.full_radps),
                  "above open, " + in_rpm(p.open_radps));
}

void validate(const AxleParameters& p) {
  fields::check(p);
  fields::require(p.drive != AxleDrive::rear || !p.lockable[kCentre], "centre_lock", "true",
                  "false: a rear drive has no centre differential");
}

void validate(const GearboxParameters& p) {
  fields::check(p);
  check_gears(p.forward, "forward", 1);
  check_gears(p.reverse, "reverse", 0);
  fields::require(p.crawler_factor == 0.0 || p.crawler_factor >= 1.0, "crawler_factor",
                  plain().print(p.crawler_factor), "0 (none) or >= 1");
}

void validate(const VariatorParameters& p) {
  fields::check(p);
  check_gears(p.ranges, "ranges", 1);
  fields::require(p.launch_ratio >= p.top_ratio, "launch_ratio", plain().print(p.launch_ratio),
                  "at least top_ratio, " + plain().print(p.top_ratio));
  fields::require(p.shift_to_radps > p.shift_from_radps, "shift_to", in_rpm(p.shift_to_radps),
                  "above shift_from, " + in_rpm(p.shift_from_radps));
}

void validate(const GearedParameters& p) {
  fields::check(p);
  check_clutch(p.clutch, p.engine);
}

void validate(const CvtParameters& p) {
  fields::check(p);
  check_clutch(p.clutch, p.engine);
}

void validate(const DrivelineParameters& parameters) {
  fields::check(parameters);
}

}  // namespace rigwire::sim

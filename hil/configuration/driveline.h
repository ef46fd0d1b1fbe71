// Keys of drive lines: engine, clutch, gearbox or belt variator, differentials.
//
//   type: geared            # or cvt
//   engine: {idle: 700 rpm, ...}
#pragma once

#include <array>
#include <cstddef>

#include "fields/visitor.h"
#include "sim/driveline/parameters.h"

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::AxleDrive>, 3> kAxleDrives{
    {{sim::AxleDrive::rear, "rear", "Rear axle only."},
     {sim::AxleDrive::switchable_front, "switchable_front",
      "Rear axle; the centre lock couples the front axle."},
     {sim::AxleDrive::centre_differential, "centre_differential",
      "Both axles, equal torque; the centre lock couples them."}}};

inline void visit(fields::Visitor& v, sim::TorquePoint& p) {
  v.number("speed", p.speed_radps, fields::in("rpm").at_least(0), "Of the crank.");
  v.number("torque", p.torque_nm, fields::in("N m").above(0), "At full load.");
}

inline void visit(fields::Visitor& v, sim::EngineParameters& p) {
  v.list("full_load", p.full_load, "Torque at full load by rising speed, linear between.");
  v.number("inertia", p.inertia_kgm2, fields::in("kg m2").above(0),
           "Crank, flywheel, clutch disc.");
  v.number("drag", p.drag_nm, fields::in("N m").at_least(0), "Friction towards standstill.");
  v.number("drag_slope", p.drag_nmsprad, fields::in("N m s/rad").at_least(0),
           "Friction per speed.");
  v.number("idle", p.idle_radps, fields::in("rpm").above(0), "Speed of the idle governor.");
  v.number("maximum", p.maximum_radps, fields::in("rpm").above(0), "Full torque up to here.");
  v.number("cut_off", p.cut_off_radps, fields::in("rpm").above(0), "No torque from here on.");
  v.number("governor", p.governor_nmsprad, fields::in("N m s/rad").above(0),
           "Torque per missing speed.");
  v.number("governor_integral", p.governor_integral_s, fields::in("s").above(0),
           "Time in which the set-speed governor repeats it.");
  v.number("torque_lag", p.torque_lag_s, fields::in("ms").at_least(0), "Accelerator to torque.");
}

inline void visit(fields::Visitor& v, sim::ClutchParameters& p) {
  v.boolean("centrifugal", p.centrifugal, "Closes by engine speed, not by the faster side's.");
  v.number("capacity", p.capacity_nm, fields::in("N m").above(0), "Closed.");
  v.number("open", p.open_radps, fields::in("rpm").above(0), "Open below.");
  v.number("full", p.full_radps, fields::in("rpm").above(0), "Closed from here on.");
}

inline void visit(fields::Visitor& v, sim::AxleParameters& p) {
  constexpr auto kFront = static_cast<std::size_t>(Differential::front);
  constexpr auto kCentre = static_cast<std::size_t>(Differential::centre);
  constexpr auto kRear = static_cast<std::size_t>(Differential::rear);
  v.choice("drive", p.drive, kAxleDrives, "Which axles the engine turns.");
  v.boolean("front_lock", p.lockable[kFront], "Whether the front differential has a lock.");
  v.boolean("centre_lock", p.lockable[kCentre], "Whether the axles can be coupled.");
  v.boolean("rear_lock", p.lockable[kRear], "Whether the rear differential has a lock.");
  v.number("lock_time", p.lock_time_s, fields::in("ms").at_least(0), "Request to engagement.");
  v.number("lock_rate_difference", p.lock_rate_difference_radps, fields::in("rad/s").above(0),
           "Greater differences of wheel rates keep a lock from engaging.");
  v.number("final_ratio", p.final_ratio, fields::plain().above(0), "Gearbox output to axle shaft.");
  v.number("portal_ratio", p.portal_ratio, fields::plain().above(0),
           "Axle shaft to wheel; 1 without.");
  v.number("output_inertia", p.output_inertia_kgm2, fields::in("kg m2").at_least(0),
           "Shafts and bevel gears, at the gearbox's output.");
  v.number("output_drag", p.output_drag_nmsprad, fields::in("N m s/rad").at_least(0),
           "Oil drag at the gearbox's output.");
}

inline void visit(fields::Visitor& v, sim::GearboxParameters& p) {
  v.number_list("forward", p.forward, fields::plain().above(0), "Ratios, first gear first.");
  v.number_list("reverse", p.reverse, fields::plain().above(0),
                "Ratios, first reverse gear first.");
  v.number("crawler_factor", p.crawler_factor, fields::plain().at_least(0),
           "Of every ratio in the crawler group; 0 = no such group.");
  v.number("ramp_down", p.ramp_down_s, fields::in("ms").at_least(0),
           "Torque to zero before a shift.");
  v.number("synchronisation", p.synchronisation_s, fields::in("ms").at_least(0), "Out of gear.");
  v.number("ramp_up", p.ramp_up_s, fields::in("ms").at_least(0), "Torque back after a shift.");
  v.number("group_change", p.group_change_radps, fields::in("rad/s").above(0),
           "Mean wheel rate below which the group may change.");
}

inline void visit(fields::Visitor& v, sim::GearedParameters& p) {
  v.section("engine", p.engine, "Combustion engine.");
  v.section("clutch", p.clutch, "Automated friction clutch.");
  v.section("gearbox", p.gearbox, "Step gearbox.");
  v.section("axles", p.axles, "From the gearbox's output to the wheels.");
}

inline void visit(fields::Visitor& v, sim::VariatorParameters& p) {
  v.number("launch_ratio", p.launch_ratio, fields::plain().above(0), "At standstill.");
  v.number("top_ratio", p.top_ratio, fields::plain().above(0), "Fully shifted.");
  v.number("shift_from", p.shift_from_radps, fields::in("rpm").above(0),
           "Engine speed at launch ratio.");
  v.number("shift_to", p.shift_to_radps, fields::in("rpm").above(0), "Engine speed at top ratio.");
  v.number("lag", p.lag_s, fields::in("ms").at_least(0), "Of the sheaves.");
  v.number_list("ranges", p.ranges, fields::plain().above(0),
                "Ratios of the groups, gear 1 first.");
  v.number("reverse_range", p.reverse_range, fields::plain().at_least(0), "0 = no reverse.");
  v.number("range_change", p.range_change_radps, fields::in("rad/s").above(0),
           "Mean wheel rate below which the range may change.");
}

inline void visit(fields::Visitor& v, sim::CvtParameters& p) {
  v.section("engine", p.engine, "Combustion engine.");
  v.section("clutch", p.clutch, "Centrifugal clutch.");
  v.section("variator", p.variator, "Belt variator and range groups.");
  v.section("axles", p.axles, "From the variator's output to the wheels.");
}

/// The whole drive line, as the machine's section shows it.
inline void visit(fields::Visitor& v, sim::DrivelineParameters& p) {
  v.variant("type", p, "Which drive line it is.");
}

}  // namespace rigwire::sim

// Keys, units and ranges of an excavator's parameters (sim/excavator/parameters.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>

#include "fields/visitor.h"
#include "hil/configuration/integration_scheme.h"
#include "hil/configuration/tyre.h"
#include "sim/excavator/parameters.h"

namespace rigwire::sim {

inline void visit(fields::Visitor& v, sim::RigidBodyParameters& p) {
  v.number("mass", p.mass_kg, fields::in("kg").above(0), "Mass.");
  v.vector3("center_of_mass", p.center_of_mass_m, fields::in("m"), "In the link's frame.");
  v.vector3("principal_inertia", p.principal_inertia_kgm2, fields::in("kg m2").above(0),
            "About the centre of mass, along the link's axes.");
}

inline void visit(fields::Visitor& v, sim::DirectLinkageParameters& p) {
  v.vector2("base_pin", p.base_pin_m, fields::in("m"), "[x, z] on the link before the joint.");
  v.vector2("rod_pin", p.rod_pin_m, fields::in("m"), "[x, z] on the link that the joint moves.");
}

inline void visit(fields::Visitor& v, sim::BucketLinkageParameters& p) {
  v.vector2("base_pin", p.base_pin_m, fields::in("m"),
            "[x, z] of the cylinder's foot on the stick.");
  v.vector2("idler_pivot", p.idler_pivot_m, fields::in("m"),
            "[x, z] of the idler's pivot on the stick.");
  v.number("idler_length", p.idler_length_m, fields::in("mm").above(0), "Idler pivot to rod pin.");
  v.number("link_length", p.link_length_m, fields::in("mm").above(0),
           "Rod pin to the bucket's lug.");
  v.number("lug_radius", p.lug_radius_m, fields::in("mm").above(0), "Bucket pin to lug.");
  v.number("lug_angle", p.lug_angle_rad, fields::in("deg").between(-180, 180),
           "Direction of the lug from the bucket's x, upward positive.");
  v.integer("branch", p.branch, fields::IntegerRule{-1, 1},
            "Side of the four-bar: 1 left, -1 right.");
}

inline void visit(fields::Visitor& v, sim::CylinderParameters& p) {
  v.integer("count", p.count, fields::IntegerRule{1, 4}, "Equal cylinders side by side.");
  v.number("bore", p.bore_m, fields::in("mm").above(0), "Piston diameter.");
  v.number("rod", p.rod_m, fields::in("mm").above(0), "Rod diameter.");
  v.number("length_min", p.length_min_m, fields::in("mm").above(0), "Pin to pin, retracted.");
  v.number("length_max", p.length_max_m, fields::in("mm").above(0), "Pin to pin, extended.");
}

inline void visit(fields::Visitor& v, sim::SpoolParameters& p) {
  v.number("time_constant", p.time_constant_s, fields::in("ms").at_least(0),
           "Lag of the pilot stage.");
  v.number("rate_limit", p.rate_limit_per_s, fields::plain().above(0),
           "Full spool travels per second.");
  v.number("dead_band", p.dead_band, fields::plain().between(0, 0.5),
           "Share of travel without flow.");
  v.number("flow_max", p.flow_max_m3ps, fields::in("l/min").above(0), "At full travel.");
}

inline void visit(fields::Visitor& v, sim::SupplyParameters& p) {
  v.number("pump_flow", p.pump_flow_m3ps, fields::in("l/min").above(0), "Of all pumps.");
  v.number("power_limit", p.power_limit_w, fields::in("kW").above(0),
           "What the engine leaves for them.");
  v.number("efficiency", p.efficiency, fields::plain().above(0).at_most(1),
           "Shaft to hydraulic power.");
  v.number("relief_pressure", p.relief_pressure_pa, fields::in("MPa").above(0),
           "Of the implement.");
  v.number("swing_relief_pressure", p.swing_relief_pressure_pa, fields::in("MPa").above(0),
           "Of the swing.");
  v.number("load_sensing_margin", p.load_sensing_margin_pa, fields::in("MPa").at_least(0),
           "Supply above the highest load.");
  v.number("load_sensing_time_constant", p.load_sensing_time_constant_s,
           fields::in("ms").above(0).at_most(10000), "Lag of the pump's pressure regulator.");
  v.number("tank_pressure", p.tank_pressure_pa, fields::in("MPa").at_least(0), "Return line.");
}

inline void visit(fields::Visitor& v, sim::DriveParameters& p) {
  v.number("swing_stiffness", p.swing_stiffness_nmprad, fields::plain().above(0), "N m per rad.");
  v.number("boom_stiffness", p.boom_stiffness_npm, fields::in("N/m").above(0), "Spring of Eq. 5.");
  v.number("stick_stiffness", p.stick_stiffness_npm, fields::in("N/m").above(0),
           "Spring of Eq. 5.");
  v.number("bucket_stiffness", p.bucket_stiffness_npm, fields::in("N/m").above(0),
           "Spring of Eq. 5.");
  v.number("damping_ratio", p.damping_ratio, fields::plain().at_least(0), "Damper of Eq. 5.");
  v.number("end_stop_stiffness", p.end_stop_stiffness_npm, fields::in("N/m").above(0),
           "Piston against cylinder head.");
  v.number("cushion", p.cushion, fields::plain().between(0, 0.5),
           "Share of stroke slowed at each end.");
}

inline void visit(fields::Visitor& v, sim::ExcavatorPose& p) {
  v.number("swing", p.swing_rad, fields::in("deg").between(-360, 360), "Left positive.");
  v.number("boom", p.boom_rad, fields::in("deg").between(-180, 180),
           "Up positive, against the upper.");
  v.number("stick", p.stick_rad, fields::in("deg").between(-180, 180),
           "Up positive, against the boom.");
  v.number("bucket", p.bucket_rad, fields::in("deg").between(-180, 180),
           "Up positive, against the stick.");
}

inline void visit(fields::Visitor& v, sim::CarrierParameters& p) {
  v.number("wheelbase", p.wheelbase_m, fields::in("m").above(0),
           "Half before, half behind the swing axis.");
  v.number("track", p.track_m, fields::in("m").above(0), "Between the tyres' middles.");
  v.number("tyre_pressure", p.tyre_pressure_pa, fields::in("MPa").above(0), "Of all tyres.");
  v.section("tyre", p.tyre, "One tyre; twins count as one.");
}

inline void visit(fields::Visitor& v, sim::ChamberParameters& p) {
  v.number("bulk_modulus", p.bulk_modulus_pa, fields::in("MPa").above(0),
           "Of oil with some air, hoses.");
  v.number("hose_volume", p.hose_volume_m3, fields::plain().above(0),
           "m3 per side, dead volume included.");
  v.number("inlet_drop", p.inlet_drop_pa, fields::in("MPa").above(0),
           "What the valve's inlet needs.");
  v.number("outlet_drop", p.outlet_drop_pa, fields::in("MPa").above(0), "What its outlet needs.");
  v.number("port_conductance", p.port_conductance, fields::plain().above(0),
           "Of relief, anti-cavitation and float, m3/s per Pa.");
  v.number("damping_ratio", p.damping_ratio, fields::plain().at_least(0), "Of seals and lines.");
}

inline constexpr std::array<fields::Choice<sim::ExcavatorLevel>, 4> kExcavatorLevels{
    {{sim::ExcavatorLevel::kinematic, "kinematic", "Cylinders move as the valves ask, no forces."},
     {sim::ExcavatorLevel::quasi_static, "quasi_static", "Loads limit force and flow; stiff oil."},
     {sim::ExcavatorLevel::dynamic, "dynamic", "Oil as springs, Eq. 5 of the paper."},
     {sim::ExcavatorLevel::chambers, "chambers", "Two pressures per cylinder as states."}}};

inline constexpr std::array<fields::Choice<sim::ExcavatorCarrier>, 2> kExcavatorCarriers{
    {{sim::ExcavatorCarrier::fixed, "fixed", "The undercarriage stands still."},
     {sim::ExcavatorCarrier::moving, "moving", "It stands on tyres: rocks, slides, tips."}}};

inline void visit(fields::Visitor& v, sim::ExcavatorParameters& p) {
  v.section("undercarriage", p.undercarriage, "Link on the ground.");
  v.section("upper", p.upper, "Link that swings.");
  v.section("boom", p.boom, "Link.");
  v.section("stick", p.stick, "Link.");
  v.section("bucket", p.bucket, "Link, empty.");
  v.vector3("payload_center_of_mass", p.payload_center_of_mass_m, fields::in("m"),
            "In the bucket's frame.");
  v.number("payload_max", p.payload_max_kg, fields::in("kg").at_least(0), "Full bucket.");
  v.number("swing_axis_height", p.swing_axis_height_m, fields::in("m").above(0),
           "Slew ring above ground.");
  v.vector3("boom_foot", p.boom_foot_m, fields::in("m"), "Pin, in the upper's frame.");
  v.number("boom_length", p.boom_length_m, fields::in("m").above(0), "Foot pin to stick pin.");
  v.number("stick_length", p.stick_length_m, fields::in("m").above(0), "Stick pin to bucket pin.");
  v.number("bucket_tip", p.bucket_tip_m, fields::in("m").above(0),
           "Bucket pin to the tip of the teeth.");
  v.section("boom_linkage", p.boom_linkage, "Pins of the boom cylinders; base from the boom foot.");
  v.section("stick_linkage", p.stick_linkage, "Pins of the stick cylinder.");
  v.section("bucket_linkage", p.bucket_linkage, "Four-bar of the bucket.");
  v.section("boom_cylinder", p.boom_cylinder, "Cylinder.");
  v.section("stick_cylinder", p.stick_cylinder, "Cylinder.");
  v.section("bucket_cylinder", p.bucket_cylinder, "Cylinder.");
  v.number("swing_displacement", p.swing_displacement_m3prad, fields::plain().above(0),
           "Motor and gear, m3 per rad of swing.");
  v.section("supply", p.supply, "Pump and pressures.");
  v.section("swing_spool", p.swing_spool, "Valve section 1.");
  v.section("boom_spool", p.boom_spool, "Valve section 2.");
  v.section("stick_spool", p.stick_spool, "Valve section 3.");
  v.section("bucket_spool", p.bucket_spool, "Valve section 4.");
  v.section("drives", p.drives, "Springs and dampers of Eq. 5.");
  v.section("chambers", p.chambers, "Oil of level chambers.");
  v.choice("level", p.level, kExcavatorLevels, "How much of the drives is modelled.");
  v.choice("carrier", p.carrier, kExcavatorCarriers, "What the undercarriage does.");
  v.section("wheels", p.wheels, "What a moving carrier stands on, its brakes locked.");
  v.choice("scheme", p.scheme, kIntegrationSchemes, "How the arm's equations are stepped.");
  v.number("step", p.step_s, fields::in("ms").above(0).at_most(100),
           "Longest inner step of the arm.");
  v.number("gravity", p.gravity_mps2, fields::in("m/s2").at_least(0), "Downwards.");
  v.section("initial", p.initial, "Joint angles at the start.");
}

}  // namespace rigwire::sim

#include "hil/world/machine_configuration.h"

#include "fields/visitor.h"
#include "hil/configuration/digging.h"
#include "hil/configuration/driveline.h"
#include "hil/configuration/excavator.h"
#include "hil/configuration/roller.h"
#include "hil/configuration/wheeled_vehicle.h"

namespace rigwire::hil {

using fields::in;

void visit(fields::Visitor& v, ExcavatorMachine& p) {
  v.section("excavator", p.excavator, "Masses, pins, cylinders, hydraulics, drives.");
  v.boolean("digs", p.digs, "Whether the bucket moves the ground; else it passes through.");
  v.section("digging", p.digging, "The bucket as a tool, and the ground's limits.");
}

void visit(fields::Visitor& v, WheeledMachine& p) {
  v.section("wheeled", p.wheeled, "Body, axles, tyres, steering, brakes.");
  v.section("driveline", p.driveline, "Engine to wheels.");
}

void visit(fields::Visitor& v, RollerMachine& p) {
  v.section("roller", p.roller, "Masses, drums, steering, drive, supplements.");
}

void visit(fields::Visitor& v, LinkShape& p) {
  v.text("link", p.link, "One of the machine's links.");
  visit(v, p.placed);
}

void visit(fields::Visitor& v, MachineConfiguration& p) {
  v.text("name", p.name, "Name of the machine, for people.");
  v.text("text", p.text, "One line for `rigwire list machines`.");
  v.required("type");
  v.variant("type", p.settings, "Topology of the machine.");
  v.vector3("position", p.position_m, in("m"),
            "[east, north, up] of the origin of its first link.");
  v.number("yaw", p.yaw_rad, in("deg").between(-360, 360),
           "Direction of its x from east, left positive.");
  v.boolean("on_ground", p.on_ground, "Whether `up` counts from the terrain under it.");
  v.list("shapes", p.shapes, "What the lidar sees of it, by link.");
}

}  // namespace rigwire::hil

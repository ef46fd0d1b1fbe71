#include "hil/world/machine.h"

namespace rigwire::hil {

using fields::in;

void visit(fields::Visitor& v, MachineModel& p) {
  p.visit(v);
}

void visit(fields::Visitor& v, LinkShape& p) {
  v.text("link", p.link, "One of the machine's links.");
  visit(v, p.placed);
}

void visit(fields::Visitor& v, MachineConfiguration& p) {
  v.text("name", p.name, "Name of the machine, for people.");
  v.text("text", p.text, "One line for `rigwire list machines`.");
  v.required("type");
  fields::visit_chosen(v, "type", p.model, "Topology of the machine.");
  v.vector3("position", p.position_m, in("m").between(-10'000, 10'000),
            "[east, north, up] of the origin of its first link.");
  v.number("yaw", p.yaw_rad, in("deg").between(-360, 360),
           "Direction of its x from east, left positive.");
  v.boolean("on_ground", p.on_ground, "Whether `up` counts from the terrain under it.");
  v.list("shapes", p.shapes, "What the lidar sees of it, by link.");
  v.section("motion", p.motion, "A recorded motion that it makes in place of its own.");
}

}  // namespace rigwire::hil

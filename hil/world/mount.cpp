#include "hil/world/mount.h"

#include "fields/visitor.h"

namespace rigwire::hil {

using fields::in;

void visit(fields::Visitor& v, MountConfiguration& p) {
  v.text("link", p.link, "Link of the machine that carries it.");
  v.vector3("position", p.position_m, in("m").between(-100, 100),
            "Place in the link's frame: x forward, y left, z up.");
  v.section("rotation", p.rotation, "Rotation of the sensor's axes against the link's.");
}

}  // namespace rigwire::hil

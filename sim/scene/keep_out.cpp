#include "sim/scene/keep_out.h"

#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;

void visit(fields::Visitor& v, KeepOut& p) {
  v.vector2("centre", p.centre_m, in("m").between(-4000, 4000), "[east, north] of the disc.");
  v.number("radius", p.radius_m, in("m").between(0, 4000),
           "Radius of the disc, within which nothing is put.");
}

}  // namespace rigwire::sim

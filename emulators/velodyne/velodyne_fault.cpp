#include "emulators/velodyne/velodyne_fault.h"

namespace rigwire::emulators {

using fields::in;
using fields::IntegerRule;

namespace {

template <class Fault>
void visit_share(fields::Visitor& v, Fault& p) {
  v.number("share", p.share, in("%").above(0).at_most(100),
           "Share of the packets that are affected, drawn for each packet.");
  visit_ramp(v, p.ramp);
}

}  // namespace

void visit(fields::Visitor& v, LostPacketsFault& p) {
  visit_share(v, p);
}

void visit(fields::Visitor& v, SwappedPacketsFault& p) {
  visit_share(v, p);
}

void visit(fields::Visitor& v, DuplicatedPacketsFault& p) {
  visit_share(v, p);
}

void visit(fields::Visitor& v, DeadLaserFault& p) {
  v.integer("first", p.first, IntegerRule{0, 127},
            "First laser that sees nothing, by the model's numbers, which count from 0.");
  v.integer("last", p.last, IntegerRule{0, 127}, "Last laser that sees nothing, included.");
}

void visit(fields::Visitor& v, DirtyWindowFault& p) {
  v.number("from", p.from_deg, in("deg").stored_as("deg").between(0, 360),
           "Azimuth at which the dirt begins, clockwise.");
  v.number("to", p.to_deg, in("deg").stored_as("deg").between(0, 360),
           "Azimuth at which the dirt ends; may lie beyond 0.");
  v.number("transmission", p.transmission, in("%").between(0, 100),
           "Share of the light that passes the dirt, one way.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, ClockOffsetFault& p) {
  v.number("offset", p.offset_s, in("s").between(-3600, 3600),
           "How far the timestamps are off; not 0.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, HourOverrunFault& p) {
  v.number("overrun", p.overrun_s, in("s").above(0).at_most(1),
           "How far the timestamp passes the hour.");
}

void visit(fields::Visitor& v, FactoryBytesFault& p) {
  v.integer("return_mode", p.return_mode, IntegerRule{0, 255}, "Byte in place of the return mode.");
  v.integer("product", p.product, IntegerRule{0, 255}, "Byte in place of the product's number.");
}

void visit(fields::Visitor& v, VelodyneFault& p) {
  visit_fault(v, p);
}

}  // namespace rigwire::emulators

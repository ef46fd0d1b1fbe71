#include "emulators/gige_camera/gige_camera_fault.h"

namespace rigwire::emulators {

using fields::in;

namespace {

template <class Fault>
void visit_share(fields::Visitor& v, Fault& p, std::string_view text) {
  v.number("share", p.share, in("%").above(0).at_most(100), text);
  visit_ramp(v, p.ramp);
}
constexpr std::string_view kOfPackets =
    "Share of the packets that are affected, drawn for each packet.";

}  // namespace

void visit(fields::Visitor& v, LostStreamPacketsFault& p) {
  visit_share(v, p, kOfPackets);
}

void visit(fields::Visitor& v, SwappedStreamPacketsFault& p) {
  visit_share(v, p, kOfPackets);
}

void visit(fields::Visitor& v, DuplicatedStreamPacketsFault& p) {
  visit_share(v, p, kOfPackets);
}

void visit(fields::Visitor& v, LostTriggerFault& p) {
  visit_share(v, p, "Share of the triggers that are affected, drawn for each trigger.");
}

void visit(fields::Visitor& v, SlowPicturesFault& p) {
  v.number("share", p.share, in("%").between(1, 100),
           "Share of the rate at which pictures still come.");
}

void visit(fields::Visitor& v, OverTemperatureFault& p) {
  v.number("temperature", p.temperature_degc, in("degC").between(-40, 150),
           "Temperature of the camera's board.");
}

void visit(fields::Visitor& v, GigeCameraFault& p) {
  visit_fault(v, p);
}

}  // namespace rigwire::emulators

#include "emulators/gige_camera/gige_camera_fault.h"

namespace rigwire::emulators {

using fields::in;

namespace {

void visit_probability(fields::Visitor& v, double& probability, std::string_view text) {
  v.number("probability", probability, in("%").above(0).at_most(100), text);
}
constexpr std::string_view kOfEachPacket = "Probability with which it happens to each packet.";

}  // namespace

void visit(fields::Visitor& v, LostStreamPacketsFault& p) {
  visit_probability(v, p.probability, kOfEachPacket);
}

void visit(fields::Visitor& v, SwappedStreamPacketsFault& p) {
  visit_probability(v, p.probability, kOfEachPacket);
}

void visit(fields::Visitor& v, DuplicatedStreamPacketsFault& p) {
  visit_probability(v, p.probability, kOfEachPacket);
}

void visit(fields::Visitor& v, LostTriggerFault& p) {
  visit_probability(v, p.probability, "Probability with which it happens to each trigger.");
}

void visit(fields::Visitor& v, OverTemperatureFault& p) {
  v.number("temperature", p.temperature_degc, in("degC").between(-40, 150),
           "Temperature of the camera's board.");
}

void visit(fields::Visitor& v, GigeCameraFault& p) {
  visit_fault(v, p);
}

}  // namespace rigwire::emulators

#include "emulators/dbc_node/fault.h"

namespace rigwire::emulators {

using fields::IntegerRule;
using fields::plain;

namespace {

void visit_message(fields::Visitor& v, std::string& message) {
  v.required("message");
  v.text("message", message, "The message that has it.");
}
void visit_signal(fields::Visitor& v, std::string& message, std::string& signal) {
  visit_message(v, message);
  v.required("signal");
  v.text("signal", signal, "Its signal.");
}

}  // namespace

void visit(fields::Visitor& v, SilentNodeFault& p) {
  v.text("message", p.message, "The message that stays away; empty: all.");
}
void visit(fields::Visitor& v, FrozenSignalFault& p) {
  visit_signal(v, p.message, p.signal);
}
void visit(fields::Visitor& v, FalseSignalFault& p) {
  visit_signal(v, p.message, p.signal);
  v.number("value", p.value, plain(), "What it shows, in the signal's unit.");
}
void visit(fields::Visitor& v, RawSignalFault& p) {
  visit_signal(v, p.message, p.signal);
  v.integer("raw", p.raw, IntegerRule{}, "Its bits; those beyond its width are not looked at.");
}
void visit(fields::Visitor& v, StoppedCounterFault& p) {
  visit_message(v, p.message);
}
void visit(fields::Visitor& v, WrongChecksumFault& p) {
  visit_message(v, p.message);
}
void visit(fields::Visitor& v, ShortFrameFault& p) {
  visit_message(v, p.message);
}
void visit(fields::Visitor& v, DbcNodeFault& p) {
  visit_fault(v, p);
}

DbcFaultPlace place_of(const DbcNodeFault& fault) {
  return std::visit(
      [](const auto& what) -> DbcFaultPlace {
        if constexpr (requires { what.signal; }) {
          return {what.message, what.signal};
        } else {
          return {what.message, {}};
        }
      },
      fault.what);
}

}  // namespace rigwire::emulators

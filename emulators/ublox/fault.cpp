#include "emulators/ublox/fault.h"

namespace rigwire::emulators {

using fields::in;
using fields::IntegerRule;

void visit(fields::Visitor& v, WrongLeapSecondFault& p) {
  v.integer("seconds", p.seconds, IntegerRule{-10, 10, fields::unit("s")},
            "Leap seconds that are too many; not 0.");
  v.check(p.seconds != 0, "seconds", "0 is the right number of leap seconds", "0",
          "-10 .. -1, 1 .. 10");
}

void visit(fields::Visitor& v, UartNoiseFault& p) {
  v.number("bit_error_rate", p.bit_error_rate, in("1").above(0).at_most(0.5),
           "Probability with which each bit is turned over.");
}

void visit(fields::Visitor& v, UbloxFault& p) {
  visit_fault(v, p);
}

}  // namespace rigwire::emulators

// The list of faults of a whole rig, of which those of its devices, buses and lines are short
// forms:
//
//   faults:
//     - {on: gnss, type: jamming, at: 12 s, for: 5 s, loss: 30 dB}
//     - {on: bus can, type: unplugged, device: imu_boom, every: 2 s, duty: 10 %}
//     - {on: sky, type: outage, when: {quantity: speed, value: 2}}
#pragma once

#include <string>

#include "hil/configuration/document.h"
#include "hil/configuration/problems.h"
#include "sim/samples/fault_book.h"

namespace rigwire::hil {

/// What every entry has; beside it those keys that its kind has there.
struct ListedFault {
  std::string on;
  std::string type;
  FaultPeriod when;
};
inline void visit(fields::Visitor& v, ListedFault& p) {
  v.required("on");
  v.text("on", p.on,
         "A device, `bus NAME`, `modbus NAME`, `air`, `machine.engine`, `machine.pumps`, or `sky`: "
         "every device with an antenna.");
  v.required("type");
  v.text("type", p.type, "Kind of the fault, one that this can have.");
  visit(v, p.when);
}

/// Gives each fault of the document's list to the list of what it is on, behind what that has, with
/// the place where it was written; one on the sky to every device with an antenna. From there on
/// they are read as any other, and `origins` knows where they were written. What names nothing that
/// can have faults goes to `problems`.
void bring_faults_home(Value& document, Problems& problems, Origins& origins);

}  // namespace rigwire::hil

// rigwire: simulated field machines on the wires of real devices.
//
// Only bytes that a real device would send cross the boundary to the field software. Ground truth
// leaves through one separate tap (`run --truth FILE`), never through a device.
#include "hil/command_line/command_line.h"

int main(int count, char** arguments) {
  return rigwire::hil::run_program(count, arguments);
}

// rigwire-conform: the verb `conform` of rigwire, which starts it.
#include "hil/command_line/command_line.h"
#include "hil/conformance/conform.h"

int main(int count, char** arguments) {
  rigwire::hil::CompanionVerbs companions;
  companions.conform = rigwire::hil::conform;
  companions.conformance_suites = rigwire::hil::conformance_suites;
  return rigwire::hil::run_program(count, arguments, companions);
}

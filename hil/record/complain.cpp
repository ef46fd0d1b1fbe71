#include "hil/record/complain.h"

#include <unistd.h>

#include "drivers/output.h"
#include "hil/configuration/plain_text.h"

namespace rigwire::hil {

void complain(const std::string& text, std::chrono::milliseconds patience) {
  const std::string line = "rigwire: " + printable(text, "\n") + "\n";
  // Nobody is left to be told when this fails, too.
  static_cast<void>(
      drivers::Output(STDERR_FILENO).write(line, std::chrono::steady_clock::now() + patience));
}

}  // namespace rigwire::hil

#include "hil/run.h"

#include <stdexcept>

namespace rigwire::hil {

int run(const RigConfiguration&, const RunOptions&) {
  throw std::runtime_error("this build has no executive");
}

}  // namespace rigwire::hil

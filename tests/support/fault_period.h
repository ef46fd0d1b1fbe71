#pragma once

#include "sim/samples/fault_book.h"

namespace rigwire {

/// Since the start of the run.
inline FaultPeriod between(Duration begin, Duration end) {
  return {begin, end - begin};
}

}  // namespace rigwire

// Who hears of every fix of a satellite receiver: a lidar for its time, a vehicle gateway for its
// position.
#pragma once

#include "sim/samples/gnss_sample.h"

namespace rigwire::hil {

class FixListener {
 public:
  virtual ~FixListener() = default;
  virtual void observe_fix(const GnssSample& sample) = 0;
};

}  // namespace rigwire::hil

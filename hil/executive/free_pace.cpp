#include "hil/executive/free_pace.h"

#include <algorithm>

namespace rigwire::hil {

bool FreePace::lets_go(SimTime now, WallTime wall) {
  if (now >= hastens_until_) {
    const std::chrono::duration<double, std::nano> span = now - left_;
    const WallTime due = due_ + std::chrono::round<WallTime::duration>(span / factor_);
    if (wall < due) {
      return false;
    }
    due_ = std::max(due, wall - kMadeUp);
  } else {
    due_ = wall;
  }
  left_ = now;
  return true;
}

}  // namespace rigwire::hil

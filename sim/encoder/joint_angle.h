// The angle between two links about an axis of the first: the truth behind a rotary encoder.
//
// R = R_BM, the moving link's attitude in the base. About z the angle is atan2(R_10, R_00); about
// another axis the same with the axes in turn. For links that turn about that axis alone it is
// exact; a tilt of the shaft by e adds an error of the order e^2. Turns are counted: between two
// calls the shaft must turn by less than half a revolution. The first angle is within -pi .. pi.
#pragma once

#include <optional>

#include "sim/link_motion.h"
#include "sim/samples/encoder_sample.h"

namespace rigwire::sim {

class JointAngle {
 public:
  /// `axis` is 0 x, 1 y, 2 z.
  explicit JointAngle(int axis) : axis_(axis) {}

  [[nodiscard]] EncoderSample sample(SimTime time, const LinkMotion& base,
                                     const LinkMotion& moving);

 private:
  int axis_;
  std::optional<double> angle_rad_;  ///< The last one.
};

}  // namespace rigwire::sim

#include "sim/replay/motion_track.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rigwire::sim {
namespace {

/// Position and the four numbers of the attitude.
using Coordinates = Eigen::Matrix<double, 7, 1>;

/// The cubic in s from 0 to 1 with these ends; slopes per h.
template <class Vector>
Vector hermite(double s, double h, const Vector& x0, const Vector& slope0, const Vector& x1,
               const Vector& slope1) {
  const double s2 = s * s;
  const double s3 = s2 * s;
  return (2.0 * s3 - 3.0 * s2 + 1.0) * x0 + (s3 - 2.0 * s2 + s) * h * slope0 +
         (3.0 * s2 - 2.0 * s3) * x1 + (s3 - s2) * h * slope1;
}

/// a times b, of quaternions as they lie in memory.
Eigen::Vector4d product(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
  return (Eigen::Quaterniond(a) * Eigen::Quaterniond(b)).coeffs();
}

/// q' = w q / 2, w in the world.
Eigen::Vector4d attitude_rate(const Eigen::Vector3d& w_W, const Eigen::Vector4d& q) {
  return 0.5 * product({w_W.x(), w_W.y(), w_W.z(), 0.0}, q);
}

/// The imaginary part of a b*, twice.
Eigen::Vector3d twice_imaginary(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
  return 2.0 * product(a, Eigen::Quaterniond(b).conjugate().coeffs()).head<3>();
}

}  // namespace

MotionTrack::MotionTrack(const Eigen::Isometry3d& X_WL) : times_{kStart} {
  add_pose(X_WL);
}

MotionTrack::MotionTrack(std::vector<SimTime> times, const std::vector<LinkMotion>& motions)
    : times_(std::move(times)) {
  assert(!times_.empty() && times_.size() == motions.size());
  knots_.reserve(motions.size());
  for (const LinkMotion& motion : motions) {
    add_pose(motion.X_WL);
    Knot& knot = knots_.back();
    knot.v_W = motion.v_WL_W;
    knot.w_W = motion.w_WL_W;
    knot.a_W = motion.a_WL_W;
    knot.alpha_W = motion.alpha_WL_W;
  }
}

MotionTrack::MotionTrack(std::vector<SimTime> times, const std::vector<Eigen::Isometry3d>& poses)
    : times_(std::move(times)) {
  assert(!times_.empty() && times_.size() == poses.size());
  knots_.reserve(poses.size());
  for (const Eigen::Isometry3d& pose : poses) {
    add_pose(pose);
  }
  fit_spline();
}

void MotionTrack::add_pose(const Eigen::Isometry3d& X_WL) {
  Knot knot;
  knot.p_W = X_WL.translation();
  knot.q = Eigen::Quaterniond(X_WL.linear()).normalized().coeffs();
  if (!knots_.empty() && knot.q.dot(knots_.back().q) < 0.0) {
    knot.q = -knot.q;
  }
  knots_.push_back(knot);
}

void MotionTrack::fit_spline() {
  const std::size_t n = knots_.size();
  if (n < 2) {
    return;
  }
  const auto at = [&](std::size_t i) {
    Coordinates y;
    y << knots_[i].p_W, knots_[i].q;
    return y;
  };
  const auto span_s = [&](std::size_t i) { return to_seconds(times_[i + 1] - times_[i]); };
  // Second derivatives M: h M- + 2 (h + h+) M + h+ M+ = 6 (slope+ - slope), none at the ends; the
  // tridiagonal system is eliminated forwards and substituted backwards.
  std::vector<Coordinates> second(n, Coordinates::Zero());
  std::vector<double> upper(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = span_s(i - 1);
    const double after = span_s(i);
    const Coordinates bend = 6.0 * ((at(i + 1) - at(i)) / after - (at(i) - at(i - 1)) / before);
    const double pivot = 2.0 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    second[i] = (bend - before * second[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) {
    second[i] -= upper[i] * second[i + 1];
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t piece = std::min(i, n - 2);
    const double h = span_s(piece);
    const Coordinates slope = (at(piece + 1) - at(piece)) / h;
    const Coordinates first =
        i == piece ? Coordinates(slope - h / 6.0 * (2.0 * second[i] + second[i + 1]))
                   : Coordinates(slope + h / 6.0 * (second[i - 1] + 2.0 * second[i]));
    Knot& knot = knots_[i];
    const Eigen::Vector4d q1 = first.tail<4>();
    const Eigen::Vector4d q2 = second[i].tail<4>();
    knot.v_W = first.head<3>();
    knot.a_W = second[i].head<3>();
    // The attitude is the unit along the spline: what changes the length alone does not turn.
    knot.w_W = twice_imaginary(q1, knot.q);
    knot.alpha_W = twice_imaginary(q2, knot.q) - 2.0 * knot.q.dot(q1) * knot.w_W;
  }
}

/// Interpolates as motion_track.h says: cubic Hermite polynomials for position, attitude, velocity
/// and rate, straight lines for the accelerations.
LinkMotion MotionTrack::at(SimTime time) const {
  LinkMotion motion;
  const auto stand = [&](const Knot& knot) {
    motion.X_WL.translation() = knot.p_W;
    motion.X_WL.linear() = Eigen::Quaterniond(knot.q).toRotationMatrix();
  };
  const auto next = std::upper_bound(times_.begin(), times_.end(), time);
  if (next == times_.begin() || (next == times_.end() && time > times_.back())) {
    stand(next == times_.begin() ? knots_.front() : knots_.back());
    return motion;
  }
  const auto upper = static_cast<std::size_t>(next - times_.begin());
  const Knot& a = knots_[upper - 1];
  if (next == times_.end()) {
    stand(a);
    motion.v_WL_W = a.v_W;
    motion.w_WL_W = a.w_W;
    motion.a_WL_W = a.a_W;
    motion.alpha_WL_W = a.alpha_W;
    return motion;
  }
  const Knot& b = knots_[upper];
  const double h = to_seconds(times_[upper] - times_[upper - 1]);
  const double s = to_seconds(time - times_[upper - 1]) / h;
  motion.X_WL.translation() = hermite(s, h, a.p_W, a.v_W, b.p_W, b.v_W);
  const Eigen::Vector4d q =
      hermite(s, h, a.q, attitude_rate(a.w_W, a.q), b.q, attitude_rate(b.w_W, b.q));
  motion.X_WL.linear() = Eigen::Quaterniond(q).normalized().toRotationMatrix();
  motion.v_WL_W = hermite(s, h, a.v_W, a.a_W, b.v_W, b.a_W);
  motion.w_WL_W = hermite(s, h, a.w_W, a.alpha_W, b.w_W, b.alpha_W);
  motion.a_WL_W = (1.0 - s) * a.a_W + s * b.a_W;
  motion.alpha_WL_W = (1.0 - s) * a.alpha_W + s * b.alpha_W;
  return motion;
}

}  // namespace rigwire::sim

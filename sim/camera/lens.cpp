#include "sim/camera/lens.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/camera/lens_blur.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr std::array<fields::Choice<LensModel>, 3> kLensModels{
    {{LensModel::brown_conrady, "brown_conrady", "Radial and tangential; up to 120 degrees."},
     {LensModel::kannala_brandt, "kannala_brandt", "Fisheye: radius by the angle."},
     {LensModel::equirectangular, "equirectangular", "Column by azimuth, row by elevation."}}};

constexpr double kHalfTurn = std::numbers::pi;
/// Rays of a brown_conrady lens farther from its axis than this are no picture.
constexpr double kGreatestTangent = 50.0;
constexpr int kLimitSteps = 4096;
constexpr int kMostNewtonSteps = 60;
/// Tolerance of the inverse, in focal lengths: 1e-9 pixels at 16384 pixels.
constexpr double kResidual = 2e-14;
/// By which an equirectangular picture may pass a pole or the full turn, rounding.
constexpr double kRounding_rad = 1e-9;

/// First root of `slope` in (0, last], by steps and bisection; `last` without one.
template <class Slope>
double first_fold(double last, const Slope& slope) {
  double before = 0.0;
  for (int i = 1; i <= kLimitSteps; ++i) {
    const double at = last * i / kLimitSteps;
    if (!(slope(at) > 0.0)) {
      double low = before;
      double high = at;
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        (slope(middle) > 0.0 ? low : high) = middle;
      }
      return low;
    }
    before = at;
  }
  return last;
}

void visit_opening(fields::Visitor& v, LensParameters& p) {
  v.number("f_number", p.f_number, plain().between(0.7, 64), "Focal length over its opening.");
}

void visit_sharpness(fields::Visitor& v, LensParameters& p) {
  v.number("mtf", p.mtf, plain().between(kLeastTransfer, 1),
           "Contrast left at 0.25 cycles per pixel, by lens and pixel; 1: no blur.");
}

void visit_offset(fields::Visitor& v, LensParameters& p) {
  v.vector2("principal_offset", p.principal_offset_px, plain().between(-10000, 10000),
            "Principal point, from the sensor's middle, in pixels right and down.");
}

}  // namespace

void visit(fields::Visitor& v, LensParameters& p) {
  v.choice("model", p.model, kLensModels, "How directions become places on the sensor.");
  v.number("focal_length", p.focal_length_m, in("mm").between(0.01, 1000),
           "Focal length of the lens.");
  if (p.model == LensModel::equirectangular) {
    for (const char* const key : {"k1", "k2", "k3", "image_circle", "vignetting"}) {
      v.refused(key, "equirectangular pictures have none");
    }
    visit_opening(v, p);
    visit_sharpness(v, p);
    v.refused("p1", "only brown_conrady has it");
    v.refused("p2", "only brown_conrady has it");
    v.refused("k4", "only kannala_brandt has it");
    visit_offset(v, p);
    return;
  }
  visit_light(v, p);
  v.number("k1", p.k1, plain().between(-10, 10), "Radial distortion, second order.");
  v.number("k2", p.k2, plain().between(-10, 10), "Radial distortion, fourth order.");
  if (p.model == LensModel::brown_conrady) {
    v.number("p1", p.p1, plain().between(-1, 1), "Tangential distortion, first.");
    v.number("p2", p.p2, plain().between(-1, 1), "Tangential distortion, second.");
    v.refused("k4", "only kannala_brandt has it");
  } else {
    v.refused("p1", "only brown_conrady has it");
    v.refused("p2", "only brown_conrady has it");
  }
  v.number("k3", p.k3, plain().between(-10, 10), "Radial distortion, sixth order.");
  if (p.model == LensModel::kannala_brandt) {
    v.number("k4", p.k4, plain().between(-10, 10), "Radial distortion, eighth order.");
  }
  visit_offset(v, p);
  v.number("image_circle", p.image_circle_rad, in("deg").between(0, 180),
           "Farther from the axis than this the picture is black; 0 = the sensor is filled.");
}

void visit_light(fields::Visitor& v, LensParameters& p) {
  visit_opening(v, p);
  v.number("vignetting", p.vignetting, plain().between(0, 1),
           "Fall-off of light to the edge: 1 as cos^4 of the angle, 0 none.");
  visit_sharpness(v, p);
}

void validate(const LensParameters& parameters) {
  fields::check(parameters);
}

Lens::Lens(const LensParameters& parameters, double pixel_pitch_m, int width_px, int height_px)
    : parameters_(parameters),
      focal_px_(parameters.focal_length_m / pixel_pitch_m),
      centre_(0.5 * (width_px - 1) + parameters.principal_offset_px.x(),
              0.5 * (height_px - 1) + parameters.principal_offset_px.y()),
      width_px_(width_px),
      height_px_(height_px),
      circle_rad_(parameters.image_circle_rad > 0.0 ? parameters.image_circle_rad : kHalfTurn),
      limit_(0.0) {
  validate(parameters);
  if (!(pixel_pitch_m > 0.0) || !std::isfinite(pixel_pitch_m) || width_px < 1 || height_px < 1) {
    throw std::invalid_argument(
        "lens: found a sensor of " + std::to_string(width_px) + " x " + std::to_string(height_px) +
        " pixels of " + std::to_string(1e6 * pixel_pitch_m) + " um, allowed are positive numbers");
  }
  find_limit();
  require_whole_picture();
}

void Lens::find_limit() {
  const LensParameters& p = parameters_;
  if (p.model == LensModel::equirectangular) {
    return;
  }
  if (p.model == LensModel::kannala_brandt) {
    const double last = std::min(circle_rad_, kHalfTurn);
    limit_ = first_fold(last, [this](double theta) { return image_radius_slope(theta); });
    folds_ = limit_ < last;
  } else {
    const double tangent = circle_rad_ < 0.5 * kHalfTurn ? std::tan(circle_rad_) : kGreatestTangent;
    const double last = std::pow(std::min(tangent, kGreatestTangent), 2);
    // d(r (1 + k1 s + k2 s^2 + k3 s^3)) / dr with s = r^2.
    limit_ = first_fold(last, [&p](double s) {
      return 1.0 + s * (3.0 * p.k1 + s * (5.0 * p.k2 + s * 7.0 * p.k3));
    });
    folds_ = limit_ < last;
  }
}

void Lens::require_whole_picture() const {
  if (parameters_.model == LensModel::equirectangular) {
    const double across_rad = width_px_ / focal_px_;
    const double upper_rad = (centre_.y() + 0.5) / focal_px_;
    const double lower_rad = upper_rad - height_px_ / focal_px_;
    const double quarter = 0.5 * kHalfTurn + kRounding_rad;
    if (across_rad > 2.0 * kHalfTurn + kRounding_rad || upper_rad > quarter ||
        lower_rad < -quarter) {
      const auto degrees = [](double rad) { return std::to_string(rad * 180.0 / kHalfTurn); };
      throw std::invalid_argument("lens: found a picture of " + degrees(across_rad) +
                                  " degrees round, from " + degrees(upper_rad) + " down to " +
                                  degrees(lower_rad) + ", allowed is up to 360, from 90 to -90");
    }
    return;
  }
  const auto refuse = [&](const Eigen::Vector2d& pixel) {
    throw std::invalid_argument(
        "lens: the distortion (k1 " + std::to_string(parameters_.k1) + ", k2 " +
        std::to_string(parameters_.k2) + ", k3 " + std::to_string(parameters_.k3) +
        ") folds over, or passes 180 degrees, before pixel " + std::to_string(pixel.x()) + ", " +
        std::to_string(pixel.y()) + " of the picture; allowed are smaller ones or an image circle");
  };
  // The edge is farthest from the axis; a lattice within it finds where tangential terms fold.
  constexpr int kLattice = 64;
  for (int i = 0; i <= kLattice; ++i) {
    for (int k = 0; k <= kLattice; ++k) {
      const Eigen::Vector2d pixel(-0.5 + width_px_ * static_cast<double>(i) / kLattice,
                                  -0.5 + height_px_ * static_cast<double>(k) / kLattice);
      if (!direction(pixel)) {
        if (parameters_.image_circle_rad <= 0.0 || folds_) {
          refuse(pixel);
        }
      }
    }
  }
  if (parameters_.model == LensModel::brown_conrady) {
    const auto left = direction({-0.5, centre_.y()});
    const auto right = direction({width_px_ - 0.5, centre_.y()});
    if (left && right) {
      const double view_rad = std::acos(std::clamp(left->dot(*right), -1.0, 1.0));
      if (view_rad > kWidestBrownConrady_rad) {
        throw std::invalid_argument(
            "lens: found a view of " + std::to_string(view_rad * 180.0 / kHalfTurn) +
            " degrees across, allowed is up to 120; the model kannala_brandt sees more");
      }
    }
  }
}

Eigen::Vector2d Lens::distorted(const Eigen::Vector2d& ideal) const {
  const LensParameters& p = parameters_;
  const double x = ideal.x();
  const double y = ideal.y();
  const double s = ideal.squaredNorm();
  const double radial = 1.0 + s * (p.k1 + s * (p.k2 + s * p.k3));
  return {x * radial + 2.0 * p.p1 * x * y + p.p2 * (s + 2.0 * x * x),
          y * radial + p.p1 * (s + 2.0 * y * y) + 2.0 * p.p2 * x * y};
}

Eigen::Matrix2d Lens::distortion_slope(const Eigen::Vector2d& ideal) const {
  const LensParameters& p = parameters_;
  const double x = ideal.x();
  const double y = ideal.y();
  const double s = ideal.squaredNorm();
  const double radial = 1.0 + s * (p.k1 + s * (p.k2 + s * p.k3));
  const double by_s = p.k1 + s * (2.0 * p.k2 + s * 3.0 * p.k3);
  const double cross = 2.0 * x * y * by_s + 2.0 * p.p1 * x + 2.0 * p.p2 * y;
  Eigen::Matrix2d slope;
  slope << radial + 2.0 * x * x * by_s + 2.0 * p.p1 * y + 6.0 * p.p2 * x, cross, cross,
      radial + 2.0 * y * y * by_s + 6.0 * p.p1 * y + 2.0 * p.p2 * x;
  return slope;
}

std::optional<Eigen::Vector2d> Lens::undistorted(const Eigen::Vector2d& seen) const {
  Eigen::Vector2d ideal = seen;
  if (ideal.squaredNorm() > limit_) {
    ideal *= 0.99 * std::sqrt(limit_ / ideal.squaredNorm());
  }
  for (int i = 0; i < kMostNewtonSteps; ++i) {
    const Eigen::Vector2d residual = distorted(ideal) - seen;
    const Eigen::Matrix2d slope = distortion_slope(ideal);
    const double determinant = slope.determinant();
    if (!(determinant > 0.0) || !(slope(0, 0) > 0.0)) {
      return std::nullopt;
    }
    if (residual.norm() <= kResidual * (1.0 + seen.norm())) {
      return ideal.squaredNorm() < limit_ ? std::optional(ideal) : std::nullopt;
    }
    // Newton's step, kept within the monotonic range.
    Eigen::Vector2d next = ideal - slope.inverse() * residual;
    if (next.squaredNorm() >= limit_) {
      next = 0.5 * (ideal + next * (std::sqrt(limit_) / next.norm()));
    }
    ideal = next;
  }
  return std::nullopt;
}

double Lens::image_radius(double theta_rad) const {
  const LensParameters& p = parameters_;
  const double s = theta_rad * theta_rad;
  return theta_rad * (1.0 + s * (p.k1 + s * (p.k2 + s * (p.k3 + s * p.k4))));
}

double Lens::image_radius_slope(double theta_rad) const {
  const LensParameters& p = parameters_;
  const double s = theta_rad * theta_rad;
  return 1.0 + s * (3.0 * p.k1 + s * (5.0 * p.k2 + s * (7.0 * p.k3 + s * 9.0 * p.k4)));
}

std::optional<double> Lens::angle_at(double radius) const {
  double low = 0.0;
  double high = limit_;
  if (radius > image_radius(high)) {
    return std::nullopt;
  }
  double theta = std::min(radius, high);
  for (int i = 0; i < kMostNewtonSteps; ++i) {
    const double residual = image_radius(theta) - radius;
    if (std::abs(residual) <= kResidual * (1.0 + radius)) {
      return theta;
    }
    (residual > 0.0 ? high : low) = theta;
    // Newton's step; the middle of the bracket where it leaves that.
    const double next = theta - residual / image_radius_slope(theta);
    theta = next > low && next < high ? next : 0.5 * (low + high);
  }
  return theta;
}

/// Inverts the lens model: brown_conrady and kannala_brandt by Newton's method in undistorted() and
/// angle_at(), equirectangular in closed form.
std::optional<Eigen::Vector3d> Lens::direction(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d seen = (pixel - centre_) / focal_px_;
  if (!seen.allFinite()) {
    return std::nullopt;
  }
  if (parameters_.model == LensModel::brown_conrady) {
    const auto ideal = undistorted(seen);
    if (!ideal) {
      return std::nullopt;
    }
    return Eigen::Vector3d(ideal->x(), ideal->y(), 1.0).normalized();
  }
  if (parameters_.model == LensModel::equirectangular) {
    const double azimuth = seen.x();
    const double depression = seen.y();
    if (std::abs(depression) > 0.5 * kHalfTurn + kRounding_rad) {
      return std::nullopt;
    }
    return Eigen::Vector3d(std::cos(depression) * std::sin(azimuth), std::sin(depression),
                           std::cos(depression) * std::cos(azimuth));
  }
  const double radius = seen.norm();
  const auto theta = angle_at(radius);
  if (!theta) {
    return std::nullopt;
  }
  if (radius == 0.0) {
    return Eigen::Vector3d::UnitZ();
  }
  const double across = std::sin(*theta) / radius;
  return Eigen::Vector3d(across * seen.x(), across * seen.y(), std::cos(*theta));
}

std::optional<Eigen::Vector2d> Lens::project(const Eigen::Vector3d& p_C) const {
  const double across = p_C.head<2>().norm();
  const double theta = std::atan2(across, p_C.z());
  if (!p_C.allFinite() || !(p_C.squaredNorm() > 0.0) || theta > circle_rad_) {
    return std::nullopt;
  }
  if (parameters_.model == LensModel::brown_conrady) {
    if (!(p_C.z() > 0.0)) {
      return std::nullopt;
    }
    const Eigen::Vector2d ideal = p_C.head<2>() / p_C.z();
    if (!(ideal.squaredNorm() < limit_)) {
      return std::nullopt;
    }
    return centre_ + focal_px_ * distorted(ideal);
  }
  if (parameters_.model == LensModel::equirectangular) {
    return centre_ + focal_px_ * Eigen::Vector2d(std::atan2(p_C.x(), p_C.z()),
                                                 std::atan2(p_C.y(), std::hypot(p_C.x(), p_C.z())));
  }
  if (theta > limit_) {
    return std::nullopt;
  }
  const Eigen::Vector2d out =
      across > 0.0 ? Eigen::Vector2d(p_C.head<2>() / across) : Eigen::Vector2d::Zero();
  return centre_ + focal_px_ * image_radius(theta) * out;
}

double Lens::falloff(const Eigen::Vector3d& direction_C) const {
  if (parameters_.model == LensModel::equirectangular) {
    return 1.0;
  }
  // The cosine law of illumination, cos^4 theta.
  const double cosine = std::max(0.0, direction_C.z());
  return 1.0 - parameters_.vignetting * (1.0 - cosine * cosine * cosine * cosine);
}

}  // namespace rigwire::sim

// Disparity pictures of a made-up stage in closed form: ground of any height, boulders (spheres),
// boxes. World: x ahead, y left, z up, the camera above the origin.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "find_rocks/stereo_picture.h"

namespace rigwire::find_rocks {

struct Boulder {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;  ///< Height of its middle.
  double radius_m = 0.5;
};
struct Box {
  double from_m[3] = {};
  double to_m[3] = {};
};

struct Stage {
  double camera_height_m = 3.0;
  double pitch_deg = 17.0;                       ///< Nose down.
  std::function<double(double, double)> ground;  ///< Unset: level, at 0.
  std::vector<Boulder> boulders;
  std::vector<Box> boxes;
  double noise_px = 0.1;  ///< Standard deviation of a disparity.
  double holes = 0.02;    ///< Share of pixels without one.
  int unmatched_columns = 80;
  unsigned seed = 1;
};

inline StereoGeometry stage_geometry() {
  StereoGeometry geometry;
  geometry.focal_px = 533.0;
  geometry.baseline_m = 0.16;
  geometry.principal_u_px = 319.5;
  geometry.principal_v_px = 239.5;
  geometry.scale_px = 0.0625;
  geometry.invalid = 0;
  return geometry;
}

/// Nearest distance along the ray from the camera, as far as z_C = 1; 0: nothing.
inline double stage_depth(const Stage& stage, const double (&ray)[3]) {
  const double eye[3] = {0.0, 0.0, stage.camera_height_m};
  double nearest = 1e9;
  if (!stage.ground && ray[2] < 0.0) {
    nearest = -eye[2] / ray[2];
  }
  // Uneven ground: steps, then halves.
  double before = 2.0;
  for (double t = before; stage.ground && t < 40.0; t *= 1.02) {
    const auto above = [&](double s) {
      return eye[2] + s * ray[2] - stage.ground(s * ray[0], s * ray[1]);
    };
    if (above(t) < 0.0) {
      double low = before;
      double high = t;
      for (int i = 0; i < 20; ++i) {
        const double middle = 0.5 * (low + high);
        (above(middle) < 0.0 ? high : low) = middle;
      }
      nearest = high;
      break;
    }
    before = t;
  }
  for (const Boulder& b : stage.boulders) {
    const double o[3] = {eye[0] - b.x_m, eye[1] - b.y_m, eye[2] - b.z_m};
    const double a = ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2];
    const double h = o[0] * ray[0] + o[1] * ray[1] + o[2] * ray[2];
    const double c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - b.radius_m * b.radius_m;
    const double root = h * h - a * c;
    if (root > 0.0) {
      nearest = std::min(nearest, (-h - std::sqrt(root)) / a);
    }
  }
  for (const Box& box : stage.boxes) {
    double in = 0.0;
    double out = 1e9;
    for (int k = 0; k < 3; ++k) {
      const double a = (box.from_m[k] - eye[k]) / ray[k];
      const double b = (box.to_m[k] - eye[k]) / ray[k];
      in = std::max(in, std::min(a, b));
      out = std::min(out, std::max(a, b));
    }
    if (in < out && in > 0.0) {
      nearest = std::min(nearest, in);
    }
  }
  return nearest < 1e8 ? nearest : 0.0;
}

/// Pixels as a camera sends them: two bytes each, the least significant first.
inline std::vector<std::uint8_t> stage_pixels(const Stage& stage, int width = 640,
                                              int height = 480) {
  const StereoGeometry geometry = stage_geometry();
  const double scale = width / 640.0;
  std::mt19937 random(stage.seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<std::uint8_t> pixels;
  const double pitch = stage.pitch_deg * 3.14159265358979 / 180.0;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const double x = ((u + 0.5) / scale - 0.5 - geometry.principal_u_px) / geometry.focal_px;
      const double y = ((v + 0.5) / scale - 0.5 - geometry.principal_v_px) / geometry.focal_px;
      // The axis points ahead and down.
      const double ray[3] = {std::cos(pitch) - y * std::sin(pitch), -x + 1e-12,
                             -std::sin(pitch) - y * std::cos(pitch)};
      const double depth = stage_depth(stage, ray);
      double count = 0.0;
      if (depth > 0.0 && u >= stage.unmatched_columns && share(random) >= stage.holes) {
        const double disparity =
            scale * geometry.focal_baseline() / depth + stage.noise_px * noise(random);
        count = std::clamp(std::round(disparity / geometry.scale_px), 0.0, 65535.0);
      }
      pixels.push_back(static_cast<std::uint8_t>(static_cast<int>(count) & 0xFF));
      pixels.push_back(static_cast<std::uint8_t>(static_cast<int>(count) >> 8));
    }
  }
  return pixels;
}

inline StereoPicture stage_picture(const Stage& stage) {
  return {stage_geometry(), 640, 480, stage_pixels(stage)};
}

}  // namespace rigwire::find_rocks

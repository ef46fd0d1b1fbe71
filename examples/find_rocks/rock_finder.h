// Rocks in a disparity picture: objects above the ground with the height and extent of a rock.
//
// Pixels that are higher above the ground than it is rough, and than their disparity may err, are
// joined to heaps in the picture; a heap is a rock when
// - it is at least as wide and as high as a rock of the minimum size, and no larger than the
//   largest,
// - it is about as wide as high, or wider: no trunk, no post, no bush that stands upright,
// - its pixels fill a third of their rectangle or more: scattered pixels are chance matches,
// - it stands on the ground: nothing that hangs in the air (a boom) and nothing that the edge of
//   what has disparities cuts,
// - and it is not of the machine itself: within a box or a part of the picture that was named.
//
// What cannot be distinguished from a rock is taken for one: a low bush, a tuft of grass, a bucket
// on the ground outside of the box, a heap of the size and steepness of a rock.
#pragma once

#include <vector>

#include "find_rocks/ground_surface.h"
#include "find_rocks/stereo_picture.h"

namespace rigwire::find_rocks {

/// A rectangle of the picture, pixels, its end excluded.
struct PictureArea {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
};

/// A box beside the camera's axes, metres: where the machine's own arm moves. An arm that turns
/// with the cab never leaves its plane, and so stays in its box.
struct OwnBox {
  double left_from_m = 0.0;  ///< Distance from the camera, left positive.
  double left_to_m = 0.0;
  double ahead_to_m = 0.0;
};

struct RockSettings {
  double least_m = 0.4;     ///< Diameter of the smallest rock that is reported.
  double largest_m = 2.5;   ///< Larger is not a rock: a truck, a wall, a tree.
  double nearest_m = 2.0;   ///< Ahead along the ground.
  double farthest_m = 0.0;  ///< 0: as far as the smallest rock can be distinguished from noise.
  std::vector<PictureArea> own_areas;
  std::vector<OwnBox> own_boxes;
  GroundSettings ground;
};

/// A rock in one picture. Frame of the camera's mount: x ahead along the axis, y left, z up.
struct SeenRock {
  double x_m = 0.0;  ///< Position of its middle; its depth is assumed to equal its width.
  double y_m = 0.0;
  double z_m = 0.0;
  double width_m = 0.0;   ///< Across the line of sight.
  double height_m = 0.0;  ///< Above the ground.
  int pixels = 0;
  /// Height above the noise, 0 .. 1: 1 from six standard deviations on.
  double contrast = 0.0;
  PictureArea area;  ///< Area that it covers.
};

struct FoundRocks {
  std::vector<SeenRock> rocks;  ///< From near to far.
  bool ground = false;          ///< Ground was found.
  double camera_height_m = 0.0;
  double pitch_rad = 0.0;    ///< Angle of the axis below the ground's plane.
  double farthest_m = 0.0;   ///< Maximum distance that was evaluated.
  double disparities = 0.0;  ///< Share of pixels that had one.
};

/// Returns how far ahead a rock of the minimum size is found: where two thirds of its diameter are
/// above the ground's roughness by 3.5 standard deviations of a pixel's height, and disparities are
/// six pixels or more: below, what matching does to all of them alike (pixel locking) bends the
/// ground.
[[nodiscard]] double resolvable_m(const RockSettings& settings, double focal_baseline,
                                  double camera_height_m);

[[nodiscard]] FoundRocks find_rocks(const StereoPicture& picture, const RockSettings& settings);

}  // namespace rigwire::find_rocks

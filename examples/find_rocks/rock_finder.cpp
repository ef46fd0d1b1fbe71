#include "find_rocks/rock_finder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace rigwire::find_rocks {
namespace {

/// Minimum height above the ground, as a share of a rock's diameter.
constexpr double kLeastHeightShare = 0.3;
constexpr double kUsualHeightShare = 2.0 / 3.0;
/// Minimum height over width of a rock; anything flatter is a crest of the ground.
constexpr double kLeastSlenderness = 0.3;
/// Maximum height over width of a loose rock; bushes, trunks and posts are taller.
constexpr double kMostSlenderness = 1.2;
/// A disc fills 0.79 of its rectangle in the picture; disparities that matching has found by chance
/// fill less, because they are scattered.
constexpr double kLeastFilling = 1.0 / 3.0;
/// Minimum visible width, as a share of a rock's diameter.
constexpr double kLeastWidthShare = 0.7;
/// Thresholds in standard deviations of a pixel's height: beyond the first it may belong to a rock,
/// beyond the second a heap has a height; six give full contrast.
constexpr double kPixelSigmas = 2.0;
constexpr double kHeapSigmas = 3.5;
constexpr double kLeastDisparity_px = 6.0;
constexpr double kFullContrastSigmas = 6.0;
constexpr double kSurfaceRoughness_m = 0.08;
/// Neighbours of one heap differ by no more than this share of their disparity, plus noise.
constexpr double kSameSurface = 0.03;
constexpr double kSameSurface_px = 0.5;
/// A heap this much above the ground at its foot hangs in the air.
constexpr double kHanging_m = 0.35;
constexpr int kLeastPixels = 30;
/// What is this near the edge of the matched part is cut by it.
constexpr int kEdge_px = 2;
constexpr double kLow = 0.05;
constexpr double kHigh = 0.95;

/// The value below which a share of them lies.
double quantile(std::vector<float>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return static_cast<double>(values[static_cast<std::size_t>(at)]);
}

class Finder {
 public:
  Finder(const StereoPicture& picture, const RockSettings& settings, const GroundSurface& ground,
         double farthest_m)
      : picture_(picture),
        settings_(settings),
        ground_(ground),
        farthest_m_(farthest_m),
        height_m_(
            static_cast<std::size_t>(picture.width()) * static_cast<std::size_t>(picture.height()),
            kGround) {}

  std::vector<SeenRock> find() {
    find_matched();
    mark();
    std::vector<SeenRock> rocks;
    for (int v = 0; v < picture_.height(); ++v) {
      for (int u = 0; u < picture_.width(); ++u) {
        if (height_m_[index(u, v)] > kGround) {
          gather(u, v);
          if (const auto rock = judged()) {
            rocks.push_back(*rock);
          }
        }
      }
    }
    std::ranges::sort(rocks, {}, &SeenRock::x_m);
    return rocks;
  }

 private:
  static constexpr float kGround = -std::numeric_limits<float>::infinity();
  struct Pixel {
    int u = 0;
    int v = 0;
    float height_m = 0.0F;
  };

  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(picture_.width()) +
           static_cast<std::size_t>(u);
  }

  /// The part of the picture that is matched: on the left there is nothing to match with.
  void find_matched() {
    std::vector<int> in_column(static_cast<std::size_t>(picture_.width()), 0);
    for (int v = 0; v < picture_.height(); ++v) {
      for (int u = 0; u < picture_.width(); ++u) {
        in_column[static_cast<std::size_t>(u)] +=
            picture_.disparity_px(u, v) > StereoPicture::kNone ? 1 : 0;
      }
    }
    const auto matched = [](int pixels) { return pixels > 0; };
    const auto first = std::ranges::find_if(in_column, matched);
    const auto last = std::find_if(in_column.rbegin(), in_column.rend(), matched);
    matched_ = {static_cast<int>(first - in_column.begin()) + kEdge_px, kEdge_px,
                static_cast<int>(in_column.rend() - last) - kEdge_px, picture_.height() - kEdge_px};
  }

  /// Heights of pixels that may be of a rock.
  void mark() {
    for (int v = 0; v < picture_.height(); ++v) {
      for (int u = 0; u < picture_.width(); ++u) {
        if (picture_.disparity_px(u, v) <= StereoPicture::kNone) {
          continue;
        }
        const auto place = ground_.place(picture_.point(u, v));
        if (place.ahead_m < settings_.nearest_m) {
          continue;
        }
        const auto below = ground_.height_m(place);
        const double limit =
            kSurfaceRoughness_m + kPixelSigmas * ground_.height_sigma_m(place.ahead_m);
        if (below && place.height_m - *below > limit) {
          height_m_[index(u, v)] = static_cast<float>(place.height_m - *below);
        }
      }
    }
  }

  /// The heap around a pixel; takes it out of what is left.
  void gather(int u0, int v0) {
    heap_.clear();
    const auto take = [this](int u, int v) {
      float& height = height_m_[index(u, v)];
      heap_.push_back({u, v, std::exchange(height, kGround)});
    };
    take(u0, v0);
    for (std::size_t next = 0; next < heap_.size(); ++next) {
      const Pixel here = heap_[next];
      const float disparity = picture_.disparity_px(here.u, here.v);
      // Holes of a pixel are passed over.
      for (int v = std::max(0, here.v - 2); v <= std::min(picture_.height() - 1, here.v + 2); ++v) {
        for (int u = std::max(0, here.u - 2); u <= std::min(picture_.width() - 1, here.u + 2);
             ++u) {
          if (height_m_[index(u, v)] > kGround &&
              std::abs(picture_.disparity_px(u, v) - disparity) <
                  static_cast<float>(kSameSurface_px) +
                      static_cast<float>(kSameSurface) * disparity) {
            take(u, v);
          }
        }
      }
    }
  }

  [[nodiscard]] bool own(const Pixel& pixel, const Point& point) const {
    const auto in_area = [&pixel](const PictureArea& a) {
      return pixel.u >= a.left && pixel.u < a.right && pixel.v >= a.top && pixel.v < a.bottom;
    };
    const auto in_box = [&point](const OwnBox& box) {
      return -point.x >= box.left_from_m && -point.x <= box.left_to_m && point.z <= box.ahead_to_m;
    };
    return std::ranges::any_of(settings_.own_areas, in_area) ||
           std::ranges::any_of(settings_.own_boxes, in_box);
  }

  /// The heap as a rock, if it is one.
  [[nodiscard]] std::optional<SeenRock> judged() {
    if (heap_.size() < kLeastPixels) {
      return std::nullopt;
    }
    std::vector<float> heights;
    std::vector<float> across;
    std::vector<float> ahead;
    std::vector<float> depth;
    SeenRock rock;
    rock.area = {heap_[0].u, heap_[0].v, heap_[0].u + 1, heap_[0].v + 1};
    int own_pixels = 0;
    for (const Pixel& pixel : heap_) {
      const Point point = picture_.point(pixel.u, pixel.v);
      own_pixels += own(pixel, point) ? 1 : 0;
      heights.push_back(pixel.height_m);
      across.push_back(static_cast<float>(point.x / point.z));
      depth.push_back(static_cast<float>(point.z));
      ahead.push_back(static_cast<float>(ground_.place(point).ahead_m));
      rock.area = {std::min(rock.area.left, pixel.u), std::min(rock.area.top, pixel.v),
                   std::max(rock.area.right, pixel.u + 1), std::max(rock.area.bottom, pixel.v + 1)};
    }
    rock.pixels = static_cast<int>(heap_.size());
    rock.height_m = quantile(heights, kHigh);
    const double foot_m = quantile(heights, kLow);
    const double nearest_m = quantile(depth, kLow);
    const double ahead_m = quantile(ahead, kLow);
    const double right = quantile(across, kHigh);
    const double left = quantile(across, kLow);
    rock.width_m = (right - left) * nearest_m / (kHigh - kLow);
    const double sigma_m = ground_.height_sigma_m(ahead_m);
    const bool cut = rock.area.left <= matched_.left || rock.area.top <= matched_.top ||
                     rock.area.right >= matched_.right || rock.area.bottom >= matched_.bottom;
    const bool small = rock.width_m < kLeastWidthShare * settings_.least_m ||
                       rock.height_m < std::max(kLeastHeightShare * settings_.least_m,
                                                kSurfaceRoughness_m + kHeapSigmas * sigma_m);
    const bool flat = rock.height_m < kLeastSlenderness * rock.width_m;
    const bool tall = rock.height_m > kMostSlenderness * rock.width_m;
    const bool large = rock.width_m > settings_.largest_m || rock.height_m > settings_.largest_m;
    const int rectangle = (rock.area.right - rock.area.left) * (rock.area.bottom - rock.area.top);
    const bool scattered = rock.pixels < kLeastFilling * rectangle;
    const bool hangs = foot_m > kHanging_m + kPixelSigmas * sigma_m;
    if (2 * own_pixels > rock.pixels || cut || small || flat || tall || large || scattered ||
        hangs || ahead_m > farthest_m_) {
      return std::nullopt;
    }
    const double middle_m = nearest_m + 0.5 * rock.width_m;
    rock.x_m = middle_m;
    rock.y_m = -0.5 * (left + right) * middle_m;
    rock.z_m = -middle_m * picture_.sight(0, (rock.area.top + rock.area.bottom) / 2).y;
    rock.contrast = std::min(1.0, rock.height_m / (kFullContrastSigmas * sigma_m));
    return rock;
  }

  const StereoPicture& picture_;
  const RockSettings& settings_;
  const GroundSurface& ground_;
  double farthest_m_;
  PictureArea matched_;
  std::vector<float> height_m_;
  std::vector<Pixel> heap_;
};

}  // namespace

double resolvable_m(const RockSettings& settings, double focal_baseline, double camera_height_m) {
  const double above_m = std::max(0.0, kUsualHeightShare * settings.least_m - kSurfaceRoughness_m);
  return std::min({settings.ground.farthest_m, focal_baseline / kLeastDisparity_px,
                   above_m * focal_baseline /
                       (kHeapSigmas * settings.ground.disparity_sigma_px * camera_height_m)});
}

FoundRocks find_rocks(const StereoPicture& picture, const RockSettings& settings) {
  FoundRocks found;
  found.disparities = static_cast<double>(picture.pixels_with_disparity()) /
                      (static_cast<double>(picture.width()) * picture.height());
  const auto ground = GroundSurface::find(picture, settings.ground);
  if (!ground) {
    return found;
  }
  found.ground = true;
  found.camera_height_m = ground->camera_height_m();
  found.pitch_rad = ground->pitch_rad();
  const double resolvable =
      resolvable_m(settings, picture.geometry().focal_baseline(), found.camera_height_m);
  found.farthest_m = settings.farthest_m > 0.0
                         ? std::min(settings.farthest_m, settings.ground.farthest_m)
                         : resolvable;
  found.rocks = Finder(picture, settings, *ground, found.farthest_m).find();
  return found;
}

}  // namespace rigwire::find_rocks

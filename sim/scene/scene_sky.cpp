// The scene as satellite signals meet it: solid things stop them, crowns let them through.

#include <algorithm>
#include <array>
#include <limits>

#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

constexpr float kForever = std::numeric_limits<float>::infinity();
/// A ray through an edge meets both of its triangles at the same place.
constexpr float kSameCrossing_m = 1e-4F;
constexpr std::size_t kMostCrossings = 256;

struct Crossing {
  float range_m = 0.0F;
  bool inwards = false;
};

/// Crossings of foliage on one ray; farther ones than the buffer holds are not counted.
struct CountingContext {
  RTCIntersectContext context;  // the first member: Embree hands it back to the filter
  std::array<Crossing, kMostCrossings> crossings;
  std::size_t count = 0;
};

/// Notes the crossing and lets the ray go on.
void note_crossing(const RTCFilterFunctionNArguments* arguments) {
  auto* counting = reinterpret_cast<CountingContext*>(arguments->context);
  const auto* ray = reinterpret_cast<const RTCRay*>(arguments->ray);
  const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
  if (counting->count < kMostCrossings) {
    // Normal and direction are both in the mesh's frame here.
    const float along = hit->Ng_x * ray->dir_x + hit->Ng_y * ray->dir_y + hit->Ng_z * ray->dir_z;
    counting->crossings[counting->count++] = {ray->tfar, along < 0.0F};
  }
  arguments->valid[0] = 0;
}

/// Length within surfaces that are crossed at these places, from 0 to `end_m`; the ray leaves all
/// of them in the end, so that what it does not enter it started in.
double length_within(std::span<Crossing> crossings, double end_m) {
  std::ranges::sort(crossings, {}, &Crossing::range_m);
  const auto twin = [](const Crossing& a, const Crossing& b) {
    return a.inwards == b.inwards && b.range_m - a.range_m < kSameCrossing_m;
  };
  const auto last = std::unique(crossings.begin(), crossings.end(), twin);
  int depth = 0;
  for (auto it = crossings.begin(); it != last; ++it) {
    depth += it->inwards ? -1 : 1;
  }
  double length_m = 0.0;
  double from_m = 0.0;
  for (auto it = crossings.begin(); it != last && from_m < end_m; ++it) {
    const double to_m = std::min(double{it->range_m}, end_m);
    length_m += depth > 0 ? to_m - from_m : 0.0;
    depth += it->inwards ? 1 : -1;
    from_m = to_m;
  }
  return length_m;
}

}  // namespace

bool Scene::blocked(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                    double clearance_m) const {
  const Internals& in = *internals_;
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray =
      make_ray(p_W - in.origin_W, direction_W, clearance_m, kForever, 1.0F, kSeeEverything);
  rtcOccluded1(in.moving.get(), &context, &ray);
  if (ray.tfar >= 0.0F) {
    rtcOccluded1(in.fixed.get(), &context, &ray);
  }
  return ray.tfar < 0.0F;
}

SkyPath Scene::sky_path(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                        double clearance_m) const {
  const Internals& in = *internals_;
  SkyPath path;
  double end_m = std::numeric_limits<double>::infinity();
  if (const auto solid = surface(p_W, direction_W, clearance_m, end_m)) {
    path.blocked = true;
    end_m = solid->range_m;
  }
  if (!in.has_foliage && !in.has_canopy) {
    return path;
  }
  const FlushDenormals flush;
  CountingContext counting;
  rtcInitIntersectContext(&counting.context);
  counting.context.filter = note_crossing;
  const auto count_in = [&](RTCScene scene, std::uint32_t mask) {
    RTCRayHit query{};
    query.ray = make_ray(p_W - in.origin_W, direction_W, 0.0, kForever, 1.0F, mask);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &counting.context, &query);
  };
  if (in.has_foliage) {
    count_in(in.moving.get(), foliage_mask());
    count_in(in.fixed.get(), foliage_mask());
  }
  if (in.has_canopy) {
    count_in(in.canopy.get(), kSeeEverything);
  }
  path.foliage_m = length_within({counting.crossings.data(), counting.count}, end_m);
  return path;
}

std::optional<ReflectingSurface> Scene::surface(const Eigen::Vector3d& p_W,
                                                const Eigen::Vector3d& direction_W,
                                                double clearance_m, double reach_m) const {
  const auto hit = cast(p_W, direction_W, clearance_m, reach_m, internals_->t1,
                        ~(foliage_mask() | loose_leaves_mask()));
  if (!hit) {
    return std::nullopt;
  }
  return ReflectingSurface{hit->range_m, hit->normal_W};
}

}  // namespace rigwire::sim

#include "sim/scene/scene_description.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sim/scene/range_checks.h"

namespace rigwire::sim {
namespace {

void require(bool holds, const std::string& member, double found, const std::string& allowed) {
  if (!holds) {
    throw std::invalid_argument(member + " is " + std::to_string(found) + ", allowed: " + allowed);
  }
}

Eigen::Quaterniond random_attitude(RandomStream& random) {
  Eigen::Quaterniond attitude(random.gaussian(), random.gaussian(), random.gaussian(),
                              random.gaussian());
  return attitude.normalized();
}

/// Diameter below which the share p of all rocks stays: the power law cut at both ends.
double diameter_at(const RockField& rocks, double p) {
  const double power = 1.0 - rocks.exponent;
  const double low = std::pow(rocks.smallest_m, power);
  const double high = std::pow(rocks.largest_m, power);
  return std::pow(low + p * (high - low), 1.0 / power);
}

}  // namespace

void validate(const PitTerrain& terrain) {
  require_within(terrain.size_m, 10.0, 4000.0, "terrain.size_m");
  require_within(terrain.cell_m, 0.05, 0.1 * terrain.size_m, "terrain.cell_m");
  require(terrain.size_m / terrain.cell_m <= 8192.0, "terrain.size_m / terrain.cell_m",
          terrain.size_m / terrain.cell_m, "at most 8192 cells along a side");
  require_within(terrain.floor_height_m, -10000.0, 10000.0, "terrain.floor_height_m");
  for (const double coordinate : {terrain.floor_centre_m.x(), terrain.floor_centre_m.y(),
                                  terrain.ramp_start_x_m, terrain.ramp_y_m}) {
    require_within(coordinate, -4000.0, 4000.0, "terrain: a coordinate of floor or ramp");
  }
  for (const double length : {terrain.floor_half_lengths_m.x(), terrain.floor_half_lengths_m.y()}) {
    require_within(length, 8.0, 4000.0, "terrain.floor_half_lengths_m");
  }
  require_within(terrain.benches, 0, 50, "terrain.benches");
  require_within(terrain.bench_height_m, 0.1, 50.0, "terrain.bench_height_m");
  require_within(terrain.face_angle_deg, 20.0, 85.0, "terrain.face_angle_deg");
  require_within(terrain.berm_width_m, 0.5, 100.0, "terrain.berm_width_m");
  require_within(terrain.windrow_height_m, 0.0, 5.0, "terrain.windrow_height_m");
  require_within(terrain.ramp_width_m, 0.0, 100.0, "terrain.ramp_width_m");
  require_within(terrain.ramp_slope, 0.01, 1.0, "terrain.ramp_slope");
  require_within(terrain.floor_roughness_m, 0.0, 1.0, "terrain.floor_roughness_m");
  require_within(terrain.face_roughness_m, 0.0, 3.0, "terrain.face_roughness_m");
  for (const Heap& heap : terrain.heaps) {
    require(heap.centre_m.allFinite(), "terrain.heaps.centre_m", heap.centre_m.x(), "finite");
    require_within(heap.height_m, 0.0, 50.0, "terrain.heaps.height_m");
    require_within(heap.repose_deg, 5.0, 60.0, "terrain.heaps.repose_deg");
  }
}

void validate(const RockField& rocks) {
  require_within(rocks.count, 0, 100000, "rocks.count");
  require(rocks.centre_m.allFinite(), "rocks.centre_m", rocks.centre_m.x(), "finite");
  require_within(rocks.radius_m, 0.1, 4000.0, "rocks.radius_m");
  require_within(rocks.smallest_m, 0.02, 20.0, "rocks.smallest_m");
  require_within(rocks.largest_m, rocks.smallest_m, 20.0, "rocks.largest_m");
  require_within(rocks.exponent, 1.1, 6.0, "rocks.exponent");
  for (const KeepOut& disc : rocks.keep_out) {
    require(disc.centre_m.allFinite(), "rocks.keep_out.centre_m", disc.centre_m.x(), "finite");
    require_within(disc.radius_m, 0.0, 4000.0, "rocks.keep_out.radius_m");
  }
}

void validate(const BoxObject& box) {
  require(box.position_m.allFinite() && std::isfinite(box.yaw_rad),
          "boxes." + box.name + ": position or yaw", box.position_m.x(), "finite");
  require_within(box.size_m.minCoeff(), 0.01, 1000.0, "boxes." + box.name + ".size_m");
  require_within(box.size_m.maxCoeff(), 0.01, 1000.0, "boxes." + box.name + ".size_m");
}

void validate(const SceneDescription& description) {
  std::visit([](const auto& terrain) { validate(terrain); }, description.terrain);
  for (const Track& track : description.tracks) {
    validate(track);
  }
  for (const SoilParameters& soil : description.soils) {
    validate(soil);
  }
  for (const SoilRegion& region : description.soil_regions) {
    validate(region);
  }
  for (const TreeField& trees : description.trees) {
    validate(trees);
  }
  for (const Forest& forest : description.forests) {
    validate(forest);
  }
  for (const GrassField& grass : description.grass) {
    validate(grass);
  }
  for (const BoxObject& box : description.boxes) {
    validate(box);
  }
  for (const RockField& rocks : description.rocks) {
    validate(rocks);
  }
  for (const FixedObject& object : description.objects) {
    require(object.position_m.allFinite() && std::isfinite(object.yaw_rad),
            "objects." + object.name + ": position or yaw", object.position_m.x(), "finite");
    require_within(object.scale, 1e-6, 1e6, "objects." + object.name + ".scale");
  }
}

std::vector<PlacedRock> place_rocks(const RockField& rocks, const HeightField& ground,
                                    RandomStream& random) {
  validate(rocks);
  constexpr int kTriesPerRock = 20;
  constexpr double kSunk = 0.3;
  std::vector<PlacedRock> placed;
  for (int i = 0; i < rocks.count; ++i) {
    const double radius = 0.5 * diameter_at(rocks, random.uniform());
    for (int attempt = 0; attempt < kTriesPerRock; ++attempt) {
      const double away = rocks.radius_m * std::sqrt(random.uniform());
      const double bearing = random.uniform(0.0, 2.0 * std::numbers::pi);
      const Eigen::Vector2d spot =
          rocks.centre_m + away * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
      const bool kept_out = std::ranges::any_of(rocks.keep_out, [&](const KeepOut& disc) {
        return (spot - disc.centre_m).norm() < disc.radius_m + radius;
      });
      if (kept_out) {
        continue;
      }
      PlacedRock& rock = placed.emplace_back();
      rock.shape = static_cast<std::size_t>(random.bits() % kRockShapes);
      rock.radius_m = radius;
      rock.X_WM.linear() = random_attitude(random).toRotationMatrix();
      rock.X_WM.translation() << spot, ground.height_m(spot.x(), spot.y()) + kSunk * radius;
      break;
    }
  }
  return placed;
}

Eigen::Isometry3d object_pose(const FixedObject& object, const HeightField& ground) {
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.linear() = Eigen::AngleAxisd(object.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  X_WM.translation() = object.position_m;
  if (object.on_ground) {
    X_WM.translation().z() += ground.height_m(object.position_m.x(), object.position_m.y());
  }
  return X_WM;
}

Eigen::Isometry3d box_pose(const BoxObject& box, const HeightField& ground) {
  FixedObject base;
  base.position_m = box.position_m;
  base.yaw_rad = box.yaw_rad;
  base.on_ground = box.on_ground;
  Eigen::Isometry3d X_WM = object_pose(base, ground);
  X_WM.translation().z() += 0.5 * box.size_m.z();
  return X_WM;
}

}  // namespace rigwire::sim

// How ground looks where soils meet and where it is steep, against the same rules point by point.
#include "sim/camera/ground_looks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "camera_site.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

constexpr int kNodes = 65;
constexpr double kCell_m = 0.5;
const std::vector<std::string> kLabels{"gravel", "sand", "concrete"};

/// Waves, and a bank that is as steep as gravel does not lie.
HeightField waves() {
  HeightField field;
  field.cell_m = kCell_m;
  field.columns = field.rows = kNodes;
  field.origin_m << -16.0, -16.0;
  for (int r = 0; r < kNodes; ++r) {
    for (int c = 0; c < kNodes; ++c) {
      field.heights_m.push_back(0.8 * std::sin(0.3 * c) * std::cos(0.2 * r) +
                                std::clamp(0.45 * (c - 45), 0.0, 3.0));
    }
  }
  return field;
}

/// Patches of the labels.
std::vector<std::uint8_t> patches() {
  std::vector<std::uint8_t> cells;
  for (int r = 0; r + 1 < kNodes; ++r) {
    for (int c = 0; c + 1 < kNodes; ++c) {
      cells.push_back(static_cast<std::uint8_t>((c / 7 + (r + c / 3) / 9) % 3));
    }
  }
  return cells;
}

struct GroundLooksSite {
  Scene scene;

  explicit GroundLooksSite(bool changeable) {
    const auto terrain = scene.add_terrain(waves(), surface("ground"));
    scene.cover_terrain(terrain, kLabels, patches());
    if (changeable) {
      scene.make_changeable(terrain);
    }
    ready(scene);
  }
};

/// One octave of value noise.
float waver(float x, float y, std::uint32_t seed) {
  const auto value = [&](int dx, int dy) {
    const auto ix = static_cast<std::uint32_t>(static_cast<int>(std::floor(x)) + dx);
    const auto iy = static_cast<std::uint32_t>(static_cast<int>(std::floor(y)) + dy);
    std::uint32_t mixed = (ix * 0x9E3779B1U) ^ (iy * 0x85EBCA77U) ^ seed;
    mixed ^= mixed >> 15U;
    mixed *= 0x2C1B3C6DU;
    mixed ^= mixed >> 13U;
    return static_cast<float>(static_cast<std::int32_t>(mixed * 0x297A2D39U)) * 0x1.0p-31F;
  };
  const float a = x - std::floor(x);
  const float b = y - std::floor(y);
  const float u = a * a * (3.0F - 2.0F * a);
  const float v = b * b * (3.0F - 2.0F * b);
  return (1.0F - v) * ((1.0F - u) * value(0, 0) + u * value(1, 0)) +
         v * ((1.0F - u) * value(0, 1) + u * value(1, 1));
}

float fading(float cell_m, float footprint_m) {
  return std::clamp(cell_m / footprint_m * (1.0F / 1.5F) - 0.5F, 0.0F, 1.0F);
}

/// Label of the cell at a place, in cells from the first node.
std::size_t label_at(const std::vector<std::uint8_t>& cells, float x, float y) {
  const int column = std::clamp(static_cast<int>(x), 0, kNodes - 2);
  const int row = std::clamp(static_cast<int>(y), 0, kNodes - 2);
  return cells[static_cast<std::size_t>(row) * (kNodes - 1) + static_cast<std::size_t>(column)];
}

/// The label that lies there, edges wavering; `laid`: which of the labels are hard surfaces.
std::size_t soil(const std::vector<std::uint8_t>& cells, const std::vector<bool>& laid, float x,
                 float y, float footprint_m) {
  bool differs = false;
  bool near_laid = false;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      const float column = std::floor(x) + static_cast<float>(dx);
      const float row = std::floor(y) + static_cast<float>(dy);
      const bool inside = column >= 0 && row >= 0 && column < kNodes - 1 && row < kNodes - 1;
      differs = differs || (inside && label_at(cells, column, row) != label_at(cells, x, y));
      if (std::abs(dx) != 1 && std::abs(dy) != 1) {
        near_laid = near_laid ||
                    laid[label_at(cells, x + static_cast<float>(dx), y + static_cast<float>(dy))];
      }
    }
  }
  if (!differs) {
    return label_at(cells, x, y);
  }
  const float coarse = (near_laid ? 0.04F : 0.25F) * fading(0.9F, footprint_m);
  const float fine = (near_laid ? 0.03F : 0.07F) * fading(0.16F, footprint_m);
  constexpr float kPer_m = 1.0F / static_cast<float>(kCell_m);
  const float x_m = x / kPer_m;
  const float y_m = y / kPer_m;
  const auto aside = [&](std::uint32_t seed) {
    return coarse * waver(x_m / 0.9F, y_m / 0.9F, seed) +
           fine * waver(x_m / 0.16F, y_m / 0.16F, seed + 1);
  };
  const float moved_x = x + aside(1U) * kPer_m - 0.5F;
  const float moved_y = y + aside(3U) * kPer_m - 0.5F;
  const float a = moved_x - std::floor(moved_x);
  const float b = moved_y - std::floor(moved_y);
  std::array<float, 3> weight{};
  for (const bool north : {false, true}) {
    for (const bool east : {false, true}) {
      const float column = std::floor(moved_x) + (east ? 1.0F : 0.0F);
      const float row = std::floor(moved_y) + (north ? 1.0F : 0.0F);
      weight[label_at(cells, column, row)] += (east ? a : 1.0F - a) * (north ? b : 1.0F - b);
    }
  }
  return static_cast<std::size_t>(std::ranges::max_element(weight) - weight.begin());
}

TEST(GroundLooks, EachPointHasTheSoilOfItsRules) {
  const GroundLooksSite site(true);
  const Scene::Internals& in = site.scene.internals();
  GroundLooks ground;
  ground.prepare(in, in.terrains.front());
  // Looks by number: the terrain's own, the cut face, then the labels'.
  std::vector<PreparedLook> looks(2);
  looks[1].shade = cut_face();
  ground.own = 0;
  ground.face = 1;
  std::vector<bool> laid;
  for (const std::string& label : kLabels) {
    looks.push_back({.shade = *shade_of_soil(label, {})});
    laid.push_back(looks.back().shade.bare_from == 0.0F);
    ground.add_label(static_cast<std::uint16_t>(looks.size() - 1), looks.back().shade);
  }
  ASSERT_EQ(std::ranges::count(laid, true), 1);

  const std::vector<std::uint8_t> cells = patches();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-15.9F, 15.9F);
  std::uniform_real_distribution<float> share(0.0F, 1.0F);
  std::array<int, 5> seen{};
  int elsewhere = 0;
  for (int packet = 0; packet < 4000; ++packet) {
    RTCRay8 rays{};
    MetSurfaces met{};
    LaneArray pixel_rad;
    LookLanes look;
    alignas(32) std::array<int, kLanes> mine{};
    for (std::size_t i = 0; i < kLanes; ++i) {
      met.x[i] = place(random) - static_cast<float>(in.origin_W.x());
      met.y[i] = place(random) - static_cast<float>(in.origin_W.y());
      met.gz[i] = 1.0F;
      rays.dir_z[i] = -share(random);
      rays.tfar[i] = 1.0F + 40.0F * share(random);
      pixel_rad[i] = 0.002F;
      mine[i] = share(random) < 0.9F ? -1 : 0;
      look[i] = 7U;
      met.draw[i] = 0.5F;
    }
    ground.find(mine, rays, pixel_rad, looks.data(), met, look);
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (mine[i] == 0) {
        EXPECT_EQ(look[i], 7U);
        EXPECT_EQ(met.draw[i], 0.5F);
        ++elsewhere;
        continue;
      }
      EXPECT_EQ(met.draw[i], 0.0F);
      const float x = (met.x[i] + static_cast<float>(in.origin_W.x()) + 16.0F) / 0.5F;
      const float y = (met.y[i] + static_cast<float>(in.origin_W.y()) + 16.0F) / 0.5F;
      const float footprint_m =
          rays.tfar[i] * pixel_rad[i] / std::sqrt(std::max(-rays.dir_z[i], 0.05F)) + 1e-6F;
      std::size_t expected = 2 + soil(cells, laid, x, y, footprint_m);
      const float bare_from = looks[expected].shade.bare_from;
      const float slope = std::hypot(met.nx[i], met.ny[i]) / met.nz[i];
      const float reach = 0.25F * bare_from;
      if (bare_from > 0.0F && slope > bare_from - reach) {
        const float ragged =
            slope > bare_from + reach
                ? 0.0F
                : reach * fading(0.5F, footprint_m) * waver(x * 0.5F / 0.5F, y * 0.5F / 0.5F, 5U);
        // Rounding may decide where both are as good.
        if (std::abs(slope + ragged - bare_from) < 1e-5F) {
          continue;
        }
        expected = slope + ragged > bare_from ? 1 : expected;
      }
      ++seen[expected];
      EXPECT_EQ(look[i], expected) << x << ' ' << y << ' ' << slope;
    }
  }
  EXPECT_EQ(seen[0], 0);
  for (std::size_t k = 1; k < seen.size(); ++k) {
    EXPECT_GT(seen[k], 500) << k;
  }
  EXPECT_GT(elsewhere, 1000);
}

TEST(GroundLooks, GroundThatCanBeDugLooksAsGroundThatCannot) {
  const GroundLooksSite whole(false);
  const GroundLooksSite tiled(true);
  CameraParameters parameters = small_camera();
  parameters.looks = {{.label = "sand", .kind = SurfaceKind::rock}};
  CameraRenderer renderer(parameters, 1, "camera");
  const Daylight light({}, sun_at(40.0, 210.0));
  const PictureJob job = job_for(parameters, at(-14.0, -2.0, 3.0, 0.1, 0.2), light);
  RenderedPicture of_whole;
  RenderedPicture of_tiled;
  renderer.render(whole.scene, job, of_whole);
  renderer.render(tiled.scene, job, of_tiled);
  EXPECT_EQ(of_whole.luminance, of_tiled.luminance);
  EXPECT_EQ(of_whole.range_m, of_tiled.range_m);
}

}  // namespace
}  // namespace rigwire::sim

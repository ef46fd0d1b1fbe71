#include "sim/scene/tree_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "sim/scene/leaf_masks.h"

namespace rigwire::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kBelowGround_m = 0.3;
constexpr double kBreastHeight_m = 1.3;

/// Dimensions of a species at the modelled height.
struct Habit {
  double height_m;
  double trunk_diameter_m;  ///< At breast height.
  double crown_base;        ///< Share of the height.
  double crown_radius_m;    ///< Where it is widest.
  double widest;            ///< Share of the crown's height above its base.
  int branches;
  double lift_low_rad;  ///< Angle of the lowest branches above the horizontal.
  double lift_high_rad;
  double sag_m;  ///< Drop of a branch's end below its straight line, per metre.
  int twigs;     ///< To a branch.
  int cards;
  double card_m;
  bool needled;
};

Habit habit(Species species) {
  switch (species) {
    case Species::spruce:
      return {22.0, 0.32, 0.18, 2.3, 0.08, 54, -0.15, 0.6, 0.10, 5, 1180, 0.42, true};
    case Species::pine:
      return {22.0, 0.34, 0.58, 2.4, 0.35, 36, 0.1, 0.9, -0.05, 6, 1300, 0.42, true};
    case Species::beech:
      return {24.0, 0.38, 0.35, 3.8, 0.45, 40, 0.4, 1.1, -0.05, 6, 1260, 0.55, false};
    case Species::oak:
      return {20.0, 0.42, 0.30, 4.2, 0.5, 34, 0.2, 1.0, 0.04, 7, 1260, 0.6, false};
    case Species::birch:
      return {19.0, 0.24, 0.35, 2.4, 0.35, 40, 0.6, 1.2, 0.18, 6, 1240, 0.38, false};
    case Species::bush:
      break;
  }
  return {2.2, 0.05, 0.08, 1.1, 0.55, 16, 0.7, 1.3, 0.05, 3, 380, 0.22, false};
}

/// Radius of the crown at share `t` of its height: half an ellipse above the widest place, another
/// below; a spruce is a cone.
double crown_radius_m(const Habit& h, double t) {
  if (h.widest < 0.1) {
    return h.crown_radius_m * std::min(1.0, (1.0 - t) + 0.02);
  }
  const double away = t > h.widest ? (t - h.widest) / (1.0 - h.widest) : (h.widest - t) / h.widest;
  return h.crown_radius_m *
         std::sqrt(std::max(0.02, 1.0 - 0.8 * away * away * (t > h.widest ? 1.2 : 1.0)));
}

double trunk_radius_m(const Habit& h, double z_m) {
  // A cone from the tip through the diameter at breast height.
  const double at_foot = 0.5 * h.trunk_diameter_m / (1.0 - kBreastHeight_m / h.height_m);
  return std::max(0.01, at_foot * std::min(1.2, 1.0 - z_m / h.height_m));
}

/// A stretch that leaves can grow from.
struct Twig {
  Eigen::Vector3d start_m;
  Eigen::Vector3d end_m;
};

void add_trunk(const Habit& h, RandomStream& random, TriangleMesh& wood) {
  constexpr int kSides = 8;
  constexpr int kStretches = 8;
  std::vector<TubePoint> points;
  for (int i = 0; i <= kStretches; ++i) {
    const double z = i == 0 ? -kBelowGround_m : h.height_m * i / kStretches;
    const double sway = i == 0 || i == kStretches ? 0.0 : 0.1 * trunk_radius_m(h, 0.0);
    points.push_back({{sway * random.gaussian(), sway * random.gaussian(), z},
                      i == kStretches ? 0.0 : trunk_radius_m(h, std::max(z, 0.0))});
  }
  add_tube(wood, points, kSides);
}

/// Sets branches around the trunk by the golden angle, from the crown's base to the top, as long as
/// the crown's outline allows and with a drop that grows with the square of the way out; twigs
/// leave to both sides by turns. Returns the twigs, which carry the leaves, and the outer half of
/// each branch.
std::vector<Twig> add_branches(const Habit& h, RandomStream& random, TriangleMesh& wood) {
  constexpr double kGoldenAngle = 2.399963229728653;
  constexpr int kBranchSides = 4;
  constexpr int kTwigSides = 3;
  std::vector<Twig> twigs;
  const double base = h.crown_base * h.height_m;
  for (int i = 0; i < h.branches; ++i) {
    const double t = (i + random.uniform(0.1, 0.9)) / h.branches;
    const double z = base + t * (h.height_m - base);
    const double azimuth = kGoldenAngle * i + random.uniform(-0.3, 0.3);
    const double lift =
        h.lift_low_rad + t * (h.lift_high_rad - h.lift_low_rad) + random.uniform(-0.12, 0.12);
    const Eigen::Vector3d direction(std::cos(lift) * std::cos(azimuth),
                                    std::cos(lift) * std::sin(azimuth), std::sin(lift));
    const double reach = crown_radius_m(h, t) * random.uniform(0.8, 1.0);
    const double to_top = std::max(0.15, h.height_m - z);
    const double length = std::min(reach / std::max(0.3, std::cos(lift)),
                                   lift > 0.0 ? to_top / std::sin(lift) : reach);
    const double radius = std::min(0.35 * trunk_radius_m(h, z), 0.02 * length + 0.004);
    const Eigen::Vector3d start(0.0, 0.0, z);
    const auto at = [&](double s) -> Eigen::Vector3d {
      return start + s * length * direction - Eigen::Vector3d(0.0, 0.0, h.sag_m * length * s * s);
    };
    const std::array<TubePoint, 3> points{
        {{at(0.0), radius}, {at(0.5), 0.6 * radius}, {at(1.0), 0.0}}};
    add_tube(wood, points, kBranchSides);
    twigs.push_back({at(0.5), at(1.0)});
    for (int k = 0; k < h.twigs; ++k) {
      const double s = 0.25 + 0.7 * (k + random.uniform()) / h.twigs;
      const double side = (k % 2 == 0 ? 1.0 : -1.0) * random.uniform(0.6, 1.1);
      const Eigen::Vector3d turned = Eigen::AngleAxisd(side, Eigen::Vector3d::UnitZ()) * direction +
                                     Eigen::Vector3d(0.0, 0.0, random.uniform(-0.25, 0.25));
      const double twig_length = length * (1.0 - 0.7 * s) * random.uniform(0.4, 0.6) + 0.05;
      const Twig twig{at(s), at(s) + twig_length * turned.normalized()};
      const std::array<TubePoint, 2> stick{{{twig.start_m, 0.35 * radius}, {twig.end_m, 0.0}}};
      add_tube(wood, stick, kTwigSides);
      twigs.push_back(twig);
    }
  }
  return twigs;
}

/// A card along the twig, tilted about it at random; of a triangle, the half of it.
void add_leaf_card(const Habit& h, const Twig& twig, LeafModel model, RandomStream& random,
                   TriangleMesh& leaves) {
  const Eigen::Vector3d along =
      ((twig.end_m - twig.start_m).normalized() +
       0.4 * Eigen::Vector3d(random.gaussian(), random.gaussian(), random.gaussian()))
          .normalized();
  const double tilt = h.needled ? random.uniform(-0.6, 0.6) : random.uniform(-kPi, kPi);
  Eigen::Vector3d level = Eigen::Vector3d::UnitZ().cross(along);
  level = level.norm() > 1e-3 ? level.normalized() : Eigen::Vector3d(along.unitOrthogonal());
  const Eigen::Vector3d across = Eigen::AngleAxisd(tilt, along) * level;
  const double size = h.card_m * random.uniform(0.75, 1.25);
  const Eigen::Vector3d foot =
      twig.start_m + random.uniform(0.1, 1.0) * (twig.end_m - twig.start_m) - 0.3 * size * along;
  const auto first = static_cast<std::uint32_t>(leaves.vertices.size());
  const auto put = [&](double u, double v) {
    leaves.vertices.push_back((foot + size * (v * along + (u - 0.5) * across)).cast<float>());
    leaves.texture_coordinates.emplace_back(static_cast<float>(u), static_cast<float>(v));
  };
  if (model == LeafModel::triangles) {
    // Two single leaves, a quarter of the card's area each.
    put(0.45, 0.0);
    put(0.45, 0.7);
    put(-0.25, 0.45);
    put(0.55, 0.3);
    put(1.25, 0.75);
    put(0.55, 1.0);
    leaves.triangles.push_back({first, first + 1, first + 2});
    leaves.triangles.push_back({first + 3, first + 4, first + 5});
    return;
  }
  put(0.0, 0.0);
  put(1.0, 0.0);
  put(1.0, 1.0);
  put(0.0, 1.0);
  leaves.triangles.push_back({first, first + 1, first + 2});
  leaves.triangles.push_back({first, first + 2, first + 3});
}

std::vector<Ring> crown_outline(const Habit& h) {
  constexpr int kRings = 5;
  const double base = h.crown_base * h.height_m;
  std::vector<Ring> rings{{0.0, base - 0.1}};
  for (int i = 0; i < kRings; ++i) {
    const double t = 0.03 + 0.85 * i / (kRings - 1);
    rings.push_back({crown_radius_m(h, t), base + t * (h.height_m - base)});
  }
  rings.push_back({0.0, h.height_m});
  return rings;
}

}  // namespace

TreeModel make_tree_model(Species species, LeafModel leaves, std::uint64_t seed, int variant) {
  const Habit h = habit(species);
  const std::string name(kSpeciesNames[static_cast<std::size_t>(species)]);
  RandomStream random(seed, "scene/tree/" + name + "/" + std::to_string(variant));
  TreeModel model;
  model.height_m = h.height_m;
  model.trunk_radius_m = 0.5 * h.trunk_diameter_m;
  model.crown_base_m = h.crown_base * h.height_m;
  model.crown = crown_outline(h);
  model.wood.name = name + " wood";
  model.leaves.name = name + " leaves";
  add_trunk(h, random, model.wood);
  const std::vector<Twig> twigs = add_branches(h, random, model.wood);
  // Long twigs bear more; every twig bears some.
  std::vector<double> reach_m{0.0};
  for (const Twig& twig : twigs) {
    reach_m.push_back(reach_m.back() + 0.05 + (twig.end_m - twig.start_m).norm());
  }
  for (int i = 0; i < h.cards; ++i) {
    const double p = random.uniform(0.0, reach_m.back());
    const auto after = std::upper_bound(reach_m.begin() + 1, reach_m.end() - 1, p);
    add_leaf_card(h, twigs[static_cast<std::size_t>(after - reach_m.begin() - 1)], leaves, random,
                  model.leaves);
  }
  if (leaves == LeafModel::cards) {
    model.leaves.alpha = h.needled ? needles() : broad_leaves();
  } else {
    model.leaves.texture_coordinates.clear();
  }
  return model;
}

double leaf_area_m2(const TreeModel& model) {
  double area = 0.0;
  const auto& v = model.leaves.vertices;
  for (const auto& [a, b, c] : model.leaves.triangles) {
    // Triangles' areas; of cards the share that the mask leaves.
    area += 0.5 * static_cast<double>((v[b] - v[a]).cross(v[c] - v[a]).norm());
  }
  return area * (model.leaves.alpha ? model.leaves.alpha->coverage() : 1.0);
}

}  // namespace rigwire::sim

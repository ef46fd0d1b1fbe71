// Crates that lie on each other: ours beside MuJoCo's.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/contact/loose_bodies.h"

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kStep_s = 1e-3;
constexpr double kMass_kg = 1000.0;
constexpr double kFriction = 0.6;
const Vector kHalf(0.5, 0.4, 0.3);

/// Where the crates' middles are after so long, from where they began.
std::vector<Vector> by_mujoco(const std::vector<Vector>& starts, double span_s) {
  std::ostringstream xml;
  xml.precision(17);
  xml << "<mujoco><option timestep='" << kStep_s
      << "' cone='elliptic' impratio='100' gravity='0 0 -9.80665'/><default><geom friction='"
      << kFriction << " 0 0' condim='3' solref='0.004 1'/></default><worldbody>"
      << "<geom type='plane' size='100 100 1'/>";
  for (const Vector& p : starts) {
    xml << "<body pos='" << p.x() << ' ' << p.y() << ' ' << p.z()
        << "'><freejoint/><geom type='box' "
        << "mass='" << kMass_kg << "' size='" << kHalf.x() << ' ' << kHalf.y() << ' ' << kHalf.z()
        << "'/></body>";
  }
  xml << "</worldbody></mujoco>";
  const std::string text = xml.str();
  // The structure is larger than a stack likes.
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "crates.xml", static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  char error[1000] = "";
  mjModel* model = mj_loadXML("crates.xml", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (model == nullptr) {
    throw std::runtime_error(error);
  }
  mjData* data = mj_makeData(model);
  for (int i = 0; i < static_cast<int>(span_s / kStep_s); ++i) {
    mj_step(model, data);
  }
  std::vector<Vector> moved;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    moved.push_back(Vector(data->qpos[7 * i], data->qpos[7 * i + 1], data->qpos[7 * i + 2]) -
                    starts[i]);
  }
  mj_deleteData(data);
  mj_deleteModel(model);
  return moved;
}

/// Ours, kept awake: what rests by decree would not be judged.
std::vector<Vector> by_us(const std::vector<Vector>& starts, double span_s) {
  SoilParameters floor;
  floor.friction = kFriction;
  const Ground ground = Ground::plane(Vector::UnitZ(), floor);
  std::vector<LooseBody> crates;
  for (const Vector& p : starts) {
    LooseBody& crate = crates.emplace_back(LooseBody{
        .name = "crate " + std::to_string(crates.size()), .shape = ConvexShape::box(kHalf)});
    const Eigen::Array3d squares = kHalf.array().square();
    crate.mass_kg = kMass_kg;
    crate.inertia_kgm2 = kMass_kg / 3.0 * (squares.sum() - squares).matrix();
    crate.X_WB.translation() = p;
    crate.friction = kFriction;
  }
  LooseBodies bodies(crates, ground);
  for (int i = 0; i < static_cast<int>(span_s / kStep_s); ++i) {
    bodies.ground_changed({-5.0, -5.0}, {5.0, 5.0});
    (void)bodies.advance(kStep_s);
  }
  std::vector<Vector> moved;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    moved.push_back(bodies.motion(i).X_WL.translation() - starts[i]);
  }
  return moved;
}

// In a minute neither falls; ours settles on its springs by a tenth of a millimetre across.
TEST(MujocoLoose, AStackOfThreeStandsInBoth) {
  const std::vector<Vector> stack{{0.0, 0.0, 0.3}, {0.05, 0.02, 0.9}, {-0.03, 0.0, 1.5}};
  const std::vector<Vector> theirs = by_mujoco(stack, 60.0);
  const std::vector<Vector> ours = by_us(stack, 60.0);
  for (std::size_t i = 0; i < stack.size(); ++i) {
    EXPECT_LT(theirs[i].norm(), 0.02) << i;
    EXPECT_LT(ours[i].head<2>().norm(), 5e-4) << i;
    EXPECT_NEAR(ours[i].z(), theirs[i].z(), 5e-3) << i;
  }
}

// Half its length over the edge of the one below it tips: 0.5 m.
TEST(MujocoLoose, ACrateTipsOverTheEdgeInBothOrInNeither) {
  for (const double over_m : {0.46, 0.54}) {
    const std::vector<Vector> two{{0.0, 0.0, 0.3}, {over_m, 0.0, 0.9}};
    const std::vector<Vector> theirs = by_mujoco(two, 4.0);
    const std::vector<Vector> ours = by_us(two, 4.0);
    const bool falls = over_m > kHalf.x();
    EXPECT_EQ(theirs[1].z() < -0.2, falls) << over_m;
    EXPECT_EQ(ours[1].z() < -0.2, falls) << over_m;
    // The one below is pushed back, hardly.
    EXPECT_NEAR(ours[0].x(), theirs[0].x(), 0.05) << over_m;
  }
}

// The upper ones together, over the lowest.
TEST(MujocoLoose, AStackLeansNoFurtherThanItsOverlapAllows) {
  // Three, each 0.2 m farther: the two upper ones' common middle is 0.3 m out, within 0.5 m.
  const std::vector<Vector> stair{{0.0, 0.0, 0.3}, {0.2, 0.0, 0.9}, {0.4, 0.0, 1.5}};
  // Each 0.4 m farther: 0.6 m out, it falls.
  const std::vector<Vector> steep{{0.0, 0.0, 0.3}, {0.4, 0.0, 0.9}, {0.8, 0.0, 1.5}};
  EXPECT_LT(by_us(stair, 4.0)[2].norm(), 1e-2);
  EXPECT_LT(by_mujoco(stair, 4.0)[2].norm(), 2e-2);
  EXPECT_LT(by_us(steep, 4.0)[2].z(), -0.2);
  EXPECT_LT(by_mujoco(steep, 4.0)[2].z(), -0.2);
}

}  // namespace
}  // namespace rigwire::sim

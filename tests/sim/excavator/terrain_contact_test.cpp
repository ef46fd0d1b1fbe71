// The excavator's house against the terrain: a bank stops its swing.
#include <gtest/gtest.h>

#include <cmath>

#include "digging_site.h"

namespace rigwire::sim::test {
namespace {

using Vector = Eigen::Vector3d;
constexpr double kDegree = std::numbers::pi / 180.0;

/// Level, with a bank of 3 m close behind the machine.
Ground with_bank() {
  HeightField field = level_field(0.2);
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      const double x = field.origin_m.x() + field.cell_m * static_cast<double>(c);
      field.heights_m[r * field.columns + c] = x < -2.7 ? 3.0 : 0.0;
    }
  }
  SoilParameters rock;
  // With much more the corner locks itself in the bank: its friction's lever is four times that of
  // the normal force.
  rock.friction = 0.2;
  return Ground(field, SoilMap{{rock}, {}}, {});
}

class HouseAtBank : public testing::TestWithParam<ExcavatorLevel> {};

// Finding: the counterweight passed into a bank. Its corner is 2.77 m from the swing axis, its rear
// 2.5 m, the bank's face 2.6 to 2.8 m.
TEST_P(HouseAtBank, ASwingIsStoppedByTheBankAndGoesBackFreely) {
  ExcavatorParameters parameters = ready_to_dig();
  parameters.level = GetParam();
  Site site(with_bank(), {}, parameters);
  double gain = 0.0;
  double lost = 0.0;
  ValveCommand command;
  command.opening = {0.6, 0.0, 0.0, 0.0};
  site.machine.valve_port()->command(command);
  for (int i = 0; i < 5000; ++i) {
    site.machine.step(std::chrono::milliseconds(1));
    const ContactReport& report = *site.machine.contact_report();
    gain = std::max(gain, lost - report.lost_j);
    lost = std::max(lost, report.lost_j);
  }
  const ContactReport& report = *site.machine.contact_report();
  EXPECT_GT(report.points, 0U);
  EXPECT_TRUE(report.terrain);
  const double stopped = site.machine.excavator().joint_angles_rad()[0];
  EXPECT_LT(stopped, 22.0 * kDegree);
  EXPECT_GT(stopped, 3.0 * kDegree);
  EXPECT_LT(report.deepest_m, 0.1);
  EXPECT_LT(gain, 50.0);
  site.run(0.8, -0.6, 0.0, 0.0, 0.0);
  EXPECT_LT(site.machine.excavator().joint_angles_rad()[0], stopped - 5.0 * kDegree);
  EXPECT_EQ(site.machine.contact_report()->points, 0U);
}

INSTANTIATE_TEST_SUITE_P(Levels, HouseAtBank,
                         testing::Values(ExcavatorLevel::quasi_static, ExcavatorLevel::dynamic,
                                         ExcavatorLevel::chambers),
                         [](const auto& level) {
                           return "level_" + std::to_string(static_cast<int>(level.param));
                         });

}  // namespace
}  // namespace rigwire::sim::test

// The excavator's house against the terrain: a bank stops its swing.
#include <gtest/gtest.h>

#include <cmath>

#include "digging_site.h"
#include "fields/constants.h"
#include "sim/contact/soil_bearing.h"

namespace rigwire::sim::test {
namespace {

using Vector = Eigen::Vector3d;

/// Level hard ground with a bank of 3 m beside the machine's rear: its face from y = -1.6 to -1.8
/// m.
Ground with_bank(double friction) {
  HeightField field = level_field(0.2);
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      const double x = field.origin_m.x() + field.cell_m * static_cast<double>(c);
      const double y = field.origin_m.y() + field.cell_m * static_cast<double>(r);
      field.heights_m[r * field.columns + c] = x < 0.5 && y < -1.7 ? 3.0 : 0.0;
    }
  }
  SoilParameters rock;
  rock.friction = friction;
  return Ground(field, SoilMap{{rock}, {}}, {});
}

struct Bank {
  ExcavatorLevel level = ExcavatorLevel::dynamic;
  double friction = 0.6;
};

class HouseAtBank : public testing::TestWithParam<Bank> {};

// Finding: the counterweight passed into a bank; then, stopped by one that nothing could break, it
// stayed there unless friction was small. Its corner, 2.5 m behind and 1.2 m beside the swing axis,
// goes 26 degrees off the face's normal.
TEST_P(HouseAtBank, ASwingIsStoppedByTheBankAndGoesBackFreely) {
  ExcavatorParameters parameters = ready_to_dig();
  parameters.level = GetParam().level;
  Site site(with_bank(GetParam().friction), {}, parameters);
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
  EXPECT_LT(stopped, 15.0 * kDegree);
  EXPECT_GT(stopped, 3.0 * kDegree);
  EXPECT_LT(report.sunk_m, 0.1);
  EXPECT_LT(report.deepest_m, 0.005);
  EXPECT_LT(gain, 50.0);
  site.run(0.8, -0.6, 0.0, 0.0, 0.0);
  EXPECT_LT(site.machine.excavator().joint_angles_rad()[0], stopped - 5.0 * kDegree);
  EXPECT_EQ(site.machine.contact_report()->points, 0U);
}

INSTANTIATE_TEST_SUITE_P(Levels, HouseAtBank,
                         testing::Values(Bank{ExcavatorLevel::quasi_static, 0.2},
                                         Bank{ExcavatorLevel::quasi_static, 0.6},
                                         Bank{ExcavatorLevel::dynamic, 0.2},
                                         Bank{ExcavatorLevel::dynamic, 0.6},
                                         Bank{ExcavatorLevel::chambers, 0.2},
                                         Bank{ExcavatorLevel::chambers, 0.6}),
                         [](const auto& bank) {
                           return "level_" + std::to_string(static_cast<int>(bank.param.level)) +
                                  "_friction_" +
                                  std::to_string(std::lround(10.0 * bank.param.friction));
                         });

struct Digs {
  ExcavatorLevel level = ExcavatorLevel::dynamic;
  ExcavatorCarrier carrier = ExcavatorCarrier::fixed;
};

/// Sand with a heap of 1.5 m in front: its top 8 m away.
Ground heaped() {
  HeightField field = level_field(0.2);
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      const double x = field.origin_m.x() + field.cell_m * static_cast<double>(c);
      const double y = field.origin_m.y() + field.cell_m * static_cast<double>(r);
      field.heights_m[r * field.columns + c] = std::max(0.0, 2.5 - 0.65 * std::hypot(x - 8.0, y));
    }
  }
  return Ground(field, SoilMap{{sand()}, {}}, {});
}

class DiggingWithBodies : public testing::TestWithParam<Digs> {};

// Finding: the bodies' contact took the force that the teeth dig with, 0.10 m3 instead of 0.28 m3.
TEST_P(DiggingWithBodies, TheBucketTakesWhatItTakesWithoutThem) {
  const auto dug_m3 = [](bool solid, bool heap) {
    ExcavatorParameters parameters = ready_to_dig();
    parameters.level = GetParam().level;
    parameters.carrier = GetParam().carrier;
    if (heap) {
      parameters.initial.boom_rad = 0.7;
    }
    if (!solid) {
      parameters.solid.boxes.clear();
    }
    Site site(heap ? heaped() : sandy(), {}, parameters);
    site.run(1.0, 0.0, 0.0, 0.0, 0.0);
    if (heap) {
      site.run(0.8, 0.0, -0.3, 0.0, 0.0);
    }
    site.dig();
    return site.machine.bucket().volume_m3();
  };
  for (const bool heap : {false, true}) {
    const double free_m3 = dug_m3(false, heap);
    EXPECT_GT(free_m3, heap ? 0.01 : 0.2) << heap;
    EXPECT_NEAR(dug_m3(true, heap), free_m3, 0.05 * free_m3) << heap;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Levels, DiggingWithBodies,
    testing::Values(Digs{ExcavatorLevel::quasi_static, ExcavatorCarrier::fixed},
                    Digs{ExcavatorLevel::dynamic, ExcavatorCarrier::fixed},
                    Digs{ExcavatorLevel::chambers, ExcavatorCarrier::fixed},
                    Digs{ExcavatorLevel::quasi_static, ExcavatorCarrier::moving},
                    Digs{ExcavatorLevel::dynamic, ExcavatorCarrier::moving},
                    Digs{ExcavatorLevel::chambers, ExcavatorCarrier::moving}),
    [](const auto& digs) {
      return "level_" + std::to_string(static_cast<int>(digs.param.level)) +
             (digs.param.carrier == ExcavatorCarrier::moving ? "_moving" : "_fixed");
    });

class StickInAHole : public testing::TestWithParam<ExcavatorLevel> {};

// Finding: a stick that swings against the wall of a hole felt 420 to 685 kN, more than any soil
// carries. What bears it is the side of it that is below the wall's edge, 0.4 m by less than 1 m.
TEST_P(StickInAHole, FeelsNoMoreThanTheGroundCarries) {
  HeightField field = level_field(0.2);
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      const double x = field.origin_m.x() + field.cell_m * static_cast<double>(c);
      const double y = field.origin_m.y() + field.cell_m * static_cast<double>(r);
      const bool hole = x > 4.0 && x < 9.0 && std::abs(y) < 0.9;
      field.heights_m[r * field.columns + c] = hole ? -3.0 : 0.0;
    }
  }
  SoilParameters soil = sand();
  soil.repose_rad = 85.0 * kDegree;  // Its walls stand.
  ExcavatorParameters parameters = ready_to_dig();
  parameters.level = GetParam();
  parameters.initial.boom_rad = -0.15;
  parameters.initial.stick_rad = -1.2;
  parameters.initial.bucket_rad = -1.2;
  DiggingParameters digging;
  digging.terrain.bank_rad = 88.0 * kDegree;
  Site site(Ground(field, SoilMap{{soil}, {}}, {}), digging, parameters);
  ValveCommand command;
  command.opening = {0.6, 0.0, 0.0, 0.0};
  site.machine.valve_port()->command(command);
  double greatest = 0.0;
  double gain = 0.0;
  double lost = 0.0;
  bool met = false;
  for (int i = 0; i < 3000; ++i) {
    site.machine.step(std::chrono::milliseconds(1));
    const ContactReport& report = *site.machine.contact_report();
    met = met || (report.terrain && report.body == "stick");
    greatest = std::max(greatest, report.force_n);
    gain = std::max(gain, lost - report.lost_j);
    lost = std::max(lost, report.lost_j);
  }
  EXPECT_TRUE(met);
  EXPECT_GT(greatest, 5e3);
  EXPECT_LT(greatest, SoilBearing(soil).pressure_pa(1.0, 0.4) * 0.4 * 1.0);
  EXPECT_LT(gain, 50.0);
  EXPECT_FALSE(site.machine.non_finite());
}

INSTANTIATE_TEST_SUITE_P(Levels, StickInAHole,
                         testing::Values(ExcavatorLevel::quasi_static, ExcavatorLevel::dynamic,
                                         ExcavatorLevel::chambers),
                         [](const auto& level) {
                           return "level_" + std::to_string(static_cast<int>(level.param));
                         });

}  // namespace
}  // namespace rigwire::sim::test

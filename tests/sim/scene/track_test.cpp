#include "sim/scene/track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/scene/open_ground.h"

namespace rigwire::sim {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Track through(std::initializer_list<Eigen::Vector2d> points, bool closed = false) {
  Track track;
  track.closed = closed;
  for (const Eigen::Vector2d& p : points) {
    track.points.push_back({p});
  }
  return track;
}

Track circle(double radius_m, int points) {
  Track track;
  track.closed = true;
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points;
    track.points.push_back({radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle))});
  }
  return track;
}

TEST(TrackLine, StraightThroughPointsInARow) {
  const TrackLine line = track_line(through({{0, 0}, {7, 0}, {20.25, 0}}));
  EXPECT_NEAR(line.length_m, 20.25, 1e-9);
  ASSERT_EQ(line.points_m.size(), 42U);
  EXPECT_NEAR(line.points_m[21].x(), 10.5, 1e-9);
  EXPECT_NEAR(line.points_m.back().x(), 20.25, 1e-9);
  for (const Eigen::Vector2d& p : line.points_m) {
    EXPECT_NEAR(p.y(), 0.0, 1e-12);
  }
}

TEST(TrackLine, ManyPointsOnACircleMakeTheCircle) {
  const TrackLine line = track_line(circle(40.0, 24));
  EXPECT_NEAR(line.length_m, 2.0 * std::numbers::pi * 40.0, 0.1);
  for (const Eigen::Vector2d& p : line.points_m) {
    EXPECT_NEAR(p.norm(), 40.0, 0.02);
  }
  const double gap = (line.points_m.back() - line.points_m.front()).norm();
  EXPECT_LE(gap, kTrackSpacing_m + 1e-9) << "closed, the first point not repeated";
  EXPECT_GT(gap, 1e-6);
}

TEST(TrackLine, PassesThroughUnevenPointsWithoutLoops) {
  const Track track = through({{0, 0}, {30, 0}, {31, 2}, {60, 20}});
  const TrackLine line = track_line(track);
  for (const TrackPoint& p : track.points) {
    EXPECT_LT(line.nearest(p.at_m).distance_m, 0.02);
  }
  for (std::size_t i = 1; i < line.points_m.size(); ++i) {
    EXPECT_GT(line.points_m[i].x(), line.points_m[i - 1].x() - 1e-9) << "turned back at " << i;
  }
}

TEST(TrackLine, NearestTellsDistanceAndPlace) {
  const TrackLine line = track_line(through({{0, 0}, {50, 0}}));
  const auto nearest = line.nearest({12.3, -4.0});
  EXPECT_NEAR(nearest.distance_m, 4.0, 1e-9);
  EXPECT_NEAR(nearest.along_m, 12.3, 1e-9);
}

TEST(Carve, TrackIsLevelAcrossAndSmootherAlongThanTheHills) {
  HillsTerrain hills;
  hills.size_m = 120.0;
  hills.longest_wave_m = 30.0;
  HeightField field = make_hills(hills, 3);
  Track track = circle(40.0, 24);
  track.roughness_m = 0.0;
  const HeightField before = field;
  carve(field, track, 3);
  double steepest_before = 0.0;
  double steepest = 0.0;
  for (int degree = 0; degree < 360; ++degree) {
    const double a = degree * std::numbers::pi / 180.0;
    const Eigen::Vector2d out(std::cos(a), std::sin(a));
    const auto height = [&](const HeightField& f, double radius, double angle) {
      return f.height_m(radius * std::cos(angle), radius * std::sin(angle));
    };
    EXPECT_NEAR(height(field, 38.7, a), height(field, 41.3, a), 0.06) << "level across";
    EXPECT_EQ(height(field, 50.0, a), height(before, 50.0, a)) << "beyond the shoulder";
    const double step = 0.5 / 40.0;
    steepest_before = std::max(
        steepest_before, std::abs(height(before, 40.0, a + step) - height(before, 40.0, a)) / 0.5);
    steepest =
        std::max(steepest, std::abs(height(field, 40.0, a + step) - height(field, 40.0, a)) / 0.5);
  }
  EXPECT_GT(steepest_before, 0.5);
  EXPECT_LT(steepest, 0.35);
}

TEST(Carve, SameSeedSameTrack) {
  HeightField a = make_level({}, 1);
  HeightField b = a;
  HeightField c = a;
  const Track track = circle(40.0, 12);
  carve(a, track, 5);
  carve(b, track, 5);
  carve(c, track, 6);
  EXPECT_EQ(a.heights_m, b.heights_m);
  EXPECT_NE(a.heights_m, c.heights_m);
}

TEST(Track, RefusesWhatIsNoTrackByName) {
  Track track = through({{0, 0}, {0, 0}});
  track.name = "loop";
  EXPECT_THAT([&] { validate(track); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("points.1: track 'loop': distance of neighbours, found 0 m")));
  track = through({{0, 0}});
  EXPECT_THAT([&] { validate(track); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("number of points, found 1")));
  track = through({{0, 0}, {5, std::nan("")}});
  EXPECT_THROW(validate(track), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim

#include "sim/gnss/broadcast_orbits.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "sim/gnss/ephemeris.h"
#include "sim/samples/calendar.h"

namespace rigwire::sim {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// 2026-06-01 00:00 by GPS time and so many seconds.
GpsTime at(std::int64_t seconds) {
  const std::int64_t gps_s = 2421LL * 604'800 + 86'400 + seconds;
  return {static_cast<std::int32_t>(gps_s / 604'800), gps_s % 604'800 * kSecond_ns};
}

/// What a user of GLONASS computes: appendix A.3.1.2 of the ICD, Runge and Kutta in steps of 60 s,
/// earth-fixed.
Eigen::Vector3d integrated(const GlonassEphemeris& set, double since_s) {
  using State = Eigen::Matrix<double, 6, 1>;
  State x;
  for (std::size_t i = 0; i < 3; ++i) {
    x(static_cast<Eigen::Index>(i)) = set.position_m[i];
    x(static_cast<Eigen::Index>(i) + 3) = set.velocity_mps[i];
  }
  const auto rate = [&](const State& s) {
    constexpr double kMu = 3.9860044e14;
    constexpr double kRadius = 6378136.0;
    constexpr double kJ2 = 1.0826257e-3;
    constexpr double kOmega = 7.292115e-5;
    const double r2 = s.head<3>().squaredNorm();
    const double r3 = r2 * std::sqrt(r2);
    const double a = 1.5 * kJ2 * kMu * kRadius * kRadius / r2 / r3;
    const double b = 5.0 * s(2) * s(2) / r2;
    const double c = -kMu / r3 - a * (1.0 - b);
    State d;
    d << s(3), s(4), s(5), (c + kOmega * kOmega) * s(0) + 2.0 * kOmega * s(4),
        (c + kOmega * kOmega) * s(1) - 2.0 * kOmega * s(3), (c - 2.0 * a) * s(2);
    return d;
  };
  for (double left = since_s; std::abs(left) > 1e-9;) {
    const double h = std::abs(left) < 60.0 ? left : std::copysign(60.0, left);
    const State k1 = rate(x);
    const State k2 = rate(x + 0.5 * h * k1);
    const State k3 = rate(x + 0.5 * h * k2);
    const State k4 = rate(x + h * k3);
    x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    left -= h;
  }
  return x.head<3>();
}

TEST(BroadcastOrbits, GlonassSatellitesAreWhereAUserIntegratesThem) {
  for (const NominalOrbit& orbit : nominal_orbits(GnssSystem::glonass)) {
    const GlonassBroadcast satellite(orbit);
    const std::int64_t begun_s = 7'218;  // a half hour of UTC begins
    const std::int64_t interval = GlonassBroadcast::interval(at(begun_s));
    ASSERT_EQ(interval, GlonassBroadcast::interval(at(begun_s + 1'799)));
    ASSERT_EQ(interval + 1, GlonassBroadcast::interval(at(begun_s + 1'800)));
    const GlonassEphemeris set = satellite.set(interval);
    EXPECT_EQ(set.time_of_day_s, 2 * 3'600 + 900 + 3 * 3'600);
    for (const std::int64_t t : {30, 450, 900, 1'350, 1'769}) {
      const SatelliteState state = satellite.state(at(begun_s + t), 0.0);
      const Eigen::Vector3d user_m = integrated(set, static_cast<double>(t) - 900.0);
      EXPECT_LT((state.position_E_m - user_m).norm(), 3e-3)
          << int{orbit.satellite.number} << " after " << t << " s";
      EXPECT_EQ(state.clock_s, -set.clock_correction_s);
    }
  }
}

// Over a change of sets, of days and of weeks nothing jumps: the velocity is the position's
// derivative.
TEST(BroadcastOrbits, SatellitesMoveSmoothly) {
  const auto check = [](const auto& satellite, std::int64_t from_s, double allowed_m) {
    for (std::int64_t t = from_s - 50; t < from_s + 50; ++t) {
      const SatelliteState a = satellite.state(at(t), 0.0);
      const SatelliteState b = satellite.state(at(t + 1), 0.0);
      const Eigen::Vector3d moved_m = b.position_E_m - a.position_E_m;
      const Eigen::Vector3d mean_mps = 0.5 * (a.velocity_E_mps + b.velocity_E_mps);
      EXPECT_LT((moved_m - mean_mps).norm(), allowed_m) << t;
    }
  };
  constexpr std::int64_t kWeekTurns_s = 6 * 86'400;
  for (const std::size_t i : {0U, 7U, 12U, 23U}) {
    const GlonassBroadcast glonass(nominal_orbits(GnssSystem::glonass)[i]);
    // A third derivative of 1e-4 m/s3 over a second; and a centimetre per second of change.
    check(glonass, 7'218, 2e-3);
    check(glonass, 86'400 + 18, 2e-3);
    const KeplerBroadcast galileo(nominal_orbits(GnssSystem::galileo)[i]);
    check(galileo, 7'200, 1e-4);
    check(galileo, kWeekTurns_s, 0.05);
    const KeplerBroadcast beidou(nominal_orbits(GnssSystem::beidou)[i]);
    check(beidou, 7'214, 1e-4);
    check(beidou, kWeekTurns_s + 14, 0.05);
  }
}

// Whoever holds a set of another two hours finds the satellite where it is, too.
TEST(BroadcastOrbits, ConsecutiveSetsSayOneOrbit) {
  for (const GnssSystem system : {GnssSystem::galileo, GnssSystem::beidou}) {
    const bool beidou = system == GnssSystem::beidou;
    for (const NominalOrbit& orbit : nominal_orbits(system)) {
      const KeplerBroadcast satellite(orbit);
      const GpsTime now = at(40'000);
      GpsTime own = now;
      own.time_of_week_ns -= beidou ? 14 * kSecond_ns : 0;
      const SatelliteState state = satellite.state(now, 0.0);
      for (const std::int64_t other : {-1, 0, 1}) {
        const GpsEphemeris set = satellite.set(satellite.interval(now) + other);
        const SatelliteState user =
            satellite_state(set, own, 0.0, beidou ? kEarthOfBeidou : kEarthOfGalileo);
        EXPECT_LT((user.position_E_m - state.position_E_m).norm(), 4e-6);
        EXPECT_EQ(user.clock_s, state.clock_s);
      }
    }
  }
}

TEST(BroadcastOrbits, SatellitesAreInTheirNominalSlots) {
  for (const GnssSystem system : {GnssSystem::galileo, GnssSystem::beidou, GnssSystem::glonass}) {
    const auto orbits = nominal_orbits(system);
    for (const NominalOrbit& orbit : orbits) {
      // At the nominal epoch.
      const GpsTime epoch{kNominalEpochWeek, kNominalEpochOfWeek_s * kSecond_ns};
      const Eigen::Vector3d nominal_m = nominal_state(orbit, epoch, 0.0).position_E_m;
      const SatelliteState state = system == GnssSystem::glonass
                                       ? GlonassBroadcast(orbit).state(epoch, 0.0)
                                       : KeplerBroadcast(orbit).state(epoch, 0.0);
      EXPECT_LT((state.position_E_m - nominal_m).norm(), 3e3) << int{orbit.satellite.number};
    }
  }
}

}  // namespace
}  // namespace rigwire::sim

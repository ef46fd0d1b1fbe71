// The excavator on tracks against closed forms: sinkage, speed, and the effort of turning and
// climbing. Figures of the machine with the numbers of its file, its weight over the middle of its
// tracks, 21 stations to a track.
//
// Sources: M. G. Bekker's plate and compaction, Z. Janosi and B. Hanamoto's shear as J. Y. Wong has
// them, Theory of Ground Vehicles, 4th edition 2008, chapters 2 and 4 (a track of even pressure,
// (A c + W tan(phi)) [1 - K / (s L) (1 - exp(-s L / K))]); spinning by Coulomb's friction along the
// slide, worked out below.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "sim/excavator/excavator.h"

namespace rigwire::bench {

struct TrackCase {
  std::string name;
  std::string figure;  ///< What is compared, with its unit.
  double closed_form = 0.0;
  double tolerance = 0.0;  ///< Share of the closed form within which a test holds it at 1 ms.
  std::function<double(double step_s)> run;
};

namespace tracks {

inline constexpr double kG_mps2 = 9.80665;

inline double mass_kg(const sim::ExcavatorParameters& p) {
  return p.undercarriage.mass_kg + p.upper.mass_kg + p.boom.mass_kg + p.stick.mass_kg +
         p.bucket.mass_kg;
}

/// The arm's own overhang is put right by the undercarriage, `ahead_m` more with what is over it.
inline sim::ExcavatorParameters balanced(double step_s, double ahead_m = 0.0) {
  sim::ExcavatorParameters p;
  p.carrier = sim::ExcavatorCarrier::moving;
  p.running_gear = sim::RunningGear::tracks;
  p.tracks.stations = 21;
  p.step_s = step_s;
  sim::ArmDynamics arm(p, {0.0, -1.0, 0.0});
  const sim::ExcavatorPose& pose = p.initial;
  const double moment_kgm =
      arm.gravity_load({pose.swing_rad, pose.boom_rad, pose.stick_rad, pose.bucket_rad})[0];
  p.undercarriage.center_of_mass_m.x() =
      (ahead_m * mass_kg(p) - moment_kgm) / p.undercarriage.mass_kg;
  return p;
}

/// Wong's sandy loam of 11 % moisture, of little sinkage under tracks.
inline sim::SoilParameters loam() {
  sim::SoilParameters soil;
  soil.name = "loam";
  soil.soft = true;
  soil.friction = 0.9;
  soil.cohesion_modulus = 5.27e3;
  soil.friction_modulus = 1.515e6;
  soil.exponent = 0.7;
  soil.cohesion_pa = 1.72e3;
  soil.internal_friction_rad = 29.0 * std::numbers::pi / 180.0;
  soil.shear_modulus_m = 0.025;
  return soil;
}

/// Its nose up the slope.
struct Slope {
  explicit Slope(double angle_rad, const sim::SoilParameters& soil = {})
      : ground(sim::Ground::plane({-std::sin(angle_rad), 0.0, std::cos(angle_rad)}, soil)) {
    X_WC.linear() = Eigen::AngleAxisd(-angle_rad, Eigen::Vector3d::UnitY()).matrix();
  }
  sim::Ground ground;
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
};

inline ValveCommand travel(double left, double right) {
  ValveCommand command;
  command.opening[4] = left;
  command.opening[5] = right;
  return command;
}

inline Eigen::Vector3d place(const sim::Excavator& machine) {
  return machine.link(sim::Link::undercarriage).X_WL.translation();
}
inline double yaw_rad(const sim::Excavator& machine) {
  const Eigen::Matrix3d R = machine.link(sim::Link::undercarriage).X_WL.linear();
  return std::atan2(R(1, 0), R(0, 0));
}

/// Common centre of mass in the undercarriage's frame.
inline Eigen::Vector3d centre_of_mass_C(const sim::Excavator& machine,
                                        const sim::ExcavatorParameters& p) {
  const std::array<const sim::RigidBodyParameters*, sim::kLinks> bodies{
      &p.undercarriage, &p.upper, &p.boom, &p.stick, &p.bucket};
  Eigen::Vector3d sum_W = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < sim::kLinks; ++i) {
    sum_W +=
        bodies[i]->mass_kg / mass_kg(p) * (machine.links()[i].X_WL * bodies[i]->center_of_mass_m);
  }
  return machine.link(sim::Link::undercarriage).X_WL.inverse() * sum_W;
}

/// Returns the sinkage on level soft soil, the machine at rest.
inline double sinkage_m(double step_s) {
  const sim::Ground ground = sim::Ground::plane(Eigen::Vector3d::UnitZ(), loam());
  return -place(sim::Excavator(balanced(step_s), Eigen::Isometry3d::Identity(), &ground)).z();
}

/// Turning on the spot with even pressure and Coulomb's friction along the slide: at x on the track
/// it is (a, x) times the turn. Each belt pulls F = mu p 2 a asinh(l / a), l = L / 2, and both
/// couple against M = mu p (l sqrt(l^2 + a^2) - a^2 asinh(l / a)) each: F B / 2 = M gives a, and
/// the turn over the belts' is (B / 2) / (B / 2 + a).
struct Spin {
  double pull_n = 0.0;    ///< Pull of each motor, including its rollers' resistance.
  double of_belts = 0.0;  ///< Turn of the machine over that of the belts without slip.
};
inline Spin closed_spin(const sim::ExcavatorParameters& p, double friction) {
  const double half_m = 0.5 * p.tracks.length_m;
  const double lever_m = 0.5 * p.tracks.gauge_m;
  double a = 0.5;
  for (int i = 0; i < 200; ++i) {
    const double s = std::asinh(half_m / a);
    a = 0.5 * a + 0.5 * (half_m * std::hypot(half_m, a) - a * a * s) / (2.0 * s * lever_m);
  }
  const double load_n = 0.5 * kG_mps2 * mass_kg(p);
  const double per_m = friction * load_n / p.tracks.length_m;
  return {per_m * 2.0 * a * std::asinh(half_m / a) + p.tracks.resistance * load_n,
          lever_m / (lever_m + a)};
}
inline Spin measured_spin(double step_s) {
  const sim::Ground ground;
  const sim::ExcavatorParameters p = balanced(step_s);
  sim::Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
  machine.command(travel(-0.3, 0.3));
  machine.step(std::chrono::seconds(4));
  const double before = yaw_rad(machine);
  Spin spin;
  for (int i = 0; i < 100; ++i) {
    machine.step(std::chrono::milliseconds(10));
    const auto drives = machine.carrier_drives();
    spin.pull_n += 0.005 * (drives[1].drive_n() - drives[0].drive_n());
  }
  const double of_belts = 2.0 * machine.carrier_drives()[1].rate_mps() / p.tracks.gauge_m;
  spin.of_belts = (yaw_rad(machine) - before) / of_belts;
  return spin;
}

/// Slip of a climb on loam: the thrust that weight and compaction ask for.
inline double closed_slip(double slope_rad) {
  const sim::ExcavatorParameters p = balanced(1e-3);
  const sim::SoilParameters soil = loam();
  const double area = p.tracks.length_m * p.tracks.shoe_width_m;
  const double weight_n = 0.5 * kG_mps2 * mass_kg(p);
  const double load_n = weight_n * std::cos(slope_rad);
  const double needed_n =
      weight_n * std::sin(slope_rad) +
      sim::compaction_resistance_n(soil,
                                   sim::plate_sinkage_m(soil, load_n / area, p.tracks.shoe_width_m),
                                   p.tracks.shoe_width_m);
  const double whole_n = area * soil.cohesion_pa + load_n * std::tan(soil.internal_friction_rad);
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double slip = 0.5 * (low + high);
    const double x = slip * p.tracks.length_m / soil.shear_modulus_m;
    (whole_n * (1.0 + std::expm1(-x) / x) < needed_n ? low : high) = slip;
  }
  return high;
}
/// With the weight over the middle of the tracks on the slope, too.
inline double measured_slip(double slope_rad, double step_s) {
  const sim::Ground level = sim::Ground::plane(Eigen::Vector3d::UnitZ(), loam());
  const sim::ExcavatorParameters still = balanced(step_s);
  const double height_m =
      centre_of_mass_C(sim::Excavator(still, Eigen::Isometry3d::Identity(), &level), still).z();
  const Slope slope(slope_rad, loam());
  sim::Excavator machine(balanced(step_s, height_m * std::tan(slope_rad)), slope.X_WC,
                         &slope.ground);
  machine.command(travel(0.4, 0.4));
  machine.step(std::chrono::seconds(25));  // What the start has sheared is passed on.
  const Eigen::Vector3d from = place(machine);
  const double of_belt = machine.carrier_drives()[0].position_m();
  machine.step(std::chrono::seconds(4));
  return 1.0 -
         (place(machine) - from).norm() / (machine.carrier_drives()[0].position_m() - of_belt);
}

/// Speed over what the oil makes of it, of both sections half open beyond their dead band.
inline double measured_speed_mps(double step_s) {
  const sim::Ground ground;
  sim::Excavator machine(balanced(step_s), Eigen::Isometry3d::Identity(), &ground);
  machine.command(travel(0.52, 0.52));
  machine.step(std::chrono::seconds(3));
  const double from = place(machine).x();
  machine.step(std::chrono::seconds(7));
  return (place(machine).x() - from) / 7.0;
}

/// What a climb has raised and its rollers have taken, over the oil's work.
inline double measured_energy(double step_s) {
  const Slope slope(0.15);
  const sim::ExcavatorParameters p = balanced(step_s);
  sim::Excavator machine(p, slope.X_WC, &slope.ground);
  machine.command(travel(0.52, 0.52));
  machine.step(std::chrono::seconds(3));
  const double height = place(machine).z();
  const auto step = from_seconds(step_s);
  double oil_j = 0.0;
  double rollers_j = 0.0;
  for (int i = 0; i < static_cast<int>(std::lround(5.0 / step_s)); ++i) {
    machine.step(step);
    for (const sim::CarrierDrive& drive : machine.carrier_drives()) {
      oil_j += step_s * drive.drive_n() * drive.rate_mps();
      rollers_j -= step_s * drive.holding_n() * drive.rate_mps();
    }
  }
  return (kG_mps2 * mass_kg(p) * (place(machine).z() - height) + rollers_j) / oil_j;
}

}  // namespace tracks

inline std::vector<TrackCase> track_cases() {
  const sim::ExcavatorParameters p = tracks::balanced(1e-3);
  const double area = p.tracks.length_m * p.tracks.shoe_width_m;
  const double friction = sim::SoilParameters{}.friction;
  std::vector<TrackCase> cases{
      {"stands on loam", "sinkage m",
       sim::plate_sinkage_m(tracks::loam(), 0.5 * tracks::kG_mps2 * tracks::mass_kg(p) / area,
                            p.tracks.shoe_width_m),
       0.03, tracks::sinkage_m},
      {"straight, hard ground", "speed m/s",
       0.5 * p.tracks.spool.flow_max_m3ps / p.tracks.area_m2(), 2e-3, tracks::measured_speed_mps},
      {"spins on the spot", "pull N", tracks::closed_spin(p, friction).pull_n, 0.02,
       [](double step_s) { return tracks::measured_spin(step_s).pull_n; }},
      {"spins on the spot", "turn over belts'", tracks::closed_spin(p, friction).of_belts, 0.08,
       [](double step_s) { return tracks::measured_spin(step_s).of_belts; }},
      {"climbs 0.15 rad", "energy over oil's", 1.0, 0.01, tracks::measured_energy}};
  for (const double slope_rad : {0.1, 0.2, 0.3}) {
    std::string name = "climbs loam, " + std::to_string(slope_rad).substr(0, 3) + " rad";
    cases.push_back(
        {std::move(name), "slip", tracks::closed_slip(slope_rad), 0.1,
         [slope_rad](double step_s) { return tracks::measured_slip(slope_rad, step_s); }});
  }
  return cases;
}

}  // namespace rigwire::bench

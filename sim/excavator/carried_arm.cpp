#include "sim/excavator/carried_arm.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rigwire::sim {

using SpatialVector = CarriedArm::SpatialVector;

namespace {

constexpr double kFree = 1e300;
constexpr int kPassesMax = 24;
constexpr int kSwitchesMax = 4;  // Per force: to a limit, back, to a limit, back.
// Distance from a cylinder's stop within which the stop acts.
constexpr double kStopReach_m = 0.005;
constexpr double kPadShear_m = 0.005;  // K of steel pads on hard ground.
// Deflection of the bristle that represents the resistance of pressed soil.
constexpr double kPloughingWind_m = 0.01;
constexpr double kLeavesRut_mps = 1e-3;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// v x m of spatial motion vectors (Featherstone 2008, chapter 2).
SpatialVector cross_motion(const SpatialVector& v, const SpatialVector& m) {
  const Eigen::Vector3d w = v.head<3>();
  SpatialVector result;
  result << w.cross(m.head<3>()), w.cross(m.tail<3>()) + v.tail<3>().cross(m.head<3>());
  return result;
}

/// v x* f, the dual on force vectors (Featherstone 2008, chapter 2).
SpatialVector cross_force(const SpatialVector& v, const SpatialVector& f) {
  const Eigen::Vector3d w = v.head<3>();
  SpatialVector result;
  result << w.cross(f.head<3>()) + v.tail<3>().cross(f.tail<3>()), w.cross(f.tail<3>());
  return result;
}

/// Motion subspace of a revolute joint: axis, and the velocity it gives to C's origin.
SpatialVector turning(const Eigen::Vector3d& axis, const Eigen::Vector3d& through) {
  SpatialVector result;
  result << axis, through.cross(axis);
  return result;
}

}  // namespace

CarriedArm::CarriedArm(const ExcavatorParameters& parameters, const Ground& ground,
                       const Eigen::Isometry3d& X_WC)
    : parameters_(parameters),
      undercarriage_(ArmDynamics::moments_of(parameters.undercarriage)),
      ground_(&ground),
      X_WC_(X_WC) {
  double mass = undercarriage_.mass_kg;
  for (const RigidBodyParameters* link :
       {&parameters.upper, &parameters.boom, &parameters.stick, &parameters.bucket}) {
    mass += link->mass_kg;
  }
  contact_rows_.reserve(kMostContactPoints + OwnContact::kMostPoints);
  contact_points_.reserve(kMostContactPoints + OwnContact::kMostPoints);
  mass_kg_ = mass;
  if (parameters.running_gear == RunningGear::tracks) {
    make_tracks();
  } else {
    make_wheels();
  }
  make_pads();
  const std::size_t footings = tyres_.size() + plates_.size();
  footings_.resize(footings);
  plate_loads_n_.resize(plates_.size());
  eliminated_.resize((stations_ > 0 ? kTracks : 0) + parameters.supports.size());
  terms_.reserve(2 * kArmJoints + kTipResistances + 3 * footings + kTracks);
}

void CarriedArm::make_wheels() {
  const CarrierParameters& wheels = parameters_.wheels;
  tyres_.assign(kCarrierWheels, Tyre(wheels.tyre, mass_kg_ / kCarrierWheels));
  // So high that with a quarter of the weight on each the origin lies on the ground.
  const double deflection = mass_kg_ * parameters_.gravity_mps2 / kCarrierWheels /
                            tyres_[0].stiffness_npm(wheels.tyre_pressure_pa);
  const double height = wheels.tyre.unloaded_radius_m - deflection;
  for (std::size_t i = 0; i < kCarrierWheels; ++i) {
    wheel_C_[i] = {(i < 2 ? 0.5 : -0.5) * wheels.wheelbase_m,
                   (i % 2 == 0 ? 0.5 : -0.5) * wheels.track_m, height};
  }
}

void CarriedArm::make_tracks() {
  const TrackParameters& p = parameters_.tracks;
  const auto gaps = static_cast<double>(p.stations - 1);
  const double carried_kg = 0.5 * mass_kg_;
  const double load_n = carried_kg * parameters_.gravity_mps2;
  // With half of the weight on each the origin lies on hard ground.
  const double height = p.end_radius_m - load_n / p.stiffness_npm;
  for (std::size_t track = 0; track < kTracks; ++track) {
    for (int k = 0; k < p.stations; ++k) {
      const bool end = k == 0 || k == p.stations - 1;
      const double share = (end ? 0.5 : 1.0) / gaps;
      const double along = p.length_m * (k / gaps - 0.5);
      // The middle of an end's half gap is a quarter of a gap from the end.
      const double inwards = (end ? 0.25 : 0.0) * p.length_m / gaps;
      Plate& plate = plates_.emplace_back();
      plate.plate = GroundPlate(
          {.area_m2 = share * p.length_m * p.shoe_width_m,
           .soil_width_m = std::min(p.shoe_width_m, p.length_m),
           .stiffness_npm = share * p.stiffness_npm,
           .damping_nspm = share * 2.0 * p.damping_ratio * std::sqrt(p.stiffness_npm * carried_kg),
           .reference_load_n = share * load_n,
           .carried_mass_kg = share * carried_kg,
           .damping_ratio = p.damping_ratio,
           .grip = p.grip,
           .shear_way_m = p.shear_way_m});
      plate.at_C = {along, (track == 0 ? 0.5 : -0.5) * p.gauge_m, height};
      plate.drive = track;
      plate.behind_front_m = std::max(0.5 * p.length_m - along - (k == 0 ? inwards : 0.0), inwards);
      plate.behind_rear_m = std::max(0.5 * p.length_m + along - (k > 0 ? inwards : 0.0), inwards);
    }
  }
  stations_ = plates_.size();
}

void CarriedArm::make_pads() {
  // A steel pad on hard ground: a tenth of the machine's weight presses it in by a fifth of a
  // millimetre, whatever the machine.
  const double load_n = 0.1 * mass_kg_ * std::max(1.0, parameters_.gravity_mps2);
  const double stiffness = load_n / 2e-4;
  std::size_t drive = stations_ > 0 ? kTracks : 0;
  for (const SupportParameters& p : parameters_.supports) {
    for (const double side : {0.5, -0.5}) {
      Plate& plate = plates_.emplace_back();
      plate.plate = GroundPlate({.area_m2 = p.pad_length_m * p.pad_width_m,
                                 .soil_width_m = std::min(p.pad_length_m, p.pad_width_m),
                                 .stiffness_npm = stiffness,
                                 .damping_nspm = std::sqrt(stiffness * 0.25 * mass_kg_),
                                 .reference_load_n = load_n,
                                 .carried_mass_kg = 0.25 * mass_kg_,
                                 .damping_ratio = 0.5,
                                 .grip = p.friction,
                                 .shear_way_m = kPadShear_m});
      plate.at_C = {p.x_m, side * p.spread_m, p.raised_m};
      plate.drive = drive;
    }
    ++drive;
  }
}

double CarriedArm::track_load_n(std::size_t track) const {
  const std::size_t each = stations_ / kTracks;
  double sum = 0.0;
  for (std::size_t i = track * each; i < (track + 1) * each; ++i) {
    sum += plate_loads_n_[i];
  }
  return sum;
}

void CarriedArm::place(const Eigen::Isometry3d& X_WC) {
  X_WC_ = X_WC;
  velocity_.setZero();
  acceleration_.setZero();
}

void CarriedArm::set_velocity(const Eigen::Vector3d& w_C, const Eigen::Vector3d& v_C) {
  velocity_.head<3>() = w_C;
  velocity_.segment<3>(3) = v_C;
}

std::size_t CarriedArm::add(const Velocities& row, const ImplicitForce& law, double least,
                            double greatest) {
  Term& term = terms_.emplace_back();
  term.row = row;
  term.law = law;
  term.least = least;
  term.greatest = greatest;
  return terms_.size() - 1;
}

std::size_t CarriedArm::add_on_carrier(const Eigen::Vector3d& point_W,
                                       const Eigen::Vector3d& direction_W, const ImplicitForce& law,
                                       double least, double greatest) {
  const Eigen::Matrix3d R_CW = X_WC_.linear().transpose();
  const Eigen::Vector3d point_C = R_CW * (point_W - X_WC_.translation());
  const Eigen::Vector3d direction_C = R_CW * direction_W;
  Velocities row = Velocities::Zero();
  // Force on the undercarriage as a wrench: moment p x n, then n.
  row.head<3>() = point_C.cross(direction_C);
  row.segment<3>(3) = direction_C;
  return add(row, law, least, greatest);
}

void CarriedArm::add_wheels(double h) {
  const Eigen::Vector3d axle_W = X_WC_.linear().col(1);
  const CarrierParameters& wheels = parameters_.wheels;
  for (std::size_t i = 0; i < tyres_.size(); ++i) {
    const Eigen::Vector3d center_W = X_WC_ * wheel_C_[i];
    const auto contact = ground_->wheel_contact(center_W, axle_W, wheels.tyre.unloaded_radius_m);
    Footing& foot = footings_[i];
    // The wheels do not roll: nothing is ploughed, and no rut is left.
    TyreLaws& laws = tyre_laws_[i];
    laws = tyres_[i].laws(
        h, contact,
        contact ? ground_->footing(*contact, X_WC_.linear().col(0), 0.0) : WheelFooting{},
        wheels.tyre_pressure_pa, 0.0);
    foot = {};
    foot.touching = contact.has_value() && laws.touching;
    if (!foot.touching) {
      continue;
    }
    foot.shear = laws;
    const Eigen::Vector3d& normal_W = contact->normal_W;
    const Eigen::Vector3d forward_W = axle_W.cross(normal_W).normalized();
    const Eigen::Vector3d left_W = normal_W.cross(forward_W);
    const Eigen::Vector3d& point_W = contact->point_W;
    foot.normal = add_on_carrier(point_W, normal_W, laws.normal, 0.0, kFree);
    foot.along = add_on_carrier(point_W, forward_W, laws.longitudinal, -kFree, kFree);
    foot.across = add_on_carrier(point_W, left_W, laws.lateral, -kFree, kFree);
  }
}

void CarriedArm::find_contact(Plate& plate, std::size_t index, double lowered_m) {
  std::optional<WheelContact> found;
  if (index < stations_) {
    found = ground_->wheel_contact(X_WC_ * plate.at_C, X_WC_.linear().col(1),
                                   parameters_.tracks.end_radius_m);
  } else {
    const Eigen::Vector3d p_W = X_WC_ * (plate.at_C - lowered_m * Eigen::Vector3d::UnitZ());
    const auto inside = ground_->penetration(p_W);
    if (inside) {
      const auto terrain = ground_->terrain_penetration(p_W);
      found = WheelContact{inside->depth_m,
                           p_W,
                           inside->normal_W,
                           terrain && terrain->depth_m == inside->depth_m ? 1.0 : 0.0,
                           {.friction = inside->friction}};
    }
  }
  plate.contact = found.value_or(WheelContact{});
  plate.soils = found ? ground_->footing(*found, X_WC_.linear().col(0), 0.0).under : SoftSoils{};
}

void CarriedArm::add_plates(double h, std::span<CarrierDrive> drives) {
  const Eigen::Vector3d axle_W = X_WC_.linear().col(1);
  const Eigen::Vector3d down_W = -X_WC_.linear().col(2);
  for (std::size_t i = 0; i < plates_.size(); ++i) {
    Plate& plate = plates_[i];
    const CarrierDrive& drive = drives[plate.drive];
    const bool of_track = i < stations_;
    find_contact(plate, i, of_track ? 0.0 : drive.position_m());
    const bool touches = plate.contact.depth_m > 0.0;
    plate.laws =
        plate.plate.laws(h, touches ? std::optional(plate.contact) : std::nullopt, plate.soils,
                         of_track ? drive.rate_mps() : 0.0,
                         drive.rate_mps() < 0.0 ? plate.behind_rear_m : plate.behind_front_m);
    Footing& foot = footings_[tyres_.size() + i];
    foot = {};
    foot.touching = plate.laws.touching;
    if (!foot.touching) {
      continue;
    }
    foot.shear = plate.laws;
    const Eigen::Vector3d& normal_W = plate.contact.normal_W;
    const Eigen::Vector3d forward_W = axle_W.cross(normal_W).normalized();
    const Eigen::Vector3d left_W = normal_W.cross(forward_W);
    const Eigen::Vector3d& point_W = plate.contact.point_W;
    foot.normal = add_on_carrier(point_W, normal_W, plate.laws.normal, 0.0, kFree);
    foot.along = add_on_carrier(point_W, forward_W, plate.laws.along, -kFree, kFree);
    foot.across = add_on_carrier(point_W, left_W, plate.laws.across, -kFree, kFree);
    // A belt goes backwards under its track; pads go down.
    for (const std::size_t term : {foot.normal, foot.along, foot.across}) {
      const Eigen::Vector3d& direction_W = term == foot.normal  ? normal_W
                                           : term == foot.along ? forward_W
                                                                : left_W;
      terms_[term].drive = plate.drive;
      terms_[term].share = of_track ? (term == foot.along ? 1.0 : 0.0) : -direction_W.dot(down_W);
    }
  }
  for (std::size_t track = 0; track < kTracks && stations_ > 0; ++track) {
    add_ploughing(h, track, drives[track].rate_mps());
  }
}

void CarriedArm::add_ploughing(double h, std::size_t track, double rate_mps) {
  Track& of = tracks_[track];
  const std::size_t each = stations_ / kTracks;
  const std::span<const Plate> plates = std::span(plates_).subspan(track * each, each);
  // Bekker's work of pressing the track's rut, per way, at its leading end.
  const Plate& leading = rate_mps < 0.0 ? plates.front() : plates.back();
  of.rut_m = 0.0;
  for (const Plate& plate : plates) {
    of.rut_m = std::max(of.rut_m, plate.laws.rut_m);
  }
  of.resistance_n = 0.0;
  if (leading.laws.touching) {
    for (std::size_t i = 0; i < leading.soils.count; ++i) {
      of.resistance_n +=
          leading.soils.share[i] * compaction_resistance_n(*leading.soils.soil[i], of.rut_m,
                                                           leading.soils.pressed_m,
                                                           parameters_.tracks.shoe_width_m);
    }
  }
  of.resisted = of.resistance_n > 0.0;
  if (!of.resisted) {
    of.bristle.reset();
    return;
  }
  of.pushing.stiffness = of.resistance_n / kPloughingWind_m;
  of.pushing.damping = std::sqrt(of.pushing.stiffness * mass_kg_);
  const Eigen::Vector3d forward_W =
      X_WC_.linear().col(1).cross(leading.contact.normal_W).normalized();
  of.term = add_on_carrier(leading.contact.point_W, forward_W, of.bristle.force(of.pushing, h, 0.0),
                           -of.resistance_n, of.resistance_n);
}

double CarriedArm::speed(const Term& term, const Velocities& found) const {
  const double of_carrier = term.row.dot(found);
  return term.drive == kNoDrive ? of_carrier
                                : of_carrier - term.share * eliminated_[term.drive].rate;
}

void CarriedArm::eliminate(double h, std::span<CarrierDrive> drives, Matrix& left,
                           Velocities& right) {
  for (std::size_t k = 0; k < drives.size(); ++k) {
    CarrierDrive& drive = drives[k];
    Eliminated& of = eliminated_[k];
    of.b.setZero();
    of.d = drive.mass_kg() / h;
    of.c = of.d * drive.rate_mps() + drive.weight_n();
    for (const DriveForce& each : drive.forces()) {
      of.c += each.held ? each.force_n : each.law.offset;
      of.d += each.held ? 0.0 : each.law.gain;
    }
  }
  for (const Term& term : terms_) {
    if (term.drive == kNoDrive || term.share == 0.0) {
      continue;
    }
    Eliminated& of = eliminated_[term.drive];
    of.c -= term.share * (term.held ? term.force : term.law.offset);
    if (!term.held) {
      of.d += term.share * term.share * term.law.gain;
      of.b += term.share * term.law.gain * term.row;
    }
  }
  for (std::size_t k = 0; k < drives.size(); ++k) {
    const Eliminated& of = eliminated_[k];
    left.noalias() -= (h / of.d) * of.b * of.b.transpose();
    right += (of.c + of.b.dot(velocity_)) / of.d * of.b;
  }
}

bool CarriedArm::clamp(Term& term, double free) {
  if (term.held) {
    // Held before another force was, it may not need to be any more. Friction stays: its limit
    // is not its own.
    const bool own = term.least > -kFree || term.greatest < kFree;
    const bool within = term.force >= term.greatest ? free < term.greatest : free > term.least;
    if (own && within && term.switches < kSwitchesMax) {
      term.held = false;
      ++term.switches;
      return true;
    }
    return false;
  }
  term.force = std::clamp(free, term.least, term.greatest);
  if (free != term.force && term.switches < kSwitchesMax) {
    term.held = true;
    ++term.switches;
    return true;
  }
  return false;
}

bool CarriedArm::clamp_standing(Footing& foot) {
  Term& along = terms_[foot.along];
  Term& across = terms_[foot.across];
  const double limit = foot.shear.limit_n(terms_[foot.normal].force);
  // Friction circle under the normal force of this pass.
  const double force = std::hypot(along.force, across.force);
  // Held forces follow the load that the solve finds; a few passes settle it.
  const bool loose = force > limit * (1.0 + 1e-9);
  if (!loose && !(foot.sliding && force < limit * (1.0 - 1e-6))) {
    return false;
  }
  const double share = force > 0.0 ? limit / force : 0.0;
  along.force *= share;
  across.force *= share;
  along.held = across.held = true;
  foot.sliding = true;
  return true;
}

bool CarriedArm::clamp_sliding(Footing& foot, const Velocities& found) {
  Term& along = terms_[foot.along];
  Term& across = terms_[foot.across];
  const double limit = foot.shear.limit_n(terms_[foot.normal].force);
  // Coulomb's cone on the trial force of both, along the slide that this pass has found: what is
  // held may come loose, or be held the other way.
  const double first = along.law.at(speed(along, found));
  const double second = across.law.at(speed(across, found));
  const double trial = std::hypot(first, second);
  if (trial <= limit) {
    along.force = first;
    across.force = second;
    const bool changed = foot.sliding && along.switches < kSwitchesMax;
    if (changed) {
      ++along.switches;
      along.held = across.held = foot.sliding = false;
    }
    return changed;
  }
  const double share = limit / trial;
  const double off = std::hypot(share * first - along.force, share * second - across.force);
  if (foot.sliding && off <= 1e-3 * limit) {
    return false;
  }
  along.force = share * first;
  across.force = share * second;
  along.held = across.held = foot.sliding = true;
  return true;
}

bool CarriedArm::clamp(const Velocities& found, std::span<CarrierDrive> drives) {
  bool changed = false;
  for (std::size_t k = 0; k < drives.size(); ++k) {
    Eliminated& of = eliminated_[k];
    of.rate = (of.c + of.b.dot(found)) / of.d;
    for (DriveForce& each : drives[k].forces()) {
      changed = each.clamp(each.law.at(of.rate)) || changed;
    }
  }
  for (Term& term : terms_) {
    changed = clamp(term, term.law.at(speed(term, found))) || changed;
  }
  for (std::size_t i = 0; i < footings_.size(); ++i) {
    if (footings_[i].touching) {
      changed =
          (i < tyres_.size() ? clamp_standing(footings_[i]) : clamp_sliding(footings_[i], found)) ||
          changed;
    }
  }
  return changed;
}

ArmStep CarriedArm::step(double h, const DrivenArm& arm, const ArmPose& at, const DriveLaws& laws,
                         const BucketLoad& load, ArmState& state, ContactSet* contacts,
                         std::span<CarrierDrive> drives, OwnContact* own) {
  velocity_.tail<4>() = state.v_radps;
  Placement placed;
  Matrix mass_matrix;
  Velocities bias;
  equations(arm, placed, state.q_rad, mass_matrix, bias);

  terms_.clear();
  for (int i = 0; i < kArmJoints; ++i) {
    Velocities row = Velocities::Zero();
    // Virtual work: a drive's force acts on its joint by the lever dx/dq.
    row[i + 6] = at.lever[i];
    add(row, laws.force[static_cast<std::size_t>(i)], laws.least[i], laws.greatest[i]);
  }
  for (int i = 1; i < kArmJoints; ++i) {
    // End stops join where the stroke would end within this step.
    const double ahead = at.x[i] + h * at.lever[i] * state.v_radps[i];
    const bool low = ahead < arm.length_least_m()[i] + kStopReach_m;
    if (low || ahead > arm.length_greatest_m()[i] - kStopReach_m) {
      Velocities row = Velocities::Zero();
      row[i + 6] = at.lever[i];
      const ImplicitForce law = arm.stop_law(i, low, h, at.x[i]);
      add(row, law, low ? 0.0 : -kFree, low ? kFree : 0.0);
    }
  }
  const Eigen::Matrix3d R_CW = X_WC_.linear().transpose();
  const auto on_bucket = [&](const Eigen::Vector3d& point_B, const Eigen::Vector3d& direction_W) {
    return point_row(placed, placed.origin_C[4] + placed.R_CB[4] * point_B, R_CW * direction_W, 4);
  };
  const std::size_t first_resistance = terms_.size();
  for (std::size_t i = 0; i < load.resistance_count; ++i) {
    const TipResistance& each = load.resistances[i];
    add(on_bucket(each.point_B, each.direction_W), {each.offset_n, each.gain_nspm}, -each.limit_n,
        each.limit_n);
  }
  add_wheels(h);
  add_plates(h, drives);
  Velocities rest = -bias;
  if (!load.force_W.isZero(0.0)) {
    rest += on_bucket(load.point_B, load.force_W);
  }

  contact_points_.clear();
  contact_rows_.clear();
  const auto add_point = [&](ContactPoint& point) {
    contact_points_.push_back(&point);
    Eigen::Vector3d p_C = R_CW * (point.p_W - X_WC_.translation());
    auto& rows = contact_rows_.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      rows[i] = point_row(placed, p_C, R_CW * point.direction_W[i], point.link);
    }
    return p_C;
  };
  const std::span<ContactPoint> with_obstacles =
      contacts != nullptr ? contacts->points() : std::span<ContactPoint>{};
  for (ContactPoint& point : with_obstacles) {
    add_point(point);
  }
  const std::span<ContactPoint> with_itself =
      own != nullptr ? own->points() : std::span<ContactPoint>{};
  for (std::size_t k = 0; k < with_itself.size(); ++k) {
    const Eigen::Vector3d p_C = add_point(with_itself[k]);
    for (std::size_t i = 0; i < 3; ++i) {
      contact_rows_.back()[i] -=
          point_row(placed, p_C, R_CW * with_itself[k].direction_W[i], own->inner_link(k));
    }
  }
  const auto contact_speeds = [&](std::size_t i, const Velocities& v) {
    const auto& rows = contact_rows_[i];
    return std::array<double, 3>{rows[0].dot(v), rows[1].dot(v), rows[2].dot(v)};
  };

  Velocities found = velocity_;
  // (M + h sum g J^T J) a = -bias + sum J^T F(start), clamp last (carried_arm.h).
  for (int pass = 0; pass < kPassesMax; ++pass) {
    Matrix left = mass_matrix;
    Velocities right = rest;
    for (const Term& term : terms_) {
      if (term.held) {
        right += term.force * term.row;
      } else {
        left.noalias() += h * term.law.gain * term.row * term.row.transpose();
        right += term.law.at(term.row.dot(velocity_)) * term.row;
      }
    }
    for (std::size_t i = 0; i < contact_points_.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const ImplicitForce law = contact_points_[i]->acting(k);
        const Velocities& row = contact_rows_[i][k];
        left.noalias() += h * law.gain * row * row.transpose();
        right += law.at(row.dot(velocity_)) * row;
      }
    }
    eliminate(h, drives, left, right);
    acceleration_ = left.llt().solve(right);
    found = velocity_ + h * acceleration_;
    bool changed = clamp(found, drives);
    for (std::size_t i = 0; i < contact_points_.size(); ++i) {
      changed = contact_points_[i]->changes(contact_speeds(i, found)) || changed;
    }
    if (!changed) {
      break;
    }
  }
  if (contacts != nullptr) {
    contacts->settle(h, [&](const ContactPoint& point) {
      return contact_speeds(static_cast<std::size_t>(&point - with_obstacles.data()), found);
    });
  }
  if (own != nullptr) {
    own->settle(h, [&](std::size_t i) { return contact_speeds(with_obstacles.size() + i, found); });
  }

  settle_wheels(h, found);
  settle_plates(h, found, drives);

  velocity_ = found;
  // Attitude by the exponential map of h w, position and joints with the new velocities.
  const Eigen::Vector3d turn = h * velocity_.head<3>();
  const double angle = turn.norm();
  const Eigen::Vector3d shift = X_WC_.linear() * (h * velocity_.segment<3>(3));
  X_WC_.translation() += shift;
  if (angle > 0.0) {
    const Eigen::Quaterniond R(X_WC_.linear() * Eigen::AngleAxisd(angle, turn / angle));
    X_WC_.linear() = R.normalized().toRotationMatrix();
  }
  state.v_radps = velocity_.tail<4>();
  state.q_rad += h * state.v_radps;

  ArmStep result;
  result.acceleration_radps2 = acceleration_.tail<4>();
  for (int i = 0; i < kArmJoints; ++i) {
    const auto n = static_cast<std::size_t>(i);
    result.force[i] = terms_[n].force;
    result.relieved[n] = terms_[n].held;
  }
  for (std::size_t i = 0; i < load.resistance_count; ++i) {
    result.resistance_n[i] = terms_[first_resistance + i].force;
  }
  return result;
}

void CarriedArm::settle_wheels(double h, const Velocities& found) {
  for (std::size_t i = 0; i < tyres_.size(); ++i) {
    const Footing& foot = footings_[i];
    loads_n_[i] = foot.touching ? terms_[foot.normal].force : 0.0;
    TyreResult result;
    if (foot.touching) {
      const Term& along = terms_[foot.along];
      const Term& across = terms_[foot.across];
      result = {.longitudinal_n = along.force,
                .lateral_n = across.force,
                .rolling_nm = 0.0,
                .longitudinal_slide_mps = along.row.dot(found),
                .lateral_slide_mps = across.row.dot(found),
                .wheel_rate_radps = 0.0,
                .slipping = foot.sliding,
                .rolling_limited = false};
    }
    tyres_[i].settle(h, tyre_laws_[i], result);
  }
}

void CarriedArm::settle_plates(double h, const Velocities& found, std::span<CarrierDrive> drives) {
  for (std::size_t i = 0; i < plates_.size(); ++i) {
    Plate& plate = plates_[i];
    const Footing& foot = footings_[tyres_.size() + i];
    plate_loads_n_[i] = foot.touching ? terms_[foot.normal].force : 0.0;
    if (foot.touching) {
      plate.plate.settle(h, plate.laws, speed(terms_[foot.along], found),
                         speed(terms_[foot.across], found), plate_loads_n_[i]);
    }
  }
  for (std::size_t track = 0; track < kTracks && stations_ > 0; ++track) {
    Track& of = tracks_[track];
    if (!of.resisted) {
      continue;
    }
    const Term& term = terms_[of.term];
    const double way_mps = term.row.dot(found);
    if (term.held) {
      of.bristle.slide_within(of.pushing, h, 0.0, way_mps, of.resistance_n);
    } else {
      of.bristle.slide(of.pushing, h, 0.0, way_mps);
    }
    // The trailing end leaves the rut.
    const std::size_t each = stations_ / kTracks;
    const Plate& trailing = plates_[track * each + (drives[track].rate_mps() < 0.0 ? each - 1 : 0)];
    if (std::abs(way_mps) > kLeavesRut_mps && trailing.laws.touching &&
        trailing.soils.pressed_m < of.rut_m) {
      ground_->press(trailing.contact, X_WC_.linear().col(0), parameters_.tracks.shoe_width_m,
                     of.rut_m);
    }
  }
  for (std::size_t k = 0; k < drives.size(); ++k) {
    drives[k].settle(h, eliminated_[k].rate);
  }
}

// Mass matrix, bias and motion of the arm with its undercarriage (carried_arm.h).

CarriedArm::Placement CarriedArm::place_links(const JointVector& q_rad) const {
  const ArmAngles at(q_rad);
  Placement result;
  const Eigen::Matrix3d R_CU = Eigen::AngleAxisd(q_rad[0], Eigen::Vector3d::UnitZ()).matrix();
  result.R_CB[0].setIdentity();
  result.origin_C[0].setZero();
  result.R_CB[1] = R_CU;
  result.origin_C[1] = {0.0, 0.0, parameters_.swing_axis_height_m};
  const std::array<Eigen::Vector3d, 3> way{parameters_.boom_foot_m,
                                           Eigen::Vector3d(parameters_.boom_length_m, 0.0, 0.0),
                                           Eigen::Vector3d(parameters_.stick_length_m, 0.0, 0.0)};
  for (std::size_t i = 0; i < 3; ++i) {
    const Turn& turn = at.link[i];
    Eigen::Matrix3d raised;
    raised << turn.cosine, 0.0, -turn.sine, 0.0, 1.0, 0.0, turn.sine, 0.0, turn.cosine;
    result.origin_C[i + 2] = result.origin_C[i + 1] + result.R_CB[i + 1] * way[i];
    result.R_CB[i + 2].noalias() = R_CU * raised;
  }
  const Eigen::Vector3d raise = -R_CU.col(1);
  for (std::size_t i = 0; i < 4; ++i) {
    result.axis[i] = turning(i == 0 ? Eigen::Vector3d::UnitZ() : raise, result.origin_C[i + 1]);
  }
  return result;
}

CarriedArm::SpatialMatrix CarriedArm::inertia_of(const ArmDynamics::Moments& moments,
                                                 const Eigen::Matrix3d& R,
                                                 const Eigen::Vector3d& origin) const {
  const Eigen::Vector3d turned = R * moments.first_kgm;
  // First and second moments shifted to C's origin; rotational inertia = tr(S) 1 - S.
  const Eigen::Vector3d first = turned + moments.mass_kg * origin;
  const Eigen::Matrix3d second = R * moments.second_kgm2 * R.transpose() +
                                 origin * turned.transpose() + turned * origin.transpose() +
                                 moments.mass_kg * origin * origin.transpose();
  SpatialMatrix inertia;
  inertia.topLeftCorner<3, 3>() = second.trace() * Eigen::Matrix3d::Identity() - second;
  inertia.topRightCorner<3, 3>() = cross_matrix(first);
  inertia.bottomLeftCorner<3, 3>() = -cross_matrix(first);
  inertia.bottomRightCorner<3, 3>() = moments.mass_kg * Eigen::Matrix3d::Identity();
  return inertia;
}

void CarriedArm::equations(const DrivenArm& arm, Placement& at, const JointVector& q_rad,
                           Matrix& mass_matrix, Velocities& bias) const {
  at = place_links(q_rad);
  at.inertia[0] = inertia_of(undercarriage_, at.R_CB[0], at.origin_C[0]);
  for (std::size_t i = 0; i < 4; ++i) {
    at.inertia[i + 1] = inertia_of(arm.dynamics().moments()[i], at.R_CB[i + 1], at.origin_C[i + 1]);
  }
  // Outward, with gravity as an upward acceleration of the undercarriage.
  std::array<SpatialVector, 5> force;
  SpatialVector v = velocity_.head<6>();
  SpatialVector a = SpatialVector::Zero();
  a.tail<3>() = X_WC_.linear().row(2).transpose() * parameters_.gravity_mps2;
  for (std::size_t i = 0; i < 5; ++i) {
    if (i > 0) {
      const SpatialVector rate = at.axis[i - 1] * velocity_[static_cast<Eigen::Index>(i + 5)];
      v += rate;
      a += cross_motion(v, rate);
    }
    // Recursive Newton-Euler: f = I a + v x* (I v), a without joint accelerations.
    const SpatialVector momentum = at.inertia[i] * v;
    force[i] = at.inertia[i] * a + cross_force(v, momentum);
  }
  // Inward.
  SpatialVector f = SpatialVector::Zero();
  SpatialMatrix composite = SpatialMatrix::Zero();
  for (std::size_t i = 5; i-- > 0;) {
    // Composite rigid bodies: forces and inertias of all links outside the joint add up.
    f += force[i];
    composite += at.inertia[i];
    if (i == 0) {
      bias.head<6>() = f;
      mass_matrix.topLeftCorner<6, 6>() = composite;
      break;
    }
    const auto row = static_cast<Eigen::Index>(i + 5);
    bias[row] = at.axis[i - 1].dot(f);
    // Column of M: S_j^T (I_composite S_i); with the undercarriage I_composite S_i itself.
    const SpatialVector column = composite * at.axis[i - 1];
    mass_matrix.block<6, 1>(0, row) = column;
    mass_matrix.block<1, 6>(row, 0) = column.transpose();
    for (std::size_t j = 1; j <= i; ++j) {
      const auto other = static_cast<Eigen::Index>(j + 5);
      mass_matrix(row, other) = mass_matrix(other, row) = at.axis[j - 1].dot(column);
    }
  }
}

CarriedArm::Velocities CarriedArm::point_row(const Placement& at, const Eigen::Vector3d& point_C,
                                             const Eigen::Vector3d& direction_C,
                                             std::size_t link) const {
  SpatialVector along;
  // Row of a unit force at a point: its wrench against undercarriage and joint axes.
  along << point_C.cross(direction_C), direction_C;
  Velocities row = Velocities::Zero();
  row.head<6>() = along;
  for (std::size_t i = 0; i < link; ++i) {
    row[static_cast<Eigen::Index>(i + 6)] = at.axis[i].dot(along);
  }
  return row;
}

void CarriedArm::place_contact_links(const ArmState& state, std::span<ContactLink> links) const {
  const Placement at = place_links(state.q_rad);
  const Eigen::Matrix3d R_WC = X_WC_.linear();
  SpatialVector v = velocity_.head<6>();
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (i > 0) {
      v += at.axis[i - 1] * state.v_radps[static_cast<Eigen::Index>(i) - 1];
    }
    const Eigen::Vector3d w = v.head<3>();
    ContactLink& link = links[i];
    link.X_WL.linear() = R_WC * at.R_CB[i];
    link.X_WL.translation() = X_WC_ * at.origin_C[i];
    link.v_WL_W = R_WC * (v.tail<3>() + w.cross(at.origin_C[i]));
    link.w_WL_W = R_WC * w;
  }
}

std::array<LinkMotion, 5> CarriedArm::motion(const ArmState& state) const {
  const Placement at = place_links(state.q_rad);
  const Eigen::Matrix3d R_WC = X_WC_.linear();
  std::array<LinkMotion, 5> links;
  SpatialVector v = velocity_.head<6>();
  SpatialVector a = acceleration_.head<6>();
  for (std::size_t i = 0; i < 5; ++i) {
    if (i > 0) {
      const auto joint = static_cast<Eigen::Index>(i + 5);
      const SpatialVector rate = at.axis[i - 1] * velocity_[joint];
      v += rate;
      a += at.axis[i - 1] * acceleration_[joint] + cross_motion(v, rate);
    }
    const Eigen::Vector3d w = v.head<3>();
    const Eigen::Vector3d alpha = a.head<3>();
    const Eigen::Vector3d& p = at.origin_C[i];
    // Spatial to ordinary acceleration of the link's origin: a_O + alpha x p + w x v.
    const Eigen::Vector3d speed = v.tail<3>() + w.cross(p);
    LinkMotion& link = links[i];
    link.X_WL.linear() = R_WC * at.R_CB[i];
    link.X_WL.translation() = X_WC_ * p;
    link.v_WL_W = R_WC * speed;
    link.w_WL_W = R_WC * w;
    link.a_WL_W = R_WC * (a.tail<3>() + alpha.cross(p) + w.cross(speed));
    link.alpha_WL_W = R_WC * alpha;
  }
  return links;
}

CarriedArm::Momentum CarriedArm::momentum(const DrivenArm& arm, const ArmState& state) const {
  Placement at = place_links(state.q_rad);
  SpatialVector v = velocity_.head<6>();
  SpatialVector sum = SpatialVector::Zero();
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  double mass = 0.0;
  for (std::size_t i = 0; i < 5; ++i) {
    const ArmDynamics::Moments& moments = i == 0 ? undercarriage_ : arm.dynamics().moments()[i - 1];
    if (i > 0) {
      v += at.axis[i - 1] * state.v_radps[static_cast<Eigen::Index>(i) - 1];
    }
    sum += inertia_of(moments, at.R_CB[i], at.origin_C[i]) * v;
    first += at.R_CB[i] * moments.first_kgm + moments.mass_kg * at.origin_C[i];
    mass += moments.mass_kg;
  }
  // Angular momentum from C's origin to the common centre of mass: L - c x p.
  const Eigen::Vector3d linear = sum.tail<3>();
  const Eigen::Vector3d angular = sum.head<3>() - (first / mass).cross(linear);
  return {X_WC_.linear() * linear, X_WC_.linear() * angular};
}

}  // namespace rigwire::sim

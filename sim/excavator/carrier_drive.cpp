#include "sim/excavator/carrier_drive.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

namespace {

constexpr double kUnbounded = 1e300;
// Level quasi_static: gain relative to that which stops the mass in a step.
constexpr double kRigid = 1e3;
constexpr double kReturn_s = 0.1;  // Level quasi_static: same as the arm's (excavator.cpp).
constexpr double kBrakes_mps = 0.05;
constexpr double kWind_m = 1e-3;  // Deflection of the holding bristle under its maximum force.
constexpr double kCushionFloor = 0.1;
constexpr double kTrackStopReach_m = 0.005;
enum Part : std::size_t { kDrive, kHolding, kStop };

}  // namespace

CarrierDrive::CarrierDrive(const ExcavatorParameters& p, const SpoolParameters& spool,
                           const ActuatorSize& size, double mass_kg, double carried_kg)
    : level_(p.level),
      supply_(p.supply),
      cushion_(p.drives.cushion),
      stop_npm_(p.drives.end_stop_stiffness_npm),
      spool_(spool),
      size_(size),
      cylinder_(size.x_max > size.x_min),
      mass_kg_(mass_kg) {
  const double middle = 0.5 * (size.x_min + size.x_max);
  // The oil's columns at mid stroke; d = 2 ratio sqrt(k m).
  stiffness_npm_ = ActuatorChambers(p.chambers, size, 0.0).stiffness(middle);
  damping_nspm_ = 2.0 * p.drives.damping_ratio * std::sqrt(stiffness_npm_ * carried_kg);
  stop_nspm_ = 2.0 * std::sqrt(stop_npm_ * mass_kg);
  rigid_nspm_ = kRigid / p.step_s * carried_kg;
  limits_ = force_limits(size.bottom_area, size.rod_side_area, p.supply.relief_pressure_pa,
                         p.supply.tank_pressure_pa);
  chambers_ = ActuatorChambers(
      p.chambers, size, 2.0 * p.chambers.damping_ratio * std::sqrt(stiffness_npm_ * carried_kg));
}

CarrierDrive::CarrierDrive(const ExcavatorParameters& p, const TrackParameters& track,
                           double carried_kg)
    : CarrierDrive(p, track.spool, {track.area_m2(), track.area_m2(), 0.0, 0.0},
                   track.moving_mass_kg, carried_kg) {
  brake_n_ = track.brake_nm / track.sprocket_radius_m;
  resistance_ = track.resistance;
  const double most = std::max(1.0, brake_n_ + resistance_ * carried_kg * p.gravity_mps2);
  holding_.stiffness = most / kWind_m;
  holding_.damping = 2.0 * std::sqrt(holding_.stiffness * mass_kg_);
  chambers_.set_pressures({p.supply.tank_pressure_pa, p.supply.tank_pressure_pa});
  ports_ = chambers_.pressures();
}

CarrierDrive::CarrierDrive(const ExcavatorParameters& p, const SupportParameters& support,
                           double carried_kg)
    : CarrierDrive(p, support.spool,
                   {support.lowering_area_m2(), support.raising_area_m2(), 0.0, support.travel_m},
                   support.mass_kg, carried_kg) {
  weight_n_ = support.mass_kg * p.gravity_mps2;
  holding_ = {1.0, 0.0, 0.0};
  // Held up by its rod side.
  ports_ =
      port_pressures(-weight_n_, size_.bottom_area, size_.rod_side_area, p.supply.tank_pressure_pa);
  chambers_.set_pressures(ports_);
  forces_[kDrive].force_n = -weight_n_;
  target_m_ = level_ == ExcavatorLevel::dynamic ? -weight_n_ / stiffness_npm_ : 0.0;
}

bool CarrierDrive::command(double opening, bool floating) {
  floating_ = floating;
  return spool_.command(floating ? 0.0 : opening);
}

bool CarrierDrive::at_end(double direction) const {
  return cylinder_ &&
         (direction > 0.0 ? target_m_ >= size_.x_max : direction < 0.0 && target_m_ <= size_.x_min);
}

double CarrierDrive::flow_request_m3ps() const {
  const double flow = asked_m3ps();
  if (!cylinder_ || flow == 0.0) {
    return flow;
  }
  const double stroke = size_.x_max - size_.x_min;
  const double left = flow > 0.0 ? size_.x_max - target_m_ : target_m_ - size_.x_min;
  if (left <= 0.0 && level_ != ExcavatorLevel::chambers) {
    return 0.0;
  }
  // Cushion, as the arm's.
  const double cushion_m = cushion_ * stroke;
  return left >= cushion_m ? flow : flow * std::max(kCushionFloor, left / cushion_m);
}

void CarrierDrive::begin(double h, double supply_pressure_pa, double ground_n) {
  // Continuity: rate = Q / A of the side that fills, the target held at the stroke's ends.
  wanted_mps_ =
      floating_ ? 0.0 : flow_m3ps_ / (flow_m3ps_ > 0.0 ? size_.bottom_area : size_.rod_side_area);
  if (cylinder_ && wanted_mps_ != 0.0) {
    wanted_mps_ = wanted_mps_ > 0.0 ? std::clamp((size_.x_max - target_m_) / h, 0.0, wanted_mps_)
                                    : std::clamp((size_.x_min - target_m_) / h, wanted_mps_, 0.0);
  }
  DriveForce& drive = forces_[kDrive];
  drive = {{}, limits_.least, limits_.greatest, false, 0.0, 0};
  switch (level_) {
    case ExcavatorLevel::kinematic:
      break;
    case ExcavatorLevel::quasi_static: {
      // F = gain (wanted - x').
      const double gain = floating_ ? damping_nspm_ : rigid_nspm_;
      const double aim =
          floating_ ? 0.0 : wanted_mps_ + (target_m_ - x_m_) / std::max(kReturn_s, h);
      drive.law = {gain * aim, gain};
      break;
    }
    case ExcavatorLevel::dynamic: {
      // Eq. 5, F = k (x_t(t + h) - x - h x') + d (v_t - x').
      const double k = floating_ ? 0.0 : stiffness_npm_;
      drive.law = {k * (target_m_ + h * wanted_mps_ - x_m_) + damping_nspm_ * wanted_mps_,
                   k * h + damping_nspm_};
      break;
    }
    case ExcavatorLevel::chambers: {
      const ValveDemand demand{flow_m3ps_, floating_, supply_pressure_pa, supply_.tank_pressure_pa,
                               supply_.relief_pressure_pa};
      drive.law = chambers_.law(h, x_m_, demand);
      const auto [least, greatest] = chambers_.limits(demand, rate_mps_);
      drive.least = least;
      drive.greatest = greatest;
      break;
    }
  }

  // Spring-applied brake, released by the section's oil.
  const bool asks = asked_m3ps() != 0.0;
  braked_ = !asks && (braked_ || std::abs(rate_mps_) < kBrakes_mps);
  holding_n_limit_ = (braked_ ? brake_n_ : 0.0) + resistance_ * ground_n;
  forces_[kHolding] = {
      held_.force(holding_, h, 0.0), -holding_n_limit_, holding_n_limit_, false, 0.0, 0};
  if (cylinder_) {
    forces_[kHolding].law = {};
  }

  DriveForce& stop = forces_[kStop];
  stop = {};
  const double ahead = x_m_ + h * rate_mps_;
  const bool low = cylinder_ && ahead < size_.x_min + kTrackStopReach_m;
  if (low || (cylinder_ && ahead > size_.x_max - kTrackStopReach_m)) {
    // One-sided: k (end - x - h x') - c x', begun where the end would be passed within the step.
    const double end = low ? size_.x_min : size_.x_max;
    stop = {{stop_npm_ * (end - x_m_), stop_npm_ * h + stop_nspm_},
            low ? 0.0 : -kUnbounded,
            low ? kUnbounded : 0.0,
            false,
            0.0,
            0};
  }
}

void CarrierDrive::settle(double h, double rate_mps) {
  const DriveForce& drive = forces_[kDrive];
  rate_mps_ = rate_mps;
  x_m_ += h * rate_mps;
  if (!cylinder_) {
    if (forces_[kHolding].held) {
      held_.slide_within(holding_, h, 0.0, rate_mps, holding_n_limit_);
    } else {
      held_.slide(holding_, h, 0.0, rate_mps);
    }
  }
  switch (level_) {
    case ExcavatorLevel::kinematic:
      break;
    case ExcavatorLevel::quasi_static:
      target_m_ = floating_ || drive.held ? x_m_ : target_m_ + h * wanted_mps_;
      break;
    case ExcavatorLevel::dynamic:
      target_m_ += h * wanted_mps_;
      if (floating_) {
        target_m_ = x_m_;
      } else if (drive.held) {
        // Behind an open relief valve the target goes where the force is held: no wind-up.
        target_m_ =
            x_m_ + (drive.force_n - damping_nspm_ * (wanted_mps_ - rate_mps)) / stiffness_npm_;
      }
      break;
    case ExcavatorLevel::chambers:
      chambers_.settle(rate_mps);
      flow_m3ps_ = chambers_.inlet_flow_m3ps();
      target_m_ = x_m_;
      break;
  }
}

void CarrierDrive::update_ports() {
  const double tank = supply_.tank_pressure_pa;
  if (level_ == ExcavatorLevel::chambers) {
    ports_ = chambers_.pressures();
    return;
  }
  ports_ = floating_ ? PortPressures{tank, tank}
                     : port_pressures(forces_[kDrive].force_n, size_.bottom_area,
                                      size_.rod_side_area, tank);
  const double asked = asked_m3ps();
  if (at_end(asked)) {
    (asked > 0.0 ? ports_.a_pa : ports_.b_pa) = supply_.relief_pressure_pa;
  }
}

bool CarrierDrive::finite() const {
  return std::isfinite(x_m_) && std::isfinite(rate_mps_) && std::isfinite(target_m_);
}

}  // namespace rigwire::sim

#include "sim/roller/ground_rest.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim/ground/obstacle_shapes.h"

namespace rigwire::sim {

namespace {

// A rigid body about an edge at `arm_m`, from level: m g a / (I + m (a^2 + h^2)).
double falling_radps2(const RollerParameters& p, double arm_m, double inertia_kgm2) {
  const double height = p.center_of_mass_height_m;
  return p.mass_kg * p.gravity_mps2 * arm_m /
         (inertia_kgm2 + p.mass_kg * (arm_m * arm_m + height * height));
}

RestMotion falling(const RollerParameters& p) {
  return {p.gravity_mps2, falling_radps2(p, 0.5 * p.drum.width_m, p.roll_inertia_kgm2),
          falling_radps2(p, p.pivot_x_m, p.pitch_inertia_kgm2)};
}

// Angles at which a disc is scanned, to either side of its lowest point. It does not roll over
// anything steeper.
constexpr int kDiscSteps = 6;
constexpr double kDiscStep_rad = 0.21;

// Limits the growth of a rate in the direction of `way` to `most`; leaves other changes as they
// are.
double held(double rate, double before, double most, double way) {
  if (way > 0.0) {
    return std::min(rate, std::max(before, 0.0) + most);
  }
  return way < 0.0 ? std::max(rate, std::min(before, 0.0) - most) : rate;
}

}  // namespace

GroundRest::GroundRest(const RollerParameters& parameters, const Ground& ground)
    : ground_(&ground),
      radius_m_(parameters.drum.radius_m),
      pivot_x_m_(parameters.pivot_x_m),
      width_m_(parameters.drum.width_m),
      frequency_radps_(2.0 * std::numbers::pi * parameters.rest_frequency_hz),
      damping_ratio_(parameters.rest_damping_ratio),
      fall_(falling(parameters)),
      drum_strips_(static_cast<std::size_t>(parameters.drum.strips)),
      count_(2 * drum_strips_) {
  near_.reserve(1024);
  place_strips({0.0, 0.0});
}

double GroundRest::friction(std::size_t drum) const {
  double sum = 0.0;
  double bearing = 0.0;
  for (std::size_t i = drum * drum_strips_; i < (drum + 1) * drum_strips_; ++i) {
    sum += strips_[i].bears() ? strips_[i].point.friction : 0.0;
    bearing += strips_[i].bears() ? 1.0 : 0.0;
  }
  return sum / std::max(1.0, bearing);
}

void GroundRest::climb(std::size_t drum, const Eigen::Vector3d& p_W, const Eigen::Matrix3d& R_WB,
                       StripGround& strip) const {
  // Tested from further below, so that a drum that is still above the obstacle finds its height,
  // too.
  constexpr double kBelow_m = 0.1;
  constexpr int kHalvings = 40;
  const Eigen::Vector3d up_W = R_WB.col(2);
  const double steer_rad = steer_rad_[drum];
  const Eigen::Vector3d axle_W =
      std::cos(steer_rad) * R_WB.col(1) - std::sin(steer_rad) * R_WB.col(0);
  const Eigen::Vector3d low_W = p_W + (radius_m_ - kBelow_m) * up_W;
  for (const std::uint32_t index : near_) {
    const Obstacle& obstacle = ground_->obstacles()[index];
    if (!climbs(climbs_[drum], *ground_, index, low_W + kBelow_m * up_W, up_W) ||
        !disc_overlap(obstacle, low_W, axle_W, radius_m_)) {
      continue;
    }
    // The minimum lift that frees the disc, by bisection.
    double least = 0.0;
    double greatest = kBelow_m + 2.0 * radius_m_;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (least + greatest);
      const bool free = !disc_overlap(obstacle, low_W + middle * up_W, axle_W, radius_m_);
      (free ? greatest : least) = middle;
    }
    const double gap_m = greatest - kBelow_m;
    if (gap_m <= strip.gap_m) {
      continue;
    }
    const auto touch = disc_overlap(obstacle, low_W + (least - 1e-6) * up_W, axle_W, radius_m_);
    strip.gap_m = gap_m;
    strip.point.obstacle = true;
    strip.point.friction = obstacle.friction;
    if (touch) {
      const Eigen::Vector3d& n = touch->normal_W;
      const double scale = 1.0 / std::max(0.1, n.dot(up_W));
      strip.point.normal_W = n;
      strip.slope = {-scale * n.dot(R_WB.col(0)), -scale * n.dot(R_WB.col(1))};
    }
  }
}

// A disc on the terrain in its plane of rolling: at an angle from its lowest point it is free when
// it is lifted by (height - z) / up_z there.
struct GroundRest::Disc {
  const Ground* ground;
  Eigen::Vector3d low_W;
  Eigen::Vector3d up_W;
  Eigen::Vector3d ahead_W;
  double radius_m;

  struct Place {
    double angle_rad = 0.0;
    double lift_m = -std::numeric_limits<double>::infinity();
    GroundPoint point;
  };

  [[nodiscard]] Place at(double angle_rad) const {
    const Eigen::Vector3d p_W =
        low_W + radius_m * (std::sin(angle_rad) * ahead_W + (1.0 - std::cos(angle_rad)) * up_W);
    const GroundPoint point = ground->terrain_at(p_W.x(), p_W.y());
    return {angle_rad, (point.height_m - p_W.z()) / std::max(0.1, up_W.z()), point};
  }
  /// A few places all along, from behind to ahead.
  [[nodiscard]] std::array<Place, 2 * kDiscSteps + 1> around() const {
    std::array<Place, 2 * kDiscSteps + 1> places;
    for (std::size_t i = 0; i < places.size(); ++i) {
      places[i] = at(kDiscStep_rad * (static_cast<double>(i) - kDiscSteps));
    }
    return places;
  }
  /// Where it has to be lifted most between two angles, by golden section.
  [[nodiscard]] Place most(double low_rad, double high_rad) const {
    constexpr double kGolden = std::numbers::phi - 1.0;
    constexpr int kRounds = 20;
    Place left = at(high_rad - kGolden * (high_rad - low_rad));
    Place right = at(low_rad + kGolden * (high_rad - low_rad));
    for (int i = 0; i < kRounds; ++i) {
      if (left.lift_m > right.lift_m) {
        high_rad = right.angle_rad;
        right = left;
        left = at(high_rad - kGolden * (high_rad - low_rad));
      } else {
        low_rad = left.angle_rad;
        left = right;
        right = at(low_rad + kGolden * (high_rad - low_rad));
      }
    }
    return left.lift_m > right.lift_m ? left : right;
  }
};

// Whether a disc is brought over what it touches at an angle round from its lowest line.
bool GroundRest::rises(double angle_rad, const Disc& disc, const RollingClimb& climb,
                       const GroundPoint& point) {
  const double up = std::cos(angle_rad);
  return climb.radius_m <= 0.0 || up > RollingClimb::kSlope ||
         disc.radius_m * (1.0 - up) <= climb.height_m(point.friction);
}

void GroundRest::roll_over(const Disc& disc, const RollingClimb& climb, const Eigen::Matrix3d& R_WB,
                           double steer_rad, StripGround& strip) {
  const auto around = disc.around();
  Disc::Place touch;
  for (std::size_t i = 1; i + 1 < around.size(); ++i) {
    // From an edge to the next place it may fall by all the way between.
    if (around[i].lift_m > around[i - 1].lift_m && around[i].lift_m >= around[i + 1].lift_m &&
        around[i].lift_m > strip.gap_m - kDiscStep_rad * disc.radius_m) {
      const Disc::Place found = disc.most(around[i - 1].angle_rad, around[i + 1].angle_rad);
      if (found.lift_m > touch.lift_m && rises(found.angle_rad, disc, climb, found.point)) {
        touch = found;
      }
    }
  }
  if (touch.lift_m <= strip.gap_m) {
    return;
  }
  strip.gap_m = touch.lift_m;
  strip.point = touch.point;
  // Along its way the disc's own slope there, across it the terrain's.
  const double c = std::cos(steer_rad);
  const double s = std::sin(steer_rad);
  const Eigen::Vector3d axle_W = c * R_WB.col(1) - s * R_WB.col(0);
  const Eigen::Vector3d& n = strip.point.normal_W;
  const double across = -n.dot(axle_W) / std::max(0.1, n.dot(disc.up_W));
  strip.slope = std::tan(touch.angle_rad) * Eigen::Vector2d(c, s) + across * Eigen::Vector2d(-s, c);
}

// Edges come within reach as the drum moves on; until it has, what was seen holds.
bool GroundRest::rough(std::size_t drum, const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB) {
  constexpr double kLookAfter_m = 0.1;
  constexpr double kAhead_m = 0.25;
  constexpr double kApart_m = 0.1;
  constexpr double kExcess_m = 1e-4;
  Seen& seen = seen_[drum];
  const double heading = steer_rad_[drum];
  Disc disc{ground_, Eigen::Vector3d::Zero(), R_WB.col(2),
            std::cos(heading) * R_WB.col(0) + std::sin(heading) * R_WB.col(1), radius_m_};
  const auto low_W = [&](std::size_t i) {
    const Eigen::Vector2d& p_B = strips_[drum * drum_strips_ + i].p_B_m;
    return Eigen::Vector3d(p_WB + p_B.x() * R_WB.col(0) + p_B.y() * R_WB.col(1));
  };
  const std::array<Eigen::Vector3d, 2> ends_W{low_W(0), low_W(drum_strips_ - 1)};
  const double moved_m =
      std::max((ends_W[0] - seen.ends_W[0]).norm(), (ends_W[1] - seen.ends_W[1]).norm());
  if (moved_m < kLookAfter_m) {
    return seen.rough;
  }
  seen = {ends_W, false};
  for (std::size_t i = 0; i < drum_strips_ && !seen.rough; ++i) {
    for (double shift_m = -kAhead_m; shift_m <= kAhead_m; shift_m += kApart_m) {
      disc.low_W = low_W(i) + shift_m * disc.ahead_W;
      const auto around = disc.around();
      const auto most = std::ranges::max_element(around, {}, &Disc::Place::lift_m);
      seen.rough = seen.rough || most->lift_m > around[kDiscSteps].lift_m + kExcess_m;
    }
  }
  return seen.rough;
}

// Only the steering changes the places of the strips.
void GroundRest::place_strips(const std::array<double, 2>& steer_rad) {
  steer_rad_ = steer_rad;
  even_ = false;
  const double share = 1.0 / static_cast<double>(drum_strips_);
  for (std::size_t drum = 0; drum < 2; ++drum) {
    const double x = drum == 0 ? pivot_x_m_ : -pivot_x_m_;
    const double c = std::cos(steer_rad[drum]);
    const double s = std::sin(steer_rad[drum]);
    for (std::size_t i = 0; i < drum_strips_; ++i) {
      const double y = ((static_cast<double>(i) + 0.5) * share - 0.5) * width_m_;
      StripGround& strip = strips_[drum * drum_strips_ + i];
      strip.p_B_m = {x - y * s, y * c};
    }
  }
}

void GroundRest::find_bearing(bool put_down) {
  constexpr double kAir_m = 0.15;
  constexpr double kTouch_m = 0.05;
  constexpr double kFace = 2.0;  // Slope of a bank's face, that falls away and carries nothing.
  stands_ = true;
  bool even = true;
  for (std::size_t drum = 0; drum < 2; ++drum) {
    bool any = false;
    for (std::size_t i = drum * drum_strips_; i < (drum + 1) * drum_strips_; ++i) {
      StripGround& strip = strips_[i];
      const bool face = !strip.point.obstacle && strip.slope.norm() > kFace && strip.gap_m < 0.0;
      const double share = (strip.gap_m + kAir_m) / (kAir_m - kTouch_m);
      strip.weight = put_down ? 1.0 : face ? 0.0 : std::clamp(share, 0.0, 1.0);
      any = any || strip.bears();
      even = even && strip.weight == 1.0;
    }
    stands_ = stands_ && any;
  }
  if (!stands_) {
    // Without support by both drums the plane is fitted to all strips (a kinematic machine never
    // tips).
    std::for_each_n(strips_.begin(), count_, [](StripGround& strip) { strip.weight = 1.0; });
    even = true;
  }
  bears_all_ = true;
  hangs_m_.setZero();
  if (even && even_) {
    return;
  }
  even_ = even;
  // Normal equations of gap = heave + y roll - x pitch.
  Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < count_; ++i) {
    const StripGround& strip = strips_[i];
    const Eigen::Vector3d row(1.0, strip.p_B_m.y(), -strip.p_B_m.x());
    sums += strip.weight * row * row.transpose();
    hangs_m_ += (1.0 - strip.weight) * strip.p_B_m;
    bears_all_ = bears_all_ && strip.bears();
  }
  // One strip per drum leaves roll undetermined: hold it.
  sums(1, 1) += 1e-9;
  inverse_ = sums.inverse();
}

std::array<std::size_t, 2> GroundRest::bearing(std::size_t drum) const {
  std::array<std::size_t, 2> found{drum_strips_, 0};
  for (std::size_t i = 0; i < drum_strips_; ++i) {
    if (strips_[drum * drum_strips_ + i].bears()) {
      found = {std::min(found[0], i), i + 1};
    }
  }
  return found;
}

void GroundRest::look(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB,
                      const std::array<double, 2>& steer_rad, bool put_down) {
  if (steer_rad != steer_rad_) {
    place_strips(steer_rad);
  }
  near_.clear();
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(pivot_x_m_ + radius_m_ + 0.5 * width_m_);
  ground_->obstacles_near(p_WB.head<2>() - reach, p_WB.head<2>() + reach, near_);
  // The terrain alone; obstacles after it.
  constexpr double ceiling_m = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count_; ++i) {
    StripGround& strip = strips_[i];
    const double x = strip.p_B_m.x();
    const double y = strip.p_B_m.y();
    const Eigen::Vector3d p_W = p_WB + x * R_WB.col(0) + y * R_WB.col(1);
    strip.point = ground_->at(p_W.x(), p_W.y(), ceiling_m);
    const Eigen::Vector3d& n = strip.point.normal_W;
    // Gap along the frame's z to the surface's tangent plane, and that plane's slopes in the frame.
    const double scale = 1.0 / std::max(0.1, n.dot(R_WB.col(2)));
    strip.gap_m = (strip.point.height_m - p_W.z()) * n.z() * scale;
    strip.slope = {-scale * n.dot(R_WB.col(0)), -scale * n.dot(R_WB.col(1))};
    const std::size_t drum = i / drum_strips_;
    if (rough(drum, p_WB, R_WB)) {
      const double heading = steer_rad[drum];
      roll_over({ground_, p_W, R_WB.col(2),
                 std::cos(heading) * R_WB.col(0) + std::sin(heading) * R_WB.col(1), radius_m_},
                climbs_[drum], R_WB, heading, strip);
    }
    climb(drum, p_W, R_WB, strip);
  }
  find_bearing(put_down);
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count_; ++i) {
    const StripGround& strip = strips_[i];
    if (strip.bears()) {
      right += strip.weight * strip.gap_m * Eigen::Vector3d(1.0, strip.p_B_m.y(), -strip.p_B_m.x());
    }
  }
  deviation_ = fit(right);
}

RestMotion GroundRest::fit(const Eigen::Vector3d& right) const {
  const Eigen::Vector3d found = inverse_ * right;
  return {found[0], found[1], found[2]};
}

RestMotion GroundRest::rates(double h, const Eigen::Vector3d& planar,
                             const RestMotion& before) const {
  // The ground's rate along the frame's z where a strip moves over it.
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count_; ++i) {
    const StripGround& strip = strips_[i];
    if (!strip.bears()) {
      continue;
    }
    const double x = strip.p_B_m.x();
    const double y = strip.p_B_m.y();
    const double climbing = strip.slope.x() * (planar[0] - planar[2] * y) +
                            strip.slope.y() * (planar[1] + planar[2] * x);
    right += strip.weight * Eigen::Vector3d(climbing, climbing * y, -climbing * x);
  }
  const RestMotion ground = fit(right);
  // y'' = w^2 (gap) + 2 zeta w (y_g' - y') by backward Euler, the ground's own rate fed forward.
  const double stiff = h * frequency_radps_ * frequency_radps_;
  const double follow = stiff * h + 2.0 * damping_ratio_ * frequency_radps_ * h;
  const double scale = 1.0 / (1.0 + follow);
  const auto solve = [&](double rate, double away, double forward) {
    return (rate + stiff * away + follow * forward) * scale;
  };
  RestMotion found{solve(before.heave, deviation_.heave, ground.heave),
                   solve(before.roll, deviation_.roll, ground.roll),
                   solve(before.pitch, deviation_.pitch, ground.pitch)};
  if (!even_) {
    // Down is less heave, roll towards the hanging side, and pitch, nose down positive.
    found.heave = held(found.heave, before.heave, h * fall_.heave, -1.0);
    found.roll = held(found.roll, before.roll, h * fall_.roll, -hangs_m_.y());
    found.pitch = held(found.pitch, before.pitch, h * fall_.pitch, hangs_m_.x());
  }
  return found;
}

}  // namespace rigwire::sim

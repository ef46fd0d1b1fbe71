#include "sim/contact/loose_bodies.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fields/check.h"
#include "fields/rules.h"

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kLongestStep_s = 1e-3;
constexpr double kCalm_mps = 5e-3;
constexpr double kCalm_s = 0.5;
constexpr double kWaking_mps = 0.02;  // A body faster than this wakes what it hits.
constexpr double kDampingRatio = 0.3;
constexpr int kMostPasses = 40;
constexpr double kMoved_m = 0.01;
// Number of intervals between terrain contact points along a crate's longest edge.
constexpr double kPointsAlong = 6.0;

std::vector<ContactBody> contact_bodies(std::span<const LooseBody> bodies) {
  std::vector<ContactBody> made;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    ContactBody& body = made.emplace_back(ContactBody{
        bodies[i].name, i, Eigen::Isometry3d::Identity(), bodies[i].shape, bodies[i].stiffness_npm,
        2.0 * kDampingRatio * std::sqrt(bodies[i].stiffness_npm * bodies[i].mass_kg)});
    body.meets_terrain = true;
    body.friction = bodies[i].friction;
    body.spacing_m = bodies[i].shape.half_lengths_m().maxCoeff() / kPointsAlong * 2.0;
  }
  return made;
}

std::vector<LooseBody> validated(std::vector<LooseBody> bodies) {
  for (const LooseBody& body : bodies) {
    const auto require = [&body](const std::string& what, double found, double least, double most) {
      // Not a number is in no range.
      fields::require(found >= least && found <= most, "loose body '" + body.name + "': " + what,
                      fields::plain().print(found),
                      fields::plain().print(least) + " .. " + fields::plain().print(most));
    };
    require("mass, kg", body.mass_kg, 0.01, 1e8);
    for (Eigen::Index i = 0; i < 3; ++i) {
      // Between a dot's and that of all its mass 100 m away.
      require("inertia, kg m2", body.inertia_kgm2[i], 1e-9 * body.mass_kg, 1e4 * body.mass_kg);
    }
    require("friction", body.friction, 0.0, 10.0);
    require("rolling_resistance", body.rolling_resistance, 0.0, 1.0);
    require("stiffness, N/m", body.stiffness_npm, 1.0, 1e12);
    require("position, m", body.X_WB.translation().cwiseAbs().maxCoeff(), 0.0, 1e8);
    // Its columns are axes.
    require("axes", (body.X_WB.linear().transpose() * body.X_WB.linear()).trace(), 3.0 - 1e-6,
            3.0 + 1e-6);
  }
  return bodies;
}

}  // namespace

LooseBodies::LooseBodies(std::vector<LooseBody> bodies, const Ground& ground)
    : bodies_(validated(std::move(bodies))),
      movers_(bodies_.size()),
      states_(bodies_.size()),
      links_(bodies_.size()),
      contact_(contact_bodies(bodies_), bodies_.size(), ground, this),
      from_(bodies_.size()),
      found_(bodies_.size()) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Mover& mover = movers_[i];
    mover.shape = &bodies_[i].shape;
    mover.X_WM = bodies_[i].X_WB;
    mover.inverse_mass_1pkg = 1.0 / bodies_[i].mass_kg;
    mover.friction = bodies_[i].friction;
    mover.stiffness_npm = bodies_[i].stiffness_npm;
    start_m_.push_back(bodies_[i].X_WB.translation());
    place(i);
    be_free(i);
  }
  members_.reserve(bodies_.size());
  awake_ = bodies_.size();
}

void LooseBodies::place(std::size_t body) {
  Mover& mover = movers_[body];
  const Eigen::Matrix3d R = mover.X_WM.linear();
  mover.inverse_inertia_W =
      R * bodies_[body].inertia_kgm2.cwiseInverse().asDiagonal() * R.transpose();
  links_[body] = {mover.X_WM, mover.v_W, mover.w_W, mover.rests};
}

/// Nothing holds it.
void LooseBodies::be_free(std::size_t body) {
  Mover& mover = movers_[body];
  mover.mobility.setZero();
  mover.mobility.topLeftCorner<3, 3>().diagonal().setConstant(mover.inverse_mass_1pkg);
  mover.mobility.bottomRightCorner<3, 3>() = mover.inverse_inertia_W;
}

void LooseBodies::wake(std::size_t body) {
  states_[body].calm_s = 0.0;
  if (movers_[body].rests) {
    movers_[body].rests = false;
    links_[body].rests = false;
    ++awake_;
  }
}

void LooseBodies::push(std::size_t mover, const Vector& p_W, const Vector& impulse_W) {
  if (impulse_W.isZero()) {
    return;
  }
  wake(mover);
  states_[mover].impulse_W += impulse_W;
  states_[mover].turn_W += (p_W - movers_[mover].X_WM.translation()).cross(impulse_W);
}

void LooseBodies::ground_changed(const Eigen::Vector2d& lower_m, const Eigen::Vector2d& upper_m) {
  contact_.look_anew();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Eigen::Array2d middle = movers_[i].X_WM.translation().head<2>();
    const double reach = bodies_[i].shape.reach_m();
    if (movers_[i].rests && (middle + reach >= lower_m.array()).all() &&
        (middle - reach <= upper_m.array()).all()) {
      wake(i);
    }
  }
}

void LooseBodies::settle(double longest_s) {
  constexpr double kStep_s = 2e-3;
  for (double t = 0.0; t < longest_s && awake_ > 0; t += kStep_s) {
    (void)advance(kStep_s);
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    start_m_[i] = movers_[i].X_WM.translation();
  }
}

LinkMotion LooseBodies::motion(std::size_t body) const {
  LinkMotion motion;
  motion.X_WL = movers_[body].X_WM;
  motion.v_WL_W = movers_[body].v_W;
  motion.w_WL_W = movers_[body].w_W;
  return motion;
}

bool LooseBodies::moved(std::size_t body) const {
  return (movers_[body].X_WM.translation() - start_m_[body]).norm() > kMoved_m;
}

double LooseBodies::energy_j() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Mover& mover = movers_[i];
    const Vector w_B = mover.X_WM.linear().transpose() * mover.w_W;
    sum += 0.5 * bodies_[i].mass_kg * mover.v_W.squaredNorm() +
           0.5 * w_B.dot(bodies_[i].inertia_kgm2.cwiseProduct(w_B)) +
           bodies_[i].mass_kg * gravity_mps2 * mover.X_WM.translation().z();
  }
  return sum;
}

std::uint32_t LooseBodies::island_of(std::uint32_t body) const {
  while (states_[body].island != body) {
    body = states_[body].island;
  }
  return body;
}

/// Bodies that share a point are of one island; what rests is as fixed as the terrain.
void LooseBodies::join_islands() {
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    states_[i].island = i;
    states_[i].touches = !states_[i].impulse_W.isZero();  // A machine, or what follows.
  }
  for (const ContactPoint& point : contact_.points()) {
    states_[point.link].touches = true;
    if (!point.mover) {
      continue;
    }
    states_[*point.mover].touches = true;
    if (movers_[*point.mover].rests || movers_[point.link].rests) {
      continue;
    }
    const std::uint32_t a = island_of(static_cast<std::uint32_t>(point.link));
    const std::uint32_t b = island_of(*point.mover);
    states_[std::max(a, b)].island = std::min(a, b);
  }
}

/// Speeds along the point's directions, of the body against what it touches, as found.
std::array<double, 3> LooseBodies::along(const ContactPoint& point) const {
  std::array<double, 3> speed{};
  const auto add = [&](std::size_t body, double sign) {
    const Eigen::Map<const Eigen::Matrix<double, 6, 1>> u(found_[body].data());
    const Vector arm = point.p_W - movers_[body].X_WM.translation();
    const Vector v = u.head<3>() + Vector(u.tail<3>()).cross(arm);
    for (std::size_t k = 0; k < 3; ++k) {
      speed[k] += sign * point.direction_W[k].dot(v);
    }
  };
  add(point.link, 1.0);
  if (point.mover) {
    add(*point.mover, -1.0);
  }
  return speed;
}

/// Cholesky's factor of the lower half, in place.
bool LooseBodies::factorise(std::size_t size) {
  for (std::size_t j = 0; j < size; ++j) {
    double* const row_j = matrix_.data() + j * size;
    for (std::size_t i = j; i < size; ++i) {
      double* const row_i = matrix_.data() + i * size;
      double sum = row_i[j];
      for (std::size_t k = 0; k < j; ++k) {
        sum -= row_i[k] * row_j[k];
      }
      if (i == j) {
        if (!(sum > 0.0)) {
          return false;
        }
        row_j[j] = std::sqrt(sum);
      } else {
        row_i[j] = sum / row_j[j];
      }
    }
  }
  return true;
}

void LooseBodies::substitute(std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      right_[i] -= matrix_[i * size + k] * right_[k];
    }
    right_[i] /= matrix_[i * size + i];
  }
  for (std::size_t i = size; i-- > 0;) {
    for (std::size_t k = i + 1; k < size; ++k) {
      right_[i] -= matrix_[k * size + i] * right_[k];
    }
    right_[i] /= matrix_[i * size + i];
  }
}

/// Either side of the point is of the island and awake.
bool LooseBodies::is_of(const ContactPoint& point, std::uint32_t island) const {
  return !movers_[point.link].rests
             ? island_of(static_cast<std::uint32_t>(point.link)) == island
             : point.mover && !movers_[*point.mover].rests && island_of(*point.mover) == island;
}

/// The island's system: masses and the gains of its points, impulses on the right.
void LooseBodies::assemble(double h, std::uint32_t island, std::size_t size) {
  const auto acting = [](const ContactPoint& point, std::size_t k) { return point.acting(k); };
  assemble(h, island, size, acting);
}

/// Linearly implicit step: (M + h sum of J^T gain J) v = impulses, with gyroscopic torque, gravity
/// and the contact forces at the step's initial velocities on the right.
template <typename Law>
void LooseBodies::assemble(double h, std::uint32_t island, std::size_t size, Law&& law_of) {
  std::fill_n(matrix_.begin(), size * size, 0.0);
  std::fill_n(right_.begin(), size, 0.0);
  for (const std::uint32_t i : members_) {
    const std::size_t at = states_[i].place;
    const Eigen::Matrix3d R = movers_[i].X_WM.linear();
    const Eigen::Matrix3d I = R * bodies_[i].inertia_kgm2.asDiagonal() * R.transpose();
    const Vector& w = movers_[i].w_W;
    const Vector force =
        states_[i].impulse_W + Vector(0.0, 0.0, -h * bodies_[i].mass_kg * gravity_mps2);
    const Vector turn = states_[i].turn_W - h * w.cross(I * w);
    for (std::size_t k = 0; k < 3; ++k) {
      matrix_[(at + k) * size + at + k] = bodies_[i].mass_kg;
      for (std::size_t m = 0; m < 3; ++m) {
        matrix_[(at + 3 + k) * size + at + 3 + m] =
            I(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(m));
      }
      right_[at + k] = force[static_cast<Eigen::Index>(k)];
      right_[at + 3 + k] = turn[static_cast<Eigen::Index>(k)];
    }
  }
  for (const ContactPoint& point : contact_.points()) {
    if (!is_of(point, island) || point.released) {
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const ImplicitForce law = law_of(point, k);
      std::array<std::pair<std::size_t, std::array<double, 6>>, 2> rows;
      std::size_t count = 0;
      const auto row = [&](std::size_t body, double sign) {
        if (movers_[body].rests) {
          return;
        }
        auto& [place, J] = rows[count++];
        place = states_[body].place;
        const Vector d = sign * point.direction_W[k];
        const Vector m = (point.p_W - movers_[body].X_WM.translation()).cross(d);
        J = {d.x(), d.y(), d.z(), m.x(), m.y(), m.z()};
      };
      row(point.link, 1.0);
      if (point.mover) {
        row(*point.mover, -1.0);
      }
      const double push = h * law.at(point.start_mps[k]);
      for (std::size_t a = 0; a < count; ++a) {
        const auto& [at_a, J_a] = rows[a];
        for (std::size_t i = 0; i < 6; ++i) {
          right_[at_a + i] += push * J_a[i];
          for (std::size_t b = 0; b < count; ++b) {
            const auto& [at_b, J_b] = rows[b];
            for (std::size_t j = 0; j < 6; ++j) {
              matrix_[(at_a + i) * size + at_b + j] += h * law.gain * J_a[i] * J_b[j];
            }
          }
        }
      }
    }
  }
}

void LooseBodies::solve(double h, std::uint32_t island) {
  members_.clear();
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    if (!movers_[i].rests && island_of(i) == island) {
      states_[i].place = static_cast<std::uint32_t>(6 * members_.size());
      members_.push_back(i);
    }
  }
  const std::size_t size = 6 * members_.size();
  if (matrix_.size() < size * size) {
    matrix_.resize(size * size);
    right_.resize(size);
  }
  for (int pass = 0; pass < kMostPasses; ++pass) {
    assemble(h, island, size);
    if (!factorise(size)) {
      return;  // Not a number: what was found in the pass before holds.
    }
    substitute(size);
    for (const std::uint32_t i : members_) {
      for (std::size_t k = 0; k < 6; ++k) {
        found_[i][k] = from_[i][k] + right_[states_[i].place + k];
      }
    }
    bool changed = false;
    for (ContactPoint& point : contact_.points()) {
      if (is_of(point, island)) {
        changed = point.changes(along(point)) || changed;
      }
    }
    if (!changed) {
      break;
    }
  }
  find_mobilities(h, island, size);
}

/// Finds the mobility of each body of the island that machines push: blocks of the inverse of the
/// island's system over a step of the machine, with k H + c in place of k h + c. Yielding soil
/// counts as a spring: it yields only under its full bearing force.
void LooseBodies::find_mobilities(double h, std::uint32_t island, std::size_t size) {
  const auto pushed = [this](std::uint32_t i) { return !states_[i].impulse_W.isZero(); };
  if (std::ranges::none_of(members_, pushed)) {
    return;
  }
  const auto over_span = [this, h](const ContactPoint& point, std::size_t k) {
    ImplicitForce law = k == 0 ? point.force[0] : point.acting(k);
    const double stiffness_npm = k == 0 ? point.law.stiffness_npm : point.law.bristle_npm;
    law.gain += law.gain > 0.0 ? (span_s_ - h) * stiffness_npm : 0.0;
    return law;
  };
  assemble(span_s_, island, size, over_span);
  if (!factorise(size)) {
    return;
  }
  for (const std::uint32_t i : members_) {
    const std::size_t at = states_[i].place;
    for (std::size_t k = 0; k < 6 && pushed(i); ++k) {
      std::fill_n(right_.begin(), size, 0.0);
      right_[at + k] = 1.0;
      substitute(size);
      movers_[i].mobility.col(static_cast<Eigen::Index>(k)) =
          Eigen::Map<const Eigen::Matrix<double, 6, 1>>(right_.data() + at);
    }
  }
}

double LooseBodies::advance(double h) {
  const int steps = std::max(1, static_cast<int>(std::ceil(h / kLongestStep_s - 1e-9)));
  double fastest = 0.0;
  span_s_ = h;
  // What machines push acts over all of h.
  for (State& state : states_) {
    state.impulse_W /= steps;
    state.turn_W /= steps;
  }
  for (int i = 0; i < steps && awake_ > 0; ++i) {
    fastest = std::max(fastest, step(h / steps));
  }
  for (State& state : states_) {
    state.impulse_W.setZero();
    state.turn_W.setZero();
  }
  return fastest;
}

double LooseBodies::step(double h) {
  double fastest = 0.0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Mover& mover = movers_[i];
    for (Eigen::Index k = 0; k < 3; ++k) {
      from_[i][static_cast<std::size_t>(k)] = mover.v_W[k];
      from_[i][static_cast<std::size_t>(k) + 3] = mover.w_W[k];
    }
    found_[i] = from_[i];
    be_free(i);
    links_[i] = {mover.X_WM, mover.v_W, mover.w_W, mover.rests};
    if (!mover.rests) {
      fastest = std::max(fastest, mover.v_W.norm() + bodies_[i].shape.reach_m() * mover.w_W.norm() +
                                      h * gravity_mps2);
    }
  }
  const bool near = contact_.near(h, fastest);
  if (near) {
    contact_.begin(h, links_);
  } else {
    contact_.clear_points();
  }
  // What moves wakes what it hits.
  for (const ContactPoint& point : contact_.points()) {
    if (!point.mover) {
      continue;
    }
    const auto speed = [&](std::size_t body) { return movers_[body].velocity_W(point.p_W).norm(); };
    const std::size_t a = point.link;
    const std::size_t b = *point.mover;
    if (movers_[a].rests != movers_[b].rests && point.gap_m < 0.0 &&
        speed(movers_[a].rests ? b : a) > kWaking_mps) {
      wake(movers_[a].rests ? a : b);
    }
  }
  join_islands();
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    if (!movers_[i].rests && island_of(i) == i) {
      solve(h, i);
    }
  }
  if (near) {
    contact_.settle(h, [this](const ContactPoint& point) { return along(point); });
  }
  fastest = 0.0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Mover& mover = movers_[i];
    State& state = states_[i];
    if (mover.rests) {
      continue;
    }
    const Eigen::Map<const Eigen::Matrix<double, 6, 1>> u(found_[i].data());
    mover.v_W = u.head<3>();
    mover.w_W = u.tail<3>();
    mover.X_WM.translation() += h * mover.v_W;
    double rate = mover.w_W.norm();
    if (state.touches && rate > 0.0) {
      // Rolling resistance is dry friction: it can only stop the rotation, not reverse it.
      const Vector w_B = mover.X_WM.linear().transpose() * mover.w_W;
      const double inertia = w_B.dot(bodies_[i].inertia_kgm2.cwiseProduct(w_B)) / (rate * rate);
      const double torque = bodies_[i].rolling_resistance * bodies_[i].mass_kg * gravity_mps2 *
                            bodies_[i].shape.reach_m();
      mover.w_W *= std::max(0.0, 1.0 - h * torque / (inertia * rate));
      rate = mover.w_W.norm();
    }
    mover.way_m += h * (mover.v_W.norm() + bodies_[i].shape.reach_m() * rate);
    if (rate > 0.0) {
      const Eigen::Quaterniond turned(Eigen::AngleAxisd(h * rate, mover.w_W / rate) *
                                      Eigen::Quaterniond(mover.X_WM.linear()));
      mover.X_WM.linear() = turned.normalized().toRotationMatrix();
    }
    const double speed = mover.v_W.norm() + bodies_[i].shape.reach_m() * rate;
    state.calm_s = state.touches && speed < kCalm_mps ? state.calm_s + h : 0.0;
    if (state.calm_s > kCalm_s) {
      mover.rests = true;
      mover.v_W.setZero();
      mover.w_W.setZero();
      --awake_;
    }
    place(i);
    fastest = std::max(fastest, speed);
  }
  return fastest;
}

}  // namespace rigwire::sim

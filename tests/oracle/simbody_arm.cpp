#include "simbody_arm.h"

#include <Simbody.h>

namespace rigwire::oracle {
namespace {

using SimTK::Vec3;

SimTK::Body::Rigid rigid(const SimbodyLink& p) {
  const Vec3 center(p.center_m.x(), p.center_m.y(), p.center_m.z());
  const Eigen::Vector3d& i = p.inertia_kgm2;
  const SimTK::Inertia about_center(i.x(), i.y(), i.z());
  return SimTK::Body::Rigid(SimTK::MassProperties(
      p.mass_kg, center, about_center.shiftFromMassCenter(center, p.mass_kg)));
}

// A pin joint turns about its frame's z; turned by 90 degrees about x that is -y.
SimTK::Transform raising(const Vec3& origin) {
  return {SimTK::Rotation(0.5 * SimTK::Pi, SimTK::XAxis), origin};
}

Vec3 pin(const Eigen::Vector2d& at, const Vec3& origin = Vec3(0)) {
  return origin + Vec3(at.x(), 0, at.y());
}

}  // namespace

struct SimbodyArm::System {
  class Drives final : public SimTK::Force::Custom::Implementation {
   public:
    Drives(System& system, const SimbodyModel& p) : s_(system), p_(p) {}
    void calcForce(const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& body_forces,
                   SimTK::Vector_<Vec3>&, SimTK::Vector& mobility_forces) const override {
      if (!s_.drives_now.targets) {
        return;
      }
      Eigen::Vector4d target;
      Eigen::Vector4d rate;
      s_.drives_now.targets(state.getTime(), target, rate);
      const auto eq5 = [&](int i, double x, double x_rate) {
        return s_.drives_now.stiffness[i] * (target[i] - x) +
               s_.drives_now.damping[i] * (rate[i] - x_rate);
      };
      const Vec3 foot(p_.boom_foot_m.x(), p_.boom_foot_m.y(), p_.boom_foot_m.z());
      s_.upper.applyOneMobilityForce(
          state, 0, eq5(0, s_.upper.getAngle(state), s_.upper.getRate(state)), mobility_forces);
      const auto cylinder = [&](int i, const SimTK::MobilizedBody& a, const Vec3& pin_a,
                                const SimTK::MobilizedBody& b, const Vec3& pin_b) {
        const Vec3 way = b.findStationLocationInGround(state, pin_b) -
                         a.findStationLocationInGround(state, pin_a);
        const Vec3 speed = b.findStationVelocityInGround(state, pin_b) -
                           a.findStationVelocityInGround(state, pin_a);
        const double length = way.norm();
        const Vec3 force = eq5(i, length, ~speed * way / length) * way / length;
        b.applyForceToBodyPoint(state, pin_b, force, body_forces);
        a.applyForceToBodyPoint(state, pin_a, -force, body_forces);
      };
      cylinder(1, s_.upper, pin(p_.boom_base_m, foot), s_.boom, pin(p_.boom_rod_m));
      cylinder(2, s_.boom, pin(p_.stick_base_m), s_.stick, pin(p_.stick_rod_m));
      const auto [length, lever] = p_.bucket_linkage(s_.bucket.getAngle(state));
      const double force = eq5(3, length, lever * s_.bucket.getRate(state));
      s_.bucket.applyOneMobilityForce(state, 0, lever * force, mobility_forces);
    }
    SimTK::Real calcPotentialEnergy(const SimTK::State&) const override { return 0; }

   private:
    System& s_;
    SimbodyModel p_;
  };

  explicit System(const SimbodyModel& p)
      : matter(system),
        forces(system),
        gravity(forces, matter, -SimTK::ZAxis, p.gravity_mps2),
        upper(matter.Ground(), Vec3(0, 0, p.swing_axis_height_m), rigid(p.links[0]), Vec3(0)),
        boom(upper, raising({p.boom_foot_m.x(), p.boom_foot_m.y(), p.boom_foot_m.z()}),
             rigid(p.links[1]), raising(Vec3(0))),
        stick(boom, raising({p.boom_length_m, 0, 0}), rigid(p.links[2]), raising(Vec3(0))),
        bucket(stick, raising({p.stick_length_m, 0, 0}), rigid(p.links[3]), raising(Vec3(0))),
        drives(forces, new Drives(*this, p)) {
    start = system.realizeTopology();
  }

  [[nodiscard]] SimTK::State at(const Eigen::Vector4d& q) {
    SimTK::State state = start;
    upper.setAngle(state, q[0]);
    boom.setAngle(state, q[1]);
    stick.setAngle(state, q[2]);
    bucket.setAngle(state, q[3]);
    return state;
  }

  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  SimTK::Force::Gravity gravity;
  SimTK::MobilizedBody::Pin upper;
  SimTK::MobilizedBody::Pin boom;
  SimTK::MobilizedBody::Pin stick;
  SimTK::MobilizedBody::Pin bucket;
  SimTK::Force::Custom drives;
  SimTK::State start;
  SimbodyDrives drives_now;
};

SimbodyArm::SimbodyArm(const SimbodyModel& model) : system_(std::make_unique<System>(model)) {}
SimbodyArm::~SimbodyArm() = default;

Eigen::Matrix4d SimbodyArm::mass_matrix(const Eigen::Vector4d& q_rad) const {
  const SimTK::State state = system_->at(q_rad);
  system_->system.realize(state, SimTK::Stage::Position);
  SimTK::Matrix m;
  system_->matter.calcM(state, m);
  Eigen::Matrix4d result;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      result(i, j) = m(i, j);
    }
  }
  return result;
}

Eigen::Vector4d SimbodyArm::gravity_load(const Eigen::Vector4d& q_rad) const {
  const SimTK::State state = system_->at(q_rad);
  system_->drives_now = {};
  system_->system.realize(state, SimTK::Stage::Dynamics);
  SimTK::Vector load;
  system_->matter.calcResidualForceIgnoringConstraints(
      state, SimTK::Vector(), system_->system.getRigidBodyForces(state, SimTK::Stage::Dynamics),
      SimTK::Vector(), load);
  return {load[0], load[1], load[2], load[3]};
}

Eigen::Vector4d SimbodyArm::run(const Eigen::Vector4d& q_rad, double span_s, double accuracy,
                                const SimbodyDrives& drives) {
  system_->drives_now = drives;
  SimTK::RungeKuttaMersonIntegrator integrator(system_->system);
  integrator.setAccuracy(accuracy);
  SimTK::TimeStepper stepper(system_->system, integrator);
  stepper.initialize(system_->at(q_rad));
  stepper.stepTo(span_s);
  const SimTK::State& state = integrator.getState();
  return {system_->upper.getAngle(state), system_->boom.getAngle(state),
          system_->stick.getAngle(state), system_->bucket.getAngle(state)};
}

}  // namespace rigwire::oracle

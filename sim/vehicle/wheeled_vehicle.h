// A vehicle of two axles as its sensors and its controller see it, at any level of modelling:
// commands in, motion of every link and its own sensors' readings out.
//
// Links, in this order: body (frame B of parameters.h), front and rear axle (origin in the beam's
// centre; with independent wheels midway between the wheels' centres, axes as the body), four
// wheels (origin in the wheel's centre, y along its axle, turning with it).
//
// Steering, tyre pressures and commands are the same at every level; a level computes motion, loads
// and wheel rates.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "sim/contact/contact_set.h"
#include "sim/driveline/driveline.h"
#include "sim/ground/ground.h"
#include "sim/machine.h"
#include "sim/vehicle/parameters.h"
#include "sim/vehicle/travel_control.h"

namespace rigwire::sim {

/// The angle follows its set point by angle' = (set point - angle) / time_constant, |angle'| at
/// most the rate. step() is the exact solution, so that dividing a step changes nothing beyond
/// rounding.
class SteeringActuator {
 public:
  explicit SteeringActuator(const SteeringParameters& parameters);

  /// Clamped to the maximum angle; NaN keeps the old set point.
  void command(double angle_rad);
  void step(double span_s);
  [[nodiscard]] double angle_rad() const { return angle_rad_; }

 private:
  SteeringParameters parameters_;
  double set_point_rad_ = 0.0;
  double angle_rad_ = 0.0;
};

/// Returns the angles of the left and the right wheel of an axle so that all wheels turn about one
/// centre: tan(wheel) = tan(angle) / (1 -+ curvature track / 2). `curvature_1pm`: of the path of
/// the point on the vehicle's long axis nearest to the turning centre, (tan front - tan rear) over
/// wheelbase, left positive.
[[nodiscard]] std::array<double, 2> ackermann_rad(double angle_rad, double track_m,
                                                  double curvature_1pm);

/// State of one wheel; for tests, status and truth.
struct WheelState {
  double rate_radps = 0.0;      ///< Rate against its axle.
  double load_n = 0.0;          ///< Normal force of the ground, never negative.
  double longitudinal_n = 0.0;  ///< On the tyre, forward.
  double lateral_n = 0.0;       ///< On the tyre, left.
  double brake_nm = 0.0;        ///< On the wheel, forward.
  double rolling_nm = 0.0;      ///< Rolling resistance on the wheel, forward.
  double ploughing_n = 0.0;     ///< Force of soft soil on the wheel's centre, forward.
  /// Moment of the lateral force about the wheel's centre, left positive.
  double aligning_nm = 0.0;
  double slide_mps = 0.0;  ///< Speed of the contact patch over the ground, magnitude.
  double friction = 0.0;   ///< Friction coefficient of the ground below.
  double sinkage_m = 0.0;
  double rolling_radius_m = 0.0;  ///< Way per radian without slip.
  bool touching = false;
  bool slipping = false;  ///< Held at the limit of friction.
};

/// Where a vehicle is put: on the ground at that place, x of B that way.
struct VehiclePlace {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;  ///< From world x (east), left positive.
};

class WheeledVehicle : public Machine, public VehiclePort, public PowerUnitDefectPort {
 public:
  void step(Duration span) final;
  [[nodiscard]] SimTime time() const final { return time_; }
  [[nodiscard]] std::span<const LinkMotion> links() const final { return links_; }
  [[nodiscard]] std::span<const std::string_view> link_names() const final { return kWheeledLinks; }
  [[nodiscard]] const std::optional<NonFinite>& non_finite() const final { return non_finite_; }
  [[nodiscard]] std::span<const StatusQuantity> status_quantities() const final;
  void read_status(std::span<double> values) const final;
  [[nodiscard]] std::span<const TruthField> truth_fields() const final;
  void read_truth(std::span<double> values) const final;
  [[nodiscard]] VehiclePort* vehicle_port() final { return this; }
  [[nodiscard]] const ContactReport* contact_report() const final { return &contact_.report(); }
  [[nodiscard]] std::span<const LeaningObstacle> leaning_obstacles() const final {
    return contact_.leaning();
  }
  [[nodiscard]] const ContactSet& contact() const { return contact_; }
  /// The corners of the body that run into things (ChassisContactParameters).
  [[nodiscard]] std::vector<BodyPoint> body_points() const final;
  /// The wheels, in their order: dust of a road by load and speed, or by slip where that is faster.
  [[nodiscard]] std::span<const DustEmitter> dust_emitters() const final { return dust_; }

  void command(const VehicleCommand& command) final;
  /// Exact readings; what a real sensor makes of them is sim/vehicle_sensors' matter. Radii are
  /// the rolling ones of the design position, as a controller has them; odometry is that of B's
  /// origin.
  [[nodiscard]] VehicleSample vehicle_sample(SimTime time) const final;
  void fail(const PowerUnitDefects& defects) final { driveline_->fail(defects); }
  [[nodiscard]] EngineData engine_data() const final { return driveline_->engine_data(); }
  [[nodiscard]] bool steers_rear() const final {
    return parameters_.rear.steering.angle_max_rad > 0.0;
  }

  /// Along the body's x, all wheels rolling; for tests and for rigs that begin on the move.
  virtual void start_rolling(double speed_mps) = 0;

  [[nodiscard]] const std::array<WheelState, kWheels>& wheels() const { return wheels_; }
  /// Coordinates of sim/vehicle/suspension.h: front 0, 1, rear 2, 3. Zeros at the levels that have
  /// none.
  [[nodiscard]] const std::array<double, 4>& suspension() const { return suspension_; }
  [[nodiscard]] double tyre_pressure_pa(std::size_t wheel) const { return pressure_pa_[wheel]; }
  [[nodiscard]] const WheeledVehicleParameters& parameters() const { return parameters_; }

 protected:
  WheeledVehicle(const WheeledVehicleParameters& parameters, const Ground& ground,
                 std::unique_ptr<Driveline> driveline);

  /// Makes one inner step. If a result is not finite, keeps the previous state and calls
  /// record_non_finite().
  virtual void inner_step(double h) = 0;
  /// Computes the links from the state.
  virtual void update_links() = 0;

  void record_non_finite(const char* quantity, const char* part);
  [[nodiscard]] const VehicleAxleParameters& axle(std::size_t i) const {
    return i == 0 ? parameters_.front : parameters_.rear;
  }
  /// Returns the steering angles of one axle's wheels, left and right.
  [[nodiscard]] const std::array<double, 2>& steer_rad(std::size_t axle) const {
    return steer_rad_[axle];
  }
  /// Returns the torque that the brakes of that wheel can hold now.
  [[nodiscard]] double brake_limit_nm(std::size_t wheel) const;
  void update_steering();

  WheeledVehicleParameters parameters_;
  const Ground* ground_;
  std::unique_ptr<Driveline> driveline_;
  StaticLoads static_;
  ContactSet contact_;
  double reach_m_;  ///< Upper bound of the distance of the vehicle's points from B's origin.
  VehicleCommand command_;  ///< Command as received.
  VehicleCommand drive_;    ///< Command after the travel control.
  std::array<WheelState, kWheels> wheels_;
  std::array<double, 4> suspension_{};
  std::array<LinkMotion, kWheeledLinks.size()> links_;
  std::array<SteeringActuator, 2> steering_;

 private:
  void step_actuators(double h);
  void step_travel(double h);
  void step_implements(double h);
  void update_dust();

  TravelControl travel_;
  double brake_share_ = 0.0;  ///< Share of the service brake's torque that is built up.
  std::array<double, kImplementEnds> hitch_share_{};  ///< 0 down .. 1 up.
  /// Share of the shaft's full speed at the engine's speed.
  std::array<double, kImplementEnds> shaft_share_{};
  double road_dust_kgpm_;
  std::array<DustEmitter, kWheels> dust_;
  Duration inner_span_;
  SimTime time_{};
  std::optional<NonFinite> non_finite_;
  std::array<std::array<double, 2>, 2> steer_rad_{};
  std::array<double, kWheels> pressure_pa_{};
  std::array<double, kWheels> pressure_target_pa_{};
};

/// Pose of B with the rear axle's middle over the place and the wheels' undersides on the ground,
/// by the heights under the four wheels: x along the middles of the axles' ground points, y
/// levelled across by the mean of front and rear. Throws std::invalid_argument when the place is
/// not finite.
[[nodiscard]] Eigen::Isometry3d place_on_ground(const Ground& ground,
                                                const WheeledVehicleParameters& parameters,
                                                const VehiclePlace& place);

/// The vehicle of that level, standing on the ground, brakes on, engine idle. `ground` must outlive
/// it. Throws std::invalid_argument as validate() does, and when the place is not finite or the
/// drive line is missing.
[[nodiscard]] std::unique_ptr<WheeledVehicle> make_wheeled_vehicle(
    const WheeledVehicleParameters& parameters, const Ground& ground,
    std::unique_ptr<Driveline> driveline, const VehiclePlace& place);

}  // namespace rigwire::sim

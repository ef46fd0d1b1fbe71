// The arm on an undercarriage that is a free rigid body standing on four tyres with their brakes
// locked, or on two tracks: ten degrees of freedom, solved together, so that the machine rocks,
// slides and tips while it works, and travels.
//
// Velocities: the undercarriage's six in its own frame C (angular, then linear of C's origin), then
// the joints'. Mass matrix by composite rigid bodies, bias by recursive Newton-Euler, both with
// spatial vectors about C's origin (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 5,
// 6 and 9). One step is linearly implicit Euler: drives, end stops, tyres and the bucket's
// resistances are forces F = offset - gain u with limits, all on the left-hand side; those beyond
// their limits are held there and the step is solved again (clamp last). Positions move with the
// new velocities, the attitude by the exponential map. Order 1; momentum in free flight is kept to
// the step's order.
//
// The tyres are those of sim/tyre, friction on hard ground and on soil theirs; wheels do not turn.
//
// A track is a rigid frame that feels the ground at stations along its length, each a piece of
// plate (ground_plate.h) under a disc of its end wheels' radius, so that it climbs what they climb
// (Ground::wheel_contact). Its end stations bear half of an inner one's share: turning on the spot
// a track of even pressure is resisted by mu W L / 4, and it tips about its ends. Soft soil resists
// with Bekker's work of pressing the rut, less what was pressed before, at the leading end. The
// pads of blade and outriggers are plates, too.
//
// What drives move (carrier_drive.h), belts and pads, has one more velocity e each, which only its
// own forces see: a force F on the ground feels J v - a e. e is eliminated: with loose forces
// F = o - g (J v - a e), m (e' - e) / h = D(e') - sum a F gives e' = (c + b v') / d with
// d = m / h + sum g_D + sum a^2 g and b = sum a g J, and the ten equations gain h b b^T / d on the
// left (negative) and b (c + b v) / d on the right. They stay positive definite.
//
// Never allocates in a step.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sim/contact/contact_set.h"
#include "sim/excavator/carrier_drive.h"
#include "sim/excavator/driven_arm.h"
#include "sim/excavator/ground_plate.h"
#include "sim/excavator/own_contact.h"
#include "sim/ground/ground.h"
#include "sim/link_motion.h"
#include "sim/tyre/tyre.h"

namespace rigwire::sim {

inline constexpr std::size_t kCarrierWheels = 4;
inline constexpr std::size_t kTracks = 2;

class CarriedArm {
 public:
  using Velocities = Eigen::Matrix<double, 10, 1>;
  using SpatialVector = Eigen::Matrix<double, 6, 1>;

  /// Places the machine at X_WC, with the tyres not yet deflected. `ground` must outlive it.
  CarriedArm(const ExcavatorParameters& parameters, const Ground& ground,
             const Eigen::Isometry3d& X_WC);

  /// One step of h > 0 seconds from `state`, which is moved, with laws that belong to `at`, its
  /// pose. The arm gives masses, stops and gains; its own gravity and load are not used.
  /// `contacts`: points on the links, whose forces are found and settled here; null: none.
  /// `own`: the same of links against each other.
  /// `drives`: those of the tracks, left and right, then one per support; they have begun their
  /// step and are settled here.
  ArmStep step(double h, const DrivenArm& arm, const ArmPose& at, const DriveLaws& laws,
               const BucketLoad& load, ArmState& state, ContactSet* contacts = nullptr,
               std::span<CarrierDrive> drives = {}, OwnContact* own = nullptr);

  /// Writes the current poses and velocities of the links, for the contact.
  void place_contact_links(const ArmState& state, std::span<ContactLink> links) const;

  /// Returns the motion of undercarriage and links at the last step's end.
  [[nodiscard]] std::array<LinkMotion, 5> motion(const ArmState& state) const;

  [[nodiscard]] const Eigen::Isometry3d& X_WC() const { return X_WC_; }
  /// Sets the pose of the machine, at rest and with straight bristles.
  void place(const Eigen::Isometry3d& X_WC);
  /// Velocity of the undercarriage in its own frame.
  [[nodiscard]] Eigen::Vector3d w_C() const { return velocity_.head<3>(); }
  [[nodiscard]] Eigen::Vector3d v_C() const { return velocity_.segment<3>(3); }
  void set_velocity(const Eigen::Vector3d& w_C, const Eigen::Vector3d& v_C);
  [[nodiscard]] bool finite() const { return X_WC_.matrix().allFinite() && velocity_.allFinite(); }
  /// Normal forces in the last step: front left, front right, rear left, rear right.
  [[nodiscard]] const std::array<double, kCarrierWheels>& wheel_loads_n() const { return loads_n_; }
  /// Normal forces in the last step: of the tracks' stations, left from the rear on, then right; of
  /// the supports' pads, left and right of each. Empty without tracks or supports.
  [[nodiscard]] std::span<const double> station_loads_n() const {
    return std::span(plate_loads_n_).first(stations_);
  }
  [[nodiscard]] std::span<const double> pad_loads_n() const {
    return std::span(plate_loads_n_).subspan(stations_);
  }
  /// Normal force on the whole track.
  [[nodiscard]] double track_load_n(std::size_t track) const;
  /// Limit of the soil's resistance to pressing the track's rut, N.
  [[nodiscard]] double ploughing_n(std::size_t track) const { return tracks_[track].resistance_n; }

  /// Momentum in the world, kg m/s, and angular momentum about the common centre of mass, kg m2/s.
  struct Momentum {
    Eigen::Vector3d linear_W;
    Eigen::Vector3d angular_W;
  };
  [[nodiscard]] Momentum momentum(const DrivenArm& arm, const ArmState& state) const;

 private:
  using Matrix = Eigen::Matrix<double, 10, 10>;
  using SpatialMatrix = Eigen::Matrix<double, 6, 6>;

  /// Links at joint angles, in C.
  struct Placement {
    std::array<Eigen::Matrix3d, 5> R_CB;
    std::array<Eigen::Vector3d, 5> origin_C;
    std::array<SpatialVector, 4> axis;
    std::array<SpatialMatrix, 5> inertia;
  };
  static constexpr std::size_t kNoDrive = ~std::size_t{0};
  /// A force along one row of velocities, less `share` times the rate of what a drive moves.
  struct Term {
    Velocities row;
    ImplicitForce law;
    double least = 0.0;
    double greatest = 0.0;
    bool held = false;
    double force = 0.0;
    int switches = 0;
    std::size_t drive = kNoDrive;
    double share = 0.0;
  };
  /// A touching wheel's or plate's terms.
  struct Footing {
    std::size_t normal = 0, along = 0, across = 0;
    bool touching = false;
    bool sliding = false;
    ShearLimit shear;
  };
  /// A piece of a track, or a pad.
  struct Plate {
    GroundPlate plate;
    Eigen::Vector3d at_C = Eigen::Vector3d::Zero();  ///< Middle of its disc; of a pad, raised.
    std::size_t drive = 0;
    double behind_front_m = 0.0;  ///< Distance from the leading end of a track that goes forward.
    double behind_rear_m = 0.0;   ///< Distance from the leading end of a track that goes backward.
    PlateLaws laws;
    WheelContact contact;
    SoftSoils soils;
  };
  /// Soil that the leading end of one track presses.
  struct Track {
    Bristle bristle;
    BristleParameters pushing;
    double resistance_n = 0.0;
    double rut_m = 0.0;
    std::size_t term = 0;
    bool resisted = false;
  };
  /// Terms of a drive's equation that are eliminated from the machine's in one pass.
  struct Eliminated {
    Velocities b = Velocities::Zero();
    double c = 0.0;
    double d = 1.0;
    double rate = 0.0;  ///< Rate found.
  };

  [[nodiscard]] Placement place_links(const JointVector& q_rad) const;
  [[nodiscard]] SpatialMatrix inertia_of(const ArmDynamics::Moments& moments,
                                         const Eigen::Matrix3d& R,
                                         const Eigen::Vector3d& origin) const;
  void equations(const DrivenArm& arm, Placement& at, const JointVector& q_rad, Matrix& mass_matrix,
                 Velocities& bias) const;
  [[nodiscard]] Velocities point_row(const Placement& at, const Eigen::Vector3d& point_C,
                                     const Eigen::Vector3d& direction_C, std::size_t link) const;
  std::size_t add(const Velocities& row, const ImplicitForce& law, double least, double greatest);
  std::size_t add_on_carrier(const Eigen::Vector3d& point_W, const Eigen::Vector3d& direction_W,
                             const ImplicitForce& law, double least, double greatest);
  void add_wheels(double h);
  void make_wheels();
  void make_tracks();
  void make_pads();
  void add_plates(double h, std::span<CarrierDrive> drives);
  void add_ploughing(double h, std::size_t track, double rate_mps);
  void find_contact(Plate& plate, std::size_t index, double lowered_m);
  [[nodiscard]] double speed(const Term& term, const Velocities& found) const;
  void eliminate(double h, std::span<CarrierDrive> drives, Matrix& left, Velocities& right);
  [[nodiscard]] static bool clamp(Term& term, double free);
  [[nodiscard]] bool clamp(const Velocities& found, std::span<CarrierDrive> drives);
  [[nodiscard]] bool clamp_standing(Footing& foot);
  [[nodiscard]] bool clamp_sliding(Footing& foot, const Velocities& found);
  void settle_wheels(double h, const Velocities& found);
  void settle_plates(double h, const Velocities& found, std::span<CarrierDrive> drives);

  ExcavatorParameters parameters_;
  ArmDynamics::Moments undercarriage_;
  const Ground* ground_;
  double mass_kg_ = 0.0;
  /// Contacts of this step: with obstacles, then the machine's own.
  std::vector<ContactPoint*> contact_points_;
  std::vector<std::array<Velocities, 3>> contact_rows_;
  std::vector<Term> terms_;        ///< Forces of this step, like the two below.
  std::vector<Footing> footings_;  ///< Wheels, or plates in their order.
  std::vector<Eliminated> eliminated_;
  std::vector<Tyre> tyres_;
  std::array<TyreLaws, kCarrierWheels> tyre_laws_;
  std::vector<Plate> plates_;
  std::size_t stations_ = 0;  ///< Number of plates that are stations, both tracks together.
  std::array<Track, kTracks> tracks_;
  std::vector<double> plate_loads_n_;
  std::array<Eigen::Vector3d, kCarrierWheels> wheel_C_;
  Eigen::Isometry3d X_WC_;
  Velocities velocity_ = Velocities::Zero();  ///< Joint velocities are those of the last step.
  Velocities acceleration_ = Velocities::Zero();
  std::array<double, kCarrierWheels> loads_n_{};
};

}  // namespace rigwire::sim

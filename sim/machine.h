// What every machine is to the world that steps it: rigid links that move, ports for commands and
// transducers, numbers for the status table and the truth tap.
//
// A machine is made standing on its ground. It knows nothing of sensors, devices or wires. Machines
// are deterministic: the same parameters, commands and calls give the same bits on one compiler.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/contact/contact_report.h"
#include "sim/link_motion.h"
#include "sim/samples/power_unit_sample.h"
#include "sim/samples/time.h"
#include "sim/samples/valve_sample.h"
#include "sim/samples/vehicle_sample.h"
#include "sim/scene/node_rectangle.h"
#include "sim/weather/dust_emitter.h"

namespace rigwire::sim {

/// The first quantity that stopped being a finite number.
struct NonFinite {
  const char* quantity = "";  ///< For example "joint acceleration".
  const char* part = "";      ///< Part of the machine: "boom", "front left wheel".
  SimTime time{};             ///< Machine time of the step that failed.
};

/// Spool commands in, transducer readings out: a machine with a valve block.
class ValvePort {
 public:
  virtual ~ValvePort() = default;
  /// What its sections move, by name, from section 0 on.
  [[nodiscard]] virtual std::span<const std::string_view> actuators() const = 0;
  /// New spool set points, valid until the next. A section whose opening is not a number keeps its
  /// old set point; openings outside -1 .. 1 are clamped.
  virtual void command(const ValveCommand& command) = 0;
  /// The set points that hold at present.
  [[nodiscard]] virtual const ValveCommand& commanded() const = 0;
  /// What the transducers read, stamped with `time`.
  [[nodiscard]] virtual ValveSample valve_sample(SimTime time) const = 0;
};

/// Driver's commands in, drive-train and wheel readings out: a machine that drives.
class VehiclePort {
 public:
  virtual ~VehiclePort() = default;
  /// New commands, valid until the next. A member that is not a number keeps its old value; members
  /// out of range are clamped; a gear that does not exist is not engaged.
  virtual void command(const VehicleCommand& command) = 0;
  [[nodiscard]] virtual VehicleSample vehicle_sample(SimTime time) const = 0;
  /// Data sheet of its engine.
  [[nodiscard]] virtual EngineData engine_data() const = 0;
  /// Whether rear_steer_rad has an effect.
  [[nodiscard]] virtual bool steers_rear() const { return false; }
};

/// Requests to an engine that drives pumps, readings of both.
class PowerUnitPort {
 public:
  virtual ~PowerUnitPort() = default;
  /// Holds until the next call. A member that is not a number keeps its old value; the others are
  /// clamped.
  virtual void command(const PowerUnitCommand& command) = 0;
  [[nodiscard]] virtual PowerUnitSample power_unit_sample(SimTime time) const = 0;
  /// Returns the data sheet of its engine.
  [[nodiscard]] virtual EngineData engine_data() const = 0;
};

/// One number of the status table.
struct StatusQuantity {
  std::string_view name;
  std::string_view unit;  ///< Unit of the displayed value: "deg", "bar".
};

/// One member of a truth record: `count` numbers under one key, which names their unit.
struct TruthField {
  std::string_view key;  ///< "joint_rad"
  std::size_t count = 1;
};

/// A point of a machine where nothing solid may be when it starts.
struct BodyPoint {
  std::string_view body;  ///< What it is a point of: "bucket".
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
};

class Machine {
 public:
  virtual ~Machine() = default;
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// Advances by `span`, in inner steps of the machine's own. span <= 0 changes not one bit. Never
  /// throws, never allocates. After a non-finite result the machine stays at rest in its last
  /// finite state, see non_finite().
  virtual void step(Duration span) = 0;

  /// Time advanced so far.
  [[nodiscard]] virtual SimTime time() const = 0;

  /// Motion of every link at the end of the last step, in the world frame; accelerations are the
  /// solver's own. In the order of link_names(), the link that carries the machine first.
  [[nodiscard]] virtual std::span<const LinkMotion> links() const = 0;
  [[nodiscard]] virtual std::span<const std::string_view> link_names() const = 0;

  [[nodiscard]] virtual const std::optional<NonFinite>& non_finite() const = 0;

  /// What read_status() writes, in its order.
  [[nodiscard]] virtual std::span<const StatusQuantity> status_quantities() const = 0;
  /// `values` has one place per quantity.
  virtual void read_status(std::span<double> values) const = 0;

  /// What read_truth() writes, in its order.
  [[nodiscard]] virtual std::span<const TruthField> truth_fields() const = 0;
  /// `values` has one place per number of all fields.
  virtual void read_truth(std::span<double> values) const = 0;

  /// The nodes of the ground's terrain that the machine has changed since the last call.
  [[nodiscard]] virtual std::optional<NodeRectangle> take_ground_changes() { return std::nullopt; }

  /// Returns the current positions of its parts other than wheels and drums, as far as the model
  /// knows them. For set-up: it allocates.
  [[nodiscard]] virtual std::vector<BodyPoint> body_points() const { return {}; }

  /// Returns why it does not stay at its initial pose, for display: "it slides, found ..., allowed
  /// ..."; empty: it stays. For set-up.
  [[nodiscard]] virtual std::string unsteady_start() const { return {}; }

  /// Where it stirs up dust at present.
  [[nodiscard]] virtual std::span<const DustEmitter> dust_emitters() const { return {}; }

  /// Contacts with solid things; null: the machine has none.
  [[nodiscard]] virtual const ContactReport* contact_report() const { return nullptr; }

  /// Obstacles of its ground that it has pushed over, by their index there: what leans is seen to.
  [[nodiscard]] virtual std::span<const LeaningObstacle> leaning_obstacles() const { return {}; }

  /// Nothing when the machine has no such port. Owned by the machine.
  [[nodiscard]] virtual ValvePort* valve_port() { return nullptr; }
  [[nodiscard]] virtual VehiclePort* vehicle_port() { return nullptr; }
  [[nodiscard]] virtual PowerUnitPort* power_unit_port() { return nullptr; }

  /// Is carried along a motion that is not its own, in place of step(): the links have come to
  /// `links` within `span`; 0: they are put there. What it does to its ground by that, it does.
  virtual void follow(Duration /*span*/, std::span<const LinkMotion> /*links*/) {}

 protected:
  Machine() = default;
};

}  // namespace rigwire::sim

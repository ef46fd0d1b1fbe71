#include "sim/replay/replayed_machine.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "sim/samples/port_members.h"

namespace rigwire::sim {
namespace {

constexpr std::array<StatusQuantity, 5> kStatus{{{"east", "m"},
                                                 {"north", "m"},
                                                 {"up", "m"},
                                                 {"speed", "m/s"},
                                                 {"commands without effect", "1"}}};

/// Below this speed of rolling wheels the curvature of the path cannot be determined.
constexpr double kLeastSpeed_mps = 0.1;

void require_width(const RecordedNumbers& numbers, std::size_t width, const char* what) {
  if (!numbers.empty() && numbers.width() != width) {
    throw std::invalid_argument(std::string("replayed machine: the record of its ") + what +
                                " is that of another machine");
  }
}

/// What was recorded at that instant, over `sample`; false without a record.
template <class Sample>
bool take_recorded(const RecordedNumbers& record, SimTime time, Sample& sample) {
  if (record.empty()) {
    return false;
  }
  std::vector<double> numbers(record.width());
  record.read(time, numbers);
  take_numbers(numbers, sample);
  return true;
}

template <class Sample>
std::size_t width_of(const Sample& sample) {
  std::vector<double> numbers;
  append_numbers(sample, numbers);
  return numbers.size();
}

}  // namespace

class ReplayedMachine::Valves final : public ValvePort {
 public:
  Valves(ReplayedMachine& machine, const ValvePort& model) : machine_(machine), model_(model) {}

  [[nodiscard]] std::span<const std::string_view> actuators() const override {
    return model_.actuators();
  }
  void command(const ValveCommand& command) override {
    machine_.commands_ += command == commanded_ ? 0 : 1;
    commanded_ = command;
  }
  [[nodiscard]] const ValveCommand& commanded() const override { return commanded_; }
  [[nodiscard]] ValveSample valve_sample(SimTime time) const override {
    ValveSample sample = model_.valve_sample(time);
    if (!take_recorded(machine_.record_.valves, time, sample) && machine_.links_.size() > 1) {
      const LinkMotion& base = machine_.links_[0];
      const LinkMotion& upper = machine_.links_[1];
      const Eigen::Matrix3d R = base.X_WL.linear().transpose() * upper.X_WL.linear();
      sample.swing_angle_rad = std::atan2(R(1, 0), R(0, 0));
      sample.swing_rate_radps = base.X_WL.linear().col(2).dot(upper.w_WL_W - base.w_WL_W);
    }
    sample.time = time;
    return sample;
  }

 private:
  ReplayedMachine& machine_;
  const ValvePort& model_;
  ValveCommand commanded_;
};

class ReplayedMachine::Vehicle final : public VehiclePort {
 public:
  Vehicle(ReplayedMachine& machine, const VehiclePort& model) : machine_(machine), model_(model) {}

  void command(const VehicleCommand& command) override {
    machine_.commands_ += command == commanded_ ? 0 : 1;
    commanded_ = command;
  }
  [[nodiscard]] EngineData engine_data() const override { return model_.engine_data(); }
  [[nodiscard]] bool steers_rear() const override { return model_.steers_rear(); }
  [[nodiscard]] VehicleSample vehicle_sample(SimTime time) const override {
    VehicleSample sample = model_.vehicle_sample(time);
    if (!take_recorded(machine_.record_.vehicle, time, sample)) {
      roll(sample);
    }
    sample.time = time;
    return sample;
  }

 private:
  /// Wheels and axle of a vehicle that rolls along the body's motion.
  void roll(VehicleSample& sample) const {
    const LinkMotion& body = machine_.links_.front();
    const Eigen::Matrix3d R_BW = body.X_WL.linear().transpose();
    const Eigen::Vector3d v_B = R_BW * body.v_WL_W;
    const Eigen::Vector3d w_B = R_BW * body.w_WL_W;
    const std::size_t links = machine_.X_BL_.size();
    double front_x_m = 0.0;
    double rear_x_m = 0.0;
    for (std::size_t wheel = 0; wheel < kWheels && links > kWheels; ++wheel) {
      const Eigen::Vector3d p_B = machine_.X_BL_[links - kWheels + wheel].translation();
      const double forward_mps = (v_B + w_B.cross(p_B)).x();
      const double radius_m = sample.wheel_radius_m[wheel];
      sample.wheel_rate_radps[wheel] = radius_m > 0.0 ? forward_mps / radius_m : 0.0;
      (wheel < 2 ? front_x_m : rear_x_m) = p_B.x();
    }
    sample.ground_speed_mps = v_B.x();
    sample.odometry.speed_mps = v_B.x();
    const bool moves = std::abs(v_B.x()) > kLeastSpeed_mps;
    sample.odometry.curvature_1pm = moves ? w_B.z() / v_B.x() : 0.0;
    sample.odometry.slip_angle_rad = moves ? std::atan(v_B.y() / v_B.x()) : 0.0;
    sample.front_steer_rad = std::atan(sample.odometry.curvature_1pm * (front_x_m - rear_x_m));
    sample.parking_brake = false;
  }

  ReplayedMachine& machine_;
  const VehiclePort& model_;
  VehicleCommand commanded_;
};

class ReplayedMachine::PowerUnit final : public PowerUnitPort {
 public:
  PowerUnit(ReplayedMachine& machine, const PowerUnitPort& model)
      : machine_(machine), model_(model) {}

  void command(const PowerUnitCommand& command) override {
    machine_.commands_ += command == commanded_ ? 0 : 1;
    commanded_ = command;
  }
  [[nodiscard]] EngineData engine_data() const override { return model_.engine_data(); }
  [[nodiscard]] PowerUnitSample power_unit_sample(SimTime time) const override {
    PowerUnitSample sample = model_.power_unit_sample(time);
    take_recorded(machine_.record_.power_unit, time, sample);
    sample.time = time;
    return sample;
  }

 private:
  ReplayedMachine& machine_;
  const PowerUnitPort& model_;
  PowerUnitCommand commanded_;
};

ReplayedMachine::ReplayedMachine(std::unique_ptr<Machine> model, MachineRecord record)
    : model_(std::move(model)), record_(std::move(record)) {
  const std::span<const LinkMotion> rest = model_->links();
  if (record_.links.size() != rest.size() || record_.links.front() == nullptr) {
    throw std::invalid_argument("replayed machine: the record has not its links");
  }
  const Eigen::Isometry3d X_BW = rest.front().X_WL.inverse();
  for (const LinkMotion& link : rest) {
    X_BL_.push_back(X_BW * link.X_WL);
  }
  std::size_t fields = 0;
  for (const TruthField& field : model_->truth_fields()) {
    truth_fields_.push_back(field);
    fields += field.count;
  }
  truth_fields_.push_back({"commands_without_effect", 1});
  require_width(record_.truth, fields, "truth");
  if (const ValvePort* port = model_->valve_port()) {
    require_width(record_.valves, width_of(ValveSample{}), "valves");
    valves_ = std::make_unique<Valves>(*this, *port);
  }
  if (const VehiclePort* port = model_->vehicle_port()) {
    require_width(record_.vehicle, width_of(VehicleSample{}), "drive train");
    vehicle_ = std::make_unique<Vehicle>(*this, *port);
  }
  if (const PowerUnitPort* port = model_->power_unit_port()) {
    require_width(record_.power_unit, width_of(PowerUnitSample{}), "engine");
    power_unit_ = std::make_unique<PowerUnit>(*this, *port);
  }
  links_.resize(rest.size());
  place();
  model_->follow(Duration{0}, links_);
}

ReplayedMachine::~ReplayedMachine() = default;

void ReplayedMachine::place() {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    links_[i] = record_.links[i] != nullptr ? record_.links[i]->at(time_)
                                            : at_mount(links_.front(), X_BL_[i]);
  }
}

void ReplayedMachine::step(Duration span) {
  if (span <= Duration{0} || non_finite_) {
    return;
  }
  time_ += span;
  place();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const LinkMotion& link = links_[i];
    if (!link.X_WL.matrix().allFinite() || !link.v_WL_W.allFinite() || !link.w_WL_W.allFinite() ||
        !link.a_WL_W.allFinite() || !link.alpha_WL_W.allFinite()) {
      non_finite_ = NonFinite{"recorded motion", link_names()[i].data(), time_};
      return;
    }
  }
  model_->follow(span, links_);
}

std::span<const StatusQuantity> ReplayedMachine::status_quantities() const {
  return kStatus;
}

void ReplayedMachine::read_status(std::span<double> values) const {
  const LinkMotion& first = links_.front();
  const Eigen::Vector3d& p_W = first.X_WL.translation();
  values[0] = p_W.x();
  values[1] = p_W.y();
  values[2] = p_W.z();
  values[3] = first.v_WL_W.norm();
  values[4] = static_cast<double>(commands_);
}

void ReplayedMachine::read_truth(std::span<double> values) const {
  const std::span<double> recorded = values.first(values.size() - 1);
  if (record_.truth.empty()) {
    std::ranges::fill(recorded, std::numeric_limits<double>::quiet_NaN());
  } else {
    record_.truth.read(time_, recorded);
  }
  values.back() = static_cast<double>(commands_);
}

ValvePort* ReplayedMachine::valve_port() {
  return valves_.get();
}

VehiclePort* ReplayedMachine::vehicle_port() {
  return vehicle_.get();
}

PowerUnitPort* ReplayedMachine::power_unit_port() {
  return power_unit_.get();
}

}  // namespace rigwire::sim

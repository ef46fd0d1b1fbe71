// An excavator that digs: the machine of excavator.h with its bucket in diggable terrain.
//
// Each inner step: forces of the ground on the bucket, step of the arm, soil moved by the bucket's
// way, weight of the bucket's content for the next step. Everything else (commands, readings,
// frames, signs) is the excavator's.
#pragma once

#include <vector>

#include "sim/excavator/bucket_soil.h"
#include "sim/excavator/excavator.h"

namespace rigwire::sim {

class DiggingExcavator final : public Machine {
 public:
  /// Builds the machine. X_WC: the undercarriage's pose. Digging changes `ground`, which must
  /// outlive the machine; a moving carrier is supported by it. The maximum payload is raised to the
  /// heaped bucket's capacity of the heaviest soil. Throws std::invalid_argument as Excavator,
  /// BucketSoil and DiggableTerrain do.
  DiggingExcavator(const ExcavatorParameters& parameters, const DiggingParameters& digging,
                   const Eigen::Isometry3d& X_WC, Ground& ground);

  /// Steps like Excavator::step; one call with N inner steps gives the same bits as N calls.
  void step(Duration span) override;
  /// Moves the soil in the bucket's way along the given motion; the soil's forces are ignored.
  void follow(Duration span, std::span<const LinkMotion> links) override;

  [[nodiscard]] SimTime time() const override { return excavator_.time(); }
  [[nodiscard]] std::span<const LinkMotion> links() const override { return excavator_.links(); }
  [[nodiscard]] std::span<const std::string_view> link_names() const override {
    return excavator_.link_names();
  }
  [[nodiscard]] const std::optional<NonFinite>& non_finite() const override {
    return excavator_.non_finite();
  }

  /// The excavator's, then "payload" in kg and "dig depth" in cm.
  [[nodiscard]] std::span<const StatusQuantity> status_quantities() const override {
    return status_quantities_;
  }
  void read_status(std::span<double> values) const override;

  /// The excavator's, then bucket_soil_m3, payload_kg, dumped_elsewhere_m3, dig_depth_m.
  [[nodiscard]] std::span<const TruthField> truth_fields() const override { return truth_fields_; }
  void read_truth(std::span<double> values) const override;

  [[nodiscard]] std::optional<NodeRectangle> take_ground_changes() override {
    return terrain_.take_changes();
  }
  /// The excavator's, and the ends of the bucket's lip.
  [[nodiscard]] std::vector<BodyPoint> body_points() const override;
  [[nodiscard]] std::string unsteady_start() const override { return excavator_.unsteady_start(); }
  [[nodiscard]] const ContactReport* contact_report() const override {
    return excavator_.contact_report();
  }
  [[nodiscard]] std::span<const LeaningObstacle> leaning_obstacles() const override {
    return excavator_.leaning_obstacles();
  }
  [[nodiscard]] ValvePort* valve_port() override { return excavator_.valve_port(); }
  [[nodiscard]] PowerUnitPort* power_unit_port() override { return excavator_.power_unit_port(); }
  /// The lip of the bucket, while soil goes in or out: dust by the height from which it falls. The
  /// flow is smoothed over a tenth of a second, which keeps its volume.
  [[nodiscard]] std::span<const DustEmitter> dust_emitters() const override { return {&dust_, 1}; }

  [[nodiscard]] Excavator& excavator() { return excavator_; }
  [[nodiscard]] const Excavator& excavator() const { return excavator_; }
  [[nodiscard]] BucketSoil& bucket() { return bucket_; }
  [[nodiscard]] const BucketSoil& bucket() const { return bucket_; }
  [[nodiscard]] DiggableTerrain& terrain() { return terrain_; }
  [[nodiscard]] const DiggableTerrain& terrain() const { return terrain_; }

  /// Terrain + bucket + dumped elsewhere, against the start; 0 unless soil was lost or invented.
  [[nodiscard]] std::int64_t balance_units() const;

 private:
  void inner_step(Duration span);
  void update_dust(double h, const Eigen::Isometry3d& X_WB);

  DiggableTerrain terrain_;
  Excavator excavator_;
  BucketSoil bucket_;
  Duration inner_span_;
  double payload_kg_ = 0.0;
  double bucket_tip_m_;
  double bucket_width_m_;
  double bucket_m3_ = 0.0;  ///< At the last look for dust.
  DustEmitter dust_;
  std::vector<StatusQuantity> status_quantities_;
  std::vector<TruthField> truth_fields_;
  std::size_t excavator_truth_ = 0;  ///< Numbers of the excavator's truth fields.
};

}  // namespace rigwire::sim

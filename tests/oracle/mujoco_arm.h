// The excavator's arm in MuJoCo: as an open chain of four hinges, or as it is built, with tubes,
// rods, idler and link as bodies of their own and their loops closed by `connect` constraints.
//
// The model's zero is the published pose: qpos counts from there. The looped arm has 12 degrees of
// freedom and 12 rows of constraint; its drives are Eq. 5 on the rods' slides (and on the swing),
// ctrl the way from the start with rate d / k on top. MuJoCo wants a mass in every moving body:
// tubes, rods, idler and link weigh kSmallMass_kg each, where ours have none.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

#include "sim/excavator/driven_arm.h"

namespace rigwire::sim {

enum class MujocoArmKind { open_chain, looped };
inline constexpr double kSmallMass_kg = 20.0;

class MujocoArm {
 public:
  /// integrator: "Euler", "implicit" or "RK4". Throws std::runtime_error with MuJoCo's message.
  MujocoArm(const ExcavatorParameters& parameters, const DriveGains& gains, MujocoArmKind kind,
            double step_s, const std::string& integrator);

  [[nodiscard]] JointMatrix mass_matrix();  ///< Mass matrix of the open chain, at its present pose.
  [[nodiscard]] JointVector bias();         ///< Bias of the open chain, at its present pose.
  [[nodiscard]] JointVector joint_angles_rad() const;

  /// Eq. 5's targets for the next step.
  void command(const JointVector& target, const JointVector& rate);
  void step() { mj_step(model_.get(), data_.get()); }

  /// Largest distance between the two halves of a loop's pin.
  [[nodiscard]] double loop_gap_m() const;
  [[nodiscard]] int degrees_of_freedom() const { return model_->nv; }
  [[nodiscard]] int constraint_rows() const { return data_->nefc; }
  /// Warnings of instability so far (bad position, velocity or acceleration).
  [[nodiscard]] int warnings() const;

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  DriveGains gains_;
  JointVector start_x_;
};

}  // namespace rigwire::sim

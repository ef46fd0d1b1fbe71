// What one step of the arm costs in closed form, and with its loops closed by constraints: our arm
// and MuJoCo's looped arm in one process, on the same geometry, masses, drives and motion.
//
//     oracle_bench [--json] [STEP_MS]
//
// One thread, CPU time, runs of the two interleaved, median of seven. The scenario is the published
// driven one (bench/published_arm.h), 4 s.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "bench/published_arm.h"
#include "mujoco_arm.h"

namespace {

using namespace rigwire::bench;
using namespace rigwire::sim;

constexpr int kRuns = 7;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Run {
  double us_per_step = 0.0;
  JointVector q = JointVector::Zero();
  double loop_gap_m = 0.0;
  int warnings = 0;
};

Run run_own(const DrivenArm& arm, const CosineTargets& targets, double step_s, int steps) {
  ArmState state{kPublishedPose, JointVector::Zero()};
  const double begin = cpu_seconds();
  for (int i = 0; i < steps; ++i) {
    step_arm(arm, 1, step_s * i, step_s, targets, state);
  }
  return {1e6 * (cpu_seconds() - begin) / steps, state.q_rad};
}

Run run_mujoco(const DrivenArm& arm, const CosineTargets& targets, double step_s, int steps,
               const char* integrator) {
  MujocoArm mujoco(published_set(), arm.gains, MujocoArmKind::looped, step_s, integrator);
  Run run;
  double spent = 0.0;
  for (int i = 0; i < steps;) {
    // The gap is looked at every 100 steps, outside the measured time.
    const double begin = cpu_seconds();
    for (const int end = std::min(steps, i + 100); i < end; ++i) {
      const DriveTargets at = targets(step_s * i);
      mujoco.command(at.position, at.rate);
      mujoco.step();
    }
    spent += cpu_seconds() - begin;
    run.loop_gap_m = std::max(run.loop_gap_m, mujoco.loop_gap_m());
  }
  run.us_per_step = 1e6 * spent / steps;
  run.q = mujoco.joint_angles_rad();
  run.warnings = mujoco.warnings();
  return run;
}

}  // namespace

int main(int argc, char** argv) {
  bool json = false;
  double step_s = 1e-3;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--json") == 0) {
      json = true;
    } else {
      step_s = 1e-3 * std::atof(argv[i]);
    }
  }
  if (!(step_s >= 1e-5 && step_s <= 0.02)) {
    std::fprintf(stderr, "oracle_bench [--json] [STEP_MS]: STEP_MS from 0.01 to 20\n");
    return 2;
  }
  const int steps = static_cast<int>(4.0 / step_s + 0.5);
  const DrivenArm arm = published_arm();
  const CosineTargets targets(arm);

  const std::vector<const char*> integrators{"Euler", "implicit", "RK4"};
  std::vector<double> own_us;
  std::vector<std::vector<double>> their_us(integrators.size());
  Run own;
  std::vector<Run> theirs(integrators.size());
  for (int i = 0; i < kRuns; ++i) {
    own = run_own(arm, targets, step_s, steps);
    own_us.push_back(own.us_per_step);
    for (std::size_t k = 0; k < integrators.size(); ++k) {
      theirs[k] = run_mujoco(arm, targets, step_s, steps, integrators[k]);
      their_us[k].push_back(theirs[k].us_per_step);
    }
  }
  const double own_median = median(own_us);
  const auto tip_gap = [&](const JointVector& q) {
    return (arm.dynamics().tip_C(q) - arm.dynamics().tip_C(own.q)).norm();
  };
  if (json) {
    std::printf(
        "{\"step_s\":%g,\"flags\":\"%s\",\"compiler\":\"%s\",\"mujoco\":\"%s\","
        "\"own\":{\"us_per_step\":%.4f,"
        "\"loop_gap_m\":0},\"mujoco_looped\":[",
        step_s, RIGWIRE_COMPILER_FLAGS, __VERSION__, mj_versionString(), own_median);
  } else {
    std::printf("compiler %s, flags%s, MuJoCo %s as packaged; step %g ms\n", __VERSION__,
                RIGWIRE_COMPILER_FLAGS, mj_versionString(), 1e3 * step_s);
    std::printf("own arm, closed-form loops, linearly implicit: %.3f us/step, loop gap 0\n",
                own_median);
  }
  for (std::size_t k = 0; k < integrators.size(); ++k) {
    const double us = median(their_us[k]);
    if (json) {
      std::printf(
          "%s{\"integrator\":\"%s\",\"us_per_step\":%.4f,\"ratio\":%.2f,"
          "\"loop_gap_m\":%.3e,\"tip_difference_m\":%.3e,\"warnings\":%d}",
          k == 0 ? "" : ",", integrators[k], us, us / own_median, theirs[k].loop_gap_m,
          tip_gap(theirs[k].q), theirs[k].warnings);
    } else {
      std::printf(
          "MuJoCo looped (12 dof, 12 rows), %-8s: %7.3f us/step, ratio %5.1f, loop gap "
          "%.2e m, tip %.2e m from ours at 4 s, %d warnings\n",
          integrators[k], us, us / own_median, theirs[k].loop_gap_m, tip_gap(theirs[k].q),
          theirs[k].warnings);
    }
  }
  if (json) {
    std::printf("]}\n");
  }
  return 0;
}

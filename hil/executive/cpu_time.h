// CPU time of the calling thread, for the stage accounts of the report.
#pragma once

#include <ctime>

namespace rigwire::hil {

[[nodiscard]] inline double thread_cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Adds the CPU time of its scope to an account.
class StageTimer {
 public:
  explicit StageTimer(double& account_s) : account_s_(account_s), start_s_(thread_cpu_seconds()) {}
  ~StageTimer() { account_s_ += thread_cpu_seconds() - start_s_; }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  double& account_s_;
  double start_s_;
};

/// Adds the CPU time of consecutive stages to an account each; reads the clock once between two of
/// them.
class StageLaps {
 public:
  /// CPU time from here on belongs to the next lap.
  void begin() { last_s_ = thread_cpu_seconds(); }
  void end(double& account_s) {
    const double now_s = thread_cpu_seconds();
    account_s += now_s - last_s_;
    last_s_ = now_s;
  }

 private:
  double last_s_ = 0.0;
};

}  // namespace rigwire::hil

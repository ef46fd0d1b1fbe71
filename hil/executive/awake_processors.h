// Processors that do not sleep.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace rigwire::hil {

/// While it lives, none of the processors that this process may use goes to sleep: on each turns a
/// thread of idle priority, which gives way to everything else. What waits for an instant is then
/// served without the wake-up of its processor (10 to 200 us from its idle states; of a virtual one
/// until its host runs it again), and a kernel that keeps few processors busy to let others sleep
/// has none that does. The price is their power, and the turbo of others.
class AwakeProcessors {
 public:
  /// Throws std::runtime_error where there is a limit_of_processors() below their number, which
  /// they would use up, and std::system_error when a thread cannot be had as it has to be.
  AwakeProcessors();
  ~AwakeProcessors();
  AwakeProcessors(const AwakeProcessors&) = delete;
  AwakeProcessors& operator=(const AwakeProcessors&) = delete;

  [[nodiscard]] std::size_t processors() const { return threads_.size(); }
  /// What has gone into keeping them awake.
  [[nodiscard]] double cpu_seconds() const;

 private:
  void end();

  std::atomic<bool> ended_{false};
  std::vector<std::thread> threads_;
};

/// The least of the limits of processor time that control groups set (`cpu.max` of version 2), in
/// processors; nothing when there is none. `membership`: /proc/self/cgroup; `root`: where the
/// groups are mounted.
[[nodiscard]] std::optional<double> limit_of_processors(const std::filesystem::path& membership,
                                                        const std::filesystem::path& root);

}  // namespace rigwire::hil

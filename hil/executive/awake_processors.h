// Keeps processors from sleeping.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace rigwire::hil {

/// While it lives, none of the processors that this process may use goes to sleep: a thread of idle
/// priority, which yields to everything else, spins on each. Work that waits for an instant is then
/// served without the wake-up of its processor (10 to 200 us from its idle states; of a virtual one
/// until its host runs it again), and a kernel that keeps few processors busy to let others sleep
/// cannot do so. The price is their power, and the turbo of others.
class AwakeProcessors {
 public:
  /// Throws std::runtime_error when limit_of_processors() is below their number, since the threads
  /// would use it up, and std::system_error when a thread cannot be made or set up.
  AwakeProcessors();
  ~AwakeProcessors();
  AwakeProcessors(const AwakeProcessors&) = delete;
  AwakeProcessors& operator=(const AwakeProcessors&) = delete;

  [[nodiscard]] std::size_t processors() const { return threads_.size(); }
  /// Returns the processor time spent on keeping them awake.
  [[nodiscard]] double cpu_seconds() const;

 private:
  void end();

  std::atomic<bool> ended_{false};
  std::vector<std::thread> threads_;
};

/// Returns the minimum of the limits of processor time that control groups set (`cpu.max` of
/// version 2), in processors; nullopt when there is none. `membership`: /proc/self/cgroup; `root`:
/// where the groups are mounted.
[[nodiscard]] std::optional<double> limit_of_processors(const std::filesystem::path& membership,
                                                        const std::filesystem::path& root);

}  // namespace rigwire::hil

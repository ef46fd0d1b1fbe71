// When each device last sent something, and which one is silent.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::field {

class SilenceWatch {
 public:
  /// A monotonic time; only differences matter.
  using Instant = std::chrono::nanoseconds;

  struct Device {
    std::string_view name;
    std::chrono::milliseconds limit;  ///< Silence allowed.
  };

  /// Devices are numbered as given, from 0.
  explicit SilenceWatch(std::vector<Device> devices);

  void heard(std::size_t device, Instant now) { last_[device] = now; }
  /// The first device that has sent data and has been silent for longer than its limit.
  [[nodiscard]] std::optional<std::size_t> silent(Instant now) const;
  /// Every device has sent data and none is silent.
  [[nodiscard]] bool all_alive(Instant now) const;
  /// Names of those that have never sent data or are silent, comma-separated.
  [[nodiscard]] std::string absent(Instant now) const;
  [[nodiscard]] std::string_view name(std::size_t device) const { return devices_[device].name; }

 private:
  [[nodiscard]] bool alive(std::size_t device, Instant now) const;

  std::vector<Device> devices_;
  std::vector<std::optional<Instant>> last_;
};

}  // namespace rigwire::field

// A device's non-volatile memory as a file, so that what a client saved is there in the next run.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "emulators/nonvolatile_memory.h"

namespace rigwire::hil {

class SettingsFile final : public emulators::NonvolatileMemory {
 public:
  /// Reads what is there; no file is an empty memory. Throws std::runtime_error with the name when
  /// the file is there and cannot be read, or holds more than a device's memory does.
  explicit SettingsFile(std::string path);

  [[nodiscard]] std::span<const std::uint8_t> content() const override { return content_; }
  /// Writes another file beside it and renames that, so that a reader sees the old content or the
  /// new one. False when that fails.
  [[nodiscard]] bool store(std::span<const std::uint8_t> block) override;

 private:
  std::string path_;
  std::vector<std::uint8_t> content_;
};

/// The file, or for an empty path a memory that lasts as long as the run.
[[nodiscard]] std::unique_ptr<emulators::NonvolatileMemory> open_settings(const std::string& path);

}  // namespace rigwire::hil

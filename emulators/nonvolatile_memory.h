// What a device keeps while its supply is off: one block of bytes, written when a client says
// "save". Who owns the device decides where it lives (a file, a test's vector, nowhere).
//
// The block is sealed with a mark, its length and a checksum (Fletcher-32 over 16-bit words,
// Fletcher 1982): what was cut off, belongs to another device or has a flipped bit is not taken,
// and the device starts with its defaults, as one whose EEPROM fails its check does.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace rigwire::emulators {

class NonvolatileMemory {
 public:
  virtual ~NonvolatileMemory() = default;
  /// What was written last; empty at delivery.
  [[nodiscard]] virtual std::span<const std::uint8_t> content() const = 0;
  /// False when it could not be written; then the old content is still there.
  [[nodiscard]] virtual bool store(std::span<const std::uint8_t> block) = 0;
};

/// Keeps it as long as the object lives.
class VolatileMemory final : public NonvolatileMemory {
 public:
  [[nodiscard]] std::span<const std::uint8_t> content() const override { return block_; }
  [[nodiscard]] bool store(std::span<const std::uint8_t> block) override {
    block_.assign(block.begin(), block.end());
    return true;
  }

 private:
  std::vector<std::uint8_t> block_;
};

/// `mark` says whose block it is.
[[nodiscard]] std::vector<std::uint8_t> seal(std::uint32_t mark,
                                             std::span<const std::uint8_t> content);
/// The content of a sealed block; nothing when it is not what seal() made with that mark.
[[nodiscard]] std::optional<std::span<const std::uint8_t>> unseal(
    std::uint32_t mark, std::span<const std::uint8_t> block);

}  // namespace rigwire::emulators

// The cable between sensor and host: packets that get lost, change places or come twice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "emulators/device.h"
#include "emulators/random_bits.h"
#include "emulators/velodyne/velodyne_fault.h"
#include "protocols/velodyne/data_packet.h"

namespace rigwire::emulators {

class FaultyCable final : public ByteOutput {
 public:
  enum class Swapping : std::uint8_t { never, as_the_faults_say };

  /// Keeps references to the faults and the output. The same seed makes the same choices.
  FaultyCable(ByteOutput& output, const VelodyneFaults& faults, std::uint64_t seed,
              Swapping swapping);

  /// Precondition: at most one data packet of bytes.
  void send(SimTime due, std::span<const std::uint8_t> bytes) override;
  /// Forgets a packet that waits to change places.
  void clear() { held_size_ = 0; }

  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  /// Draws where a `Fault` holds.
  template <class Fault>
  [[nodiscard]] bool happens(SimTime now);

  ByteOutput& output_;
  const VelodyneFaults& faults_;
  RandomBits random_;
  Swapping swapping_;
  std::array<std::uint8_t, protocols::velodyne::kDataPacketSize> held_{};
  std::size_t held_size_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace rigwire::emulators

// The cable behind the camera, with its faults: packets of the stream that are lost, change places
// with their successors or arrive twice, and a link that is down.
#pragma once

#include <cstdint>
#include <vector>

#include "emulators/gige_camera/datagram.h"
#include "emulators/gige_camera/gige_camera_fault.h"
#include "emulators/random_bits.h"

namespace rigwire::emulators {

class FaultyStream final : public DatagramOutput {
 public:
  /// The output and the faults must outlive it. `longest`: bytes of the longest datagram.
  FaultyStream(DatagramOutput& output, const GigeCameraFaults& faults, std::uint64_t seed,
               std::size_t longest);

  /// A packet that is held back waits for the next one.
  void send(SimTime due, const UdpEnd& to, std::span<const std::uint8_t> bytes,
            bool do_not_fragment) override;
  /// Forgets a packet that waits to change places.
  void clear() { held_.clear(); }
  /// Datagrams that the faults have swallowed.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  template <class Fault>
  [[nodiscard]] bool happens(SimTime now);

  DatagramOutput& output_;
  const GigeCameraFaults& faults_;
  RandomBits random_;
  std::vector<std::uint8_t> held_;
  UdpEnd held_to_;
  std::uint64_t lost_ = 0;
};

}  // namespace rigwire::emulators

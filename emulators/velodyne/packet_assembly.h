// Firings into data packets, by the layout of protocols/velodyne/packet_layout.h: which echo goes
// to which block.
//
// With two returns per shot, where the strongest return is also the last, the second strongest
// takes its block; where there was only one, both blocks have equal bytes, which clients take as
// "both". Returns are compared by their distances as sent. A shot without a return has distance 0,
// and a reflectivity byte of the laser's own.
//
// Sources: as packet_layout.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "emulators/velodyne/return_encoder.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"
#include "protocols/velodyne/packet_layout.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::emulators {

/// The reflectivity byte of each laser's shots without a return.
using NoReturnBytes = std::array<std::uint8_t, kMaxLasers>;

class PacketAssembly {
 public:
  /// The model's table must outlive it.
  PacketAssembly(const protocols::velodyne::Model& model, const ReturnEncoder& encode,
                 const NoReturnBytes& no_return = {});
  PacketAssembly(const PacketAssembly&) = delete;
  PacketAssembly& operator=(const PacketAssembly&) = delete;

  /// Begins a packet; what was unfinished is forgotten.
  void begin(protocols::velodyne::ReturnMode mode);
  void discard() { begin(mode_); }

  /// Takes one bank of a firing, whose azimuth is 0 .. 35999. Banks come in order, and the packet
  /// is not complete.
  void add(const LidarFiring& bank, std::uint16_t azimuth_counts);

  [[nodiscard]] bool empty() const { return banks_ == 0; }
  [[nodiscard]] bool complete() const { return firings_left() == 0; }
  /// Some, but not all firings of a block are there.
  [[nodiscard]] bool within_block() const;
  /// Whole firings that the packet still lacks.
  [[nodiscard]] int firings_left() const;

  /// For the timestamp and the factory bytes, which are the caller's to set.
  [[nodiscard]] protocols::velodyne::DataPacketWriter& write() { return write_; }
  [[nodiscard]] std::span<const std::uint8_t, protocols::velodyne::kDataPacketSize> bytes() const {
    return bytes_;
  }

 private:
  /// Blocks of one bank.
  struct BankBlocks {
    std::size_t strongest = 0;  ///< Or of the one echo that the return mode names.
    std::size_t last = 0;       ///< Dual return.
  };

  void lay_out();
  /// Distance 0 with the byte that the laser has for it.
  void mark_no_returns(std::size_t first_laser, EncodedReturns& encoded) const;

  const protocols::velodyne::Model& model_;
  const ReturnEncoder& encode_;
  std::array<protocols::velodyne::ChannelWord, kMaxLasers> no_return_{};  ///< By laser.
  bool marks_no_returns_ = false;
  protocols::velodyne::ReturnMode mode_ = protocols::velodyne::ReturnMode::strongest;
  /// In the order of the banks.
  std::array<BankBlocks, protocols::velodyne::kBlocksPerPacket> blocks_{};
  std::array<std::uint8_t, protocols::velodyne::kDataPacketSize> bytes_{};
  protocols::velodyne::DataPacketWriter write_{bytes_};
  int banks_ = 0;  ///< In the packet so far.
  int firings_per_packet_ = 0;
};

}  // namespace rigwire::emulators

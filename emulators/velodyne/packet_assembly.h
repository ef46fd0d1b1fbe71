// Firings into data packets: which block an echo goes to, in every return mode of every model.
//
// One firing of all lasers fills one block of 32 lasers, half a block of 16 (two firings share it
// and its azimuth), two blocks of 64 or four of 128. With two returns per shot each block has a
// partner of the same azimuth:
//
//   32 and 16 lasers   even block last, odd block strongest
//   128 lasers         the same, bank by bank; the packet's last four blocks stay empty
//   64 lasers          both banks of the strongest, then both banks of the last
//
// Where the strongest return is also the last, the partner carries the second strongest, and where
// there was but one, the same again: equal bytes, which clients take as "both".
//
// Sources: VLP-16 user's manual 63-9243 Rev. D, section 9.1 (dual return mode); HDL-64E S3 manual,
// "Dual return"; VLS-128 manual; order in the HDL-64E as velodyne_decoder 3.1 reads it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emulators/velodyne/return_encoder.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::emulators {

class PacketAssembly {
 public:
  /// The model's table must outlive it.
  PacketAssembly(const protocols::velodyne::Model& model, const ReturnEncoder& encode);

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
  [[nodiscard]] static int firings_per_packet(const protocols::velodyne::Model& model,
                                              protocols::velodyne::ReturnMode mode);

  /// Factory bytes and timestamp are the caller's to set.
  [[nodiscard]] protocols::velodyne::DataPacket& packet() { return packet_; }

 private:
  [[nodiscard]] std::size_t block_index(std::size_t group, std::size_t bank,
                                        std::size_t partner) const;

  const protocols::velodyne::Model& model_;
  const ReturnEncoder& encode_;
  protocols::velodyne::ReturnMode mode_ = protocols::velodyne::ReturnMode::strongest;
  protocols::velodyne::DataPacket packet_;
  int banks_ = 0;  ///< In the packet so far.
  int firings_per_packet_ = 0;
};

}  // namespace rigwire::emulators

// What each place of a data packet holds, by model and return mode: which laser, which firing,
// which echo, and when it was shot. Encoder and decoder both ask here.
//
//   one return    VLP-16: block = 2 firings of 16 lasers.  HDL-32E, VLP-32C: block = 1 firing.
//                 HDL-64E: blocks 2 n (lasers 0-31) and 2 n + 1 (32-63) = firing n.
//                 VLS-128: blocks 4 n .. 4 n + 3 = firing n.
//   two returns   all but HDL-64E: even block last echo, odd block strongest of the same firing.
//                 VLS-128: one firing in blocks 0 .. 7, the last four hold nothing.
//                 HDL-64E: blocks 4 n and 4 n + 1 strongest, 4 n + 2 and 4 n + 3 last.
//
// Blocks of one firing carry the same azimuth, the rotor's when the first laser of the block's
// first firing is shot.
//
// Sources: VLP-16 manual 63-9243 Rev. D, section 9.3; VLS-128 manual 63-9483 Rev. A, section 9.3
// (which bank a block holds, time of the stamp); HDL-64E S3 manual, appendix E, and
// velodyne_decoder 3.1 (order of the two returns).
#pragma once

#include <cstddef>
#include <cstdint>

#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"

namespace rigwire::protocols::velodyne {

enum class BlockEcho : std::uint8_t {
  single,     ///< The one echo that the return mode names.
  last,       ///< Dual return: the farthest.
  strongest,  ///< Dual return: the strongest, or the second strongest where the last is that.
  none,       ///< The block holds nothing.
};

struct BlockPlace {
  std::size_t first_firing = 0;  ///< In the packet, from 0.
  std::size_t first_laser = 0;   ///< 0, 32, 64 or 96.
  BlockEcho echo = BlockEcho::single;

  friend bool operator==(const BlockPlace&, const BlockPlace&) = default;
};

/// Precondition for `mode` dual here and below: the model's blocks are one of the layouts above,
/// whether or not its firmware can send two returns.
[[nodiscard]] BlockPlace block_place(const Model& model, ReturnMode mode, std::size_t block);

/// Flag of the blocks whose first laser this is.
[[nodiscard]] std::uint16_t block_flag(std::size_t first_laser);

/// Returns the number of firings of all lasers in one packet.
[[nodiscard]] std::size_t firings_per_packet(const Model& model, ReturnMode mode);

/// Returns the time from the first firing of a packet to that of the next, while all firings are
/// sent.
[[nodiscard]] std::int32_t packet_period_ns(const Model& model, ReturnMode mode);

/// Laser of a position in a packet, and the time it fired.
struct Shot {
  std::size_t laser = 0;
  std::size_t firing = 0;  ///< In the packet, from 0.
  BlockEcho echo = BlockEcho::single;
  std::int32_t block_offset_ns = 0;  ///< After the instant of the block's azimuth.
  /// After the packet's timestamp; negative for the first groups of a VLS-128. Behind a gap that
  /// the view window leaves within a packet shots are later than this, by an unknown time.
  std::int32_t packet_offset_ns = 0;
};

/// `channel` 0..31 of `block` 0..11. Precondition: both in range, the block holds an echo.
[[nodiscard]] Shot shot(const Model& model, ReturnMode mode, std::size_t block,
                        std::size_t channel);

/// What a single packet says about its sender.
struct Recognition {
  const Model* model = nullptr;  ///< Null when there is a doubt.
  std::string_view doubt;        ///< Static text; empty when the model is certain.
};

/// From flags and product id. In doubt: HDL-64E (S2 or S3 is decided by the status channel, not by
/// one packet), 0x23 (VLP-32A or VLP-32B), no product id (old firmware), ids and flags that
/// contradict each other.
[[nodiscard]] Recognition recognize(const DataPacket& packet);

/// From the first factory byte, 0 of old firmware counting as strongest. An HDL-64E has no such
/// byte: it sends two returns when its first and third block agree in azimuth (wrongly for a rotor
/// at rest), strongest otherwise.
[[nodiscard]] ReturnMode return_mode(const DataPacket& packet, const Model& model);

}  // namespace rigwire::protocols::velodyne

// Messages with a repeated part: a head and so many blocks, two structs of layout.h.
//
// A head that contains the number of its blocks has block_count(); that of others (MON-IO,
// CFG-RINV) follows from the length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// A decoded head and its blocks, which point into the frame and are read one by one.
template <class Head, class Block>
class Blocks {
 public:
  /// Precondition: the payload is as decode_blocks checks it.
  explicit Blocks(std::span<const std::uint8_t> payload)
      : head_(read_payload<Head>(payload)), blocks_(payload.subspan(Head::kLength)) {}

  [[nodiscard]] const Head& head() const { return head_; }
  [[nodiscard]] std::size_t size() const { return blocks_.size() / Block::kLength; }
  /// Precondition: index < size().
  [[nodiscard]] Block operator[](std::size_t index) const {
    return read_payload<Block>(blocks_.subspan(index * Block::kLength, Block::kLength));
  }

 private:
  Head head_;
  std::span<const std::uint8_t> blocks_;
};

/// Bytes of the frame with so many blocks.
template <class Head, class Block>
[[nodiscard]] constexpr std::size_t frame_size(std::size_t blocks) {
  return kOverheadBytes + Head::kLength + blocks * Block::kLength;
}

/// Malformed when class or id are another message's, or the length does not fit the blocks that the
/// head announces.
template <class Head, class Block>
[[nodiscard]] Decoded<Blocks<Head, Block>> decode_blocks(const FrameView& frame) {
  if (frame.id != Head::kId) {
    return Malformed{"another UBX message", 2};
  }
  const auto payload = frame.payload;
  if (payload.size() < Head::kLength || (payload.size() - Head::kLength) % Block::kLength != 0) {
    return Malformed{"UBX payload length", 4};
  }
  Blocks<Head, Block> blocks(payload);
  if constexpr (requires { blocks.head().block_count(); }) {
    if (blocks.head().block_count() != blocks.size()) {
      return Malformed{"UBX payload length and number of blocks", 4};
    }
  }
  return {blocks, kOverheadBytes + payload.size()};
}

/// Writes a whole frame into `out` and returns its size; 0 when `out` is too small, the payload
/// longer than 65535 bytes, or the head announces another number of blocks.
template <class Head, class Block>
[[nodiscard]] std::size_t encode_blocks(const Head& head, std::span<const Block> blocks,
                                        std::span<std::uint8_t> out) {
  const std::size_t total = frame_size<Head, Block>(blocks.size());
  if (total > out.size() || total - kOverheadBytes > 0xFFFF) {
    return 0;
  }
  if constexpr (requires { head.block_count(); }) {
    if (head.block_count() != blocks.size()) {
      return 0;
    }
  }
  write_payload(head, out.subspan(kHeaderBytes, Head::kLength));
  std::size_t at = kHeaderBytes + Head::kLength;
  for (const Block& block : blocks) {
    write_payload(block, out.subspan(at, Block::kLength));
    at += Block::kLength;
  }
  seal_frame(Head::kId, out.first(total));
  return total;
}

}  // namespace rigwire::protocols::ubx

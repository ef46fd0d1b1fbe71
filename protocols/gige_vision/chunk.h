// Chunks: data that a device appends to its pictures. Each is bytes followed by its tag, identifier
// (4) and length of the bytes (4), most significant byte first; so they are read from the end:
//
//   picture | id length | bytes | id length | ... | bytes | id length
//
// The picture is the first chunk. Lengths are multiples of 4. Source: Aravis 0.8.26,
// src/arvbuffer.c (arv_buffer_get_chunk_data).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace rigwire::protocols::gige_vision {

inline constexpr std::size_t kChunkTagSize = 4 + 4;  // identifier, length

struct ChunkTag {
  std::uint32_t id = 0;
  std::uint32_t length = 0;
};
/// Precondition: eight bytes of room. Returns eight.
std::size_t write_chunk_tag(std::span<std::uint8_t> out, const ChunkTag& tag);

struct Chunk {
  std::uint32_t id = 0;
  std::span<const std::uint8_t> bytes;
};

/// Reads the chunks of a payload, the last one first.
class ChunkReader {
 public:
  explicit ChunkReader(std::span<const std::uint8_t> payload) : rest_(payload) {}

  /// Nothing when there is no further one, or when what is left is no chunk.
  [[nodiscard]] std::optional<Chunk> next();
  /// What next() has not taken: not empty at the end when a tag claims more than there is.
  [[nodiscard]] std::span<const std::uint8_t> rest() const { return rest_; }

 private:
  std::span<const std::uint8_t> rest_;
};

}  // namespace rigwire::protocols::gige_vision

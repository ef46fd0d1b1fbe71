#include "protocols/gige_vision/chunk.h"

#include "protocols/bytes.h"

namespace rigwire::protocols::gige_vision {

std::size_t write_chunk_tag(std::span<std::uint8_t> out, const ChunkTag& tag) {
  store_big(out, 0, tag.id);
  store_big(out, 4, tag.length);
  return kChunkTagSize;
}

std::optional<Chunk> ChunkReader::next() {
  if (rest_.size() < kChunkTagSize) {
    return std::nullopt;
  }
  const std::size_t tag = rest_.size() - kChunkTagSize;
  const auto length = load_big<std::uint32_t>(rest_, tag + 4);
  if (length > tag) {
    return std::nullopt;
  }
  const Chunk chunk{load_big<std::uint32_t>(rest_, tag), rest_.subspan(tag - length, length)};
  rest_ = rest_.first(tag - length);
  return chunk;
}

}  // namespace rigwire::protocols::gige_vision

#include "emulators/nonvolatile_memory.h"

#include <algorithm>

#include "protocols/bytes.h"

namespace rigwire::emulators {
namespace {

using protocols::load_little;
using protocols::store_little;

constexpr std::size_t kHeaderBytes = 4 + 4 + 4;  // mark, length, checksum

std::uint32_t checksum(std::span<const std::uint8_t> bytes) {
  std::uint32_t first = 0xFFFF;
  std::uint32_t second = 0xFFFF;
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    const std::uint32_t high = i + 1 < bytes.size() ? bytes[i + 1] : 0U;
    first = (first + (bytes[i] | (high << 8U))) % 0xFFFFU;
    second = (second + first) % 0xFFFFU;
  }
  return (second << 16U) | first;
}

}  // namespace

std::vector<std::uint8_t> seal(std::uint32_t mark, std::span<const std::uint8_t> content) {
  std::vector<std::uint8_t> block(kHeaderBytes + content.size());
  store_little<std::uint32_t>(block, 0, mark);
  store_little<std::uint32_t>(block, 4, static_cast<std::uint32_t>(content.size()));
  store_little<std::uint32_t>(block, 8, checksum(content));
  std::copy(content.begin(), content.end(), block.begin() + kHeaderBytes);
  return block;
}

std::optional<std::span<const std::uint8_t>> unseal(std::uint32_t mark,
                                                    std::span<const std::uint8_t> block) {
  if (block.size() < kHeaderBytes || load_little<std::uint32_t>(block, 0) != mark ||
      load_little<std::uint32_t>(block, 4) != block.size() - kHeaderBytes) {
    return std::nullopt;
  }
  const auto content = block.subspan(kHeaderBytes);
  if (load_little<std::uint32_t>(block, 8) != checksum(content)) {
    return std::nullopt;
  }
  return content;
}

}  // namespace rigwire::emulators

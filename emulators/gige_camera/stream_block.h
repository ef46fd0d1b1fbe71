// One block of the stream: a picture, what is appended to it, and how it is divided into packets.
// The picture is shared, not copied; any packet can be made again as long as the block is kept.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "protocols/gige_vision/gvsp.h"
#include "sim/samples/picture_sample.h"

namespace rigwire::emulators {

class StreamBlock {
 public:
  static constexpr std::size_t kPartsMaximum = 8;
  static constexpr std::size_t kChunkBytes = 128;

  StreamBlock() = default;

  std::shared_ptr<const Picture> picture;
  std::array<std::uint8_t, kPartsMaximum> parts{};  ///< Indices of the picture's parts.
  std::array<std::uint16_t, kPartsMaximum> purposes{};
  std::size_t part_count = 0;
  std::array<std::uint8_t, kChunkBytes> chunks{};  ///< After the last part.
  std::size_t chunk_bytes = 0;
  std::uint32_t chunk_layout = 0;
  std::uint64_t number = 0;  ///< From 1; 0: no block.
  std::uint64_t timestamp = 0;
  bool multipart = false;
  bool extended_ids = false;
  std::uint32_t packet_size = 0;  ///< With IP and UDP headers.
  std::uint32_t next = 0;         ///< First packet that has not been sent.

  /// Computed when all the above is set: number of packets, leader and trailer included.
  void divide();
  [[nodiscard]] std::uint32_t packets() const { return packets_; }
  [[nodiscard]] bool sent() const { return next >= packets_; }

  /// Writes packet `index` and returns its length. Precondition: index < packets(), room for a
  /// packet in `out`.
  std::size_t write(std::uint32_t index, protocols::gige_vision::Status status,
                    std::span<std::uint8_t> out) const;

 private:
  [[nodiscard]] const PicturePart& part(std::size_t index) const {
    return picture->parts[parts[index]];
  }
  /// Bytes of a section: a part, or behind the last one the chunks.
  [[nodiscard]] std::span<const std::uint8_t> section(std::size_t index) const;
  [[nodiscard]] std::size_t sections() const { return part_count + (chunk_bytes > 0 ? 1 : 0); }
  [[nodiscard]] std::size_t room() const;
  std::size_t write_leader(std::span<std::uint8_t> out) const;
  std::size_t write_image_payload(std::uint32_t index, std::span<std::uint8_t> out) const;
  std::size_t write_multipart_payload(std::uint32_t index, std::span<std::uint8_t> out) const;
  std::size_t write_trailer(std::span<std::uint8_t> out) const;

  std::uint32_t packets_ = 0;
  std::uint64_t payload_bytes_ = 0;
};

}  // namespace rigwire::emulators

// GigE Vision streaming protocol (GVSP): blocks (a picture each) of a leader, payload packets and a
// trailer, every packet one UDP datagram. All integers are most significant byte first; what the
// pixels hold is the pixel format's.
//
//   header, short identifiers:     status (2), block (2), format (1), packet (3)
//   header, extended identifiers:  status (2), flags (2), 0x80 | format (1), 0 (2), parts (1),
//                                  block (8), packet (4)
//
// Blocks are numbered from 1; 0 is no block, so that short numbers go 65535, 1. Packet 0 is the
// leader, packets 1 .. n the payload, packet n + 1 the trailer. `parts` is other than 0 only in the
// leader of a multi-part block: such blocks need extended identifiers, since with short ones the
// same bits are the packet's number.
//
//   leader, image:       flags (2), payload type (2), timestamp (8), pixel format (4), width (4),
//                        height (4), offset x (4), offset y (4), padding x (2), padding y (2)
//   leader, multi-part:  flags (2), payload type (2), timestamp (8), then for each part: data type
//                        (2), length (6), pixel format (4), 0 (2), source (1), zones (1), zone
//                        directions (4), purpose (2), region (2), width (4), height (4), offset x
//                        (4), offset y (4), padding x (2), padding y (2), 0 (4)
//   payload:             bytes of the picture; packet k of an image begins at (k - 1) * room, and
//                        only the last is shorter: receivers compute positions from the packet size
//   payload, multi-part: part (1), zone (1), offset (6), bytes of that part alone
//   trailer, image:      0 (2), payload type (2), height (4)
//   trailer, multi-part: 0 (2), payload type (2)
//   trailer with chunks: in addition length of the payload with its chunks (4), layout (4)
//
// The offset of a multi-part packet counts in the whole payload, parts one after the other: so does
// Aravis (arvgvstream.c) read it.
//
// The packet size that a client sets (SCPS) is that of the IP packet: 28 bytes of IP and UDP
// headers, the header above, then `room` bytes.
//
// Which identifiers. Cameras of GigE Vision 2.x can do both and start with the short ones, so that
// clients of 1.x read them; a client asks for the others by bit 30 of register 0x0960. Aravis 0.8
// reads both and never asks. The writer here does both.
//
// Sources: Aravis 0.8.26 (src/arvgvsp.c, arvgvspprivate.h, arvgvstream.c), Wireshark 4.0
// (packet-gvsp.c).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocols/gige_vision/gvcp.h"
#include "protocols/gige_vision/pixel_format.h"
#include "protocols/gige_vision/status.h"
#include "protocols/result.h"

namespace rigwire::protocols::gige_vision {

enum class PacketFormat : std::uint8_t {
  leader = 1,
  trailer = 2,
  payload = 3,
  multipart = 7,  ///< Payload of a multi-part block.
};

struct PayloadType {
  static constexpr std::uint16_t kImage = 0x0001;
  static constexpr std::uint16_t kMultipart = 0x000A;
  static constexpr std::uint16_t kWithChunks = 0x4000;  ///< Added to either.
};

struct PacketHeader {
  Status status = Status::success;
  std::uint16_t flags = 0;  ///< Extended identifiers only.
  bool extended_ids = false;
  PacketFormat format = PacketFormat::payload;
  std::uint8_t parts = 0;    ///< Extended identifiers only.
  std::uint64_t block = 1;   ///< 1 .. 65535 with short identifiers.
  std::uint32_t packet = 0;  ///< Below 2^24 with short identifiers.

  friend bool operator==(const PacketHeader&, const PacketHeader&) = default;
};
/// Bits of PacketHeader::flags.
struct PacketFlag {
  static constexpr std::uint16_t kResent = 0x0001;
};

inline constexpr std::size_t kShortHeaderSize = 2 + 2 + 1 + 3;
inline constexpr std::size_t kExtendedHeaderSize = 2 + 2 + 1 + 3 + 8 + 4;
[[nodiscard]] constexpr std::size_t packet_header_size(bool extended_ids) {
  return extended_ids ? kExtendedHeaderSize : kShortHeaderSize;
}
inline constexpr std::size_t kMultipartHeaderSize = 1 + 1 + 6;  // part, zone, offset

inline constexpr std::size_t kImageLeaderSize = 2 + 2 + 8 + 4 + 4 + 4 + 4 + 4 + 2 + 2;
inline constexpr std::size_t kMultipartLeaderSize = 2 + 2 + 8;
inline constexpr std::size_t kPartSize =
    2 + 6 + 4 + 2 + 1 + 1 + 4 + 2 + 2 + 4 + 4 + 4 + 4 + 2 + 2 + 4;
inline constexpr std::size_t kPartsMaximum = 255;
inline constexpr std::size_t kTrailerChunkSize = 4 + 4;
static_assert(kShortHeaderSize == 8 && kExtendedHeaderSize == 20 && kImageLeaderSize == 36 &&
              kPartSize == 48);

/// The short number of a block: 1 .. 65535, then 1 again. Precondition: block > 0.
[[nodiscard]] constexpr std::uint16_t short_block(std::uint64_t block) {
  return static_cast<std::uint16_t>((block - 1) % 0xFFFFU + 1);
}

/// Bytes of the picture in each packet of a stream whose packets have `packet_size` bytes with IP
/// and UDP headers. Precondition: there is room for at least one.
[[nodiscard]] constexpr std::size_t payload_room(std::size_t packet_size, bool extended_ids,
                                                 bool multipart) {
  const std::size_t headers =
      kIpUdpHeaders + packet_header_size(extended_ids) + (multipart ? kMultipartHeaderSize : 0);
  assert(packet_size > headers);
  return packet_size - headers;
}

struct ImageLeader {
  bool with_chunks = false;
  std::uint64_t timestamp = 0;  ///< Ticks of the device's clock, at the start of the exposure.
  PixelFormatCode format = PixelFormatCode::mono8;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t offset_x = 0;
  std::uint32_t offset_y = 0;
  std::uint16_t padding_x = 0;  ///< Bytes after each line.
  std::uint16_t padding_y = 0;  ///< Bytes after the last line.

  friend bool operator==(const ImageLeader&, const ImageLeader&) = default;
};

/// What a part is.
enum class DataType : std::uint16_t {
  image_2d = 1,
  image_3d = 5,
  confidence = 9,
  chunks = 10,
};

struct PartLeader {
  DataType type = DataType::image_2d;
  std::uint64_t length = 0;  ///< Bytes, below 2^48.
  PixelFormatCode format = PixelFormatCode::mono8;
  std::uint8_t source = 0;
  std::uint16_t purpose = 0;  ///< Identifier of the component (ComponentIDValue).
  std::uint16_t region = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t offset_x = 0;
  std::uint32_t offset_y = 0;
  std::uint16_t padding_x = 0;
  std::uint16_t padding_y = 0;

  friend bool operator==(const PartLeader&, const PartLeader&) = default;
};

struct ChunkTrailer {
  std::uint32_t payload_length = 0;  ///< Bytes of pictures and chunks together.
  std::uint32_t layout = 0;          ///< Identifier that changes when the set of chunks changes.

  friend bool operator==(const ChunkTrailer&, const ChunkTrailer&) = default;
};
struct Trailer {
  bool multipart = false;
  std::uint32_t height = 0;  ///< Lines sent of an image. 0 for a multi-part block.
  std::optional<ChunkTrailer> chunks;

  friend bool operator==(const Trailer&, const Trailer&) = default;
};

// --- Writing: each function fills the beginning of `out` and returns how many bytes. Precondition:
// there is room. ---

std::size_t write_header(std::span<std::uint8_t> out, const PacketHeader& header);
std::size_t write_image_leader(std::span<std::uint8_t> out, const ImageLeader& leader);
std::size_t write_multipart_leader(std::span<std::uint8_t> out, bool with_chunks,
                                   std::uint64_t timestamp, std::span<const PartLeader> parts);
std::size_t write_multipart_header(std::span<std::uint8_t> out, std::uint8_t part,
                                   std::uint64_t offset);
std::size_t write_trailer(std::span<std::uint8_t> out, const Trailer& trailer);

// --- Reading. ---

struct StreamPacket {
  PacketHeader header;
  std::span<const std::uint8_t> payload;  ///< Empty when the status is an error.
};
/// Malformed: a format that is none of PacketFormat, or the block 0.
[[nodiscard]] Decoded<StreamPacket> decode_stream_packet(std::span<const std::uint8_t> datagram);

struct MultipartLeader {
  bool with_chunks = false;
  std::uint64_t timestamp = 0;
  std::vector<PartLeader> parts;
};
/// The payload type of a leader or trailer. Incomplete below four bytes.
[[nodiscard]] Decoded<std::uint16_t> decode_payload_type(std::span<const std::uint8_t> payload);
/// Malformed when the payload type is no image.
[[nodiscard]] Decoded<ImageLeader> decode_image_leader(std::span<const std::uint8_t> payload);
/// Malformed when the payload type is no multi-part block. `parts` is the header's.
[[nodiscard]] Decoded<MultipartLeader> decode_multipart_leader(
    std::span<const std::uint8_t> payload, std::uint8_t parts);
struct MultipartPayload {
  std::uint8_t part = 0;
  std::uint64_t offset = 0;
  std::span<const std::uint8_t> bytes;
};
[[nodiscard]] Decoded<MultipartPayload> decode_multipart_payload(
    std::span<const std::uint8_t> payload);
[[nodiscard]] Decoded<Trailer> decode_trailer(std::span<const std::uint8_t> payload);

}  // namespace rigwire::protocols::gige_vision

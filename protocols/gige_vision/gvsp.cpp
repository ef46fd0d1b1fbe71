#include "protocols/gige_vision/gvsp.h"

#include <algorithm>
#include <cassert>

#include "protocols/bytes.h"

namespace rigwire::protocols::gige_vision {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint8_t kExtended = 0x80;
constexpr std::uint32_t kPacketMask = 0x00FF'FFFF;
constexpr std::uint64_t k48Bits = (std::uint64_t{1} << 48U) - 1;

// Offsets in the header.
constexpr std::size_t kBlockStatusAt = 0;
constexpr std::size_t kBlockAt = 2;       // short identifiers
constexpr std::size_t kBlockFlagsAt = 2;  // extended identifiers
constexpr std::size_t kFormatAt = 4;
constexpr std::size_t kExtendedPartsAt = 7;
constexpr std::size_t kExtendedBlockAt = 8;
constexpr std::size_t kExtendedPacketAt = 16;

// Offsets in leaders and trailers.
constexpr std::size_t kPayloadTypeAt = 2;
constexpr std::size_t kTimestampAt = 4;
constexpr std::size_t kImageFormatAt = 12;
constexpr std::size_t kImageGeometryAt = 16;
constexpr std::size_t kTrailerHeightAt = 4;

// Offsets in a part.
constexpr std::size_t kPartTypeAt = 0;  // with the length in one word of 64 bits
constexpr std::size_t kPartFormatAt = 8;
constexpr std::size_t kPartSourceAt = 14;
constexpr std::size_t kPartPurposeAt = 20;
constexpr std::size_t kPartRegionAt = 22;
constexpr std::size_t kPartGeometryAt = 24;

std::uint64_t long_word(Bytes bytes, std::size_t at) {
  return load_big<std::uint64_t>(bytes, at);
}

/// Width to padding, which image leaders and parts have in common.
template <class Leader>
void write_geometry(std::span<std::uint8_t> out, const Leader& leader) {
  store_big(out, 0, leader.width);
  store_big(out, 4, leader.height);
  store_big(out, 8, leader.offset_x);
  store_big(out, 12, leader.offset_y);
  store_big(out, 16, leader.padding_x);
  store_big(out, 18, leader.padding_y);
}
template <class Leader>
void read_geometry(Bytes bytes, Leader& leader) {
  leader.width = load_big<std::uint32_t>(bytes, 0);
  leader.height = load_big<std::uint32_t>(bytes, 4);
  leader.offset_x = load_big<std::uint32_t>(bytes, 8);
  leader.offset_y = load_big<std::uint32_t>(bytes, 12);
  leader.padding_x = load_big<std::uint16_t>(bytes, 16);
  leader.padding_y = load_big<std::uint16_t>(bytes, 18);
}

void write_type(std::span<std::uint8_t> out, std::uint16_t type, bool with_chunks) {
  store_big(out, 0, std::uint16_t{0});
  store_big(out, kPayloadTypeAt,
            static_cast<std::uint16_t>(type | (with_chunks ? PayloadType::kWithChunks : 0)));
}

bool has_chunks(std::uint16_t type) {
  return (type & PayloadType::kWithChunks) != 0;
}
std::uint16_t plain(std::uint16_t type) {
  return static_cast<std::uint16_t>(type & ~PayloadType::kWithChunks);
}

PartLeader read_part(Bytes bytes) {
  PartLeader part;
  const std::uint64_t type_and_length = long_word(bytes, kPartTypeAt);
  part.type = static_cast<DataType>(type_and_length >> 48U);
  part.length = type_and_length & k48Bits;
  part.format = static_cast<PixelFormatCode>(load_big<std::uint32_t>(bytes, kPartFormatAt));
  part.source = bytes[kPartSourceAt];
  part.purpose = load_big<std::uint16_t>(bytes, kPartPurposeAt);
  part.region = load_big<std::uint16_t>(bytes, kPartRegionAt);
  read_geometry(bytes.subspan(kPartGeometryAt), part);
  return part;
}

void write_part(std::span<std::uint8_t> out, const PartLeader& part) {
  std::ranges::fill(out.first(kPartSize), std::uint8_t{0});
  store_big(out, kPartTypeAt,
            static_cast<std::uint64_t>(part.type) << 48U | (part.length & k48Bits));
  store_big(out, kPartFormatAt, static_cast<std::uint32_t>(part.format));
  out[kPartSourceAt] = part.source;
  store_big(out, kPartPurposeAt, part.purpose);
  store_big(out, kPartRegionAt, part.region);
  write_geometry(out.subspan(kPartGeometryAt), part);
}

}  // namespace

std::size_t write_header(std::span<std::uint8_t> out, const PacketHeader& header) {
  store_big(out, kBlockStatusAt, static_cast<std::uint16_t>(header.status));
  const auto format = static_cast<std::uint8_t>(header.format);
  if (!header.extended_ids) {
    store_big(out, kBlockAt, static_cast<std::uint16_t>(header.block));
    store_big(out, kFormatAt, std::uint32_t{format} << 24U | (header.packet & kPacketMask));
    return kShortHeaderSize;
  }
  store_big(out, kBlockFlagsAt, header.flags);
  store_big(out, kFormatAt,
            static_cast<std::uint32_t>(kExtended | format) << 24U | std::uint32_t{header.parts});
  store_big(out, kExtendedBlockAt, header.block);
  store_big(out, kExtendedPacketAt, header.packet);
  return kExtendedHeaderSize;
}

std::size_t write_image_leader(std::span<std::uint8_t> out, const ImageLeader& leader) {
  write_type(out, PayloadType::kImage, leader.with_chunks);
  store_big(out, kTimestampAt, leader.timestamp);
  store_big(out, kImageFormatAt, static_cast<std::uint32_t>(leader.format));
  write_geometry(out.subspan(kImageGeometryAt), leader);
  return kImageLeaderSize;
}

std::size_t write_multipart_leader(std::span<std::uint8_t> out, bool with_chunks,
                                   std::uint64_t timestamp, std::span<const PartLeader> parts) {
  assert(parts.size() <= kPartsMaximum);
  write_type(out, PayloadType::kMultipart, with_chunks);
  store_big(out, kTimestampAt, timestamp);
  std::size_t at = kMultipartLeaderSize;
  for (const PartLeader& part : parts) {
    write_part(out.subspan(at), part);
    at += kPartSize;
  }
  return at;
}

std::size_t write_multipart_header(std::span<std::uint8_t> out, std::uint8_t part,
                                   std::uint64_t offset) {
  store_big(out, 0, std::uint64_t{part} << 56U | (offset & k48Bits));
  return kMultipartHeaderSize;
}

std::size_t write_trailer(std::span<std::uint8_t> out, const Trailer& trailer) {
  write_type(out, trailer.multipart ? PayloadType::kMultipart : PayloadType::kImage,
             trailer.chunks.has_value());
  std::size_t at = kTrailerHeightAt;
  if (!trailer.multipart) {
    store_big(out, at, trailer.height);
    at += 4;
  }
  if (trailer.chunks) {
    store_big(out, at, trailer.chunks->payload_length);
    store_big(out, at + 4, trailer.chunks->layout);
    at += kTrailerChunkSize;
  }
  return at;
}

Decoded<StreamPacket> decode_stream_packet(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < kShortHeaderSize) {
    return Incomplete{kShortHeaderSize, datagram.size()};
  }
  PacketHeader header;
  header.status = static_cast<Status>(load_big<std::uint16_t>(datagram, kBlockStatusAt));
  header.extended_ids = (datagram[kFormatAt] & kExtended) != 0;
  const std::size_t size = packet_header_size(header.extended_ids);
  if (datagram.size() < size) {
    return Incomplete{size, datagram.size()};
  }
  header.format = static_cast<PacketFormat>(datagram[kFormatAt] & ~kExtended);
  switch (header.format) {
    case PacketFormat::leader:
    case PacketFormat::trailer:
    case PacketFormat::payload:
    case PacketFormat::multipart:
      break;
    default:
      return Malformed{"a packet is a leader, a trailer or payload", kFormatAt};
  }
  if (header.extended_ids) {
    header.flags = load_big<std::uint16_t>(datagram, kBlockFlagsAt);
    header.parts = datagram[kExtendedPartsAt];
    header.block = long_word(datagram, kExtendedBlockAt);
    header.packet = load_big<std::uint32_t>(datagram, kExtendedPacketAt);
  } else {
    header.block = load_big<std::uint16_t>(datagram, kBlockAt);
    header.packet = load_big<std::uint32_t>(datagram, kFormatAt) & kPacketMask;
  }
  if (header.block == 0) {
    return Malformed{"blocks are numbered from 1",
                     header.extended_ids ? kExtendedBlockAt : kBlockAt};
  }
  return {StreamPacket{header, datagram.subspan(size)}, datagram.size()};
}

Decoded<std::uint16_t> decode_payload_type(std::span<const std::uint8_t> payload) {
  constexpr std::size_t kNeeded = kPayloadTypeAt + 2;
  if (payload.size() < kNeeded) {
    return Incomplete{kNeeded, payload.size()};
  }
  return {load_big<std::uint16_t>(payload, kPayloadTypeAt), kNeeded};
}

Decoded<ImageLeader> decode_image_leader(std::span<const std::uint8_t> payload) {
  if (payload.size() < kImageLeaderSize) {
    return Incomplete{kImageLeaderSize, payload.size()};
  }
  const std::uint16_t type = load_big<std::uint16_t>(payload, kPayloadTypeAt);
  if (plain(type) != PayloadType::kImage) {
    return Malformed{"payload type is no image", kPayloadTypeAt};
  }
  ImageLeader leader;
  leader.with_chunks = has_chunks(type);
  leader.timestamp = long_word(payload, kTimestampAt);
  leader.format = static_cast<PixelFormatCode>(load_big<std::uint32_t>(payload, kImageFormatAt));
  read_geometry(payload.subspan(kImageGeometryAt), leader);
  return {leader, kImageLeaderSize};
}

Decoded<MultipartLeader> decode_multipart_leader(std::span<const std::uint8_t> payload,
                                                 std::uint8_t parts) {
  const std::size_t size = kMultipartLeaderSize + parts * kPartSize;
  if (payload.size() < size) {
    return Incomplete{size, payload.size()};
  }
  const std::uint16_t type = load_big<std::uint16_t>(payload, kPayloadTypeAt);
  if (plain(type) != PayloadType::kMultipart) {
    return Malformed{"payload type is not multi-part", kPayloadTypeAt};
  }
  MultipartLeader leader;
  leader.with_chunks = has_chunks(type);
  leader.timestamp = long_word(payload, kTimestampAt);
  for (std::size_t i = 0; i < parts; ++i) {
    leader.parts.push_back(read_part(payload.subspan(kMultipartLeaderSize + i * kPartSize)));
  }
  return {std::move(leader), size};
}

Decoded<MultipartPayload> decode_multipart_payload(std::span<const std::uint8_t> payload) {
  if (payload.size() < kMultipartHeaderSize) {
    return Incomplete{kMultipartHeaderSize, payload.size()};
  }
  return {MultipartPayload{payload[0], long_word(payload, 0) & k48Bits,
                           payload.subspan(kMultipartHeaderSize)},
          payload.size()};
}

Decoded<Trailer> decode_trailer(std::span<const std::uint8_t> payload) {
  std::size_t size = kTrailerHeightAt;
  if (payload.size() < size) {
    return Incomplete{size, payload.size()};
  }
  const std::uint16_t type = load_big<std::uint16_t>(payload, kPayloadTypeAt);
  Trailer trailer;
  trailer.multipart = plain(type) == PayloadType::kMultipart;
  if (!trailer.multipart && plain(type) != PayloadType::kImage) {
    return Malformed{"payload type is neither image nor multi-part", kPayloadTypeAt};
  }
  size += (trailer.multipart ? 0 : 4) + (has_chunks(type) ? kTrailerChunkSize : 0);
  if (payload.size() < size) {
    return Incomplete{size, payload.size()};
  }
  if (!trailer.multipart) {
    trailer.height = load_big<std::uint32_t>(payload, kTrailerHeightAt);
  }
  if (has_chunks(type)) {
    trailer.chunks = ChunkTrailer{load_big<std::uint32_t>(payload, size - 8),
                                  load_big<std::uint32_t>(payload, size - 4)};
  }
  return {trailer, size};
}

}  // namespace rigwire::protocols::gige_vision

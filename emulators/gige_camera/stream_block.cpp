#include "emulators/gige_camera/stream_block.h"

#include <algorithm>
#include <cassert>

#include "emulators/gige_camera/camera_features.h"

namespace rigwire::emulators {
namespace {

namespace gev = protocols::gige_vision;

gev::DataType data_type(PictureComponent component) {
  switch (component) {
    case PictureComponent::intensity:
      return gev::DataType::image_2d;
    case PictureComponent::disparity:
    case PictureComponent::range:
      return gev::DataType::image_3d;
    case PictureComponent::confidence:
      return gev::DataType::confidence;
  }
  return gev::DataType::image_2d;
}

/// Geometry and format, which the leader of an image and that of a part have in common.
template <class Leader>
void describe(const PicturePart& part, Leader& leader) {
  leader.format = pixel_format_code(part.format);
  leader.width = static_cast<std::uint32_t>(part.region.width);
  leader.height = static_cast<std::uint32_t>(part.region.height);
  leader.offset_x = static_cast<std::uint32_t>(part.region.offset_x);
  leader.offset_y = static_cast<std::uint32_t>(part.region.offset_y);
}

std::uint32_t divided(std::size_t bytes, std::size_t room) {
  return static_cast<std::uint32_t>((bytes + room - 1) / room);
}

}  // namespace

std::span<const std::uint8_t> StreamBlock::section(std::size_t index) const {
  return index < part_count ? std::span<const std::uint8_t>(part(index).bytes)
                            : std::span(chunks).first(chunk_bytes);
}

std::size_t StreamBlock::room() const {
  return gev::payload_room(packet_size, extended_ids, multipart);
}

void StreamBlock::divide() {
  payload_bytes_ = 0;
  std::uint32_t packets = 0;
  // A packet of a multi-part block carries one part alone.
  for (std::size_t i = 0; i < sections(); ++i) {
    payload_bytes_ += section(i).size();
    packets += divided(section(i).size(), room());
  }
  if (!multipart) {
    packets = divided(payload_bytes_, room());
  }
  packets_ = 1 + packets + 1;  // leader, payload, trailer
}

std::size_t StreamBlock::write(std::uint32_t index, gev::Status status,
                               std::span<std::uint8_t> out) const {
  assert(index < packets_);
  gev::PacketHeader header;
  header.status = status;
  header.extended_ids = extended_ids;
  header.block = extended_ids ? number : gev::short_block(number);
  header.packet = index;
  if (index == 0) {
    header.format = gev::PacketFormat::leader;
    header.parts = multipart ? static_cast<std::uint8_t>(sections()) : std::uint8_t{0};
  } else if (index == packets_ - 1) {
    header.format = gev::PacketFormat::trailer;
  } else {
    header.format = multipart ? gev::PacketFormat::multipart : gev::PacketFormat::payload;
  }
  if (status == gev::Status::packet_resent && extended_ids) {
    header.flags = gev::PacketFlag::kResent;
  }
  const std::size_t size = gev::write_header(out, header);
  const std::span<std::uint8_t> rest = out.subspan(size);
  switch (header.format) {
    case gev::PacketFormat::leader:
      return size + write_leader(rest);
    case gev::PacketFormat::trailer:
      return size + write_trailer(rest);
    case gev::PacketFormat::payload:
      return size + write_image_payload(index, rest);
    case gev::PacketFormat::multipart:
      return size + write_multipart_payload(index, rest);
  }
  return size;
}

std::size_t StreamBlock::write_leader(std::span<std::uint8_t> out) const {
  if (!multipart) {
    gev::ImageLeader leader;
    leader.with_chunks = chunk_bytes > 0;
    leader.timestamp = timestamp;
    describe(part(0), leader);
    return gev::write_image_leader(out, leader);
  }
  std::array<gev::PartLeader, kPartsMaximum + 1> leaders{};
  for (std::size_t i = 0; i < part_count; ++i) {
    leaders[i].type = data_type(part(i).component);
    leaders[i].length = part(i).bytes.size();
    leaders[i].source = part(i).source;
    leaders[i].purpose = purposes[i];
    describe(part(i), leaders[i]);
  }
  if (chunk_bytes > 0) {
    leaders[part_count].type = gev::DataType::chunks;
    leaders[part_count].length = chunk_bytes;
  }
  return gev::write_multipart_leader(out, chunk_bytes > 0, timestamp,
                                     std::span(leaders).first(sections()));
}

std::size_t StreamBlock::write_image_payload(std::uint32_t index,
                                             std::span<std::uint8_t> out) const {
  std::size_t from = (index - 1) * room();
  std::size_t done = 0;
  // The image and its chunks are one row of bytes.
  for (std::size_t i = 0; i < sections() && done < room(); ++i) {
    const std::span<const std::uint8_t> bytes = section(i);
    if (from < bytes.size()) {
      const std::size_t count = std::min(bytes.size() - from, room() - done);
      std::ranges::copy(bytes.subspan(from, count), out.subspan(done).begin());
      done += count;
      from = 0;
    } else {
      from -= bytes.size();
    }
  }
  return done;
}

std::size_t StreamBlock::write_multipart_payload(std::uint32_t index,
                                                 std::span<std::uint8_t> out) const {
  std::uint32_t packet = index - 1;
  std::uint64_t before = 0;
  std::size_t i = 0;
  for (; packet >= divided(section(i).size(), room()); ++i) {
    packet -= divided(section(i).size(), room());
    before += section(i).size();
  }
  const std::size_t from = packet * room();
  const std::size_t header =
      gev::write_multipart_header(out, static_cast<std::uint8_t>(i), before + from);
  const std::size_t count = std::min(room(), section(i).size() - from);
  std::ranges::copy(section(i).subspan(from, count), out.subspan(header).begin());
  return header + count;
}

std::size_t StreamBlock::write_trailer(std::span<std::uint8_t> out) const {
  gev::Trailer trailer;
  trailer.multipart = multipart;
  trailer.height = multipart ? 0 : static_cast<std::uint32_t>(part(0).region.height);
  if (chunk_bytes > 0) {
    trailer.chunks = gev::ChunkTrailer{static_cast<std::uint32_t>(payload_bytes_), chunk_layout};
  }
  return gev::write_trailer(out, trailer);
}

}  // namespace rigwire::emulators

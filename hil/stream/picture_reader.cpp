#include "hil/stream/picture_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rigwire::hil {
namespace {

namespace gige = protocols::gige_vision;
using Code = gige::PixelFormatCode;

bool is_bayer(Code code) {
  return code == Code::bayer_rg8 || code == Code::bayer_rg10 || code == Code::bayer_rg12 ||
         code == Code::bayer_rg16;
}

/// Significant bits of a sample; 0: no picture to look at.
unsigned depth_of(Code code) {
  switch (code) {
    case Code::mono8:
    case Code::bayer_rg8:
    case Code::rgb8:
      return 8;
    case Code::mono10:
    case Code::bayer_rg10:
      return 10;
    case Code::mono12:
    case Code::bayer_rg12:
      return 12;
    case Code::mono16:
    case Code::bayer_rg16:
    case Code::coord3d_c16:
      return 16;
    default:
      return 0;
  }
}

/// Returns the grey of a coordinate's value in a picture: linear between black and white, 0 if the
/// value is invalid.
unsigned grey_of(const CoordinateScale& scale, unsigned value) {
  if (value == scale.coding.invalid) {
    return 0;
  }
  const double coordinate = scale.coding.offset + scale.coding.scale * value;
  const double share = (coordinate - scale.black) / (scale.white - scale.black);
  return static_cast<unsigned>(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
}

std::size_t line_bytes(const gige::PartLeader& part) {
  return std::size_t{part.width} * gige::bits_per_pixel(part.format) / 8 + part.padding_x;
}

}  // namespace

const SmallPicture* PictureReader::take(SimTime at, std::span<const std::uint8_t> datagram) {
  const auto packet = gige::decode_stream_packet(datagram);
  if (!packet.ok() || packet->header.status != gige::Status::success) {
    return nullptr;
  }
  if (packet->header.format == gige::PacketFormat::leader) {
    if (at >= next_) {
      begin(at, *packet);
    }
  } else if (block_ == packet->header.block) {
    if (packet->header.format != gige::PacketFormat::trailer) {
      add(*packet);
    } else if (end()) {
      return &small_;
    }
  }
  return nullptr;
}

void PictureReader::begin(SimTime at, const gige::StreamPacket& packet) {
  block_.reset();
  const auto type = gige::decode_payload_type(packet.payload);
  if (!type.ok()) {
    return;
  }
  multipart_ = (*type & ~gige::PayloadType::kWithChunks) == gige::PayloadType::kMultipart;
  part_ = {};
  part_number_ = 0;
  part_from_ = 0;
  if (multipart_) {
    const auto leader = gige::decode_multipart_leader(packet.payload, packet.header.parts);
    if (!leader.ok()) {
      return;
    }
    // An image before a map of disparities or distances, whatever the client takes.
    auto part = std::ranges::find(leader->parts, gige::DataType::image_2d, &gige::PartLeader::type);
    if (part == leader->parts.end()) {
      part = std::ranges::find_if(
          leader->parts, [this](const gige::PartLeader& each) { return can_show(each.format); });
    }
    if (part == leader->parts.end()) {
      return;
    }
    part_number_ = static_cast<std::size_t>(part - leader->parts.begin());
    for (auto before = leader->parts.begin(); before != part; ++before) {
      part_from_ += before->length;
    }
    part_ = *part;
  } else {
    const auto leader = gige::decode_image_leader(packet.payload);
    if (!leader.ok()) {
      return;
    }
    part_.format = leader->format;
    part_.width = leader->width;
    part_.height = leader->height;
    part_.padding_x = leader->padding_x;
  }
  const std::size_t size = line_bytes(part_) * part_.height;
  if (!can_show(part_.format) || size == 0 || part_.width > kMostBytes ||
      part_.height > kMostBytes || size > kMostBytes) {
    return;
  }
  bytes_.resize(size);
  come_ = 0;
  room_ = 0;
  last_ = 0;
  block_ = packet.header.block;
  next_ = at + kEvery;
}

void PictureReader::add(const gige::StreamPacket& packet) {
  if (packet.header.packet <= last_) {
    return;  // sent again
  }
  last_ = packet.header.packet;
  if (multipart_) {
    const auto told = gige::decode_multipart_payload(packet.payload);
    if (told.ok() && told->part == part_number_ && told->offset >= part_from_) {
      place(told->offset - part_from_, told->bytes);
    }
    return;
  }
  // The last one alone may be shorter; it is not the first, or there is no other.
  room_ = room_ == 0 ? packet.payload.size() : room_;
  place((packet.header.packet - 1) * room_, packet.payload);
}

void PictureReader::place(std::size_t from, std::span<const std::uint8_t> bytes) {
  if (from < bytes_.size()) {
    const auto part = bytes.first(std::min(bytes.size(), bytes_.size() - from));
    std::ranges::copy(part, bytes_.begin() + static_cast<std::ptrdiff_t>(from));
    come_ += part.size();
  }
}

bool PictureReader::can_show(Code format) const {
  return depth_of(format) != 0 && (format != Code::coord3d_c16 || scale_);
}

bool PictureReader::end() {
  small_.block = *block_;
  block_.reset();
  return come_ == bytes_.size() && make_small();
}

bool PictureReader::make_small() {
  const bool bayer = is_bayer(part_.format);
  const bool coloured = bayer || part_.format == Code::rgb8;
  // One cell of four pixels of a mosaic has all colours and makes one pixel.
  const std::uint32_t cell = bayer ? 2 : 1;
  const std::uint32_t columns = part_.width / cell;
  const std::uint32_t rows = part_.height / cell;
  if (columns == 0 || rows == 0) {
    return false;
  }
  const std::uint32_t every = (columns + kMostWidth - 1) / kMostWidth;
  const unsigned depth = depth_of(part_.format);
  const std::size_t sample = depth > 8 ? 2 : 1;
  const std::size_t line = line_bytes(part_);
  // More than eight bits lie in two bytes, the low one first.
  const auto value_at = [&](std::uint32_t x, std::uint32_t y, std::size_t band, std::size_t bands) {
    const std::size_t place = y * line + (x * bands + band) * sample;
    return sample == 1 ? unsigned{bytes_[place]}
                       : bytes_[place] | unsigned{bytes_[place + 1]} << 8U;
  };
  // The highest eight bits of brightness; coordinates between the limits of their scale.
  const CoordinateScale* const scale = part_.format == Code::coord3d_c16 ? &*scale_ : nullptr;
  const auto at = [&](std::uint32_t x, std::uint32_t y, std::size_t band, std::size_t bands) {
    const unsigned value = value_at(x, y, band, bands);
    return static_cast<std::uint8_t>(scale != nullptr ? grey_of(*scale, value)
                                                      : value >> (depth - 8));
  };
  small_.remark = scale == nullptr
                      ? std::string()
                      : fmt::format("{}: black {:g} {}, white {:g} {}", scale->quantity,
                                    scale->black, scale->unit, scale->white, scale->unit);
  small_.sent_width = part_.width;
  small_.sent_height = part_.height;
  small_.width = (columns + every - 1) / every;
  small_.height = (rows + every - 1) / every;
  small_.encoding = coloured ? "rgb8" : "mono8";
  small_.pixels.clear();
  for (std::uint32_t row = 0; row < small_.height; ++row) {
    for (std::uint32_t column = 0; column < small_.width; ++column) {
      const std::uint32_t x = column * every * cell;
      const std::uint32_t y = row * every * cell;
      if (bayer) {  // red, green; green, blue
        small_.pixels.push_back(at(x, y, 0, 1));
        small_.pixels.push_back(at(x + 1, y, 0, 1));
        small_.pixels.push_back(at(x + 1, y + 1, 0, 1));
      } else if (coloured) {
        for (std::size_t band = 0; band < 3; ++band) {
          small_.pixels.push_back(at(x, y, band, 3));
        }
      } else {
        small_.pixels.push_back(at(x, y, 0, 1));
      }
    }
  }
  return true;
}

}  // namespace rigwire::hil

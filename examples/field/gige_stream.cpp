#include "field/gige_stream.h"

#include <algorithm>
#include <utility>

namespace rigwire::field {

namespace gev = protocols::gige_vision;

namespace {

/// Short numbers of blocks go 1 .. 65535, then 1 again.
constexpr std::int64_t kShortBlocks = 0xFFFF;
/// Leaders and trailers, and a short packet at the end of each part.
constexpr std::size_t kPacketsBeside = 2 + gev::kPartsMaximum;

std::size_t image_bytes(const gev::ImageLeader& leader) {
  const std::size_t line =
      (std::size_t{leader.width} * gev::bits_per_pixel(leader.format) + 7) / 8 + leader.padding_x;
  return line * leader.height + leader.padding_y;
}

}  // namespace

GigeStream::GigeStream(const GigeStreamSettings& settings, Ask ask, Take take)
    : settings_(settings), ask_(std::move(ask)), take_(std::move(take)) {
  const std::size_t room = gev::payload_room(settings.packet_size, true, true);
  most_packets_ = settings.payload_bytes / room + kPacketsBeside;
}

std::uint64_t GigeStream::unrolled(const gev::PacketHeader& header) const {
  if (header.extended_ids || newest_ == 0) {
    return header.block;
  }
  const auto index = static_cast<std::int64_t>((header.block - 1) % kShortBlocks);
  const auto newest_index = static_cast<std::int64_t>((newest_ - 1) % kShortBlocks);
  std::int64_t ahead = (index - newest_index + kShortBlocks) % kShortBlocks;
  ahead -= ahead > kShortBlocks / 2 ? kShortBlocks : 0;
  const auto number = static_cast<std::int64_t>(newest_) + ahead;
  return number > 0 ? static_cast<std::uint64_t>(number) : 0;
}

std::vector<std::uint8_t> GigeStream::spare() {
  if (spare_.empty()) {
    return std::vector<std::uint8_t>(settings_.payload_bytes);
  }
  std::vector<std::uint8_t> memory = std::move(spare_.back());
  spare_.pop_back();
  return memory;
}

GigeStream::Block* GigeStream::block_of(Instant now, const gev::StreamPacket& packet,
                                        std::uint64_t number) {
  if (const auto found = blocks_.find(number); found != blocks_.end()) {
    return &found->second;
  }
  const bool far = newest_ != 0 && number > newest_ + kFarAhead;
  if (number < newest_ || (far && packet.header.format != gev::PacketFormat::leader)) {
    return nullptr;
  }
  counters_.dropped += newest_ != 0 ? number - newest_ - 1 : 0;
  newest_ = number;
  while (blocks_.size() >= kBlocksAtOnce) {
    drop(blocks_.begin());
  }
  Block& block = blocks_[number];
  block.extended_ids = packet.header.extended_ids;
  block.wire_number = packet.header.block;
  block.payload = spare();
  block.heard = now;
  // What an older block still lacks at its end does not come by itself any more.
  for (auto& [older, waiting] : blocks_) {
    if (older < number && !waiting.ask_at) {
      waiting.ask_at = now + kReordering;
    }
  }
  return &block;
}

void GigeStream::receive(Instant now, std::span<const std::uint8_t> datagram) {
  ++counters_.packets;
  const auto packet = gev::decode_stream_packet(datagram);
  if (!packet.ok() || packet->header.packet >= most_packets_) {
    ++counters_.refused;
    return;
  }
  const std::uint64_t number = unrolled(packet->header);
  if (number <= settled_) {
    ++counters_.duplicates;
    return;
  }
  // A leader is checked before it may begin a block.
  if (packet->header.format == gev::PacketFormat::leader && !is_error(packet->header.status)) {
    Block trial;
    if (!store_leader(trial, *packet)) {
      ++counters_.refused;
      return;
    }
  }
  Block* const block = block_of(now, *packet, number);
  if (block == nullptr || block->extended_ids != packet->header.extended_ids) {
    ++counters_.refused;
    return;
  }
  const auto at = blocks_.find(number);
  if (is_error(packet->header.status)) {  // the camera no longer has it
    drop(at);
    return;
  }
  const std::uint32_t index = packet->header.packet;
  if (index < block->have.size() && block->have[index]) {
    ++counters_.duplicates;
    return;
  }
  if (!store(*block, *packet)) {
    ++counters_.refused;
    return;
  }
  if (index >= block->have.size()) {
    block->have.resize(index + 1, false);
  }
  block->have[index] = true;
  ++block->present;
  block->heard = now;
  block->requests = 0;
  if (block->complete()) {
    hand_over(at);
  } else if (block->gapless() && number == newest_) {
    block->ask_at.reset();
  } else if (!block->ask_at) {
    block->ask_at = now + kReordering;
  }
}

bool GigeStream::store_leader(Block& block, const gev::StreamPacket& packet) {
  if (packet.header.packet != 0) {
    return false;
  }
  if (packet.header.parts > 0) {
    auto leader = gev::decode_multipart_leader(packet.payload, packet.header.parts);
    if (!leader.ok()) {
      return false;
    }
    std::uint64_t total = 0;
    for (const gev::PartLeader& part : leader->parts) {
      total += part.length;
    }
    block.parts = *leader;
    return total <= settings_.payload_bytes;
  }
  const auto leader = gev::decode_image_leader(packet.payload);
  if (!leader.ok()) {
    return false;
  }
  block.image = *leader;
  // Each factor first, so that the product fits.
  return leader->width <= settings_.payload_bytes && leader->height <= settings_.payload_bytes &&
         gev::bits_per_pixel(leader->format) > 0 && image_bytes(*leader) <= settings_.payload_bytes;
}

bool GigeStream::store_bytes(Block& block, std::size_t at, std::span<const std::uint8_t> bytes) {
  if (at > block.payload.size() || bytes.size() > block.payload.size() - at) {
    return false;
  }
  std::ranges::copy(bytes, block.payload.begin() + static_cast<std::ptrdiff_t>(at));
  block.end = std::max(block.end, at + bytes.size());
  return true;
}

bool GigeStream::store(Block& block, const gev::StreamPacket& packet) {
  const gev::PacketHeader& header = packet.header;
  if (block.last && header.packet > *block.last) {
    return false;
  }
  switch (header.format) {
    case gev::PacketFormat::leader:
      return store_leader(block, packet);
    case gev::PacketFormat::trailer: {
      const auto trailer = gev::decode_trailer(packet.payload);
      if (!trailer.ok() || header.packet == 0 || header.packet + 1 < block.have.size()) {
        return false;
      }
      block.trailer = *trailer;
      block.last = header.packet;
      return true;
    }
    case gev::PacketFormat::payload: {
      const std::size_t room = gev::payload_room(settings_.packet_size, header.extended_ids, false);
      return header.packet > 0 && packet.payload.size() <= room &&
             store_bytes(block, (header.packet - 1) * room, packet.payload);
    }
    case gev::PacketFormat::multipart: {
      const auto part = gev::decode_multipart_payload(packet.payload);
      return part.ok() && header.packet > 0 && store_bytes(block, part->offset, part->bytes);
    }
  }
  return false;
}

std::optional<GigeBlock> GigeStream::assembled(std::uint64_t number, const Block& block) const {
  GigeBlock whole;
  whole.number = number;
  const auto payload = std::span(block.payload).first(block.end);
  const auto chunks_of = [&whole](std::span<const std::uint8_t> bytes) {
    gev::ChunkReader reader(bytes);
    while (const auto chunk = reader.next()) {
      whole.chunks.push_back(*chunk);
    }
    return reader.rest().empty();
  };
  if (block.parts) {
    whole.timestamp = block.parts->timestamp;
    std::size_t at = 0;
    for (const gev::PartLeader& part : block.parts->parts) {
      if (part.length > payload.size() - at) {
        return std::nullopt;
      }
      const auto bytes = payload.subspan(at, part.length);
      at += part.length;
      if (part.type != gev::DataType::chunks) {
        whole.pictures.push_back({part, bytes});
      } else if (!chunks_of(bytes)) {
        return std::nullopt;
      }
    }
    return at == payload.size() ? std::optional(std::move(whole)) : std::nullopt;
  }
  if (!block.image) {
    return std::nullopt;
  }
  const gev::ImageLeader& leader = *block.image;
  whole.timestamp = leader.timestamp;
  gev::PartLeader info;
  info.format = leader.format;
  info.width = leader.width;
  info.height = leader.height;
  info.offset_x = leader.offset_x;
  info.offset_y = leader.offset_y;
  info.padding_x = leader.padding_x;
  info.padding_y = leader.padding_y;
  info.length = image_bytes(leader);
  std::span<const std::uint8_t> bytes = payload;
  if (leader.with_chunks) {
    // The image is the first chunk, hence the last that is read.
    if (!chunks_of(payload) || whole.chunks.empty()) {
      return std::nullopt;
    }
    bytes = whole.chunks.back().bytes;
    whole.chunks.pop_back();
  }
  if (bytes.size() != info.length) {
    return std::nullopt;
  }
  whole.pictures.push_back({info, bytes});
  return whole;
}

void GigeStream::drop(Blocks::iterator at) {
  ++counters_.dropped;
  settled_ = std::max(settled_, at->first);
  spare_.push_back(std::move(at->second.payload));
  blocks_.erase(at);
}

void GigeStream::drop_before(std::uint64_t number) {
  while (!blocks_.empty() && blocks_.begin()->first < number) {
    drop(blocks_.begin());
  }
}

void GigeStream::hand_over(Blocks::iterator at) {
  const std::uint64_t number = at->first;
  drop_before(number);
  Block block = std::move(at->second);
  blocks_.erase(at);
  settled_ = number;
  if (const auto whole = assembled(number, block)) {
    ++counters_.blocks;
    take_(*whole);
  } else {
    ++counters_.dropped;
  }
  spare_.push_back(std::move(block.payload));
}

void GigeStream::ask_for_missing(Block& block, bool the_end_too) {
  gev::PacketResend request;
  request.extended_ids = block.extended_ids;
  request.block = block.wire_number;
  const auto size = static_cast<std::uint32_t>(block.have.size());
  for (std::uint32_t first = 0; first < size; ++first) {
    if (block.have[first]) {
      continue;
    }
    std::uint32_t last = first;
    while (last + 1 < size && !block.have[last + 1]) {
      ++last;
    }
    request.first = first;
    request.last = last;
    counters_.asked += last - first + 1;
    ask_(request);
    first = last;
  }
  if (the_end_too && !block.last) {
    request.first = size;
    request.last =
        block.extended_ids ? gev::PacketResend::kToTheEndExtended : gev::PacketResend::kToTheEnd;
    ++counters_.asked;
    ask_(request);
  }
}

void GigeStream::advance(Instant now) {
  for (auto at = blocks_.begin(); at != blocks_.end();) {
    const auto next = std::next(at);
    Block& block = at->second;
    const bool quiet = now - block.heard >= kQuiet;
    const bool due = block.ask_at && *block.ask_at <= now;
    if (quiet || due) {
      if (!settings_.resend || block.requests >= kRequests) {
        drop(at);
      } else {
        ++block.requests;
        // Nothing has come since the last request: the end does not come by itself either.
        ask_for_missing(block, quiet || block.requests > 1 || at->first < newest_);
        block.ask_at = now + kAgain;
        block.heard = now;
      }
    }
    at = next;
  }
}

std::optional<GigeStream::Instant> GigeStream::next_event() const {
  std::optional<Instant> earliest;
  for (const auto& [number, block] : blocks_) {
    const Instant at = std::min(block.heard + kQuiet, block.ask_at.value_or(Instant::max()));
    earliest = std::min(at, earliest.value_or(Instant::max()));
  }
  return earliest;
}

}  // namespace rigwire::field

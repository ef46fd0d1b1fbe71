// The stream: packets that test the way, blocks of pictures, packets that are asked for again.
// Everything is put back.
#include <algorithm>
#include <array>
#include <numeric>

#include "conform/gige_vision/gige_vision_trial.h"
#include "protocols/bytes.h"

namespace rigwire::conform {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
using protocols::load_big;
using std::chrono::milliseconds;

namespace {

using T = GigeVisionTrial;
using Bytes = GigeBytes;

constexpr unsigned kLeader = 1;
constexpr unsigned kTrailer = 2;
constexpr unsigned kPayload = 3;
constexpr unsigned kMultipart = 7;

std::uint32_t own_address_word(T& trial) {
  std::uint32_t number = 0;
  std::uint32_t part = 0;
  for (const char c : trial.device().own_address + ".") {
    if (c == '.') {
      number = number << 8U | part;
      part = 0;
    } else {
      part = part * 10 + static_cast<std::uint32_t>(c - '0');
    }
  }
  return number;
}

// --- before pictures ---

/// Control, with the stream to our port.
bool open_stream(T& trial) {
  return trial.take_control() && trial.write(boot::kStreamDestination, own_address_word(trial)) &&
         trial.write(boot::kStreamPort, trial.device().line->own(T::kStream).port);
}

void test_packet(T& trial, std::uint32_t size) {
  const auto before = open_stream(trial) ? trial.read(boot::kStreamPacketSize) : std::nullopt;
  if (!before) {
    return;
  }
  const std::uint32_t wanted = size != 0 ? size : *before & gev::PacketSize::kSize;
  const bool fired =
      trial.write(boot::kStreamPacketSize,
                  gev::PacketSize::kFireTest | gev::PacketSize::kDoNotFragment | wanted);
  const auto came = fired ? trial.listen(milliseconds(300)) : std::vector<DatagramLine::Datagram>();
  static_cast<void>(trial.write(boot::kStreamPacketSize, *before & ~gev::PacketSize::kFireTest));
  if (fired && trial.expect(!came.empty(), "a test packet", "none")) {
    trial.expect(came.front().bytes.size() + 28 == wanted,
                 std::to_string(wanted) + " bytes with IP and UDP headers",
                 std::to_string(came.front().bytes.size() + 28));
    trial.expect(came.size() == 1, "one test packet", std::to_string(came.size()));
  }
}

void no_test_packet(T& trial) {
  if (!open_stream(trial) || !trial.write(boot::kStreamPort, 0)) {
    return;
  }
  if (const auto before = trial.read(boot::kStreamPacketSize)) {
    static_cast<void>(trial.status_of_write(
        boot::kStreamPacketSize, gev::PacketSize::kFireTest | (*before & gev::PacketSize::kSize)));
    const auto came = trial.listen(milliseconds(300));
    trial.expect(came.empty(), "no test packet from a closed channel", std::to_string(came.size()));
  }
}

template <std::uint32_t address>
void kept(T& trial, std::uint32_t value, std::uint32_t bits) {
  const auto before = trial.take_control() ? trial.read(address) : std::nullopt;
  if (before && trial.write(address, value)) {
    if (const auto now = trial.read(address)) {
      trial.expect((*now & bits) == value, gige_address_text(value),
                   gige_address_text(*now & bits));
    }
    static_cast<void>(trial.write(address, *before));
  }
}

void closed_at_the_end(T& trial) {
  if (open_stream(trial) && trial.write(boot::kControlPrivilege, 0)) {
    if (const auto port = trial.read(boot::kStreamPort)) {
      trial.expect((*port & 0xFFFFU) == 0, "a closed channel (port 0) when control ends",
                   std::to_string(*port & 0xFFFFU));
    }
  }
}

// --- blocks ---

/// Returns the stream, or null if there is none.
const GigeStream* blocks_of(T& trial) {
  const GigeStream& stream = gige_stream(trial);
  return trial.expect(stream.failure.empty(), "blocks while it acquires", stream.failure) ? &stream
                                                                                          : nullptr;
}

/// Checks each packet of each block and shows the first that is wrong.
template <class Check>
void each(T& trial, const std::string& expected, const Check& check) {
  const GigeStream* const stream = blocks_of(trial);
  if (stream == nullptr) {
    return;
  }
  for (const GigeBlock& block : stream->blocks) {
    for (const auto& [number, packet] : block.packets) {
      const std::string wrong = check(*stream, block, packet);
      if (!wrong.empty()) {
        trial.received(packet.datagram.bytes, "block " + std::to_string(block.number) +
                                                  ", packet " + std::to_string(number));
        trial.expect(false, expected, wrong);
        return;
      }
    }
  }
  trial.expect(true, expected, "");
}

void come(T& trial) {
  static_cast<void>(blocks_of(trial));
}

void nothing_strange(T& trial) {
  if (const GigeStream* const stream = blocks_of(trial)) {
    trial.expect(stream->strange.empty(), "packets with a whole header",
                 std::to_string(stream->strange.size()) + " others");
  }
}

void statuses(T& trial) {
  each(trial, "status 0 in each packet",
       [](const GigeStream&, const GigeBlock&, const GigeStreamPacket& packet) {
         return packet.status == 0 ? std::string()
                                   : gige_status_text(static_cast<std::uint16_t>(packet.status));
       });
}

void formats(T& trial) {
  each(trial, "leader first, then payload, trailer last",
       [](const GigeStream&, const GigeBlock& block, const GigeStreamPacket& packet) {
         const bool last = packet.packet == block.packets.rbegin()->first;
         const bool right = packet.packet == 0 ? packet.format == kLeader
                            : last             ? packet.format == kTrailer
                                   : packet.format == kPayload || packet.format == kMultipart;
         return right ? std::string() : "format " + std::to_string(packet.format);
       });
}

void in_order(T& trial) {
  if (const GigeStream* const stream = blocks_of(trial)) {
    if (stream->lost_here > 0) {
      return trial.broken("this machine did not take " + std::to_string(stream->lost_here) +
                          " packets in time");
    }
    for (const GigeBlock& block : stream->blocks) {
      trial.expect(block.in_order, "packets in the order of their numbers, none missing",
                   "otherwise in block " + std::to_string(block.number));
    }
  }
}

void once(T& trial) {
  if (const GigeStream* const stream = blocks_of(trial)) {
    for (const GigeBlock& block : stream->blocks) {
      trial.expect(
          block.repeated == 0, "each packet once",
          std::to_string(block.repeated) + " again in block " + std::to_string(block.number));
    }
  }
}

void block_numbers(T& trial) {
  if (const GigeStream* const stream = blocks_of(trial)) {
    const bool extended = stream->blocks.front().packets.begin()->second.extended_ids;
    std::uint64_t before = 0;
    for (const GigeBlock& block : stream->blocks) {
      const std::uint64_t right = !extended && before == 0xFFFF ? 1 : before + 1;
      trial.expect(block.number != 0, "no block 0", "one");
      // One that was lost as a whole leaves a number out.
      trial.expect(before == 0 || block.number >= right, "numbers that grow, behind 65535 1",
                   std::to_string(before) + ", then " + std::to_string(block.number));
      before = block.number;
    }
  }
}

void from_one(T& trial) {
  if (const GigeStream* const stream = blocks_of(trial)) {
    trial.expect(stream->blocks.front().number == 1, "block 1 first",
                 std::to_string(stream->blocks.front().number));
  }
}

void identifiers(T& trial) {
  each(trial, "identifiers of one length",
       [](const GigeStream& stream, const GigeBlock&, const GigeStreamPacket& packet) {
         const bool first = stream.blocks.front().packets.begin()->second.extended_ids;
         return packet.extended_ids == first ? std::string() : std::string("of the other");
       });
}

void sizes(T& trial) {
  each(trial, "packets as long as the packet size, but the last of a block's payload",
       [](const GigeStream& stream, const GigeBlock& block, const GigeStreamPacket& packet) {
         const std::size_t size = packet.datagram.bytes.size() + 28;
         const auto next = block.packets.find(packet.packet + 1);
         const bool full = packet.format == kPayload && next != block.packets.end() &&
                           next->second.format == kPayload;
         return size > stream.packet_size || (full && size != stream.packet_size)
                    ? std::to_string(size) + " of " + std::to_string(stream.packet_size)
                    : std::string();
       });
}

void source_port(T& trial) {
  each(trial, "the port that its register says",
       [](const GigeStream& stream, const GigeBlock&, const GigeStreamPacket& packet) {
         return stream.source_port != 0 && packet.datagram.from.port != stream.source_port
                    ? std::to_string(packet.datagram.from.port)
                    : std::string();
       });
}

/// Checks the leaders only.
template <class Check>
void each_leader(T& trial, const std::string& expected, const Check& check) {
  each(trial, expected,
       [&](const GigeStream& stream, const GigeBlock& block, const GigeStreamPacket& packet) {
         return packet.format == kLeader ? check(stream, block, packet.payload) : std::string();
       });
}

constexpr std::size_t kImageLeader = 36;

bool is_image(const Bytes& leader) {
  return leader.size() >= kImageLeader && (load_big<std::uint16_t>(leader, 2) & 0x3FFFU) == 1;
}

void payload_types(T& trial) {
  each_leader(trial, "a payload type that there is, and its leader's length",
              [](const GigeStream&, const GigeBlock&, const Bytes& leader) {
                if (leader.size() < 12) {
                  return std::to_string(leader.size()) + " bytes";
                }
                const unsigned type = load_big<std::uint16_t>(leader, 2) & 0x3FFFU;
                const bool image = type == 1 && leader.size() >= kImageLeader;
                const bool parts = type == 10 && (leader.size() - 12) % 48 == 0;
                const bool other = type >= 2 && type <= 9;
                return image || parts || other ? std::string()
                                               : gige_address_text(type) + " of " +
                                                     std::to_string(leader.size()) + " bytes";
              });
}

/// In ticks; 0 where the leader has none.
std::uint64_t stamp_of(const Bytes& leader) {
  return leader.size() < 12 ? 0 : load_big<std::uint64_t>(leader, 4);
}
std::uint64_t stamp_of(const GigeBlock& block) {
  return stamp_of(block.packets.begin()->second.payload);
}

void timestamps(T& trial) {
  std::uint64_t before = 0;
  each_leader(trial, "time stamps that never go back",
              [&](const GigeStream&, const GigeBlock&, const Bytes& leader) {
                const auto stamp = stamp_of(leader);
                const bool back = stamp < before || stamp == 0;
                before = stamp;
                return back ? std::to_string(stamp) : std::string();
              });
}

void new_pictures(T& trial) {
  if (const GigeStream* const stream = blocks_of(trial)) {
    const auto payload = [](const GigeBlock& block) {
      Bytes all;
      for (const auto& [number, packet] : block.packets) {
        if (packet.format == kPayload || packet.format == kMultipart) {
          all = std::move(all) + packet.payload;
        }
      }
      return all;
    };
    const std::vector<GigeBlock>& blocks = stream->blocks;
    if (blocks.size() < 5 || stamp_of(blocks.front()) == stamp_of(blocks.back())) {
      return trial.not_applicable("fewer than five pictures");
    }
    const Bytes first = payload(blocks.front());
    const bool same = std::ranges::all_of(
        blocks, [&](const GigeBlock& block) { return payload(block) == first; });
    trial.expect(!same, "pictures that differ, by their noise", "the same bytes in all");
  }
}

void at_its_rate(T& trial) {
  const double rate_hz = trial.claims().rate_hz;
  if (rate_hz == 0.0) {
    return trial.not_applicable("no rate of pictures is claimed");
  }
  const GigeStream* const stream = blocks_of(trial);
  if (stream == nullptr) {
    return;
  }
  if (stream->tick_frequency_hz == 0) {
    return trial.not_applicable("no frequency of ticks");
  }
  // Blocks that were lost as a whole count by their numbers.
  const GigeBlock& first = stream->blocks.front();
  const GigeBlock& last = stream->blocks.back();
  const auto ticks = stamp_of(last) - stamp_of(first);
  const auto pictures = last.number - first.number;
  if (!trial.expect(pictures >= 1 && stamp_of(first) != 0 && stamp_of(last) > stamp_of(first),
                    "two pictures with time stamps in two seconds", "none")) {
    return;
  }
  const double found_hz = static_cast<double>(pictures) *
                          static_cast<double>(stream->tick_frequency_hz) /
                          static_cast<double>(ticks);
  trial.expect(found_hz >= 0.95 * rate_hz && found_hz <= 1.05 * rate_hz,
               std::to_string(rate_hz) + " Hz within 5 %", std::to_string(found_hz) + " Hz");
}

/// Bytes of the pixels, by the leader.
std::uint64_t image_bytes(const Bytes& leader) {
  const std::uint64_t bits = load_big<std::uint32_t>(leader, 12) >> 16U & 0xFFU;
  const std::uint64_t width = load_big<std::uint32_t>(leader, 16);
  const std::uint64_t height = load_big<std::uint32_t>(leader, 20);
  return (width * bits + 7) / 8 * height + load_big<std::uint16_t>(leader, 32) * height +
         load_big<std::uint16_t>(leader, 34);
}

std::uint64_t payload_bytes(const GigeBlock& block) {
  return std::accumulate(block.packets.begin(), block.packets.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& each) {
                           const bool pixels = each.second.format == kPayload;
                           return sum + (pixels ? each.second.payload.size() : 0);
                         });
}

void image_size(T& trial) {
  each_leader(trial, "as many bytes as width, height and format of the leader say",
              [](const GigeStream&, const GigeBlock& block, const Bytes& leader) {
                const bool whole =
                    block.in_order && is_image(leader) && load_big<std::uint16_t>(leader, 2) == 1;
                return whole && payload_bytes(block) != image_bytes(leader)
                           ? std::to_string(payload_bytes(block)) + " for " +
                                 std::to_string(image_bytes(leader))
                           : std::string();
              });
}

void as_registered(T& trial) {
  if (const GigeStream* const stream = blocks_of(trial)) {
    if (stream->payload_size == 0) {
      return trial.not_applicable("no register of the payload's size is claimed");
    }
    for (const GigeBlock& block : stream->blocks) {
      trial.expect(!block.in_order || payload_bytes(block) == 0 ||
                       payload_bytes(block) == stream->payload_size,
                   std::to_string(stream->payload_size) + " bytes, as its register says",
                   std::to_string(payload_bytes(block)));
    }
  }
}

void trailers(T& trial) {
  each(trial, "in the trailer the leader's payload type and height",
       [](const GigeStream&, const GigeBlock& block, const GigeStreamPacket& packet) {
         if (packet.format != kTrailer) {
           return std::string();
         }
         const Bytes& leader = block.packets.begin()->second.payload;
         const Bytes& trailer = packet.payload;
         if (trailer.size() < 4 || leader.size() < 4 ||
             load_big<std::uint16_t>(trailer, 2) != load_big<std::uint16_t>(leader, 2)) {
           return "payload type: " + hex_text(trailer, 8);
         }
         const bool tall =
             !is_image(leader) || (trailer.size() >= 8 && load_big<std::uint32_t>(trailer, 4) ==
                                                              load_big<std::uint32_t>(leader, 20));
         return tall ? std::string() : "height: " + hex_text(trailer, 8);
       });
}

// --- asked for again ---

/// Acquires anew until a packet of a block came, then calls `ask` with it and the answers.
template <class Ask>
void while_acquiring(T& trial, const Ask& ask) {
  const auto& claims = trial.claims();
  if (!open_stream(trial) || !trial.write(claims.start->address, claims.start->value)) {
    return;
  }
  std::optional<GigeStreamPacket> found;
  for (int i = 0; i < 40 && !found; ++i) {
    for (const DatagramLine::Datagram& datagram : trial.listen(milliseconds(50))) {
      const auto packet = gige_stream_packet(datagram);
      found =
          !found && packet && packet->format == kPayload && packet->packet == 1 ? packet : found;
    }
  }
  static_cast<void>(trial.write(claims.stop->address, claims.stop->value));
  static_cast<void>(trial.listen(milliseconds(300)));
  if (trial.expect(found.has_value(), "a packet of a picture", "none in two seconds")) {
    ask(*found);
  }
}

Bytes resend_of(const GigeStreamPacket& packet, std::uint32_t first, std::uint32_t last,
                std::uint64_t block) {
  if (packet.extended_ids) {
    return gige_word(0) + gige_word(first) + gige_word(last) +
           gige_word(static_cast<std::uint32_t>(block >> 32U)) +
           gige_word(static_cast<std::uint32_t>(block));
  }
  return gige_word(static_cast<std::uint32_t>(block & 0xFFFFU)) + gige_word(first) +
         gige_word(last);
}

std::vector<GigeStreamPacket> resent(T& trial, const GigeStreamPacket& packet, std::uint32_t number,
                                     std::uint64_t block) {
  const std::uint8_t flags = packet.extended_ids ? 0x10 : 0x00;
  std::vector<GigeStreamPacket> all;
  if (trial.send(T::framed(Gvcp::kPacketResend, resend_of(packet, number, number, block),
                           trial.next_request(), flags),
                 "PACKETRESEND of packet " + std::to_string(number) + " of block " +
                     std::to_string(block))) {
    for (const DatagramLine::Datagram& datagram : trial.listen(milliseconds(300))) {
      trial.received(datagram.bytes, "to the stream's port");
      if (auto again = gige_stream_packet(datagram)) {
        all.push_back(std::move(*again));
      }
    }
  }
  return all;
}

void again(T& trial) {
  while_acquiring(trial, [&](const GigeStreamPacket& packet) {
    const auto found = resent(trial, packet, 1, packet.block);
    if (trial.expect(!found.empty(), "the packet again", "none")) {
      const GigeStreamPacket& one = found.front();
      trial.expect(one.block == packet.block && one.packet == 1 && one.payload == packet.payload,
                   "the same block, number and bytes", hex_text(one.datagram.bytes, 24));
      trial.expect((one.status & 0x8000U) == 0, "no error",
                   gige_status_text(static_cast<std::uint16_t>(one.status)));
    }
  });
}

void never_was(T& trial) {
  while_acquiring(trial, [&](const GigeStreamPacket& packet) {
    for (const GigeStreamPacket& one : resent(trial, packet, 1, packet.block + 20'000)) {
      trial.expect((one.status & 0x8000U) != 0, "an error for a block that never was, or nothing",
                   gige_status_text(static_cast<std::uint16_t>(one.status)));
    }
  });
}

void beyond_the_block(T& trial) {
  while_acquiring(trial, [&](const GigeStreamPacket& packet) {
    for (const GigeStreamPacket& one : resent(trial, packet, 0x00FF'FFF0, packet.block)) {
      trial.expect((one.status & 0x8000U) != 0, "an error for a packet that never was, or nothing",
                   gige_status_text(static_cast<std::uint16_t>(one.status)));
    }
  });
}

void ends(T& trial) {
  while_acquiring(trial, [&](const GigeStreamPacket&) {
    const auto more = trial.listen(milliseconds(500));
    trial.expect(more.empty(), "nothing more once the acquisition has ended",
                 std::to_string(more.size()) + " packets");
  });
}

void ends_with_control(T& trial) {
  const auto& claims = trial.claims();
  if (open_stream(trial) && trial.write(claims.start->address, claims.start->value) &&
      trial.write(boot::kControlPrivilege, 0)) {
    static_cast<void>(trial.listen(milliseconds(500)));
    const auto more = trial.listen(milliseconds(500));
    trial.expect(more.empty(), "no stream for an application that has left",
                 std::to_string(more.size()) + " packets");
  }
}

constexpr GigeVisionRow setting(const char* title, Strength strength, void (*run)(T&)) {
  return {"stream", title, strength, run, Danger::writes, 0, false};
}
constexpr GigeVisionRow picture(const char* title, Strength strength, void (*run)(T&),
                                std::uint32_t capability = 0) {
  return {"blocks", title, strength, run, Danger::writes, capability, true};
}

constexpr std::array kStreamRows{
    setting("The packet size is kept", kMust,
            [](T& t) { kept<boot::kStreamPacketSize>(t, 1000, gev::PacketSize::kSize); }),
    setting("The delay between packets is kept", kMust,
            [](T& t) { kept<boot::kStreamPacketDelay>(t, 1000, 0xFFFF'FFFF); }),
    setting("A test packet is as long as the packet size", kMust, [](T& t) { test_packet(t, 0); }),
    setting("A test packet of 1400 bytes", kMust, [](T& t) { test_packet(t, 1400); }),
    setting("A closed channel sends no test packet", kMust, no_test_packet),
    setting("The channel is closed when control ends", kMust, closed_at_the_end),
    picture("Blocks come while it acquires", kMust, come),
    picture("Packets have whole headers", kMust, nothing_strange),
    picture("Packets have no error", kMust, statuses),
    picture("Leader, payload and trailer follow each other", kMust, formats),
    picture("Packets come in order", kShould, in_order),
    picture("Packets come once", kShould, once),
    picture("Blocks are numbered upwards", kMust, block_numbers),
    picture("The first block is 1", kShould, from_one),
    picture("Identifiers are of one length", kMust, identifiers),
    picture("Packets are as long as they are set", kMust, sizes),
    picture("The stream comes from its port", kShould, source_port),
    picture("The leader has a payload type", kMust, payload_types),
    picture("Time stamps go forward", kMust, timestamps),
    picture("Pictures differ", kShould, new_pictures),
    picture("The image has the bytes that its leader says", kMust, image_size),
    picture("The image has the bytes that its register says", kMust, as_registered),
    picture("The trailer agrees with the leader", kMust, trailers),
    picture("A packet is sent again when it is asked for", kMust, again,
            gev::Capability::kPacketResend),
    picture("A block that never was is not sent", kMust, never_was, gev::Capability::kPacketResend),
    picture("A packet that never was is not sent", kMust, beyond_the_block,
            gev::Capability::kPacketResend),
    picture("The stream ends with the acquisition", kMust, ends),
    picture("The stream ends with control", kMust, ends_with_control),
    picture("Pictures come at the claimed rate, by their time stamps", kMust, at_its_rate),
};

}  // namespace

std::vector<GigeVisionCase> gige_stream_cases() {
  return gige_cases_in_control_of(kStreamRows);
}

}  // namespace rigwire::conform

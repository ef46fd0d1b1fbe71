// The stream of a GigE Vision camera: packets in, whole blocks (pictures) out.
//
// - Packets may come in any order, twice, or not at all. What is missing is asked for again, until
//   three requests have brought nothing; a block that stays incomplete is dropped and counted.
// - Blocks come out whole and in order, never a part of one.
// - Memory is bounded: blocks no longer than the camera has said they are (PayloadSize), and four
//   of them at once. What does not fit, is no packet or contradicts itself is refused and counted.
//
// No sockets and no clock here: the time is an argument, requests leave by a function.
// Source: protocols/gige_vision/gvsp.h.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocols/gige_vision/chunk.h"
#include "protocols/gige_vision/gvcp.h"
#include "protocols/gige_vision/gvsp.h"

namespace rigwire::field {

/// One picture of a block: an image, or one part of several.
struct GigePicture {
  /// Description of the part; purpose 0 for a plain image.
  protocols::gige_vision::PartLeader info;
  std::span<const std::uint8_t> bytes;  ///< Size according to `info`, padding included.
};

/// A whole block. Views hold during the call that hands it over.
struct GigeBlock {
  std::uint64_t number = 0;
  std::uint64_t timestamp = 0;  ///< Ticks of the camera's clock, at the start of the exposure.
  std::vector<GigePicture> pictures;
  std::vector<protocols::gige_vision::Chunk> chunks;  ///< Appended data, by their identifiers.
};

struct GigeStreamSettings {
  std::size_t packet_size = 1500;  ///< In force, with IP and UDP headers.
  std::size_t payload_bytes = 0;   ///< Payload of the longest block.
  bool resend = true;              ///< The camera sends packets again.
};

struct GigeStreamCounters {
  std::uint64_t packets = 0;
  std::uint64_t refused = 0;     ///< Datagrams that are not packets of a possible block.
  std::uint64_t duplicates = 0;  ///< Packets that were there already, or of a block that is over.
  std::uint64_t asked = 0;       ///< Packets that were asked for again.
  std::uint64_t blocks = 0;      ///< Whole ones.
  std::uint64_t dropped = 0;     ///< Blocks that stayed incomplete, and those never seen at all.

  friend bool operator==(const GigeStreamCounters&, const GigeStreamCounters&) = default;
};

class GigeStream {
 public:
  /// A monotonic time; only differences matter.
  using Instant = std::chrono::nanoseconds;
  using Ask = std::function<void(const protocols::gige_vision::PacketResend&)>;
  using Take = std::function<void(const GigeBlock&)>;

  static constexpr std::chrono::milliseconds kReordering{2};  ///< Before a gap counts as a loss.
  static constexpr std::chrono::milliseconds kAgain{15};      ///< From request to request.
  static constexpr std::chrono::milliseconds kQuiet{40};  ///< Without a packet: the end is lost.
  /// Requests without result after which the block is dropped.
  static constexpr int kRequests = 3;
  static constexpr std::size_t kBlocksAtOnce = 4;
  /// A block farther ahead than this begins with its leader, or is noise.
  static constexpr std::uint64_t kFarAhead = 8;

  /// `take` must not destroy the stream. Precondition: packets have room for a byte.
  GigeStream(const GigeStreamSettings& settings, Ask ask, Take take);

  void receive(Instant now, std::span<const std::uint8_t> datagram);
  /// Asks for what is missing, drops what stays so.
  void advance(Instant now);
  /// When advance() has something to do; nothing: when the next packet has come.
  [[nodiscard]] std::optional<Instant> next_event() const;

  [[nodiscard]] const GigeStreamCounters& counters() const { return counters_; }

 private:
  struct Block {
    bool extended_ids = false;
    std::uint64_t wire_number = 0;
    std::optional<protocols::gige_vision::ImageLeader> image;
    std::optional<protocols::gige_vision::MultipartLeader> parts;
    std::optional<protocols::gige_vision::Trailer> trailer;
    std::optional<std::uint32_t> last;  ///< Number of the trailer.
    std::vector<bool> have;
    std::uint32_t present = 0;  ///< Number of true entries in `have`.
    std::size_t end = 0;        ///< End of the received bytes.
    std::vector<std::uint8_t> payload;
    Instant heard{0};
    std::optional<Instant> ask_at;
    int requests = 0;

    [[nodiscard]] bool complete() const { return last && present == *last + 1; }
    /// All that came is without a gap.
    [[nodiscard]] bool gapless() const { return present == have.size(); }
  };
  using Blocks = std::map<std::uint64_t, Block>;

  /// The number of the block since the stream began, short identifiers unrolled.
  [[nodiscard]] std::uint64_t unrolled(const protocols::gige_vision::PacketHeader& header) const;
  Block* block_of(Instant now, const protocols::gige_vision::StreamPacket& packet,
                  std::uint64_t number);
  [[nodiscard]] bool store(Block& block, const protocols::gige_vision::StreamPacket& packet);
  [[nodiscard]] bool store_leader(Block& block, const protocols::gige_vision::StreamPacket& packet);
  [[nodiscard]] bool store_bytes(Block& block, std::size_t at, std::span<const std::uint8_t> bytes);
  void ask_for_missing(Block& block, bool the_end_too);
  void drop_before(std::uint64_t number);
  void drop(Blocks::iterator at);
  void hand_over(Blocks::iterator at);
  [[nodiscard]] std::optional<GigeBlock> assembled(std::uint64_t number, const Block& block) const;
  [[nodiscard]] std::vector<std::uint8_t> spare();

  GigeStreamSettings settings_;
  Ask ask_;
  Take take_;
  std::size_t most_packets_;
  Blocks blocks_;
  std::uint64_t newest_ = 0;   ///< Block that was begun last; 0: none yet.
  std::uint64_t settled_ = 0;  ///< Blocks up to this one are handed over or dropped.
  std::vector<std::vector<std::uint8_t>> spare_;  ///< Memory of blocks that are over.
  GigeStreamCounters counters_;
};

}  // namespace rigwire::field

// MCAP: the file format of recordings with many channels of messages, each with its schema, that
// Foxglove Studio, Lichtblick and PlotJuggler open.
//
// Source: mcap.dev, "MCAP format specification", version 0. A file is the magic, records, and the
// magic again; a record is an opcode (1), a length (8) and its content; everything is
// little-endian, texts, lists and maps have their length in bytes (4) in front.
//
//   0x01 header   0x03 schema    0x05 message  0x07 message index  0x09 attachment  0x0C metadata
//   0x02 footer   0x04 channel   0x06 chunk    0x08 chunk index    0x0A, 0x0D their indices
//   0x0B statistics              0x0E summary offset               0x0F end of data
//
// Messages are written in chunks that are not compressed. A file that ends anywhere is good up to
// the last whole chunk: readers fall back to reading from the front where the summary is missing.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocols/result.h"

namespace rigwire::protocols::mcap {

using Bytes = std::vector<std::uint8_t>;
using Pairs = std::vector<std::pair<std::string, std::string>>;

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

struct Schema {
  std::uint16_t id = 0;  ///< From 1 on.
  std::string name;      ///< "foxglove.FrameTransforms"
  std::string encoding;  ///< "jsonschema"
  std::string data;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;  ///< 0: none.
  std::string topic;
  std::string encoding;  ///< Encoding of its messages: "json".
};

struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t time_ns = 0;  ///< Log time; the publish time is written with the same value.
  std::string_view data;
};

/// Writes a file from its front to its end, never back. What is ready lies in bytes() until the
/// caller takes it away. Chunks depend on what is written alone, so that equal calls give equal
/// bytes.
class Writer {
 public:
  /// `library`: name of the writer.
  explicit Writer(std::string_view library);

  /// Returns its number.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data);
  std::uint16_t add_channel(std::uint16_t schema, std::string_view topic,
                            std::string_view encoding);
  void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view data);
  void attach(std::string_view name, std::string_view media_type, std::uint64_t time_ns,
              std::string_view data);
  void describe(std::string_view name, const Pairs& pairs);
  /// Closes the chunk: what was written so far is ready.
  void end_chunk();
  /// Closes the chunk and writes summary and footer. Nothing may follow.
  void finish();

  [[nodiscard]] const Bytes& bytes() const { return ready_; }
  void taken() {
    taken_ += ready_.size();
    ready_.clear();
  }
  /// What was ready and not taken away is lost, as if it had never been written; indices follow.
  /// Returns how many messages. Precondition: no schema, channel, attachment or description was in
  /// it.
  std::uint64_t forget();

  /// A chunk ends when it holds more than that, or lasts longer.
  static constexpr std::size_t kChunkBytes = 256 * 1024;
  static constexpr std::uint64_t kChunkTime_ns = 1'000'000'000;

 private:
  struct IndexEntry {
    std::uint64_t time_ns;
    std::uint64_t offset;  ///< In the chunk.
  };
  struct ChunkIndex {
    std::uint64_t start_ns = 0;
    std::uint64_t end_ns = 0;
    std::uint64_t offset = 0;
    std::uint64_t length = 0;
    std::uint64_t index_length = 0;
    std::uint64_t bytes = 0;
    std::map<std::uint16_t, std::uint64_t> indices;  ///< Offsets, by channel.
    std::map<std::uint16_t, std::uint64_t> counts;   ///< Messages, by channel.
  };
  struct Placed {
    std::uint64_t offset = 0;
    std::uint64_t length = 0;
    std::uint64_t time_ns = 0;
    std::uint64_t size = 0;
    std::string name;
    std::string media_type;
  };
  [[nodiscard]] std::uint64_t position() const { return taken_ + ready_.size(); }

  Bytes ready_;
  std::uint64_t taken_ = 0;
  Bytes chunk_;
  std::uint64_t chunk_start_ns_ = 0;
  std::uint64_t chunk_end_ns_ = 0;
  std::map<std::uint16_t, std::vector<IndexEntry>> chunk_indices_;
  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  std::vector<std::uint32_t> sequences_;  ///< Next, by channel.
  std::vector<ChunkIndex> chunks_;
  std::vector<Placed> attachments_;
  std::vector<Placed> metadata_;
};

/// A record as it lies in a file or a chunk; refers to the bytes that were given.
struct Record {
  Opcode opcode{};
  std::span<const std::uint8_t> content;
};

inline constexpr std::size_t kMagicSize = 8;
[[nodiscard]] bool begins_with_magic(std::span<const std::uint8_t> bytes);

/// The record at the front of `bytes`. Malformed: a length beyond 2^40.
[[nodiscard]] Decoded<Record> next_record(std::span<const std::uint8_t> bytes);

// The contents that are read again; malformed where a length in them is wrong.
[[nodiscard]] Decoded<Schema> read_schema(std::span<const std::uint8_t> content);
[[nodiscard]] Decoded<Channel> read_channel(std::span<const std::uint8_t> content);
[[nodiscard]] Decoded<Message> read_message(std::span<const std::uint8_t> content);
/// The records of a chunk. Malformed: compressed, or its checksum is wrong.
[[nodiscard]] Decoded<std::span<const std::uint8_t>> read_chunk(
    std::span<const std::uint8_t> content);
struct Attachment {
  std::string name;
  std::string media_type;
  std::string_view data;
};
[[nodiscard]] Decoded<Attachment> read_attachment(std::span<const std::uint8_t> content);

}  // namespace rigwire::protocols::mcap

#include "protocols/mcap/mcap.h"

#include <algorithm>
#include <array>

#include "protocols/bytes.h"

namespace rigwire::protocols::mcap {
namespace {

constexpr std::array<std::uint8_t, kMagicSize> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::size_t kRecordHead = 1     // opcode
                                    + 8;  // length
static_assert(kRecordHead == 9);
constexpr std::uint64_t kLongestRecord = std::uint64_t{1} << 40U;

/// CRC-32 as ISO 3309 has it, reflected, polynomial 0x04C11DB7.
constexpr std::array<std::uint32_t, 256> kCrcTable = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t rest = i;
    for (int bit = 0; bit < 8; ++bit) {
      rest = (rest & 1U) != 0 ? rest >> 1U ^ 0xEDB8'8320U : rest >> 1U;
    }
    table[i] = rest;
  }
  return table;
}();

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  std::uint32_t rest = 0xFFFF'FFFFU;
  for (const std::uint8_t byte : bytes) {
    rest = rest >> 8U ^ kCrcTable[(rest ^ byte) & 0xFFU];
  }
  return ~rest;
}

template <class Integer>
void put(Bytes& out, Integer value) {
  const std::size_t at = out.size();
  out.resize(at + sizeof(Integer));
  store_little<Integer>(out, at, value);
}

void put_raw(Bytes& out, std::string_view text) {
  out.insert(out.end(), text.begin(), text.end());
}

void put_text(Bytes& out, std::string_view text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  put_raw(out, text);
}

/// Writes opcode and length around what is appended while it lives.
class OpenRecord {
 public:
  OpenRecord(Bytes& out, Opcode opcode) : out_(out) {
    put(out, static_cast<std::uint8_t>(opcode));
    put<std::uint64_t>(out, 0);
    start_ = out.size();
  }
  ~OpenRecord() { store_little<std::uint64_t>(out_, start_ - 8, out_.size() - start_); }
  OpenRecord(const OpenRecord&) = delete;
  OpenRecord& operator=(const OpenRecord&) = delete;
  [[nodiscard]] std::size_t start() const { return start_; }

 private:
  Bytes& out_;
  std::size_t start_ = 0;
};

/// Writes the length in bytes in front of a list or map.
class OpenList {
 public:
  explicit OpenList(Bytes& out) : out_(out) {
    put<std::uint32_t>(out, 0);
    start_ = out.size();
  }
  ~OpenList() {
    store_little<std::uint32_t>(out_, start_ - 4, static_cast<std::uint32_t>(out_.size() - start_));
  }
  OpenList(const OpenList&) = delete;
  OpenList& operator=(const OpenList&) = delete;

 private:
  Bytes& out_;
  std::size_t start_ = 0;
};

void put_map(Bytes& out, const std::map<std::uint16_t, std::uint64_t>& numbers) {
  const OpenList list(out);
  for (const auto& [key, value] : numbers) {
    put(out, key);
    put(out, value);
  }
}

void put_schema(Bytes& out, const Schema& schema) {
  const OpenRecord record(out, Opcode::schema);
  put(out, schema.id);
  put_text(out, schema.name);
  put_text(out, schema.encoding);
  put_text(out, schema.data);
}

void put_channel(Bytes& out, const Channel& channel) {
  const OpenRecord record(out, Opcode::channel);
  put(out, channel.id);
  put(out, channel.schema);
  put_text(out, channel.topic);
  put_text(out, channel.encoding);
  put<std::uint32_t>(out, 0);  // no metadata
}

/// Reads from the front. After all reads, ok() reports whether anything was missing.
class Cursor {
 public:
  explicit Cursor(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <class Integer>
  Integer number() {
    const auto piece = take(sizeof(Integer));
    return piece.empty() ? Integer{0} : load_little<Integer>(piece, 0);
  }
  std::span<const std::uint8_t> take(std::uint64_t size) {
    if (size > bytes_.size() - at_) {
      ok_ = false;
      at_ = bytes_.size();
      return {};
    }
    const auto piece = bytes_.subspan(at_, static_cast<std::size_t>(size));
    at_ += piece.size();
    return piece;
  }
  std::string_view text(std::uint64_t size) {
    const auto piece = take(size);
    return {reinterpret_cast<const char*>(piece.data()), piece.size()};
  }
  std::string_view text() { return text(number<std::uint32_t>()); }
  std::string_view rest() { return text(bytes_.size() - at_); }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t at() const { return at_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

template <class T>
Decoded<T> checked(T value, const Cursor& cursor) {
  if (!cursor.ok()) {
    return Malformed{"a length within a record", cursor.at()};
  }
  return {std::move(value), cursor.at()};
}

/// The next fields of a record, each as its type has it.
template <class... Fields>
void take_fields(Cursor& cursor, Fields&... fields) {
  const auto take = [&cursor](auto& field) {
    using Field = std::remove_reference_t<decltype(field)>;
    if constexpr (std::is_integral_v<Field>) {
      field = cursor.number<Field>();
    } else {
      field = cursor.text();
    }
  };
  (take(fields), ...);
}

}  // namespace

Writer::Writer(std::string_view library) {
  ready_.assign(kMagic.begin(), kMagic.end());
  const OpenRecord header(ready_, Opcode::header);
  put_text(ready_, "");
  put_text(ready_, library);
}

std::uint16_t Writer::add_schema(std::string_view name, std::string_view encoding,
                                 std::string_view data) {
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  schemas_.push_back({id, std::string(name), std::string(encoding), std::string(data)});
  put_schema(ready_, schemas_.back());
  return id;
}

std::uint16_t Writer::add_channel(std::uint16_t schema, std::string_view topic,
                                  std::string_view encoding) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  channels_.push_back({id, schema, std::string(topic), std::string(encoding)});
  sequences_.push_back(0);
  put_channel(ready_, channels_.back());
  return id;
}

void Writer::write(std::uint16_t channel, std::uint64_t time_ns, std::string_view data) {
  if (!chunk_.empty() &&
      (chunk_.size() + data.size() > kChunkBytes ||
       (time_ns > chunk_start_ns_ && time_ns - chunk_start_ns_ >= kChunkTime_ns))) {
    end_chunk();
  }
  if (chunk_.empty()) {
    chunk_start_ns_ = time_ns;
    chunk_end_ns_ = time_ns;
  }
  chunk_start_ns_ = std::min(chunk_start_ns_, time_ns);
  chunk_end_ns_ = std::max(chunk_end_ns_, time_ns);
  chunk_indices_[channel].push_back({time_ns, chunk_.size()});
  const OpenRecord record(chunk_, Opcode::message);
  put(chunk_, channel);
  put(chunk_, sequences_[channel]++);
  put(chunk_, time_ns);
  put(chunk_, time_ns);
  put_raw(chunk_, data);
}

void Writer::end_chunk() {
  if (chunk_.empty()) {
    return;
  }
  ChunkIndex index;
  index.start_ns = chunk_start_ns_;
  index.end_ns = chunk_end_ns_;
  index.offset = position();
  index.bytes = chunk_.size();
  {
    const OpenRecord record(ready_, Opcode::chunk);
    put(ready_, chunk_start_ns_);
    put(ready_, chunk_end_ns_);
    put<std::uint64_t>(ready_, chunk_.size());
    put(ready_, crc32(chunk_));
    put_text(ready_, "");  // not compressed
    put<std::uint64_t>(ready_, chunk_.size());
    ready_.insert(ready_.end(), chunk_.begin(), chunk_.end());
  }
  index.length = position() - index.offset;
  for (const auto& [channel, entries] : chunk_indices_) {
    index.indices[channel] = position();
    index.counts[channel] = entries.size();
    const OpenRecord record(ready_, Opcode::message_index);
    put(ready_, channel);
    const OpenList list(ready_);
    for (const IndexEntry& entry : entries) {
      put(ready_, entry.time_ns);
      put(ready_, entry.offset);
    }
  }
  index.index_length = position() - index.offset - index.length;
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_indices_.clear();
}

std::uint64_t Writer::forget() {
  std::uint64_t messages = 0;
  std::erase_if(chunks_, [&](const ChunkIndex& chunk) {
    if (chunk.offset < taken_) {
      return false;
    }
    for (const auto& [channel, count] : chunk.counts) {
      messages += count;
    }
    return true;
  });
  ready_.clear();
  return messages;
}

void Writer::attach(std::string_view name, std::string_view media_type, std::uint64_t time_ns,
                    std::string_view data) {
  Placed placed{position(), 0, time_ns, data.size(), std::string(name), std::string(media_type)};
  {
    const OpenRecord record(ready_, Opcode::attachment);
    put(ready_, time_ns);
    put(ready_, time_ns);
    put_text(ready_, name);
    put_text(ready_, media_type);
    put<std::uint64_t>(ready_, data.size());
    put_raw(ready_, data);
    put(ready_, crc32(std::span(ready_).subspan(record.start())));
  }
  placed.length = position() - placed.offset;
  attachments_.push_back(std::move(placed));
}

void Writer::describe(std::string_view name, const Pairs& pairs) {
  Placed placed{position(), 0, 0, 0, std::string(name), {}};
  {
    const OpenRecord record(ready_, Opcode::metadata);
    put_text(ready_, name);
    const OpenList list(ready_);
    for (const auto& [key, value] : pairs) {
      put_text(ready_, key);
      put_text(ready_, value);
    }
  }
  placed.length = position() - placed.offset;
  metadata_.push_back(std::move(placed));
}

void Writer::finish() {
  end_chunk();
  {
    const OpenRecord record(ready_, Opcode::data_end);
    put<std::uint32_t>(ready_, 0);
  }
  const std::uint64_t summary = position();
  struct Group {
    Opcode opcode;
    std::uint64_t start;
    std::uint64_t length;
  };
  std::vector<Group> groups;
  // Records of one kind are grouped; the positions of the groups follow them.
  const auto group = [&](Opcode opcode, const auto& items, const auto& write) {
    const std::uint64_t start = position();
    for (const auto& item : items) {
      write(item);
    }
    if (position() != start) {
      groups.push_back({opcode, start, position() - start});
    }
  };
  group(Opcode::schema, schemas_, [this](const Schema& schema) { put_schema(ready_, schema); });
  group(Opcode::channel, channels_,
        [this](const Channel& channel) { put_channel(ready_, channel); });
  std::uint64_t messages = 0;
  std::uint64_t first_ns = chunks_.empty() ? 0 : chunks_.front().start_ns;
  std::uint64_t last_ns = 0;
  std::map<std::uint16_t, std::uint64_t> counts;
  for (const ChunkIndex& chunk : chunks_) {
    first_ns = std::min(first_ns, chunk.start_ns);
    last_ns = std::max(last_ns, chunk.end_ns);
    for (const auto& [channel, count] : chunk.counts) {
      messages += count;
      counts[channel] += count;
    }
  }
  group(Opcode::statistics, std::array{0}, [&](int) {
    const OpenRecord record(ready_, Opcode::statistics);
    put(ready_, messages);
    put(ready_, static_cast<std::uint16_t>(schemas_.size()));
    put(ready_, static_cast<std::uint32_t>(channels_.size()));
    put(ready_, static_cast<std::uint32_t>(attachments_.size()));
    put(ready_, static_cast<std::uint32_t>(metadata_.size()));
    put(ready_, static_cast<std::uint32_t>(chunks_.size()));
    put(ready_, first_ns);
    put(ready_, last_ns);
    put_map(ready_, counts);
  });
  group(Opcode::chunk_index, chunks_, [this](const ChunkIndex& chunk) {
    const OpenRecord record(ready_, Opcode::chunk_index);
    put(ready_, chunk.start_ns);
    put(ready_, chunk.end_ns);
    put(ready_, chunk.offset);
    put(ready_, chunk.length);
    put_map(ready_, chunk.indices);
    put(ready_, chunk.index_length);
    put_text(ready_, "");
    put(ready_, chunk.bytes);
    put(ready_, chunk.bytes);
  });
  group(Opcode::attachment_index, attachments_, [this](const Placed& placed) {
    const OpenRecord record(ready_, Opcode::attachment_index);
    put(ready_, placed.offset);
    put(ready_, placed.length);
    put(ready_, placed.time_ns);
    put(ready_, placed.time_ns);
    put(ready_, placed.size);
    put_text(ready_, placed.name);
    put_text(ready_, placed.media_type);
  });
  group(Opcode::metadata_index, metadata_, [this](const Placed& placed) {
    const OpenRecord record(ready_, Opcode::metadata_index);
    put(ready_, placed.offset);
    put(ready_, placed.length);
    put_text(ready_, placed.name);
  });
  const std::uint64_t offsets = position();
  for (const Group& written : groups) {
    const OpenRecord record(ready_, Opcode::summary_offset);
    put(ready_, static_cast<std::uint8_t>(written.opcode));
    put(ready_, written.start);
    put(ready_, written.length);
  }
  {
    const OpenRecord record(ready_, Opcode::footer);
    put(ready_, summary);
    put(ready_, offsets);
    put<std::uint32_t>(ready_, 0);  // no checksum
  }
  ready_.insert(ready_.end(), kMagic.begin(), kMagic.end());
}

bool begins_with_magic(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kMagicSize && std::equal(kMagic.begin(), kMagic.end(), bytes.begin());
}

Decoded<Record> next_record(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kRecordHead) {
    return Incomplete{kRecordHead, bytes.size()};
  }
  const auto length = load_little<std::uint64_t>(bytes, 1);
  if (length > kLongestRecord) {
    return Malformed{"the length of a record", 1};
  }
  if (bytes.size() - kRecordHead < length) {
    return Incomplete{kRecordHead + static_cast<std::size_t>(length), bytes.size()};
  }
  const auto size = static_cast<std::size_t>(length);
  return {{static_cast<Opcode>(bytes[0]), bytes.subspan(kRecordHead, size)}, kRecordHead + size};
}

Decoded<Schema> read_schema(std::span<const std::uint8_t> content) {
  Cursor cursor(content);
  Schema schema;
  take_fields(cursor, schema.id, schema.name, schema.encoding, schema.data);
  return checked(std::move(schema), cursor);
}

Decoded<Channel> read_channel(std::span<const std::uint8_t> content) {
  Cursor cursor(content);
  Channel channel;
  take_fields(cursor, channel.id, channel.schema, channel.topic, channel.encoding);
  return checked(std::move(channel), cursor);
}

Decoded<Message> read_message(std::span<const std::uint8_t> content) {
  Cursor cursor(content);
  Message message;
  std::uint64_t published_ns = 0;
  take_fields(cursor, message.channel, message.sequence, message.time_ns, published_ns);
  message.data = cursor.rest();
  return checked(message, cursor);
}

Decoded<std::span<const std::uint8_t>> read_chunk(std::span<const std::uint8_t> content) {
  Cursor cursor(content);
  (void)cursor.take(8 + 8);  // times
  (void)cursor.take(8);      // length before compression
  const auto crc = cursor.number<std::uint32_t>();
  if (!cursor.text().empty()) {
    return Malformed{"a chunk that is compressed", cursor.at()};
  }
  const auto records = cursor.take(cursor.number<std::uint64_t>());
  if (cursor.ok() && crc != 0 && crc != crc32(records)) {
    return Malformed{"the checksum of a chunk", 8 + 8 + 8};
  }
  return checked(records, cursor);
}

Decoded<Attachment> read_attachment(std::span<const std::uint8_t> content) {
  Cursor cursor(content);
  (void)cursor.take(8 + 8);  // times
  Attachment attachment;
  take_fields(cursor, attachment.name, attachment.media_type);
  attachment.data = cursor.text(cursor.number<std::uint64_t>());
  return checked(std::move(attachment), cursor);
}

}  // namespace rigwire::protocols::mcap

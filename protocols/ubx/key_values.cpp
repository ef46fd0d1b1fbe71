#include "protocols/ubx/key_values.h"

#include "protocols/bytes.h"

namespace rigwire::protocols::ubx {
namespace {

constexpr std::size_t kKeyBytes = 4;
constexpr Malformed kOtherMessage{"another UBX message", 2};
constexpr Malformed kTooShort{"UBX payload length", 4};
constexpr Malformed kWrongVersion{"unknown version of a key list", kHeaderBytes};
constexpr Malformed kBadList{"cut or too long key list", kHeaderBytes + kKeyListHeadBytes};

using Payload = std::span<const std::uint8_t>;

/// How many pairs the list has; nothing when it is not sound.
std::optional<std::size_t> count_pairs(Payload list) {
  KeyValueReader reader(list);
  std::size_t count = 0;
  while (reader.next()) {
    ++count;
  }
  return reader.finished() && count <= kMaximumConfigurationItems ? std::optional(count)
                                                                  : std::nullopt;
}
std::optional<std::size_t> count_keys(Payload list) {
  const std::size_t count = list.size() / kKeyBytes;
  return list.size() % kKeyBytes == 0 && count <= kMaximumConfigurationItems ? std::optional(count)
                                                                             : std::nullopt;
}

std::size_t frame_bytes(const FrameView& frame) {
  return kOverheadBytes + frame.payload.size();
}

using CountOf = std::optional<std::size_t> (*)(Payload);

Decoded<KeyChange> decode_change(const FrameView& frame, MessageId id, CountOf count) {
  if (frame.id != id) {
    return kOtherMessage;
  }
  if (frame.payload.size() < kKeyListHeadBytes) {
    return kTooShort;
  }
  KeyChange change;
  change.version = frame.payload[0];
  change.layers = frame.payload[1];
  if (change.version > 1) {
    return kWrongVersion;
  }
  if (change.version == 1) {
    change.transaction = static_cast<Transaction>(frame.payload[2] & 3U);
  }
  change.list = frame.payload.subspan(kKeyListHeadBytes);
  const auto found = count(change.list);
  if (!found) {
    return kBadList;
  }
  change.count = *found;
  return {change, frame_bytes(frame)};
}

Decoded<KeyQuery> decode_query(const FrameView& frame, std::uint8_t version, CountOf count) {
  if (frame.id != kCfgValget) {
    return kOtherMessage;
  }
  if (frame.payload.size() < kKeyListHeadBytes) {
    return kTooShort;
  }
  if (frame.payload[0] != version) {
    return kWrongVersion;
  }
  KeyQuery query;
  query.layer = frame.payload[1];
  query.position = load_little<std::uint16_t>(frame.payload, 2);
  query.list = frame.payload.subspan(kKeyListHeadBytes);
  const auto found = count(query.list);
  if (!found) {
    return kBadList;
  }
  query.count = *found;
  return {query, frame_bytes(frame)};
}

}  // namespace

std::optional<KeyValue> KeyValueReader::next() {
  if (rest_.size() < kKeyBytes) {
    return std::nullopt;
  }
  KeyValue pair;
  pair.key = load_little<std::uint32_t>(rest_, 0);
  const std::size_t bytes = value_bytes(pair.key);
  if (bytes == 0 || rest_.size() < kKeyBytes + bytes) {
    return std::nullopt;
  }
  for (std::size_t i = bytes; i-- > 0;) {
    pair.value = pair.value << 8U | rest_[kKeyBytes + i];
  }
  rest_ = rest_.subspan(kKeyBytes + bytes);
  return pair;
}

std::optional<std::uint32_t> KeyReader::next() {
  if (rest_.size() < kKeyBytes) {
    return std::nullopt;
  }
  const auto key = load_little<std::uint32_t>(rest_, 0);
  rest_ = rest_.subspan(kKeyBytes);
  return key;
}

bool KeyListWriter::head(std::uint8_t version, std::uint8_t layer, std::uint16_t rest) {
  if (out_.size() < size_ + kKeyListHeadBytes) {
    return false;
  }
  out_[size_] = version;
  out_[size_ + 1] = layer;
  store_little(out_, size_ + 2, rest);
  size_ += kKeyListHeadBytes;
  return true;
}

bool KeyListWriter::key(std::uint32_t key) {
  if (out_.size() < size_ + kKeyBytes) {
    return false;
  }
  store_little(out_, size_, key);
  size_ += kKeyBytes;
  return true;
}

bool KeyListWriter::value(const KeyValue& pair) {
  const std::size_t bytes = value_bytes(pair.key);
  if (bytes == 0 || out_.size() < size_ + kKeyBytes + bytes) {
    return false;
  }
  store_little(out_, size_, pair.key);
  size_ += kKeyBytes;
  for (std::size_t i = 0; i < bytes; ++i) {
    out_[size_++] = static_cast<std::uint8_t>(pair.value >> (8U * i));
  }
  return true;
}

Decoded<KeyChange> decode_valset(const FrameView& frame) {
  return decode_change(frame, kCfgValset, count_pairs);
}

Decoded<KeyChange> decode_valdel(const FrameView& frame) {
  return decode_change(frame, kCfgValdel, count_keys);
}

Decoded<KeyQuery> decode_valget(const FrameView& frame) {
  return decode_query(frame, 0, count_keys);
}

Decoded<KeyQuery> decode_valget_reply(const FrameView& frame) {
  return decode_query(frame, 1, count_pairs);
}

}  // namespace rigwire::protocols::ubx

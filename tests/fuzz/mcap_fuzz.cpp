// Any bytes as records of an MCAP file: every record ends within them, and what is in one is read
// without reading beyond it.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/mcap/mcap.h"

namespace mcap = rigwire::protocols::mcap;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

static void read_records(std::span<const std::uint8_t> rest, int depth) {
  while (!rest.empty()) {
    const auto record = mcap::next_record(rest);
    if (!record.ok()) {
      require(record.malformed() || record.shortage().needed > rest.size());
      return;
    }
    require(record.consumed() >= 9 && record.consumed() <= rest.size());
    const auto content = record->content;
    if (const auto message = mcap::read_message(content); message.ok()) {
      require(message->data.size() + 22 == content.size());
    }
    (void)mcap::read_schema(content);
    (void)mcap::read_channel(content);
    if (const auto attachment = mcap::read_attachment(content); attachment.ok()) {
      require(attachment->data.size() < content.size());
    }
    if (const auto chunk = mcap::read_chunk(content); chunk.ok() && depth < 4) {
      require(chunk->size() < content.size());
      read_records(*chunk, depth + 1);
    }
    rest = rest.subspan(record.consumed());
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  read_records(mcap::begins_with_magic(bytes) ? bytes.subspan(mcap::kMagicSize) : bytes, 0);
  return 0;
}

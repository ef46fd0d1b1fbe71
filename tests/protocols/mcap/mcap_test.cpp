#include "protocols/mcap/mcap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "protocols/bytes.h"

namespace rigwire::protocols::mcap {
namespace {

constexpr std::uint64_t kStart_ns = 1'780'300'800'000'000'000;
constexpr std::uint64_t kSecond_ns = 1'000'000'000;

struct Contents {
  std::vector<std::string> messages;
  std::vector<Opcode> records;
  bool whole = false;
};

Contents read(std::span<const std::uint8_t> file) {
  Contents contents;
  if (!begins_with_magic(file)) {
    return contents;
  }
  file = file.subspan(kMagicSize);
  while (true) {
    const auto record = next_record(file);
    if (!record.ok()) {
      contents.whole = file.size() == kMagicSize && begins_with_magic(file);
      return contents;
    }
    contents.records.push_back(record->opcode);
    if (record->opcode == Opcode::chunk) {
      auto inner = *read_chunk(record->content);
      while (!inner.empty()) {
        const auto message = next_record(inner);
        contents.messages.emplace_back(read_message(message->content)->data);
        inner = inner.subspan(message.consumed());
      }
    }
    file = file.subspan(record.consumed());
  }
}

Bytes sample(std::size_t seconds) {
  Writer writer("rigwire");
  const auto schema = writer.add_schema("rigwire.Truth", "jsonschema", "{}");
  const auto truth = writer.add_channel(schema, "/truth", "json");
  const auto events = writer.add_channel(0, "/events", "json");
  writer.attach("rig.yaml", "application/yaml", kStart_ns, "name: pit");
  writer.describe("rigwire", {{"seed", "1"}});
  for (std::size_t i = 0; i < 10 * seconds; ++i) {
    const std::uint64_t now = kStart_ns + i * kSecond_ns / 10;
    writer.write(truth, now, "truth " + std::to_string(i));
    if (i % 10 == 0) {
      writer.write(events, now, "event " + std::to_string(i));
    }
  }
  writer.finish();
  return writer.bytes();
}

TEST(Mcap, WhatIsWrittenIsRead) {
  const Bytes file = sample(3);
  const Contents contents = read(file);
  EXPECT_TRUE(contents.whole);
  ASSERT_EQ(contents.messages.size(), 33U);
  EXPECT_EQ(contents.messages.front(), "truth 0");
  EXPECT_EQ(contents.messages[1], "event 0");
  EXPECT_EQ(contents.messages.back(), "truth 29");
  EXPECT_EQ(std::ranges::count(contents.records, Opcode::chunk), 3);
  EXPECT_EQ(std::ranges::count(contents.records, Opcode::chunk_index), 3);
  EXPECT_EQ(contents.records.back(), Opcode::footer);
}

TEST(Mcap, IndicesLeadToWhatTheyName) {
  const Bytes file = sample(2);
  std::span<const std::uint8_t> rest = std::span(file).subspan(kMagicSize);
  int chunks = 0;
  while (true) {
    const auto record = next_record(rest);
    if (!record.ok()) {
      break;
    }
    if (record->opcode == Opcode::chunk_index) {
      ++chunks;
      const auto offset = load_little<std::uint64_t>(record->content, 16);
      const auto length = load_little<std::uint64_t>(record->content, 24);
      const auto there = next_record(std::span(file).subspan(offset));
      ASSERT_TRUE(there.ok());
      EXPECT_EQ(there->opcode, Opcode::chunk);
      EXPECT_EQ(there.consumed(), length);
      // The index of the first channel, which follows the length of the map and its number.
      const auto index_at = load_little<std::uint64_t>(record->content, 32 + 4 + 2);
      const auto index = next_record(std::span(file).subspan(index_at));
      ASSERT_TRUE(index.ok());
      ASSERT_EQ(index->opcode, Opcode::message_index);
      const auto in_chunk = load_little<std::uint64_t>(index->content, 2 + 4 + 8);
      const auto message = next_record(read_chunk(there->content)->subspan(in_chunk));
      ASSERT_TRUE(message.ok());
      EXPECT_EQ(read_message(message->content)->time_ns,
                load_little<std::uint64_t>(index->content, 2 + 4));
    }
    if (record->opcode == Opcode::attachment_index) {
      const auto offset = load_little<std::uint64_t>(record->content, 0);
      const auto there = next_record(std::span(file).subspan(offset));
      ASSERT_EQ(there->opcode, Opcode::attachment);
      EXPECT_EQ(read_attachment(there->content)->data, "name: pit");
    }
    rest = rest.subspan(record.consumed());
  }
  EXPECT_EQ(chunks, 2);
}

TEST(Mcap, AFileThatEndsAnywhereIsGoodUpToItsLastWholeChunk) {
  const Bytes file = sample(3);
  std::size_t before = 0;
  for (std::size_t size = kMagicSize; size < file.size(); ++size) {
    const Contents contents = read(std::span(file).first(size));
    EXPECT_FALSE(contents.whole) << size;
    EXPECT_GE(contents.messages.size(), before) << size;
    before = contents.messages.size();
  }
  EXPECT_EQ(before, 33U);
}

TEST(Mcap, WhatADiskDidNotTakeIsInNoIndex) {
  Writer writer("rigwire");
  const auto channel = writer.add_channel(0, "/truth", "json");
  Bytes file = writer.bytes();
  writer.taken();
  for (std::uint64_t second = 0; second < 4; ++second) {
    writer.write(channel, kStart_ns + second * kSecond_ns, std::to_string(second));
    writer.end_chunk();
    if (second == 1) {
      EXPECT_EQ(writer.forget(), 1U);
    } else {
      file.insert(file.end(), writer.bytes().begin(), writer.bytes().end());
      writer.taken();
    }
  }
  writer.finish();
  file.insert(file.end(), writer.bytes().begin(), writer.bytes().end());
  const Contents contents = read(file);
  EXPECT_TRUE(contents.whole);
  EXPECT_EQ(contents.messages, (std::vector<std::string>{"0", "2", "3"}));
  EXPECT_EQ(std::ranges::count(contents.records, Opcode::chunk_index), 3);
}

TEST(Mcap, AChunkThatWasChangedIsTold) {
  Bytes file = sample(1);
  std::span<const std::uint8_t> rest = std::span(file).subspan(kMagicSize);
  while (next_record(rest)->opcode != Opcode::chunk) {
    rest = rest.subspan(next_record(rest).consumed());
  }
  const auto at = static_cast<std::size_t>(rest.data() - file.data());
  file[at + 100] ^= 1U;
  EXPECT_TRUE(read_chunk(next_record(std::span(file).subspan(at))->content).malformed());
}

}  // namespace
}  // namespace rigwire::protocols::mcap

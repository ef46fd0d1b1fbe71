#include "protocols/pcapng/pcapng.h"

#include <gtest/gtest.h>

#include <string>

#include "protocols/bytes.h"

namespace rigwire::protocols::pcapng {
namespace {

const Bytes kPayload{1, 2, 3, 4, 5};

Bytes sample() {
  Bytes file;
  append(file, Section{"rigwire 1", "rig pit"});
  append(file, Interface{LinkType::socketcan, "can", "slcan /tmp/can"});
  append(file, Interface{LinkType::rtac_serial, "gnss", ""});
  Packet packet;
  packet.interface = 1;
  packet.time_ns = 1'780'300'800'123'456'789;
  packet.bytes = kPayload;
  packet.direction = Direction::outbound;
  packet.lost_before = 7;
  packet.comment = "7 before this were not recorded";
  append(file, packet);
  append(file, Statistics{1, 1'780'300'801'000'000'000, 1, 7});
  return file;
}

std::vector<Block> read_all(std::span<const std::uint8_t> bytes, Reader& reader) {
  std::vector<Block> blocks;
  while (!bytes.empty()) {
    auto block = reader.next(bytes);
    if (!block.ok()) {
      break;
    }
    bytes = bytes.subspan(block.consumed());
    blocks.push_back(*block);
  }
  return blocks;
}

// From the document's figures of section, interface and enhanced packet block, by hand.
TEST(PcapNg, ASectionAndAnInterfaceByHand) {
  Bytes file;
  append(file, Section{});
  append(file, Interface{LinkType::ethernet, "a", ""});
  const Bytes expected{0x0A, 0x0D, 0x0D, 0x0A, 28, 0, 0, 0, 0x4D, 0x3C, 0x2B, 0x1A, 1, 0, 0, 0,
                       0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 28, 0, 0, 0,
                       // interface: Ethernet, no limit, name "a", resolution 9, end of options
                       1, 0, 0, 0, 40, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 'a', 0, 0, 0, 9,
                       0, 1, 0, 9, 0, 0, 0, 0, 0, 0, 0, 40, 0, 0, 0};
  EXPECT_EQ(file, expected);
}

TEST(PcapNg, WhatIsWrittenIsRead) {
  const Bytes file = sample();
  Reader reader;
  const std::vector<Block> blocks = read_all(file, reader);
  ASSERT_EQ(blocks.size(), 5U);
  EXPECT_EQ(std::get<Section>(blocks[0]).application, "rigwire 1");
  EXPECT_EQ(std::get<Section>(blocks[0]).comment, "rig pit");
  EXPECT_EQ(std::get<Interface>(blocks[1]).link, LinkType::socketcan);
  EXPECT_EQ(std::get<Interface>(blocks[1]).description, "slcan /tmp/can");
  const auto& packet = std::get<Packet>(blocks[3]);
  EXPECT_EQ(packet.time_ns, 1'780'300'800'123'456'789U);
  EXPECT_EQ(Bytes(packet.bytes.begin(), packet.bytes.end()), kPayload);
  EXPECT_EQ(packet.original_length, kPayload.size());
  EXPECT_EQ(packet.direction, Direction::outbound);
  EXPECT_EQ(packet.lost_before, 7U);
  EXPECT_EQ(packet.comment, "7 before this were not recorded");
  EXPECT_EQ(std::get<Statistics>(blocks[4]).lost, 7U);
  ASSERT_EQ(reader.interfaces().size(), 2U);
  EXPECT_EQ(reader.interfaces()[1].name, "gnss");
}

TEST(PcapNg, AFileThatEndsAnywhereIsGoodUpToItsLastWholeBlock) {
  const Bytes file = sample();
  Reader whole;
  const std::size_t blocks = read_all(file, whole).size();
  for (std::size_t size = 0; size < file.size(); ++size) {
    Reader reader;
    const auto cut = std::span(file).first(size);
    const std::size_t read = read_all(cut, reader).size();
    EXPECT_LT(read, blocks) << size;
    Reader again;
    std::span<const std::uint8_t> rest = cut;
    for (std::size_t i = 0; i < read; ++i) {
      rest = rest.subspan(again.next(rest).consumed());
    }
    EXPECT_TRUE(again.next(rest).incomplete()) << size;
  }
}

/// Every number of the sample's blocks in the other byte order, by the places that the format gives
/// them.
TEST(PcapNg, BothByteOrdersAndCoarserTimesAreRead) {
  const Bytes file{0x0A, 0x0D, 0x0D, 0x0A, 0, 0, 0, 28, 0x1A, 0x2B, 0x3C, 0x4D, 0, 1, 0, 0, 0xFF,
                   0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 28,
                   // interface without options: microseconds
                   0, 0, 0, 1, 0, 0, 0, 20, 0, 227, 0, 0, 0, 0, 0, 0, 0, 0, 0, 20,
                   // packet at 1 s and 2 us with one byte
                   0, 0, 0, 6, 0, 0, 0, 36, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x0F, 0x42, 0x42, 0, 0, 0, 1,
                   0, 0, 0, 1, 0xAB, 0, 0, 0, 0, 0, 0, 36};
  Reader reader;
  const std::vector<Block> blocks = read_all(file, reader);
  ASSERT_EQ(blocks.size(), 3U);
  EXPECT_EQ(std::get<Interface>(blocks[1]).link, LinkType::socketcan);
  EXPECT_EQ(std::get<Packet>(blocks[2]).time_ns, 1'000'002'000U);
  EXPECT_EQ(std::get<Packet>(blocks[2]).bytes[0], 0xAB);
}

TEST(PcapNg, WhatContradictsItselfIsMalformed) {
  const auto after_section = [](const Bytes& block) {
    Bytes file;
    append(file, Section{});
    Reader reader;
    (void)reader.next(file);
    return reader.next(block).malformed();
  };
  Bytes orphan;
  Packet packet;
  packet.bytes = kPayload;
  append(orphan, packet);
  EXPECT_TRUE(after_section(orphan)) << "a packet of no interface";
  EXPECT_TRUE(Reader().next(orphan).malformed()) << "a packet before the section";
  EXPECT_TRUE(after_section({6, 0, 0, 0, 13, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(after_section({6, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFC, 0, 0, 0, 0}));
  EXPECT_TRUE(after_section({9, 0, 0, 0, 12, 0, 0, 0, 16, 0, 0, 0})) << "two lengths that differ";
  Bytes file;
  append(file, Section{"x", ""});
  store_little<std::uint16_t>(file, 24 + 2, 400);  // length of the option
  EXPECT_TRUE(Reader().next(file).malformed());
}

}  // namespace
}  // namespace rigwire::protocols::pcapng

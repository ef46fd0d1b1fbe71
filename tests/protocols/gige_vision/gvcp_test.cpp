// Packets worked by hand after the tables that Aravis and Wireshark read by.
#include "protocols/gige_vision/gvcp.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rigwire::protocols::gige_vision {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const GvcpPacket& packet) {
  return {packet.view().begin(), packet.view().end()};
}

/// The status that the command is refused with; success when it is none.
Status refusal(const Bytes& datagram) {
  const auto packet = decode_command(datagram);
  EXPECT_TRUE(packet.ok());
  const auto interpreted = interpret(*packet);
  const auto* const status = std::get_if<Status>(&interpreted);
  return status == nullptr ? Status::success : *status;
}

template <class Kind>
Kind interpreted(const GvcpPacket& packet) {
  const auto decoded = decode_command(packet.view());
  EXPECT_TRUE(decoded.ok());
  return std::get<Kind>(std::get<Command>(interpret(*decoded)));
}

TEST(Gvcp, DiscoveryOfAravis) {
  EXPECT_EQ(bytes_of(encode_discovery(0xFFFF)), (Bytes{0x42, 0x01, 0, 2, 0, 0, 0xFF, 0xFF}));
  EXPECT_EQ(bytes_of(encode_discovery(0xFFFF, true)), (Bytes{0x42, 0x11, 0, 2, 0, 0, 0xFF, 0xFF}));
  EXPECT_FALSE(interpreted<Discovery>(encode_discovery(1)).broadcast_answer);
  EXPECT_TRUE(interpreted<Discovery>(encode_discovery(1, true)).broadcast_answer);
}

TEST(Gvcp, ForceIpHasItsAddressesAtTheirPlaces) {
  ForceIp command;
  command.mac = {0x02, 0x52, 0x57, 0, 0, 1};
  command.address = 0x7F00'0005;
  command.mask = 0xFF00'0000;
  command.gateway = 0x7F00'0001;
  const Bytes bytes = bytes_of(encode_force_ip(7, command));
  Bytes expected{0x42, 1, 0, 4, 0, 56, 0, 7};
  expected.resize(8 + 56);
  const Bytes mac{0x02, 0x52, 0x57, 0, 0, 1};
  std::copy(mac.begin(), mac.end(), expected.begin() + 8 + 2);
  expected[8 + 20] = 0x7F;
  expected[8 + 23] = 0x05;
  expected[8 + 36] = 0xFF;
  expected[8 + 52] = 0x7F;
  expected[8 + 55] = 0x01;
  EXPECT_EQ(bytes, expected);
  const auto again = interpreted<ForceIp>(encode_force_ip(7, command));
  EXPECT_EQ(again.mac, command.mac);
  EXPECT_EQ(again.address, command.address);
  EXPECT_EQ(again.mask, command.mask);
  EXPECT_EQ(again.gateway, command.gateway);
}

TEST(Gvcp, ResendWithShortIdentifiers) {
  const auto packet = encode_packet_resend(0x1234, {0, false, 0xABCD, 5, 9});
  EXPECT_EQ(bytes_of(packet),
            (Bytes{0x42, 0, 0, 0x40, 0, 12, 0x12, 0x34, 0, 0, 0xAB, 0xCD, 0, 0, 0, 5, 0, 0, 0, 9}));
  const auto again = interpreted<PacketResend>(packet);
  EXPECT_EQ(again.block, 0xABCDU);
  EXPECT_EQ(again.first, 5U);
  EXPECT_EQ(again.last, 9U);
  EXPECT_FALSE(again.extended_ids);
}

TEST(Gvcp, ResendWithExtendedIdentifiers) {
  const auto packet = encode_packet_resend(2, {0, true, 0x1'0000'0001, 5, 0x0100'0000});
  EXPECT_EQ(bytes_of(packet), (Bytes{0x42, 0x10, 0, 0x40, 0, 20, 0, 2,  //
                                     0,    0,    0, 0,    0, 0,  0, 5,  //
                                     1,    0,    0, 0,                  //
                                     0,    0,    0, 1,    0, 0,  0, 1}));
  const auto again = interpreted<PacketResend>(packet);
  EXPECT_EQ(again.block, 0x1'0000'0001U);
  EXPECT_EQ(again.last, 0x0100'0000U);
}

TEST(Gvcp, ResendOfNoBlockOrBackwardIsRefused) {
  EXPECT_EQ(refusal(bytes_of(encode_packet_resend(2, {0, false, 0, 5, 9}))),
            Status::invalid_parameter);
  EXPECT_EQ(refusal(bytes_of(encode_packet_resend(2, {0, false, 1, 9, 5}))),
            Status::invalid_parameter);
}

TEST(Gvcp, ControlIsAskedForAsAravisDoes) {
  const RegisterValue ccp{0x0A00, 2};
  EXPECT_EQ(bytes_of(encode_write_registers(0xFF15, std::span(&ccp, 1))),
            (Bytes{0x42, 1, 0, 0x82, 0, 8, 0xFF, 0x15, 0, 0, 0x0A, 0, 0, 0, 0, 2}));
  EXPECT_EQ(bytes_of(encode_written(Status::success, CommandCode::write_registers, 0xFF15, 1)),
            (Bytes{0, 0, 0, 0x83, 0, 4, 0xFF, 0x15, 0, 0, 0, 1}));
}

TEST(Gvcp, SeveralRegistersInOneCommand) {
  const std::vector<RegisterValue> pairs{{0x0D00, 50000}, {0x0D18, 0x7F00'0001}};
  const auto packet = encode_write_registers(3, pairs);
  const auto decoded = decode_command(packet.view());
  const auto written = std::get<WriteRegisters>(std::get<Command>(interpret(*decoded)));
  ASSERT_EQ(written.size(), 2U);
  EXPECT_EQ(written.address(1), 0x0D18U);
  EXPECT_EQ(written.value(1), 0x7F00'0001U);

  const std::vector<std::uint32_t> addresses{0x0934, 0x0004, 0x0A00};
  const auto reading = encode_read_registers(4, addresses);
  const auto read = decode_command(reading.view());
  const auto asked = std::get<ReadRegisters>(std::get<Command>(interpret(*read)));
  ASSERT_EQ(asked.addresses.size(), 3U);
  EXPECT_EQ(asked.addresses[2], 0x0A00U);
}

TEST(Gvcp, MemoryIsReadInWholeWordsUpTo536Bytes) {
  EXPECT_EQ(bytes_of(encode_read_memory(1, 0x200, 512)),
            (Bytes{0x42, 1, 0, 0x84, 0, 8, 0, 1, 0, 0, 2, 0, 0, 0, 2, 0}));
  EXPECT_EQ(interpreted<ReadMemory>(encode_read_memory(1, 0x200, 536)).count, 536);
  EXPECT_EQ(refusal(bytes_of(encode_read_memory(1, 0x200, 540))), Status::invalid_parameter);
  EXPECT_EQ(refusal(bytes_of(encode_read_memory(1, 0x200, 0))), Status::invalid_parameter);
  EXPECT_EQ(refusal(bytes_of(encode_read_memory(1, 0x200, 6))), Status::bad_alignment);
  EXPECT_EQ(refusal(bytes_of(encode_read_memory(1, 0x202, 8))), Status::bad_alignment);
}

TEST(Gvcp, MemoryIsWrittenInWholeWords) {
  const Bytes name{'l', 'e', 'f', 't'};
  const auto packet = encode_write_memory(1, 0xE8, name);
  EXPECT_EQ(bytes_of(packet),
            (Bytes{0x42, 1, 0, 0x86, 0, 8, 0, 1, 0, 0, 0, 0xE8, 'l', 'e', 'f', 't'}));
  EXPECT_EQ(refusal(bytes_of(encode_write_memory(1, 0xE9, name))), Status::bad_alignment);
  EXPECT_EQ(refusal(bytes_of(encode_write_memory(1, 0xE8, Bytes{1, 2, 3}))), Status::bad_alignment);
  EXPECT_EQ(refusal(bytes_of(encode_write_memory(1, 0xE8, {}))), Status::invalid_header);
}

TEST(Gvcp, AlignmentOfEveryAddressIsChecked) {
  const std::vector<std::uint32_t> addresses{0x0934, 0x0006};
  EXPECT_EQ(refusal(bytes_of(encode_read_registers(4, addresses))), Status::bad_alignment);
  const std::vector<RegisterValue> pairs{{0x0D00, 1}, {0x0D03, 1}};
  EXPECT_EQ(refusal(bytes_of(encode_write_registers(4, pairs))), Status::bad_alignment);
}

TEST(Gvcp, LengthsThatACommandCannotHave) {
  EXPECT_EQ(refusal({0x42, 1, 0, 2, 0, 4, 0, 1, 0, 0, 0, 0}), Status::invalid_header);
  EXPECT_EQ(refusal({0x42, 1, 0, 0x80, 0, 0, 0, 1}), Status::invalid_header);
  EXPECT_EQ(refusal({0x42, 1, 0, 0x80, 0, 2, 0, 1, 0, 0}), Status::invalid_header);
  EXPECT_EQ(refusal({0x42, 1, 0, 0x82, 0, 4, 0, 1, 0, 0, 0, 0}), Status::invalid_header);
  EXPECT_EQ(refusal({0x42, 1, 0, 0x40, 0, 4, 0, 1, 0, 0, 0, 0}), Status::invalid_header);
  EXPECT_EQ(refusal({0x42, 1, 0, 4, 0, 4, 0, 1, 0, 0, 0, 0}), Status::invalid_header);
  EXPECT_EQ(refusal({0x42, 1, 0, 0x84, 0, 4, 0, 1, 0, 0, 0, 0}), Status::invalid_header);
}

TEST(Gvcp, CommandsThatAreNotThere) {
  for (const std::uint8_t code : Bytes{0xC0, 0xC2, 0x7F}) {  // EVENT, EVENTDATA, none
    EXPECT_EQ(refusal({0x42, 1, 0, code, 0, 0, 0, 1}), Status::not_implemented);
  }
}

TEST(Gvcp, EveryTruncationIsIncompleteAndABitMoreIsMalformed) {
  const Bytes whole = bytes_of(encode_read_memory(1, 0x200, 512));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto packet = decode_command(std::span(whole).first(size));
    ASSERT_TRUE(packet.incomplete()) << size;
    EXPECT_EQ(packet.shortage().needed, size < 8 ? 8U : whole.size());
    EXPECT_EQ(peek_header(std::span(whole).first(size)).has_value(), size >= 8) << size;
  }
  Bytes longer = whole;
  longer.push_back(0);
  ASSERT_TRUE(decode_command(longer).malformed());
  EXPECT_EQ(peek_header(longer)->command, 0x84);
}

TEST(Gvcp, WhatIsNoCommandIsNotEvenRefused) {
  EXPECT_TRUE(decode_command(Bytes{0x43, 1, 0, 2, 0, 0, 0, 1}).malformed());
  EXPECT_FALSE(peek_header(Bytes{0x43, 1, 0, 2, 0, 0, 0, 1}));
  EXPECT_TRUE(decode_command(Bytes{0x42, 1, 0, 2, 0, 0, 0, 0}).malformed());
  EXPECT_FALSE(peek_header(Bytes{0x42, 1, 0, 2, 0, 0, 0, 0}));
}

TEST(Gvcp, CommandsBeyondThePacketSizeAreMalformed) {
  Bytes longest{0x42, 1, 0, 0x86, 0x02, 0x1C, 0, 1};  // 540 bytes of payload
  longest.resize(548);
  EXPECT_TRUE(decode_command(longest).ok());
  longest[5] = 0x20;
  longest.resize(552);
  EXPECT_TRUE(decode_command(longest).malformed());
}

TEST(Gvcp, AcknowledgesReadBack) {
  GvcpPacket memory = begin_acknowledge(Status::success, 0x85, 9);
  memory.word(0x200);
  memory.append(Bytes{'L', 'o', 'c', 'a'});
  memory.finish();
  const auto decoded = decode_acknowledge(memory.view());
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded->acknowledge, 0x85);
  EXPECT_EQ(decoded->request, 9);
  const auto content = decode_memory(*decoded);
  ASSERT_TRUE(content.ok());
  EXPECT_EQ(content->address, 0x200U);
  EXPECT_EQ(std::string(content->bytes.begin(), content->bytes.end()), "Loca");

  const auto refused = encode_acknowledge(Status::access_denied, 0x83, 10);
  EXPECT_EQ(bytes_of(refused), (Bytes{0x80, 0x06, 0, 0x83, 0, 0, 0, 10}));
  EXPECT_TRUE(is_error(decode_acknowledge(refused.view())->status));
  EXPECT_TRUE(decode_memory(*decode_acknowledge(refused.view())).incomplete());
  EXPECT_TRUE(decode_count(*decode_acknowledge(refused.view())).incomplete());
}

TEST(Gvcp, PendingSaysHowLong) {
  const auto pending = encode_pending(9, 1500);
  EXPECT_EQ(bytes_of(pending), (Bytes{0, 0, 0, 0x89, 0, 4, 0, 9, 0, 0, 0x05, 0xDC}));
  EXPECT_EQ(*decode_count(*decode_acknowledge(pending.view())), 1500);
}

TEST(Gvcp, RegisterValuesAreWholeWords) {
  const Bytes values{0, 0, 0x00, 0x81, 0, 8, 0, 9, 0, 0, 0, 1, 0xFF, 0, 0, 2};
  const auto acknowledge = decode_acknowledge(values);
  ASSERT_TRUE(acknowledge.ok());
  const auto words = decode_register_values(*acknowledge);
  ASSERT_TRUE(words.ok());
  EXPECT_EQ((*words)[1], 0xFF00'0002U);
  const Bytes odd{0, 0, 0x00, 0x81, 0, 2, 0, 9, 0, 0};
  EXPECT_TRUE(decode_register_values(*decode_acknowledge(odd)).malformed());
}

}  // namespace
}  // namespace rigwire::protocols::gige_vision

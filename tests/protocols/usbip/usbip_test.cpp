#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "protocols/bytes.h"
#include "protocols/usbip/commands.h"
#include "protocols/usbip/operations.h"

namespace rigwire::protocols::usbip {
namespace {

using Bytes = std::vector<std::uint8_t>;

DeviceRecord receiver() {
  DeviceRecord record;
  record.path = "/rigwire/gnss";
  record.bus_id = "1-2";
  record.bus = 1;
  record.device = 2;
  record.vendor = 0x1546;
  record.product = 0x01A7;
  record.release = 0x0100;
  record.device_class = 2;
  record.configuration_value = 1;
  record.configurations = 1;
  record.interfaces = 2;
  return record;
}

Submit read_of(std::uint32_t length) {
  Submit submit;
  submit.number = 7;
  submit.device = 0x00010002;
  submit.to_host = true;
  submit.endpoint = 2;
  submit.length = length;
  return submit;
}

Bytes with_word(const CommandBytes& header, std::size_t at, std::uint32_t value) {
  Bytes bytes(header.begin(), header.end());
  store_big(std::span(bytes), at, value);
  return bytes;
}

TEST(UsbIpOperations, TheClientsRequestsAreTheKernelToolsBytes) {
  EXPECT_THAT(encode_request(DeviceListRequest{}),
              ::testing::ElementsAre(0x01, 0x11, 0x80, 0x05, 0, 0, 0, 0));
  ImportRequest import;
  import.bus_id = {'1', '-', '2'};
  Bytes expected{0x01, 0x11, 0x80, 0x03, 0, 0, 0, 0, '1', '-', '2'};
  expected.resize(40);
  EXPECT_EQ(encode_request(import), expected);
  const auto decoded = decode_request(expected);
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(std::get<ImportRequest>(*decoded).name(), "1-2");
}

TEST(UsbIpOperations, AnImportReplyHasItsFieldsWhereLinuxReadsThem) {
  const Bytes bytes = encode_import_reply(receiver());
  ASSERT_EQ(bytes.size(), 320U);
  EXPECT_EQ(bytes[8], '/');
  EXPECT_EQ(bytes[8 + 256], '1');
  EXPECT_THAT(std::span(bytes).subspan(8 + 288),
              ::testing::ElementsAre(0, 0, 0, 1,                          // bus
                                     0, 0, 0, 2,                          // device
                                     0, 0, 0, 2,                          // full speed
                                     0x15, 0x46, 0x01, 0xA7, 0x01, 0x00,  // identity
                                     2, 0, 0,                             // class
                                     1, 1, 2));  // configuration, how many, interfaces
  EXPECT_THAT(encode_import_refusal(), ::testing::ElementsAre(1, 0x11, 0, 3, 0, 0, 0, 1));
}

TEST(UsbIpOperations, RepliesSurviveTheRoundTripAndEveryCutIsIncomplete) {
  const std::vector<ListedDevice> listed{{receiver(), {{2, 2, 1}, {10, 0, 255}}}};
  const Bytes list = encode_device_list(listed);
  EXPECT_EQ(list.size(), 8U + 4U + 312U + 2U * 4U);
  EXPECT_EQ(*decode_device_list(list), listed);
  for (std::size_t size = 0; size < list.size(); ++size) {
    EXPECT_TRUE(decode_device_list(std::span(list).first(size)).incomplete()) << size;
  }
  const Bytes import = encode_import_reply(receiver());
  EXPECT_EQ(decode_import_reply(import)->device, receiver());
  for (std::size_t size = 0; size < import.size(); ++size) {
    EXPECT_TRUE(decode_import_reply(std::span(import).first(size)).incomplete()) << size;
  }
  EXPECT_EQ(decode_import_reply(encode_import_refusal())->status, OperationStatus::failed);
}

TEST(UsbIpOperations, AnotherVersionOrOperationIsSeenAtOnce) {
  EXPECT_TRUE(decode_request(Bytes{0x01, 0x06}).malformed());
  EXPECT_TRUE(decode_request(Bytes{0x01, 0x11, 0x00, 0x05}).malformed());
  EXPECT_TRUE(decode_request(Bytes{0x01, 0x11, 0x80}).incomplete());
}

TEST(UsbIpCommands, ASubmitHasItsFieldsWhereLinuxPutsThem) {
  Submit submit = read_of(18);
  submit.endpoint = 0;
  submit.flags = 0x200;
  submit.setup = {0x80, 6, 0, 1, 0, 0, 18, 0};
  const CommandBytes bytes = encode(submit);
  EXPECT_THAT(bytes, ::testing::ElementsAre(0, 0, 0, 1, 0, 0, 0, 7, 0, 1, 0, 2, 0, 0, 0, 1,   //
                                            0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 18, 0, 0, 0, 0,  //
                                            0, 0, 0, 0, 0, 0, 0, 0, 0x80, 6, 0, 1, 0, 0, 18, 0));
  EXPECT_EQ(std::get<Submit>(*decode_from_host(bytes)), submit);
}

TEST(UsbIpCommands, RepliesSurviveTheRoundTrip) {
  const SubmitReply reply{9, -32, 4};
  EXPECT_EQ(std::get<SubmitReply>(*decode_from_device(encode(reply))), reply);
  const UnlinkReply unlinked{10, -104};
  EXPECT_EQ(std::get<UnlinkReply>(*decode_from_device(encode(unlinked))), unlinked);
  const Unlink unlink{11, 0x10001, 9};
  EXPECT_EQ(std::get<Unlink>(*decode_from_host(encode(unlink))), unlink);
}

TEST(UsbIpCommands, BothWaysToSayNoPacketsAreUnderstood) {
  const CommandBytes header = encode(read_of(64));
  EXPECT_EQ(std::get<Submit>(*decode_from_host(with_word(header, 32, 0xFFFFFFFF))).packets, 0U);
  EXPECT_EQ(std::get<Submit>(*decode_from_host(header)).packets, 0U);
  EXPECT_EQ(std::get<Submit>(*decode_from_host(with_word(header, 32, 1024))).tail_size(),
            1024U * 16U);
  EXPECT_TRUE(decode_from_host(with_word(header, 32, 1025)).malformed());
}

TEST(UsbIpCommands, HostileLengthsAreRefused) {
  const CommandBytes read = encode(read_of(64));
  EXPECT_TRUE(decode_from_host(with_word(read, 24, 0x80000000)).malformed());
  EXPECT_TRUE(decode_from_host(with_word(read, 24, 0xFFFFFFFF)).malformed());
  EXPECT_TRUE(decode_from_host(with_word(read, 24, 0x7FFFFFFF)).ok());
  Submit write = read_of(64);
  write.to_host = false;
  EXPECT_EQ(write.tail_size(), 64U);
  EXPECT_TRUE(decode_from_host(with_word(encode(write), 24, 1U << 20U)).ok());
  EXPECT_TRUE(decode_from_host(with_word(encode(write), 24, (1U << 20U) + 1U)).malformed());
}

TEST(UsbIpCommands, WhatNoHostSaysIsMalformed) {
  const CommandBytes header = encode(read_of(64));
  EXPECT_TRUE(decode_from_host(with_word(header, 0, 3)).malformed());
  EXPECT_TRUE(decode_from_host(with_word(header, 0, 0)).malformed());
  EXPECT_TRUE(decode_from_host(with_word(header, 12, 2)).malformed());
  EXPECT_TRUE(decode_from_host(with_word(header, 16, 16)).malformed());
  for (std::size_t size = 0; size < header.size(); ++size) {
    EXPECT_TRUE(decode_from_host(std::span(header).first(size)).incomplete()) << size;
  }
}

}  // namespace
}  // namespace rigwire::protocols::usbip

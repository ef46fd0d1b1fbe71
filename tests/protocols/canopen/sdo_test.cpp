// Frames worked by hand from CiA 301, 7.2.4.3.
#include "protocols/canopen/sdo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string_view>

#include "protocols/canopen/identifiers.h"
#include "protocols/canopen/object_entry.h"

namespace rigwire::protocols::canopen {
namespace {

using testing::ElementsAre;

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

TEST(Sdo, UploadAndItsExpeditedAnswer) {
  EXPECT_THAT(make_upload({0x6004, 0}), ElementsAre(0x40, 0x04, 0x60, 0, 0, 0, 0, 0));
  const std::array<std::uint8_t, 4> four{0x78, 0x56, 0x34, 0x12};
  EXPECT_THAT(make_upload_answer({0x6004, 0}, four),
              ElementsAre(0x43, 0x04, 0x60, 0, 0x78, 0x56, 0x34, 0x12));
  EXPECT_THAT(make_upload_answer({0x1017, 0}, std::span(four).first(2)),
              ElementsAre(0x4B, 0x17, 0x10, 0, 0x78, 0x56, 0, 0));
  EXPECT_THAT(make_upload_answer({0x1001, 0}, std::span(four).first(1)),
              ElementsAre(0x4F, 0x01, 0x10, 0, 0x78, 0, 0, 0));
}

TEST(Sdo, DownloadOfEachLength) {
  EXPECT_THAT(make_download({0x1010, 1}, bytes_of("save")),
              ElementsAre(0x23, 0x10, 0x10, 1, 's', 'a', 'v', 'e'));
  const std::array<std::uint8_t, 2> word{0xE8, 0x03};
  const SdoPayload download = make_download({0x1017, 0}, word);
  EXPECT_THAT(download, ElementsAre(0x2B, 0x17, 0x10, 0, 0xE8, 0x03, 0, 0));
  const auto request = decode_sdo_request(download);
  ASSERT_TRUE(request.ok());
  EXPECT_EQ(request->kind, SdoRequestKind::download);
  EXPECT_EQ(request->object, (ObjectAddress{0x1017, 0}));
  EXPECT_EQ(request->length, 2);
  EXPECT_TRUE(request->size_indicated);
  EXPECT_THAT(make_download_answer({0x1017, 0}), ElementsAre(0x60, 0x17, 0x10, 0, 0, 0, 0, 0));
}

TEST(Sdo, SizeThatIsNotSaidIsFour) {
  const std::array<std::uint8_t, 8> payload{0x22, 0x17, 0x10, 0, 0xE8, 0x03, 0, 0};
  const auto request = decode_sdo_request(payload);
  EXPECT_EQ(request->length, 4);
  EXPECT_FALSE(request->size_indicated);
}

TEST(Sdo, SegmentsOfAString) {
  EXPECT_THAT(make_upload_announcement({0x1008, 0}, 10),
              ElementsAre(0x41, 0x08, 0x10, 0, 10, 0, 0, 0));
  EXPECT_THAT(make_upload_segment_request(true), ElementsAre(0x70, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(make_upload_segment(false, false, bytes_of("Encoder")),
              ElementsAre(0x00, 'E', 'n', 'c', 'o', 'd', 'e', 'r'));
  EXPECT_THAT(make_upload_segment(true, true, bytes_of("406")),
              ElementsAre(0x19, '4', '0', '6', 0, 0, 0, 0));
}

TEST(Sdo, AbortCarriesItsCode) {
  EXPECT_THAT(make_abort({0x6004, 0}, SdoAbort::write_of_read_only),
              ElementsAre(0x80, 0x04, 0x60, 0, 0x02, 0x00, 0x01, 0x06));
}

TEST(Sdo, OtherLengthsAndBlockTransfers) {
  const std::array<std::uint8_t, 8> block{0xA4, 0x08, 0x10, 0, 0, 0, 0, 0};
  EXPECT_EQ(decode_sdo_request(block)->kind, SdoRequestKind::other);
  for (std::size_t length = 0; length < block.size(); ++length) {
    EXPECT_TRUE(decode_sdo_request(std::span(block).first(length)).malformed()) << length;
  }
}

TEST(CanopenManagement, CommandsAndStates) {
  const can::Frame start = make_network_request({NetworkCommand::start, 5});
  EXPECT_EQ(start.id, 0U);
  EXPECT_THAT(start.payload(), ElementsAre(0x01, 0x05));
  EXPECT_EQ(decode_network_request(start)->node_id, 5);
  can::Frame odd = start;
  odd.data[0] = 3;
  EXPECT_FALSE(decode_network_request(odd));
  odd = start;
  odd.length = 1;
  EXPECT_FALSE(decode_network_request(odd));
  EXPECT_EQ(make_heartbeat(5, NodeState::pre_operational).id, 0x705U);
  EXPECT_THAT(make_heartbeat(5, NodeState::pre_operational).payload(), ElementsAre(0x7F));
  EXPECT_THAT(make_emergency(0x85, {0x5000, 0x81, 0}).payload(),
              ElementsAre(0x00, 0x50, 0x81, 0, 0, 0, 0, 0));
}

TEST(ObjectEntryValues, SignsSurvive) {
  std::array<std::uint8_t, 4> bytes{};
  for (const std::int64_t value : {-32768LL, -1LL, 0LL, 32767LL}) {
    store(DataType::integer16, std::span(bytes).first(2), value);
    EXPECT_EQ(load(DataType::integer16, std::span(bytes).first(2)), value);
  }
  store(DataType::integer32, bytes, -5);
  EXPECT_THAT(bytes, ElementsAre(0xFB, 0xFF, 0xFF, 0xFF));
  EXPECT_EQ(load(DataType::unsigned32, bytes), 0xFFFFFFFB);
}

}  // namespace
}  // namespace rigwire::protocols::canopen

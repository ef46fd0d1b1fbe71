#include "protocols/velodyne/packet_layout.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <utility>

namespace rigwire::protocols::velodyne {
namespace {

const Model& packet_layout_model(std::string_view name) {
  return *find_model(name);
}

TEST(VelodynePacketLayout, EveryLaserOfEveryFiringStandsOnce) {
  for (const Model& packet_layout_model : models()) {
    for (const ReturnMode mode : {ReturnMode::strongest, ReturnMode::dual}) {
      std::map<std::pair<std::size_t, std::size_t>, int> seen;
      for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
        if (block_place(packet_layout_model, mode, b).echo == BlockEcho::none) {
          continue;
        }
        for (std::size_t c = 0; c < kChannelsPerBlock; ++c) {
          const Shot fired = shot(packet_layout_model, mode, b, c);
          ++seen[{fired.firing, fired.laser}];
        }
      }
      EXPECT_EQ(seen.size(),
                firings_per_packet(packet_layout_model, mode) * packet_layout_model.lasers.size())
          << packet_layout_model.name;
      for (const auto& [place, times] : seen) {
        EXPECT_EQ(times, mode == ReturnMode::dual ? 2 : 1) << packet_layout_model.name;
      }
    }
  }
}

TEST(VelodynePacketLayout, TimesAreThoseOfTheFiringTables) {
  const auto single = ReturnMode::strongest;
  EXPECT_EQ(shot(packet_layout_model("HDL-32E"), single, 11, 31).packet_offset_ns,
            11 * 46080 + 31 * 1152);
  EXPECT_EQ(shot(packet_layout_model("HDL-32E"), ReturnMode::dual, 11, 31).packet_offset_ns,
            5 * 46080 + 31 * 1152);
  EXPECT_EQ(shot(packet_layout_model("VLP-16"), single, 11, 31).packet_offset_ns,
            23 * 55296 + 15 * 2304);
  EXPECT_EQ(shot(packet_layout_model("VLP-16"), ReturnMode::dual, 3, 16).packet_offset_ns,
            3 * 55296);
  EXPECT_EQ(shot(packet_layout_model("VLP-32C"), single, 2, 31).packet_offset_ns,
            2 * 55296 + 15 * 2304);
  EXPECT_EQ(shot(packet_layout_model("HDL-64E S2"), single, 11, 31).packet_offset_ns,
            5 * 48000 + 42000 + 3660);
  EXPECT_EQ(shot(packet_layout_model("HDL-64E S2"), single, 10, 31).packet_offset_ns,
            shot(packet_layout_model("HDL-64E S2"), single, 11, 31).packet_offset_ns)
      << "the banks fire together";
  EXPECT_EQ(shot(packet_layout_model("HDL-64E S3"), ReturnMode::dual, 11, 1).packet_offset_ns,
            2 * 57600 + 1300);
}

TEST(VelodynePacketLayout, VlsStampBelongsToTheFourthGroup) {
  const Model& vls = *find_model("VLS-128", "5.1.7");
  EXPECT_EQ(shot(vls, ReturnMode::strongest, 0, 0).packet_offset_ns, -8700);
  EXPECT_EQ(shot(vls, ReturnMode::strongest, 0, 24).packet_offset_ns, -8700 + 3 * 2665);
  EXPECT_EQ(shot(vls, ReturnMode::strongest, 11, 31).packet_offset_ns,
            2 * 53300 + 16 * 2665 - 8700);
  EXPECT_EQ(shot(vls, ReturnMode::dual, 7, 31).packet_offset_ns, 16 * 2665 - 8700);
  EXPECT_EQ(block_place(vls, ReturnMode::dual, 7).echo, BlockEcho::strongest);
  EXPECT_EQ(block_place(vls, ReturnMode::dual, 8).echo, BlockEcho::none);
  EXPECT_EQ(firings_per_packet(vls, ReturnMode::dual), 1U);
}

TEST(VelodynePacketLayout, Hdl64SendsTheLastEchoAfterBothBanksOfTheStrongest) {
  const Model& hdl = packet_layout_model("HDL-64E S3");
  const auto place = [&hdl](std::size_t block) {
    return block_place(hdl, ReturnMode::dual, block);
  };
  EXPECT_EQ(place(0), (BlockPlace{0, 0, BlockEcho::strongest}));
  EXPECT_EQ(place(1), (BlockPlace{0, 32, BlockEcho::strongest}));
  EXPECT_EQ(place(2), (BlockPlace{0, 0, BlockEcho::last}));
  EXPECT_EQ(place(3), (BlockPlace{0, 32, BlockEcho::last}));
  EXPECT_EQ(place(4), (BlockPlace{1, 0, BlockEcho::strongest}));
}

TEST(VelodynePacketLayout, PacketsOfTwoReturnsComeTwiceAsOften) {
  for (const std::string_view name : {"HDL-32E", "VLP-16", "Puck Hi-Res", "VLP-32C"}) {
    EXPECT_EQ(packet_period_ns(packet_layout_model(name), ReturnMode::strongest),
              2 * packet_period_ns(packet_layout_model(name), ReturnMode::dual));
  }
  EXPECT_EQ(packet_period_ns(packet_layout_model("HDL-32E"), ReturnMode::last), 552960);
  EXPECT_EQ(packet_period_ns(packet_layout_model("VLP-16"), ReturnMode::last), 1327104);
  EXPECT_EQ(packet_period_ns(*find_model("VLS-128", "5.1.7"), ReturnMode::strongest), 159900);
  EXPECT_EQ(packet_period_ns(packet_layout_model("VLS-128"), ReturnMode::strongest), 173340);
  EXPECT_EQ(packet_period_ns(packet_layout_model("HDL-64E S3"), ReturnMode::dual), 172800);
}

TEST(VelodyneRecognition, TellsTheModelOrTheDoubt) {
  DataPacket packet;
  packet.product_id = 0x28;
  EXPECT_EQ(recognize(packet).model, &packet_layout_model("VLP-32C"));
  packet.product_id = 0x24;
  EXPECT_EQ(recognize(packet).model, &packet_layout_model("Puck Hi-Res"));
  for (const std::uint8_t id : std::array<std::uint8_t, 4>{0x00, 0x23, 0x31, 0xA1}) {
    packet.product_id = id;
    EXPECT_EQ(recognize(packet).model, nullptr) << int{id};
    EXPECT_FALSE(recognize(packet).doubt.empty());
  }
  packet.blocks[1].flag = kFlagLasers32To63;
  packet.product_id = 'U';
  EXPECT_NE(recognize(packet).doubt.find("HDL-64E"), std::string_view::npos);
  packet.blocks[2].flag = kFlagLasers64To95;
  EXPECT_EQ(recognize(packet).model, nullptr);
  packet.product_id = 0xA1;
  EXPECT_EQ(recognize(packet).model, &packet_layout_model("VLS-128"));
  EXPECT_TRUE(recognize(packet).doubt.empty());
}

TEST(VelodyneRecognition, Hdl64TellsItsReturnModeByAzimuths) {
  DataPacket packet;
  EXPECT_EQ(return_mode(packet, packet_layout_model("HDL-64E S3")), ReturnMode::dual);
  EXPECT_EQ(return_mode(packet, packet_layout_model("HDL-64E S2")), ReturnMode::strongest)
      << "it cannot";
  packet.blocks[2].azimuth_counts = 17;
  EXPECT_EQ(return_mode(packet, packet_layout_model("HDL-64E S3")), ReturnMode::strongest);
  packet.return_mode_byte = 0x38;
  EXPECT_EQ(return_mode(packet, packet_layout_model("VLP-16")), ReturnMode::last);
  packet.return_mode_byte = 0;
  EXPECT_EQ(return_mode(packet, packet_layout_model("VLP-16")), ReturnMode::strongest);
}

}  // namespace
}  // namespace rigwire::protocols::velodyne

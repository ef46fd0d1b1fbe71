// The configuration of a NEO-7P: every poll, acknowledgement and refusal of its recording, and
// every message damaged in every way.
#include "emulators/ublox/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using namespace protocols::ubx;
using testing::ElementsAre;

class UbloxConfigurationTest : public UbloxReceiverTest {
 protected:
  UbloxConfigurationTest() : receiver_(as_delivered(), calendar_, line_) {
    run(receiver_, kStart + 1900ms);  // the first epoch has left
  }
  static UbloxSettings as_delivered() {
    UbloxSettings settings;
    settings.start_banner = false;
    return settings;
  }
  /// Payloads and ids of the frames that answer; sentences in between are left out.
  std::vector<std::pair<MessageId, Bytes>> ask(MessageId id, const Bytes& payload) {
    line_.clear();
    say(receiver_, id, payload);
    receiver_.advance(now_ + 400ms);
    now_ += 400ms;
    return line_.frames();
  }
  static std::string hex(const Bytes& bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const auto byte : bytes) {
      text += kDigits[byte / 16];
      text += kDigits[byte % 16];
    }
    return text;
  }
  std::string frame_hex(MessageId id, const Bytes& payload) {
    Bytes frame(kOverheadBytes + payload.size());
    EXPECT_EQ(encode_frame(id, payload, frame), frame.size());
    return hex(frame);
  }
  void expect_ack(MessageId id, const Bytes& payload) {
    const auto frames = ask(id, payload);
    ASSERT_EQ(frames.size(), 1U) << int(id.message_id);
    EXPECT_EQ(frames[0].first, AckAck::kId) << int(id.message_id) << " " << hex(payload);
    EXPECT_EQ(frames[0].second, (Bytes{id.message_class, id.message_id}));
  }
  void expect_nak(MessageId id, const Bytes& payload) {
    const auto frames = ask(id, payload);
    ASSERT_EQ(frames.size(), 1U) << int(id.message_id) << " " << payload.size();
    EXPECT_EQ(frames[0].first, AckNak::kId) << int(id.message_id) << " " << hex(payload);
    EXPECT_EQ(frames[0].second, (Bytes{id.message_class, id.message_id}));
  }
  Bytes poll(MessageId id, const Bytes& selector = {}) {
    const auto frames = ask(id, selector);
    EXPECT_EQ(frames.size(), 2U);
    if (frames.size() != 2) {
      return {};
    }
    EXPECT_EQ(frames[0].first, id);
    EXPECT_EQ(frames[1].first, AckAck::kId);  // data first, then the acknowledgement
    return frames[0].second;
  }

  UbloxReceiver receiver_;
};

TEST_F(UbloxConfigurationTest, FramesOfTheRecordedNeo7pByteByByte) {
  const std::vector<std::tuple<MessageId, Bytes, std::string>> expected{
      {CfgRate::kId, {}, "b56206080600e803010001000139"},
      {CfgPrt::kId, {1}, "b56206001400010 00000c008000080250000070003000000000092b5"},
      {CfgPrt::kId, {3}, "b56206001400030000000000000000000000070003000000000027ce"},
      {CfgMsg::kId, {0x0B, 0x30}, "b562060108000b300000000000004a4b"},
      {CfgSbas::kId, {}, "b562061608000 1030300d1a20600a4ef"},
      {CfgGnssHead::kId,
       {},
       "b562063e2400001616040004ff0001000000010103000100000005000300010000000608ff0000000000b813"},
      {CfgNav5::kId,
       {},
       "b56206242400ffff000300000000102700000500fa00fa0064002c01003c0000000000000000000000004c1c"},
  };
  for (auto [id, selector, whole] : expected) {
    std::erase(whole, ' ');
    EXPECT_EQ(frame_hex(id, poll(id, selector)), whole);
  }
  EXPECT_EQ(frame_hex(AckAck::kId, {6, 0x13}), "b562050102000613214a");
  EXPECT_EQ(frame_hex(AckNak::kId, {6, 0x61}), "b5620500020006616e93");
}

TEST_F(UbloxConfigurationTest, PayloadsOfTheRecordedNeo7p) {
  EXPECT_EQ(hex(poll(CfgAnt::kId)), "1b00f0b9");
  EXPECT_EQ(hex(poll(CfgRxm::kId)), "0800");
  EXPECT_EQ(hex(poll(kCfgItfm)), "f3ac622d1e030000");
  EXPECT_EQ(hex(poll(CfgNmea::kId)), "002300020000000000000000");
  EXPECT_EQ(hex(poll(CfgInf::kId, {0})), "00000000000000000000");
  EXPECT_EQ(hex(poll(CfgInf::kId, {1})), "01000000878787878787");
  EXPECT_EQ(hex(poll(CfgInf::kId, {3})), "03000000000000000000");
  for (const std::uint8_t protocol : Bytes{0x0D, 0x0E, 0x0F}) {
    expect_nak(CfgInf::kId, {protocol});
  }
  EXPECT_EQ(hex(poll(CfgPrt::kId, {0})), "0000000084000000000000000700030000000000");
  EXPECT_EQ(hex(poll(CfgPrt::kId, {2})), "02000000c0380000000000000000000000000000");
  EXPECT_EQ(hex(poll(CfgPrt::kId, {4})), "0400000000320000000000000700030000000000");
  EXPECT_EQ(poll(CfgPrt::kId), poll(CfgPrt::kId, {1}));
  expect_nak(CfgPrt::kId, {5});
  EXPECT_EQ(poll(kCfgPm2).size(), 44U);
  EXPECT_EQ(poll(kCfgLogfilter).size(), 12U);
  EXPECT_EQ(poll(kCfgLogfilter)[0], 1);
  const Bytes usb = poll(kCfgUsb);
  ASSERT_EQ(usb.size(), 108U);
  EXPECT_EQ(hex(Bytes(usb.begin(), usb.begin() + 4)), "4615a701");
  EXPECT_EQ(std::string(usb.begin() + 44, usb.begin() + 72), "u-blox 7 - GPS/GNSS Receiver");
  const Bytes datum = poll(kCfgDat);
  ASSERT_EQ(datum.size(), 52U);
  EXPECT_EQ(std::string(datum.begin() + 2, datum.begin() + 7), "WGS84");
  const CfgDat wgs84 = read_payload<CfgDat>(datum);
  EXPECT_EQ(wgs84.major_axis_m, 6378137.0);
  EXPECT_EQ(wgs84.inverse_flattening, 298.257223563);
  const Bytes inventory = poll(kCfgRinv);
  // The recorded answer has 24 bytes: the text ends with a zero.
  EXPECT_EQ(hex(inventory), "004e6f746963653a206e6f20646174612073617665642100");
  EXPECT_EQ(hex(poll(CfgNavx5::kId)),
            "0000ffff0f000000030203160700000100009b060000000001010100006464000001100000000000");
  const auto expert = read_payload<CfgNavx5>(poll(CfgNavx5::kId));
  EXPECT_EQ(expert.minimum_satellites, 3);
  EXPECT_EQ(expert.maximum_satellites, 22);
  EXPECT_EQ(expert.minimum_cn0_dbhz, 7);
  EXPECT_EQ(expert.week_rollover, 1691);
  EXPECT_EQ(expert.precise_point_positioning, 1);
  EXPECT_EQ(expert.maximum_orbit_error_m, 100);
  const auto pulse = read_payload<CfgTp5>(poll(CfgTp5::kId));
  EXPECT_EQ(pulse.period, 1'000'000U);
  EXPECT_EQ(pulse.pulse, 0U);
  EXPECT_EQ(pulse.pulse_locked, 100'000U);
  EXPECT_EQ(pulse.flags, 0xF7U);
  EXPECT_EQ(read_payload<CfgTp5>(poll(CfgTp5::kId, {1})).flags, 0xFEU);
  expect_nak(CfgTp5::kId, {2});
}

// Masks were read back as 0: a client that changed one field of what it had read and wrote it back
// was acknowledged, and nothing changed.
TEST_F(UbloxConfigurationTest, ExpertSettingsThatAreReadChangedAndWrittenBackApply) {
  Bytes payload = poll(CfgNavx5::kId);
  ASSERT_EQ(payload.size(), CfgNavx5::kLength);
  constexpr std::size_t kMinimumSatellites = 10;
  constexpr std::size_t kMinimumCn0 = 12;
  payload[kMinimumSatellites] = 5;
  payload[kMinimumCn0] = 20;
  expect_ack(CfgNavx5::kId, payload);
  EXPECT_EQ(hex(poll(CfgNavx5::kId)), hex(payload));
  EXPECT_EQ(receiver_.solution().satellites_used, 8);
  // What the mask does not name stays.
  CfgNavx5 other;
  other.mask1 = 1 << 3;
  other.minimum_satellites = 9;
  other.minimum_cn0_dbhz = 21;
  Bytes bytes(CfgNavx5::kLength);
  write_payload(other, bytes);
  expect_ack(CfgNavx5::kId, bytes);
  payload[kMinimumCn0] = 21;
  EXPECT_EQ(hex(poll(CfgNavx5::kId)), hex(payload));
}

TEST_F(UbloxConfigurationTest, RatesOfTheRecordedTable) {
  const std::vector<std::pair<int, std::vector<int>>> supported{
      {0x01, {1, 2, 3, 4, 6, 7, 0x11, 0x12, 0x20, 0x21, 0x22, 0x30, 0x31, 0x32, 0x60}},
      {0x02, {0x10, 0x11, 0x13, 0x20, 0x30, 0x31}},
      {0x0A, {2, 6, 7, 8, 9, 0x0B, 0x21}},
      {0x0B, {0x01, 0x30, 0x31, 0x32, 0x33}},
      {0x0D, {1, 3}},
      {0x21, {8}},
      {0xF0, {6, 7, 8, 9, 0x0A, 0x0D}},
      {0xF1, {0, 3, 4}}};
  std::ptrdiff_t known = 0;
  for (const auto& [message_class, ids] : supported) {
    for (const int message_id : ids) {
      const Bytes id{std::uint8_t(message_class), std::uint8_t(message_id)};
      EXPECT_EQ(poll(CfgMsg::kId, id), (Bytes{id[0], id[1], 0, 0, 0, 0, 0, 0}));
      expect_ack(CfgMsg::kId, {id[0], id[1], 0, 0, 0, 0, 0, 0});
      expect_ack(CfgMsg::kId, {id[0], id[1], 0});
      ++known;
    }
  }
  for (const std::uint8_t id : Bytes{0, 1, 2, 3, 4, 5}) {
    EXPECT_EQ(poll(CfgMsg::kId, {0xF0, id}), (Bytes{0xF0, id, 1, 1, 1, 1, 1, 1}));
    ++known;
  }
  EXPECT_EQ(std::ranges::count_if(ublox_neo_7p().messages, &UbloxMessage::periodic), known);
  const std::vector<std::pair<int, std::vector<int>>> refused{
      {0x05, {0, 1}},
      {0x0B, {0x02, 0x50}},
      {0x06, {0, 1, 2, 4, 8, 9, 0x13, 0x24, 0x31, 0x3E}},
      {0x10, {0x02, 0x10}},
      {0x13, {0x21, 0x60, 0x80}},
      {0x0A, {0x28, 0x2E}},
      {0x01, {9, 0x23, 0x24, 0x25, 0x34, 0x35, 0x40}},
      {0x02, {0x15}},
      {0x09, {0x14}},
      {0x0D, {4, 0x11, 0x12, 0x13}},
      {0xF0, {0x0E, 0x0F}},
      {0xF1, {1}},
      {0x21, {0x0B, 0x0D, 0x0E, 0x0F}}};
  for (const auto& [message_class, ids] : refused) {
    for (const int message_id : ids) {
      const Bytes id{std::uint8_t(message_class), std::uint8_t(message_id)};
      expect_nak(CfgMsg::kId, id);
      expect_nak(CfgMsg::kId, {id[0], id[1], 1});
      expect_nak(CfgMsg::kId, {id[0], id[1], 0, 1, 0, 0, 0, 0});
    }
  }
}

TEST_F(UbloxConfigurationTest, UnknownMessagesAreRefusedWhatever) {
  for (const std::uint8_t id : Bytes{0x07, 0x0E, 0x12, 0x1D, 0x1E, 0x29, 0x32, 0x3D, 0x53, 0x60,
                                     0x61, 0x62, 0x8A, 0x8B, 0x8C, 0xFF}) {
    for (const std::size_t length : {0, 1, 4, 12, 200}) {
      expect_nak({0x06, id}, Bytes(length, 1));
    }
  }
}

TEST_F(UbloxConfigurationTest, EveryMessageOfAnotherLengthIsRefusedAndChangesNothing) {
  struct Known {
    MessageId id;
    std::size_t length;
    Bytes selector;
  };
  const std::vector<Known> messages{
      {CfgPrt::kId, 20, {1}}, {CfgMsg::kId, 8, {1, 2}}, {CfgInf::kId, 10, {1}},
      {CfgRate::kId, 6, {}},  {CfgRxm::kId, 2, {}},     {CfgAnt::kId, 4, {}},
      {CfgSbas::kId, 8, {}},  {CfgNmea::kId, 12, {}},   {CfgNavx5::kId, 40, {}},
      {CfgNav5::kId, 36, {}}, {CfgTp5::kId, 32, {0}},   {CfgGnssHead::kId, 36, {}},
      {kCfgDat, 44, {}},      {kCfgPm2, 44, {}},        {kCfgUsb, 108, {}},
      {kCfgItfm, 8, {}},      {kCfgLogfilter, 12, {}},
  };
  for (const auto& [id, length, selector] : messages) {
    const Bytes before = poll(id, selector);
    Bytes all = before;
    all.resize(length + 1, 0);
    for (std::size_t cut = selector.empty() ? 1 : selector.size() + 1; cut <= length + 1; ++cut) {
      const bool right = cut == length || (id == CfgMsg::kId && cut == 3);
      if (!right) {
        SCOPED_TRACE(cut);
        line_.clear();
        say(receiver_, id, Bytes(all.begin(), all.begin() + std::ptrdiff_t(cut)));
        receiver_.advance(now_ += 20ms);
        EXPECT_EQ(ids(), std::vector{AckNak::kId}) << int(id.message_id);
      }
    }
    EXPECT_EQ(poll(id, selector), before) << int(id.message_id);
  }
  for (const std::size_t length : {1, 11, 14, 25}) {
    expect_nak(CfgCfg::kId, Bytes(length));
  }
}

TEST_F(UbloxConfigurationTest, BadChecksumIsDroppedInSilenceForEveryMessage) {
  for (const MessageId id : {CfgPrt::kId, CfgMsg::kId, CfgRate::kId, CfgNav5::kId, kCfgPm2}) {
    Bytes frame(kOverheadBytes + 44);
    ASSERT_EQ(encode_frame(id, Bytes(44, 7), frame), frame.size());
    for (std::size_t i = 2; i < frame.size(); i += 5) {
      if (i == 4 || i == 5) {
        continue;  // another length waits for more bytes
      }
      line_.clear();
      Bytes damaged = frame;
      damaged[i] ^= 0x40;
      receiver_.receive(now_, damaged);
      receiver_.advance(now_ += 20ms);
      EXPECT_TRUE(line_.all.empty()) << i;
    }
  }
}

TEST_F(UbloxConfigurationTest, ValuesThatTheDeviceDoesNotTakeAreRefused) {
  expect_nak(CfgRate::kId, {49, 0, 1, 0, 1, 0});
  expect_ack(CfgRate::kId, {50, 0, 7, 0, 0, 0});
  EXPECT_EQ(hex(poll(CfgRate::kId)), "320001000000");  // navRate forced to 1
  expect_nak(CfgRate::kId, {0xE8, 3, 1, 0, 2, 0});
  Bytes nmea = poll(CfgNmea::kId);
  for (const std::uint8_t version : Bytes{0x20, 0x40, 0x41, 0x4B}) {
    nmea[1] = version;
    expect_nak(CfgNmea::kId, nmea);
  }
  nmea[1] = 0x21;
  expect_ack(CfgNmea::kId, nmea);
  Bytes pm2 = poll(kCfgPm2);
  pm2[0] = 2;  // version
  expect_nak(kCfgPm2, pm2);
  Bytes gnss = poll(CfgGnssHead::kId);
  gnss[0] = 1;
  expect_nak(CfgGnssHead::kId, gnss);
  Bytes nav5 = poll(CfgNav5::kId);
  nav5[2] = 1;  // reserved model
  expect_nak(CfgNav5::kId, nav5);
  nav5[2] = 9;
  expect_nak(CfgNav5::kId, nav5);
}

TEST_F(UbloxConfigurationTest, OneRadioPath) {
  const auto systems = [&](int gps, int sbas, int qzss, int glonass) {
    Bytes payload = poll(CfgGnssHead::kId);
    payload[4 + 4] = std::uint8_t(gps);
    payload[12 + 4] = std::uint8_t(sbas);
    payload[20 + 4] = std::uint8_t(qzss);
    payload[28 + 4] = std::uint8_t(glonass);
    return payload;
  };
  expect_nak(CfgGnssHead::kId, systems(1, 1, 1, 1));
  expect_nak(CfgGnssHead::kId, systems(1, 0, 0, 1));
  expect_nak(CfgGnssHead::kId, systems(0, 1, 1, 1));
  expect_nak(CfgGnssHead::kId, systems(0, 0, 0, 0));
  expect_nak(CfgGnssHead::kId, systems(0, 1, 0, 0));
  expect_ack(CfgGnssHead::kId, systems(1, 0, 0, 0));
  expect_ack(CfgGnssHead::kId, systems(0, 0, 0, 1));
  expect_nak(CfgGnssHead::kId, {0, 0, 22, 1, 2, 8, 10, 0, 1, 0, 0, 0});  // no Galileo in the chip
  expect_ack(CfgGnssHead::kId, {0, 0, 22, 1, 2, 8, 10, 0, 0, 0, 0, 0});  // off it is anyway
}

TEST_F(UbloxConfigurationTest, OnlyTheFieldsOfTheMaskChange) {
  CfgNav5 wanted;
  wanted.mask = 1;
  wanted.dynamic_model = 4;
  wanted.fix_mode = 2;
  wanted.minimum_elevation_deg = 20;
  wanted.position_dilution_mask_e1 = 11;
  wanted.static_hold_cmps = 99;
  wanted.cn0_satellites = 3;
  wanted.utc_standard = 3;
  CfgNav5 expected = read_payload<CfgNav5>(poll(CfgNav5::kId));
  const auto send = [&](std::uint16_t mask) {
    wanted.mask = mask;
    Bytes payload(CfgNav5::kLength);
    write_payload(wanted, payload);
    expect_ack(CfgNav5::kId, payload);
    return read_payload<CfgNav5>(poll(CfgNav5::kId));
  };
  expected.dynamic_model = 4;
  EXPECT_EQ(send(0x0001), expected);
  expected.minimum_elevation_deg = 20;
  EXPECT_EQ(send(0x0002), expected);
  EXPECT_EQ(send(0x0000), expected);
  expected.static_hold_cmps = 99;
  EXPECT_EQ(send(0x0040), expected);
  expected.cn0_satellites = 3;
  EXPECT_EQ(send(0x0100), expected);
  expected.utc_standard = 3;
  EXPECT_EQ(send(0x0400), expected);
}

TEST_F(UbloxConfigurationTest, ClearSaveLoadInThatOrderBySection) {
  const auto period = [&] { return poll(CfgRate::kId)[0] + 256 * poll(CfgRate::kId)[1]; };
  const auto gll = [&] { return poll(CfgMsg::kId, {0xF0, 1})[3]; };
  const auto store = [&](std::uint32_t clear, std::uint32_t save, std::uint32_t load) {
    Bytes payload(12);
    write_payload(CfgCfg{clear, save, load}, payload);
    expect_ack(CfgCfg::kId, payload);
  };
  expect_ack(CfgRate::kId, {200, 0, 1, 0, 1, 0});
  expect_ack(CfgMsg::kId, {0xF0, 1, 5});
  store(0, kSectionNavigation, 0);
  store(0, 0, kSectionMessages);  // the rates were not saved
  EXPECT_EQ(gll(), 1);
  EXPECT_EQ(period(), 200);
  expect_ack(CfgRate::kId, {0xF4, 1, 1, 0, 1, 0});
  store(0, 0, kSectionNavigation);
  EXPECT_EQ(period(), 200);
  store(kSectionNavigation, 0, 0);  // saved state gone, present one stays
  EXPECT_EQ(period(), 200);
  store(0, 0, kSectionNavigation);
  EXPECT_EQ(period(), 1000);
  expect_ack(CfgRate::kId, {0xF4, 1, 1, 0, 1, 0});
  store(0xFFFF, 0xFFFF, 0xFFFF);  // cleared, then saved again, then loaded
  EXPECT_EQ(period(), 500);
  Bytes with_devices(13);
  with_devices[0] = with_devices[8] = 0xFF;
  with_devices[12] = 1;
  expect_ack(CfgCfg::kId, with_devices);
  EXPECT_EQ(period(), 1000);
}

TEST_F(UbloxConfigurationTest, BytesThatNobodyReadsAreKept) {
  Bytes pm2 = poll(kCfgPm2);
  pm2[30] = 0x55;
  expect_ack(kCfgPm2, pm2);
  EXPECT_EQ(poll(kCfgPm2), pm2);
  Bytes datum(44, 0x11);
  expect_ack(kCfgDat, datum);
  const Bytes read = poll(kCfgDat);
  EXPECT_EQ(Bytes(read.begin() + 8, read.end()), datum);
  EXPECT_EQ(std::string(read.begin() + 2, read.begin() + 6), "USER");
  expect_ack(kCfgRinv, {1, 'm', 'i', 'n', 'e'});
  EXPECT_EQ(poll(kCfgRinv), (Bytes{1, 'm', 'i', 'n', 'e'}));
  expect_nak(kCfgRinv, Bytes(32, 1));
}

TEST_F(UbloxConfigurationTest, UnknownClassIsNotAnswered) {
  for (const std::uint8_t message_class : Bytes{0x00, 0x03, 0x07, 0x13, 0x27, 0x99}) {
    EXPECT_TRUE(ask({message_class, 0x40}, {}).empty());
    EXPECT_TRUE(ask({message_class, 0x40}, Bytes(10)).empty());
  }
}

}  // namespace
}  // namespace rigwire::emulators

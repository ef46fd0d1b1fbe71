#include "emulators/usb/cdc_acm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>

#include "protocols/usb/descriptor_reader.h"
#include "protocols/usb/descriptors.h"
#include "usb_probe.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::usb::DescriptorBytes;
using protocols::usb::Outcome;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

struct RecordedDevice final : CdcAcmDevice {
  void received(SimTime /*now*/, std::span<const std::uint8_t> bytes) override {
    heard.insert(heard.end(), bytes.begin(), bytes.end());
  }
  void line_changed(SimTime /*now*/, const CdcAcmLine& line) override { lines.push_back(line); }
  Bytes heard;
  std::vector<CdcAcmLine> lines;
};

CdcAcmSettings small_queue() {
  CdcAcmSettings settings = ublox_usb(7);
  settings.queue_bytes = 256;
  settings.capabilities |= protocols::usb::cdc::kHasBreak;
  return settings;
}

class CdcAcmTest : public ::testing::Test {
 protected:
  CdcAcmTest() { host.configure(); }
  void set_lines(std::uint16_t state) {
    EXPECT_EQ(host.control({0x21, 0x22, state, 0, 0}).outcome, Outcome::done);
  }
  bool stalls(const protocols::usb::Setup& setup, const Bytes& data = {}) {
    return host.control(setup, data).outcome == Outcome::stalled;
  }
  static Bytes counted(std::size_t size) {
    Bytes bytes(size);
    std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
    return bytes;
  }

  RecordedDevice device;
  CdcAcm acm{small_queue(), device};
  DirectHost host{acm};
};

TEST(UbloxUsb, AUblox7HasTheDescriptorsThatWereReadFromOne) {
  RecordedDevice device;
  const CdcAcm acm(ublox_usb(7), device);
  const DescriptorBytes bytes(acm.description());
  EXPECT_THAT(bytes.device(), ElementsAre(18, 1, 0x10, 0x01, 2, 0, 0, 64, 0x46, 0x15, 0xA7, 0x01,
                                          0x00, 0x01, 1, 2, 0, 1));
  const Bytes expected{
      9, 2,    62,   0,    2,    1,  0,   0xC0, 50,  // configuration: self powered, 100 mA
      9, 4,    0,    0,    1,    2,  2,   1,    0,   // communications, abstract control
      5, 0x24, 0x00, 0x10, 0x01,                     // header 1.10
      4, 0x24, 0x02, 0x02,                           // line coding
      5, 0x24, 0x01, 0x03, 1,                        // call management, data interface 1
      7, 5,    0x83, 3,    64,   0,  255,            // notifications
      9, 4,    1,    0,    2,    10, 0,   255,  0,   // data
      7, 5,    0x01, 2,    64,   0,  0,              //
      7, 5,    0x82, 2,    64,   0,  0};
  EXPECT_THAT(bytes.configuration(), ElementsAreArray(expected));
  EXPECT_EQ(bytes.configuration().size(), 62U);
  EXPECT_EQ(*protocols::usb::decode_text(bytes.text(1)), "u-blox AG - www.u-blox.com");
  EXPECT_EQ(*protocols::usb::decode_text(bytes.text(2)), "u-blox 7 - GPS/GNSS Receiver");
}

TEST(UbloxUsb, EveryGenerationHasItsProductId) {
  EXPECT_EQ(ublox_usb(8).product, 0x01A8);
  EXPECT_EQ(ublox_usb(9).product, 0x01A9);
  EXPECT_THROW((void)ublox_usb(6), std::invalid_argument);
}

TEST_F(CdcAcmTest, LineCodingIsKeptAndTold) {
  EXPECT_THAT(host.control({0xA1, 0x21, 0, 0, 7}).data, ElementsAre(0x80, 0x25, 0, 0, 0, 0, 8));
  const Bytes coding{0x00, 0xC2, 0x01, 0x00, 2, 2, 7};  // 115200 7E2
  EXPECT_EQ(host.control({0x21, 0x20, 0, 0, 7}, coding).outcome, Outcome::done);
  EXPECT_EQ(host.control({0xA1, 0x21, 0, 0, 64}).data, coding);
  EXPECT_THAT(host.control({0xA1, 0x21, 0, 0, 3}).data, ElementsAre(0x00, 0xC2, 0x01));
  ASSERT_EQ(device.lines.size(), 1U);
  EXPECT_EQ(device.lines[0].coding.rate_bps, 115200U);
  EXPECT_EQ(device.lines[0].coding.parity, protocols::usb::cdc::Parity::even);
  EXPECT_FALSE(device.lines[0].client_present);
}

TEST_F(CdcAcmTest, UnknownRequestsStall) {
  EXPECT_TRUE(stalls({0x21, 0x20, 0, 0, 6}, Bytes(6)));  // a short line coding
  EXPECT_TRUE(stalls({0x21, 0x20, 0, 1, 7}, Bytes(7)));  // to the data interface
  EXPECT_TRUE(stalls({0xA1, 0x01, 0, 0, 8}));            // encapsulated response
  EXPECT_TRUE(stalls({0x21, 0x00, 0, 0, 2}, Bytes(2)));
  EXPECT_TRUE(stalls({0x22, 0x22, 3, 0, 0}));     // to an endpoint
  EXPECT_TRUE(stalls({0xC1, 0x21, 0, 0, 7}));     // of a vendor
  EXPECT_TRUE(stalls({0x81, 6, 0x2200, 0, 64}));  // no descriptors of the class
}

TEST_F(CdcAcmTest, AClientIsThereByDtrOrByReading) {
  set_lines(3);
  EXPECT_TRUE(acm.line().client_present);
  EXPECT_TRUE(acm.line().request_to_send);
  set_lines(0);
  EXPECT_FALSE(acm.line().client_present);
  const auto read = host.read(0x82, 128);
  EXPECT_TRUE(acm.line().client_present);
  EXPECT_TRUE(acm.cancel(kStart, read));
  EXPECT_FALSE(acm.line().client_present);
  set_lines(1);
  host.port.detach(kStart);
  EXPECT_FALSE(acm.line().client_present);
  EXPECT_FALSE(acm.line().data_terminal_ready);
}

TEST_F(CdcAcmTest, ACloseThatCrossesTheLastAnswerIsSeen) {
  set_lines(3);
  host.read(0x82, 64);
  acm.send(kStart + 1s, counted(8));  // ends the read; the host, closing, asks for no other
  EXPECT_EQ(acm.next_event(), kNever) << "DTR is set";
  host.control({0x21, 0x22, 0, 0, 0}, {}, kStart + 1s);
  EXPECT_TRUE(acm.line().client_present) << "it may just be about to ask again";
  acm.advance(acm.next_event());
  EXPECT_FALSE(acm.line().client_present);
  EXPECT_EQ(acm.next_event(), kNever);
}

TEST_F(CdcAcmTest, AClientThatReadsOneByOneStays) {
  for (int i = 0; i < 5; ++i) {
    const SimTime now = kStart + i * 1s;
    host.read(0x82, 64, now);
    EXPECT_TRUE(acm.send(now + 500ms, counted(8)));
    EXPECT_TRUE(acm.send(now + 501ms, counted(8)));  // waits for the next read
    host.read(0x82, 64, now + 502ms);
    EXPECT_EQ(acm.next_event(), now + 502ms + CdcAcm::kReadPause);
  }
  EXPECT_EQ(host.ends.size(), 10U);
}

TEST_F(CdcAcmTest, BytesFillReadsAndEndThemShort) {
  host.read(0x82, 128);
  host.read(0x82, 128);
  host.read(0x82, 128);
  EXPECT_TRUE(acm.send(kStart, counted(200)));
  ASSERT_EQ(host.ends.size(), 2U);
  EXPECT_EQ(host.ends[0].data.size(), 128U);
  EXPECT_EQ(host.ends[1].data.size(), 72U);
  EXPECT_EQ(host.ends[1].data[0], 128);
  EXPECT_TRUE(acm.send(kStart, counted(64)));  // whole packets and less than asked for
  ASSERT_EQ(host.ends.size(), 3U);
  EXPECT_EQ(host.ends[2].data.size(), 64U);
}

TEST_F(CdcAcmTest, BytesWaitForTheNextRead) {
  set_lines(1);
  EXPECT_TRUE(acm.send(kStart, counted(10)));
  EXPECT_TRUE(acm.send(kStart, counted(10)));
  EXPECT_THAT(host.ends, IsEmpty());
  host.read(0x82, 4);
  host.read(0x82, 64);
  ASSERT_EQ(host.ends.size(), 2U);
  EXPECT_THAT(host.ends[0].data, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(host.ends[1].data.size(), 16U);
}

TEST_F(CdcAcmTest, WhatDoesNotFitIsLostWholeAndCounted) {
  set_lines(1);
  EXPECT_TRUE(acm.send(kStart, counted(200)));
  EXPECT_FALSE(acm.send(kStart, counted(57)));
  EXPECT_TRUE(acm.send(kStart, counted(56)));
  EXPECT_EQ(acm.lost_bytes(), 57U);
  host.read(0x82, 100);
  EXPECT_TRUE(acm.send(kStart, counted(100))) << "room again, with the queue wrapped";
  host.read(0x82, 1000);
  EXPECT_EQ(host.ends.at(1).data.size(), 256U);
}

TEST_F(CdcAcmTest, NothingWaitsForAClientThatIsNotThere) {
  EXPECT_TRUE(acm.send(kStart, counted(300)));
  EXPECT_EQ(acm.lost_bytes(), 0U);
  set_lines(1);
  EXPECT_TRUE(acm.send(kStart, counted(3)));
  set_lines(0);
  host.read(0x82, 64);
  EXPECT_THAT(host.ends, IsEmpty()) << "what the last client left";
}

TEST_F(CdcAcmTest, WhatTheHostWritesReachesTheDevice) {
  host.write(0x01, {'a', 'b'});
  host.write(0x01, {});
  host.write(0x01, {'c'});
  EXPECT_THAT(device.heard, ElementsAre('a', 'b', 'c'));
  ASSERT_EQ(host.ends.size(), 3U);
  EXPECT_EQ(host.ends[0].taken, 2U);
}

TEST_F(CdcAcmTest, ABreakEndsByItselfOrWhenTold) {
  host.control({0x21, 0x23, 250, 0, 0}, {}, kStart + 1s);
  EXPECT_TRUE(acm.line().sending_break);
  EXPECT_EQ(acm.next_event(), kStart + 1250ms);
  acm.advance(kStart + 1250ms);
  EXPECT_FALSE(acm.line().sending_break);
  host.control({0x21, 0x23, 0xFFFF, 0, 0}, {}, kStart + 2s);
  EXPECT_TRUE(acm.line().sending_break);
  EXPECT_EQ(acm.next_event(), kNever);
  host.control({0x21, 0x23, 0, 0, 0}, {}, kStart + 3s);
  EXPECT_FALSE(acm.line().sending_break);
}

TEST_F(CdcAcmTest, ADeviceWithoutBreaksStallsThem) {
  CdcAcm plain(ublox_usb(7), device);
  DirectHost other(plain);
  EXPECT_EQ(other.control({0x21, 0x23, 250, 0, 0}).outcome, Outcome::stalled);
}

TEST_F(CdcAcmTest, TheSerialStateIsNotifiedOnce) {
  using namespace protocols::usb::cdc::serial_state;
  acm.set_serial_state(kStart, kCarrier | kOverrun);
  host.read(0x83, 64);
  host.read(0x83, 64);
  ASSERT_EQ(host.ends.size(), 1U);
  EXPECT_THAT(host.ends[0].data, ElementsAre(0xA1, 0x20, 0, 0, 0, 0, 2, 0, 0x41, 0));
  acm.set_serial_state(kStart, kCarrier);
  EXPECT_EQ(host.ends.size(), 1U) << "nothing new";
  acm.set_serial_state(kStart, 0);
  EXPECT_EQ(host.ends.size(), 2U);
}

TEST_F(CdcAcmTest, AnUnplugForgetsEverything) {
  host.read(0x82, 64);
  host.read(0x83, 64);
  host.port.detach(kStart);
  EXPECT_TRUE(acm.send(kStart, counted(3)));
  acm.set_serial_state(kStart, 1);
  EXPECT_THAT(host.ends, IsEmpty());
}

}  // namespace
}  // namespace rigwire::emulators

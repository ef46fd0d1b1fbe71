// What is said to the receiver: configuration, polls, noise; and what it answers.
#include "emulators/ublox/receiver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "protocols/ubx/monitor.h"
#include "protocols/ubx/version.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using namespace protocols::ubx;
using testing::ElementsAre;
using testing::StartsWith;

class UbloxReceiverInputTest : public UbloxReceiverTest {};

TEST_F(UbloxReceiverInputTest, PollGivesTheDataThenTheAcknowledgement) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgRate::kId, {});
  run(receiver, now_ + 100ms);
  EXPECT_THAT(ids(), ElementsAre(CfgRate::kId, AckAck::kId));
  EXPECT_EQ(decoded<CfgRate>().at(0), (CfgRate{1000, 1, 1}));
  EXPECT_EQ(decoded<AckAck>().at(0), (AckAck{6, 8}));
}

TEST_F(UbloxReceiverInputTest, DefaultsAreThoseOfTheRecordedNeo7p) {
  UbloxSettings settings = quiet();
  settings.baud = 9600;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  const std::vector<std::pair<MessageId, std::string>> expected{
      {CfgAnt::kId, "1b00f0b9"},
      {CfgGnssHead::kId,
       "001616040004ff0001000000010103000100000005000300010000000608ff0000000000"},
      {CfgNav5::kId, "ffff000300000000102700000500fa00fa0064002c01003c000000000000000000000000"},
      {CfgRxm::kId, "0800"},
      {CfgSbas::kId, "01030300d1a20600"},
      {CfgNmea::kId, "002300020000000000000000"},
      {CfgPrt::kId, "01000000c0080000802500000700030000000000"},
      {CfgRate::kId, "e80301000100"},
  };
  for (const auto& [id, hex] : expected) {
    line_.clear();
    say(receiver, id, {});
    run(receiver, now_ + 200ms);
    const auto frames = line_.frames();
    ASSERT_EQ(frames.size(), 2U);
    std::string found;
    for (const auto byte : frames[0].second) {
      constexpr std::string_view kDigits = "0123456789abcdef";
      found += kDigits[byte / 16];
      found += kDigits[byte % 16];
    }
    EXPECT_EQ(found, hex);
    EXPECT_EQ(frames[1].first, AckAck::kId);
  }
}

TEST_F(UbloxReceiverInputTest, UnknownConfigurationIsRefused) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  for (const std::uint8_t id :
       Bytes{0x07, 0x0E, 0x12, 0x1D, 0x1E, 0x29, 0x32, 0x3D, 0x53, 0x60, 0x61, 0x62, 0x8A, 0x8B}) {
    line_.clear();
    say(receiver, {0x06, id}, {});
    say(receiver, {0x06, id}, {1, 2, 3, 4});
    run(receiver, now_ + 50ms);
    EXPECT_THAT(ids(), ElementsAre(AckNak::kId, AckNak::kId)) << int(id);
    EXPECT_EQ(decoded<AckNak>().at(0), (AckNak{6, id}));
  }
}

TEST_F(UbloxReceiverInputTest, WrongLengthsAreRefusedAndChangeNothing) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgRate::kId, {0x64});
  say(receiver, CfgPrt::kId, Bytes(21, 1));
  say(receiver, CfgMsg::kId, {1, 2, 3, 4, 5});
  say(receiver, CfgGnssHead::kId, {0, 0, 22, 2, 0, 0});
  say(receiver, CfgNav5::kId, Bytes(35));
  run(receiver, now_ + 50ms);
  EXPECT_THAT(ids(), testing::Each(AckNak::kId));
  EXPECT_EQ(ids().size(), 5U);
  EXPECT_EQ(receiver.sample_plan().period, 1s);
}

TEST_F(UbloxReceiverInputTest, MessageRatesOfUnsupportedIdsAreRefused) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  for (const auto& [message_class, message_id] : {std::pair{0x0B, 0x02},
                                                  {0x01, 0x35},
                                                  {0x01, 0x61},
                                                  {0x13, 0x60},
                                                  {0xF0, 0x0E},
                                                  {0x06, 0x00},
                                                  {0x01, 0x09}}) {
    line_.clear();
    const Bytes id{std::uint8_t(message_class), std::uint8_t(message_id)};
    say(receiver, CfgMsg::kId, id);
    say(receiver, CfgMsg::kId, {id[0], id[1], 1});
    run(receiver, now_ + 50ms);
    EXPECT_THAT(ids(), ElementsAre(AckNak::kId, AckNak::kId));
  }
}

TEST_F(UbloxReceiverInputTest, MessageRateSwitchesOnAndOff) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgMsg::kId, {0x01, 0x02, 2});
  run(receiver, kStart + 4900ms);
  EXPECT_EQ(decoded<NavPosllh>().size(), 2U);
  EXPECT_EQ(ids().at(0), AckAck::kId);
  line_.clear();
  say(receiver, CfgMsg{0x01, 0x02, {0, 0, 0, 0, 0, 0}});
  run(receiver, kStart + 8900ms);
  EXPECT_EQ(decoded<NavPosllh>().size(), 0U);
  line_.clear();
  say(receiver, CfgMsg::kId, {0x01, 0x02});
  run(receiver, now_ + 50ms);
  EXPECT_EQ(decoded<CfgMsg>().at(0), (CfgMsg{0x01, 0x02, {}}));
}

TEST_F(UbloxReceiverInputTest, RateChangesTheSamplePlan) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 530ms);
  say(receiver, CfgRate{200, 5, 0});
  EXPECT_EQ(receiver.sample_plan(), (SamplePlan{kStart + 600ms, 200ms}));
  run(receiver, now_ + 20ms);
  line_.clear();
  say(receiver, CfgRate{49, 1, 1});
  say(receiver, CfgRate::kId, {});
  run(receiver, now_ + 50ms);
  EXPECT_THAT(ids(), testing::Contains(AckNak::kId));
  EXPECT_EQ(decoded<CfgRate>().at(0), (CfgRate{200, 1, 0}));  // ratio forced to 1 below protocol 18
}

TEST_F(UbloxReceiverInputTest, BaudChangeTakesEffectForWhatFollows) {
  UbloxSettings settings = quiet();
  settings.baud = 9600;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  CfgPrt uart{1, 0, 0x08D0, 115200, 0x27, 0x23, 0};
  CfgPrt usb{3, 0, 0, 0, 7, 3, 0};
  Bytes blocks(40);
  write_payload(uart, std::span(blocks).first(20));
  write_payload(usb, std::span(blocks).subspan(20));
  say(receiver, CfgPrt::kId, blocks);
  run(receiver, now_ + 50ms);
  EXPECT_EQ(receiver.baud(), 115200U);
  EXPECT_THAT(ids(), ElementsAre(AckAck::kId));
  EXPECT_NEAR(to_seconds(line_.last_due - (kStart + 500ms)), 10 * 10 / 115200.0, 1e-8);
  line_.clear();
  uart.baud = 12345;
  say(receiver, uart);
  run(receiver, now_ + 50ms);
  EXPECT_THAT(ids(), ElementsAre(AckNak::kId));
  EXPECT_EQ(receiver.baud(), 115200U);
}

// The second UART of a NEO-7P is off: it has no speed from which a new one could go on.
TEST_F(UbloxReceiverInputTest, APortWithoutASpeedCanBeGivenOne) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  CfgPrt second = receiver.configuration().present().ports[kPortUart2];
  ASSERT_EQ(second.baud, 0U);
  second.baud = 115'200;
  say(receiver, second);
  run(receiver, now_ + 50ms);
  EXPECT_THAT(ids(), ElementsAre(AckAck::kId));
  EXPECT_EQ(receiver.second_baud(), 115'200U);
}

TEST_F(UbloxReceiverInputTest, VersionIsThatOfTheNeo7p) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, MonVerHead::kId, {});
  run(receiver, now_ + 100ms);
  const auto frames = line_.frames();
  ASSERT_EQ(frames.size(), 1U);  // no acknowledgement
  EXPECT_EQ(frames[0].second.size(), 220U);
  const auto version = decode_version({frames[0].first, frames[0].second});
  ASSERT_TRUE(version.ok());
  EXPECT_EQ(version->software, "1.00 (71863)");
  EXPECT_EQ(version->hardware, "00070000");
  EXPECT_THAT(version->extensions,
              ElementsAre("1.00 (59842)", "PROTVER 14.00", "FIS 0xEF4015", "MOD NEO-7P-0",
                          "PPP RAW 1.01", "GPS;SBAS;GLO;QZSS"));
}

TEST_F(UbloxReceiverInputTest, BurstOfTwentyFramesIsAnsweredInOrder) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  Bytes burst;
  for (unsigned i = 0; i < 20; ++i) {
    const auto frame = encode(CfgMsg{0xF0, static_cast<std::uint8_t>(i % 6), {0, 0, 0, 0, 0, 0}});
    burst.insert(burst.end(), frame.begin(), frame.end());
  }
  receiver.receive(now_, burst);
  run(receiver, now_ + 100ms);
  EXPECT_EQ(decoded<AckAck>().size(), 20U);
  EXPECT_EQ(receiver.received().accepted, 20U);
}

TEST_F(UbloxReceiverInputTest, ByteByByteIsAsGoodAsAtOnce) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  Bytes bytes{'x', 0xB5, 'y', '\r', '\n', '$', 'P', '\r', '\n'};
  const auto frame = encode(CfgRate{500, 1, 1});
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  for (const auto byte : bytes) {
    receiver.receive(now_, {&byte, 1});
  }
  EXPECT_EQ(receiver.sample_plan().period, 500ms);
  EXPECT_EQ(receiver.received().accepted, 1U);
  EXPECT_GE(receiver.received().malformed, 1U);
}

TEST_F(UbloxReceiverInputTest, BadChecksumIsDroppedInSilence) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  auto frame = encode(CfgRate{500, 1, 1});
  frame.back() ^= 1;
  receiver.receive(now_, frame);
  run(receiver, now_ + 50ms);
  EXPECT_TRUE(line_.all.empty());
  EXPECT_EQ(receiver.sample_plan().period, 1s);
  EXPECT_EQ(receiver.received().malformed, 1U);
}

TEST_F(UbloxReceiverInputTest, OversizedFrameDoesNotSwallowTheNext) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  Bytes bytes{0xB5, 0x62, 0x06, 0x00, 0xFF, 0xFF};
  const auto frame = encode(CfgRate{500, 1, 1});
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  receiver.receive(now_, bytes);
  EXPECT_EQ(receiver.sample_plan().period, 500ms);
}

TEST_F(UbloxReceiverInputTest, SurvivesAMegabyteOfNoise) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  std::uint64_t state = 1;
  Bytes noise(1 << 20);
  for (auto& byte : noise) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    byte = static_cast<std::uint8_t>(state >> 56U);
  }
  for (std::size_t at = 0; at < noise.size(); at += 777) {
    receiver.receive(now_,
                     std::span(noise).subspan(at, std::min<std::size_t>(777, noise.size() - at)));
  }
  EXPECT_EQ(receiver.received().bytes, noise.size());
  EXPECT_EQ(receiver.received().accepted, 0U);
  // Whatever frame the noise left open is closed by at most one longest payload.
  receiver.receive(now_, Bytes(1100, 0));
  say(receiver, CfgRate{500, 1, 1});
  EXPECT_EQ(receiver.sample_plan().period, 500ms);
}

// A link that trickles, and one that makes up the beginning of the longest frame there is: the
// frames behind it are late, none is lost. On both ports.
TEST_F(UbloxReceiverInputTest, CorrectionsThatTrickleThroughGarbageAreAllTaken) {
  // Message 1005 of station 2003, the standard's example.
  const Bytes correction{0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98,
                         0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC, 0x09,
                         0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98};
  constexpr std::size_t kFrames = 60;
  Bytes stream{0xD3, 0x03, 0xFF};  // 1023 bytes are to follow
  std::mt19937 random(3);
  for (std::size_t i = 0; i < kFrames; ++i) {
    stream.insert(stream.end(), correction.begin(), correction.end());
    for (std::size_t k = random() % 4; k > 0; --k) {
      stream.push_back(static_cast<std::uint8_t>(random() % 0xD3));
    }
  }
  // The last of them are taken when what was promised could have come.
  stream.insert(stream.end(), 1'100, 0);
  for (const bool second : {false, true}) {
    now_ = kStart;
    line_ = {};
    UbloxSettings settings = quiet();
    settings.profile = &ublox_zed_f9p();
    UbloxReceiver receiver(settings, calendar_, line_);
    run(receiver, kStart + 500ms);
    for (const std::uint8_t byte : stream) {
      if (second) {
        receiver.receive_second(now_, {&byte, 1}, receiver.second_baud());
      } else {
        receiver.receive(now_, {&byte, 1});
      }
      now_ += 50ms;  // 20 bytes per second
      receiver.advance(now_);
    }
    say(receiver, MonMsgpp::kId, {});
    run(receiver, now_ + 300ms);
    const auto report = decoded<MonMsgpp>();
    ASSERT_EQ(report.size(), 1U);
    constexpr std::size_t kPerPort = 8;
    constexpr std::size_t kRtcm3 = 5;
    EXPECT_EQ(report[0].messages[kPerPort * (second ? kPortUart2 : kPortUart1) + kRtcm3], kFrames);
  }
}

TEST_F(UbloxReceiverInputTest, UnknownSentenceIsAnswered) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  const std::string_view good = "$PUBX,40,GLL,0,1,0,0,0,0*5D\r\n";
  receiver.receive(now_, {reinterpret_cast<const std::uint8_t*>(good.data()), good.size()});
  protocols::nmea::Sentence strange("PGRMO");
  strange.empty().field("2");
  receiver.receive(now_, strange.bytes());
  run(receiver, now_ + 50ms);
  EXPECT_THAT(line_.sentences(), ElementsAre("$GPTXT,01,01,01,NMEA unknown msg*58"));
  line_.clear();
  run(receiver, kStart + 1500ms);
  EXPECT_THAT(line_.sentences(), ElementsAre(StartsWith("$GPGLL,")));
}

TEST_F(UbloxReceiverInputTest, ResetGreetsAgainAndForgetsWhatWasNotSaved) {
  UbloxSettings settings = quiet();
  settings.start_banner = true;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgRate{200, 1, 1});
  say(receiver, CfgRst{0, 1});
  line_.clear();
  run(receiver, now_ + 900ms);
  EXPECT_EQ(line_.sentences().size(), 11U);
  EXPECT_EQ(receiver.sample_plan().period, 1s);
  say(receiver, CfgRate{200, 1, 1});
  say(receiver, CfgCfg{0, 0xFFFF, 0});
  say(receiver, CfgRst{0, 1});
  run(receiver, now_ + 900ms);
  EXPECT_EQ(receiver.sample_plan().period, 200ms);
  say(receiver, CfgCfg{0xFFFF, 0, 0xFFFF});
  EXPECT_EQ(receiver.sample_plan().period, 1s);
}

TEST_F(UbloxReceiverInputTest, StoppedReceiverAsksForNoSamples) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgRst{0, 8});
  EXPECT_EQ(receiver.sample_plan().first, kNever);
  say(receiver, CfgRst{0, 9});
  EXPECT_EQ(receiver.sample_plan().first, kStart + 1s);
}

TEST_F(UbloxReceiverInputTest, OnlyOneRadioPath) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgGnssHead::kId, {0, 0, 22, 1, 6, 8, 255, 0, 1, 0, 0, 0});  // GLONASS too
  say(receiver, CfgGnssHead::kId,
      {0, 0, 22, 4, 0, 4, 255, 0, 0, 0, 0, 0, 1,   1, 3, 0, 0, 0,
       0, 0, 5,  0, 3, 0, 0,   0, 0, 0, 6, 8, 255, 0, 1, 0, 0, 0});  // alone
  run(receiver, now_ + 50ms);
  EXPECT_THAT(ids(), ElementsAre(AckNak::kId, AckAck::kId));
}

}  // namespace
}  // namespace rigwire::emulators

// The line between receiver and client: speeds that differ, noise, buffers; and the supply.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <numeric>

#include "emulators/ublox/line_quality.h"
#include "fault_period.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/timing.h"
#include "rig.h"
#include "supply_switch.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using namespace protocols::ubx;
using testing::ElementsAre;
using testing::StartsWith;

class UbloxLineTest : public UbloxReceiverTest {};

TEST_F(UbloxLineTest, ReadingAtTheSameSpeedIsReading) {
  const Bytes sent{0x00, 0xFF, 0xB5, 0x62, 0x55, 0xAA, 'G', 'P'};
  std::array<std::uint8_t, 40> read{};
  const std::size_t count = read_at_wrong_speed(sent, 9600, 9600, read);
  EXPECT_EQ(Bytes(read.begin(), read.begin() + std::ptrdiff_t(count)), sent);
}

TEST_F(UbloxLineTest, ReadingTwiceAsFastSeesEachBitTwice) {
  // 0x55 on the line: 0 1010 1010 1; read twice as fast the first byte is start, then 0 11 00 11 0.
  std::array<std::uint8_t, 40> read{};
  const std::size_t count = read_at_wrong_speed(Bytes{0x55}, 9600, 19200, read);
  ASSERT_GE(count, 1U);
  EXPECT_EQ(read[0], 0b0110'0110);
}

TEST_F(UbloxLineTest, ClientAtAnotherSpeedHearsGarbageAndIsNotUnderstood) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  receiver.set_client(now_, {true, 9600});
  say(receiver, CfgRate{200, 1, 1});
  say(receiver, MonVerHead::kId, {});
  run(receiver, now_ + 100ms);
  EXPECT_EQ(receiver.sample_plan().period, 1s);
  EXPECT_EQ(receiver.received().accepted, 0U);
  EXPECT_TRUE(line_.all.empty());
  receiver.set_client(now_, {true, 115200});
  say(receiver, MonIoHead::kId, {});
  run(receiver, now_ + 100ms);
  const auto frames = line_.frames();
  ASSERT_EQ(frames.size(), 1U);
  const auto io = decode_blocks<MonIoHead, MonIoPort>({frames[0].first, frames[0].second});
  ASSERT_TRUE(io.ok());
  EXPECT_EQ((*io)[1].framing_errors, 14 + 8);
  EXPECT_EQ((*io)[1].received_bytes, 14U + 8 + 8);
  line_.clear();
  say(receiver, MonVerHead::kId, {});
  receiver.set_client(now_, {true, 38400});  // hears the answer at a third of the speed
  run(receiver, now_ + 100ms);
  EXPECT_GT(line_.all.size(), 20U);
  EXPECT_LT(line_.all.size(), 228U);
  EXPECT_FALSE(decode_frame(line_.all).ok());
}

TEST_F(UbloxLineTest, UnknownSpeedAndNobodyAreNotGarbled) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  for (const SerialClient client : {SerialClient{false, 9600}, SerialClient{true, 0}}) {
    line_.clear();
    receiver.set_client(now_, client);
    say(receiver, CfgRate::kId, {});
    run(receiver, now_ + 50ms);
    EXPECT_THAT(ids(), ElementsAre(CfgRate::kId, AckAck::kId));
  }
}

TEST_F(UbloxLineTest, SpeedChangeByCommandIsHeardAfterTheClientFollows) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  receiver.set_client(now_, {true, 115200});
  say(receiver, CfgPrt{1, 0, 0x08C0, 38400, 7, 3, 0});
  receiver.set_client(now_, {true, 38400});
  run(receiver, now_ + 50ms);  // the acknowledgement may be lost, as on the real line
  line_.clear();
  say(receiver, CfgRate::kId, {});
  run(receiver, now_ + 50ms);
  EXPECT_THAT(ids(), ElementsAre(CfgRate::kId, AckAck::kId));
}

TEST_F(UbloxLineTest, NoiseTurnsBitsAtItsRate) {
  struct Sink final : ByteOutput {
    void send(SimTime, std::span<const std::uint8_t> bytes) override {
      for (const auto byte : bytes) {
        errors += std::popcount(byte);
        ++count;
      }
    }
    int errors = 0;
    int count = 0;
  };
  Sink sink;
  UbloxLineQuality line(sink, 7);
  line.set_bit_error_rate(0.01);
  const Bytes zeros(8);
  for (int i = 0; i < 10'000; ++i) {
    line.send(kStart, zeros);
  }
  EXPECT_EQ(sink.count, 80'000);
  EXPECT_NEAR(sink.errors, 6400, 4 * 80);  // binomial, four standard deviations
  line.set_bit_error_rate(0.0);
  sink.errors = 0;
  line.send(kStart, zeros);
  EXPECT_EQ(sink.errors, 0);
}

TEST_F(UbloxLineTest, NoiseIsAFaultWithAnEnd) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-SOL"};
  settings.faults = {{between(2500ms, 4500ms), UartNoiseFault{0.01}}};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 2400ms);
  EXPECT_EQ(line_.frames().size(), 2U);
  line_.clear();
  run(receiver, kStart + 4400ms);
  EXPECT_EQ(line_.all.size(), 120U);
  EXPECT_FALSE(decode_frame(line_.all).ok() && decode_frame(std::span(line_.all).subspan(60)).ok());
  line_.clear();
  run(receiver, kStart + 5900ms);
  EXPECT_EQ(line_.frames().size(), 1U);
}

TEST_F(UbloxLineTest, OverflowIsCountedShownAndForgotten) {
  UbloxSettings settings = quiet();
  settings.baud = 9600;
  settings.transmit_buffer_bytes = 1024;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 100ms + settings.start_up);
  for (int i = 0; i < 10; ++i) {
    say(receiver, MonVerHead::kId, {});
  }
  run(receiver, now_ + 2s);
  line_.clear();
  say(receiver, MonTxbuf::kId, {});
  say(receiver, MonTxbuf::kId, {});
  run(receiver, now_ + 500ms);
  const auto buffers = decoded<MonTxbuf>();
  ASSERT_EQ(buffers.size(), 2U);
  EXPECT_EQ(buffers[0].errors, 0x82);
  EXPECT_EQ(buffers[1].errors, 0);
  EXPECT_EQ(buffers[0].peak_usage_percent[1], 89);  // 4 * 228 - 8 of 1024
  EXPECT_EQ(receiver.counters().messages_lost, 6U);
}

TEST_F(UbloxLineTest, TextsAlsoLeaveAsInformationMessages) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgInf{0, {0, 7, 0, 0, 0, 0}});
  run(receiver, now_ + 50ms);
  line_.clear();
  protocols::nmea::Sentence strange("PGRMO");
  strange.empty();
  receiver.receive(now_, strange.bytes());
  run(receiver, now_ + 50ms);
  const auto frames = line_.frames();
  ASSERT_EQ(frames.size(), 1U);  // INF-WARNING
  EXPECT_EQ(frames[0].first, (MessageId{0x04, 0x01}));
  EXPECT_EQ(std::string(frames[0].second.begin(), frames[0].second.end()), "NMEA unknown msg");
  EXPECT_EQ(line_.sentences().size(), 1U);
}

TEST_F(UbloxLineTest, SentencesBeyondTheUsualSetAreThere) {
  UbloxSettings settings = quiet();
  settings.nmea_sentences = {"GST", "GBS", "DTM", "GRS", "GNS", "PUBX,00", "PUBX,03", "PUBX,04"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1900ms,
      [](GnssSample& s) { s.position_covariance_ned_m2 = {4.0, 0.0, 0.0, 9.0, 0.0, 25.0}; });
  // PUBX,03 has more fields than the reader of this fixture keeps.
  const std::string text = line_.text();
  for (const std::string_view expected :
       {"$GPGST,080001.00,1.6,,,,2.0,3.0,5.0*73\r\n", "$GPGBS,080001.00,2.0,3.0,5.0,",
        "$GPGRS,080001.00,1,0.0,", "$GPDTM,W84,,0.0,N,0.0,E,0.0,W84*6F\r\n",
        "$GPGNS,080001.00,4925.44074,N,00745.06274,W,AN,08,1.59,",
        "$PUBX,00,080001.00,4925.44074,N,00745.06274,W,328.250,G3,2.5,4.0,5.091,45.00,-0.250,",
        "$PUBX,03,08,", "$PUBX,04,080001.00,010626,115201.00,2421,18,"}) {
    EXPECT_THAT(text, testing::HasSubstr(std::string(expected)));
  }
}

TEST_F(UbloxLineTest, AntennaIsSupervised) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"MON-HW"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1500ms);
  run(receiver, kStart + 2500ms, [](GnssSample& s) {
    s.radio.antenna = AntennaState::short_circuit;
    s.radio.jamming = 0.5;
    s.radio.noise_db = 6.0;
  });
  run(receiver, kStart + 3500ms, [](GnssSample& s) { s.radio.antenna = AntennaState::open; });
  const auto hw = decoded<MonHw>();
  ASSERT_EQ(hw.size(), 3U);
  EXPECT_EQ(hw[0].antenna_status, 2);
  EXPECT_EQ(hw[0].antenna_power, 1);
  EXPECT_NEAR(hw[0].jamming_indicator, 7.5, 0.5);
  EXPECT_EQ(hw[0].noise_per_ms, 104);
  EXPECT_EQ(hw[1].antenna_status, 3);
  EXPECT_EQ(hw[1].antenna_power, 0);
  EXPECT_NEAR(hw[1].jamming_indicator, 131.5, 0.5);
  EXPECT_NEAR(hw[1].noise_per_ms, 208, 1);
  EXPECT_LT(hw[1].gain_control, hw[0].gain_control);
  EXPECT_EQ(hw[2].antenna_status, 2);  // open circuits are not looked for as delivered
  EXPECT_THAT(line_.sentences(),
              ElementsAre("$GPTXT,01,01,02,ANTSTATUS=SHORT*6D", "$GPTXT,01,01,02,ANTSTATUS=OK*3B"));
  say(receiver, CfgAnt{0x001F, 0xB9F0});
  run(receiver, kStart + 4500ms, [](GnssSample& s) { s.radio.antenna = AntennaState::open; });
  EXPECT_EQ(decoded<MonHw>().back().antenna_status, 4);
}

TEST_F(UbloxLineTest, SupplyOffIsSilenceAndOnIsTheBanner) {
  UbloxSettings settings = quiet();
  settings.start_banner = true;
  settings.nmea_sentences = {"GLL"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 2500ms);
  say(receiver, CfgRate{500, 1, 1});
  say(receiver, CfgCfg{0, 0xFFFF, 0});
  test::switch_supply(receiver, now_, false);
  line_.clear();
  EXPECT_EQ(receiver.sample_plan().first, kNever);
  EXPECT_EQ(receiver.next_event(), kNever);
  say(receiver, MonVerHead::kId, {});
  receiver.update(good_sample(now_ + 1s));
  run(receiver, now_ + 10s);
  EXPECT_TRUE(line_.all.empty());
  test::switch_supply(receiver, now_, true);
  EXPECT_EQ(receiver.sample_plan().period, 500ms);  // saved, and the battery kept it
  run(receiver, now_ + 900ms);
  EXPECT_THAT(line_.sentences().at(0), StartsWith("$GPTXT,01,01,02,u-blox ag"));
  EXPECT_THAT(line_.sentences().back(), testing::HasSubstr(",A,A*"));  // hot start
}

TEST_F(UbloxLineTest, AFaultOfTheSupplyAtTheStartDelaysPowerOn) {
  UbloxSettings settings = quiet();
  settings.nmea_sentences = {"GLL"};
  settings.supply_faults = {{{0s, 3s}, NoSupplyFault{}}};
  UbloxReceiver receiver(settings, calendar_, line_);
  EXPECT_EQ(receiver.sample_plan().first, kNever);
  EXPECT_EQ(receiver.next_event(), kStart + 3s);
  run(receiver, kStart + 2900ms);
  EXPECT_TRUE(line_.all.empty());
  run(receiver, kStart + 6s);
  EXPECT_EQ(receiver.sample_plan().first, kStart + 4s);
  EXPECT_FALSE(line_.sentences().empty());
}

TEST_F(UbloxLineTest, ASlowReceiverTellsAnEvenShareOfItsEpochs) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-SOL"};
  settings.measurement_period = 100ms;
  settings.faults = {{between(2s, 4s), SlowFixFault{.share = 0.4}}};
  UbloxReceiver receiver(settings, calendar_, line_);
  const auto told = [&](SimTime until) {
    line_.clear();
    run(receiver, until);
    return decoded<NavSol>().size();
  };
  run(receiver, kStart + 1050ms);
  EXPECT_EQ(told(kStart + 2050ms), 10U);
  EXPECT_EQ(told(kStart + 4050ms), 8U);
  EXPECT_EQ(told(kStart + 5050ms), 10U);
}

TEST_F(UbloxLineTest, WhoeverRefusesAnswersNakAndStaysAsHeIs) {
  UbloxSettings settings = quiet();
  settings.faults = {{between(1s, 2s), RefusedConfigurationFault{}}};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1200ms);
  say(receiver, CfgRate{500, 1, 1});
  run(receiver, kStart + 1500ms);
  EXPECT_EQ(receiver.counters().refused, 1U);
  EXPECT_EQ(receiver.counters().acknowledged, 0U);
  EXPECT_EQ(receiver.configuration().rate().measurement_period_ms, 1000);
  say(receiver, CfgRst{0, 0});
  EXPECT_EQ(receiver.counters().resets, 0U) << "nor is it reset";
  say(receiver, CfgRate::kId, {});
  run(receiver, kStart + 1800ms);
  EXPECT_EQ(receiver.counters().acknowledged, 1U) << "a poll changes nothing";
  run(receiver, kStart + 2200ms);
  say(receiver, CfgRate{500, 1, 1});
  EXPECT_EQ(receiver.configuration().rate().measurement_period_ms, 500);
}

TEST_F(UbloxLineTest, FourHoursOffIsAWarmStart) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-SOL"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1500ms);
  test::switch_supply(receiver, now_, false);
  now_ += 5h;
  test::switch_supply(receiver, now_, true);
  line_.clear();
  run(receiver, now_ + 40s);
  const auto sol = decoded<NavSol>();
  EXPECT_EQ(sol.front().flags, 0xDC);                            // time and week at once ...
  EXPECT_EQ(std::ranges::count(sol, 0, &NavSol::fix_type), 28);  // ... the fix after 28 s
}

TEST_F(UbloxLineTest, WithoutBatteryNothingOutlivesTheSupply) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-SOL"};
  settings.backup_battery = false;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1500ms);
  say(receiver, CfgRate{500, 1, 1});
  say(receiver, CfgCfg{0, 0xFFFF, 0});
  say(receiver, CfgRst{0, 0});  // a reset keeps it
  EXPECT_EQ(receiver.sample_plan().period, 500ms);
  test::switch_supply(receiver, now_, false);
  test::switch_supply(receiver, now_ + 1s, true);
  now_ += 1s;
  EXPECT_EQ(receiver.sample_plan().period, 1s);
  line_.clear();
  run(receiver, now_ + 3s);
  EXPECT_EQ(decoded<NavSol>().at(0).flags, 0xD0);
}

TEST_F(UbloxLineTest, ResetsByWhatTheyClear) {
  for (const auto& [mask, epochs_without_fix] :
       {std::pair{0x0000, 0}, {0x0001, 28}, {0xFFFF, 30}}) {
    UbloxSettings settings = quiet();
    settings.ubx_messages = {"NAV-SOL"};
    line_ = {};
    now_ = kStart;
    UbloxReceiver receiver(settings, calendar_, line_);
    run(receiver, kStart + 1500ms);
    line_.clear();
    say(receiver, CfgRst{static_cast<std::uint16_t>(mask), 2});
    run(receiver, now_ + 35s);
    const auto sol = decoded<NavSol>();
    EXPECT_NEAR(double(std::ranges::count(sol, 0, &NavSol::fix_type)), epochs_without_fix, 1.0)
        << mask;
    const bool time_at_once = (sol.front().flags & 0x0C) == 0x0C;
    EXPECT_EQ(time_at_once, mask != 0xFFFF);
    const bool position_at_once = sol.front().position_cm[0] != 637'813'700;
    EXPECT_EQ(position_at_once, mask != 0xFFFF);
  }
}

TEST_F(UbloxLineTest, EdgesOnTheInterruptPinAreTimed) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"TIM-TM2", "TIM-TP"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1500ms);
  receiver.external_interrupt(kStart + 1500ms + 123'456ns, true);
  run(receiver, kStart + 3500ms);
  const auto marks = decoded<TimTm2>();
  ASSERT_EQ(marks.size(), 1U);
  EXPECT_EQ(marks[0].count, 1);
  EXPECT_EQ(marks[0].flags & 0x84, 0x80);
  EXPECT_EQ(marks[0].rising_time_of_week_ms, 115'219'500U);
  EXPECT_EQ(marks[0].rising_rest_ns, 123'456U);
  EXPECT_EQ(marks[0].rising_week, 2421);
  const auto pulses = decoded<TimTp>();
  ASSERT_EQ(pulses.size(), 3U);
  EXPECT_EQ(pulses[0].time_of_week_ms, 115'220'000U);  // of the pulse to come
  EXPECT_EQ(pulses[0].week, 2421);
}

TEST_F(UbloxLineTest, DueTimesNeverGoBackWhateverTheClientDoes) {
  // UbloxLine itself holds the order of due times.
  UbloxSettings settings;
  UbloxReceiver receiver(settings, calendar_, line_);
  std::uint64_t state = 3;
  const auto draw = [&](std::uint64_t below) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return (state >> 33U) % below;
  };
  const std::array<std::uint32_t, 4> speeds{4800, 9600, 115200, 460800};
  for (int i = 0; i < 300; ++i) {
    switch (draw(5)) {
      case 0:
        receiver.set_client(now_, {draw(2) == 0, speeds[draw(4)]});
        break;
      case 1:
        receiver.set_client(now_, {});
        say(receiver, CfgPrt{1, 0, 0x08C0, speeds[draw(4)], 7, 3, 0});
        break;
      case 2:
        test::switch_supply(receiver, now_, draw(4) != 0);
        break;
      case 3:
        receiver.set_client(now_, {});
        say(receiver, CfgRst{0, static_cast<std::uint8_t>(draw(10))});
        break;
      default:
        break;
    }
    run(receiver, now_ + Duration{static_cast<std::int64_t>(draw(700)) * 1'000'000});
  }
  EXPECT_GT(receiver.counters().epochs, 10U);
}

TEST_F(UbloxLineTest, TenMegabytesOfNoiseAreOnlyNoise) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  std::uint64_t state = 99;
  Bytes noise(1 << 16);
  std::uint64_t fed = 0;
  while (fed < 10'000'000) {
    for (std::size_t i = 0; i + 8 <= noise.size(); i += 8) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      for (std::size_t k = 0; k < 8; ++k) {
        noise[i + k] = static_cast<std::uint8_t>((state ^ state >> 29U) >> 8 * k);
      }
    }
    receiver.receive(now_, noise);
    receiver.advance(now_ += 1ms);
    fed += noise.size();
  }
  EXPECT_EQ(receiver.received().bytes, fed);
  EXPECT_LE(receiver.received().accepted, 1U);
  receiver.receive(now_, Bytes(1100, 0));
  say(receiver, CfgRate{500, 1, 1});
  EXPECT_EQ(receiver.sample_plan().period, 500ms);
}

}  // namespace
}  // namespace rigwire::emulators

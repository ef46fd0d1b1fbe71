#include "protocols/rtcm3/message.h"

#include <gtest/gtest.h>

#include <random>

#include "example_messages.h"

namespace rigwire::protocols::rtcm3 {
namespace {

using Bytes = std::vector<std::uint8_t>;

Decoded<Message> read(std::span<const std::uint8_t> bytes) {
  const auto frame = decode_frame(bytes);
  EXPECT_TRUE(frame.ok());
  return decode_message(frame->payload);
}

// Message 1005 of the standard's example 4.2.
const Bytes kMessageExample{0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98,
                            0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC, 0x09,
                            0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98};

TEST(Rtcm3Message, ExampleOfTheStandardIsReadAndWrittenAgain) {
  const auto message = read(kMessageExample);
  ASSERT_TRUE(message.ok());
  const auto& p = std::get<AntennaPosition>(*message);
  EXPECT_EQ(p.station, 2003);
  EXPECT_TRUE(p.gps && !p.glonass && !p.galileo && !p.computed && !p.single_oscillator);
  EXPECT_NEAR(p.position_m[0], 1'114'104.5999, 5e-5);
  EXPECT_NEAR(p.position_m[1], -4'850'729.7108, 5e-5);
  EXPECT_NEAR(p.position_m[2], 3'975'521.4643, 5e-5);
  EXPECT_EQ(framed(*message), kMessageExample);
}

// A ZED-F9T's 1230 without a bias has four bytes, with two of them eight.
TEST(Rtcm3Message, BiasesTakeTheBytesThatTheirMaskSays) {
  GlonassBiases none{.station = 0, .aligned = false};
  EXPECT_EQ(framed(none).size(), 4U + 6U);
  GlonassBiases two = none;
  two.biases_m[0] = -71.94;
  two.biases_m[2] = 0.0;
  const Bytes bytes = framed(two);
  EXPECT_EQ(bytes.size(), 8U + 6U);
  EXPECT_EQ(bytes[3 + 3], 0x0A) << "mask 1010 after three reserved bits";
  const auto message = read(bytes);
  ASSERT_TRUE(message.ok());
  EXPECT_NEAR(*std::get<GlonassBiases>(*message).biases_m[0], -71.94, 1e-9);
  EXPECT_FALSE(std::get<GlonassBiases>(*message).biases_m[1]);
}

// Texts behind their counts, of five lengths, one of them none.
TEST(Rtcm3Message, DescriptorsComeBackAndALongerTextThanTheStandardHasIsRefused) {
  const StationDescriptors written = example_descriptors();
  const Bytes bytes = framed(written);
  ASSERT_EQ(bytes.size(), 3U + 9U + 20U + 0U + 11U + 4U + 7U + 3U) << "heads and texts";
  EXPECT_EQ(std::string(bytes.begin() + 3 + 4, bytes.begin() + 3 + 24), "LEIAR25.R4      LEIT");
  const auto message = read(bytes);
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(std::get<StationDescriptors>(*message), written);
  // The receiver's count, after 3 bytes of number and station, antenna, set-up and no serial.
  Bytes payload(bytes.begin() + 3, bytes.end() - 3);
  ASSERT_EQ(payload[26], 11);
  payload[26] = 32;
  payload.resize(200);
  EXPECT_TRUE(decode_message(payload).malformed());
  payload[26] = 31;
  EXPECT_TRUE(decode_message(payload).ok());
  EXPECT_EQ(StationDescriptors::Text(std::string(40, 'x')).text(), std::string(31, 'x'));
}

void expect_observation(const SignalObservation& read, const SignalObservation& written,
                        double range_m, double phase_m, bool rates, double cn0_dbhz) {
  ASSERT_TRUE(read.range_m && read.phase_m);
  EXPECT_NEAR(*read.range_m, *written.range_m, range_m);
  EXPECT_NEAR(*read.phase_m, *written.phase_m, phase_m);
  EXPECT_EQ(read.rate_mps.has_value(), rates);
  if (rates) {
    EXPECT_NEAR(*read.rate_mps, *written.rate_mps, 0.51e-4);
  }
  EXPECT_NEAR(read.cn0_dbhz, written.cn0_dbhz, cn0_dbhz);
  EXPECT_EQ(read.half_cycle, written.half_cycle);
  EXPECT_LE(read.locked_s, written.locked_s);
  EXPECT_GE(read.locked_s, 0.45 * written.locked_s);
}

// Half a step of each field: 2^-24 and 2^-29 ms of light are 17.9 and 0.56 mm.
TEST(Rtcm3Message, SignalsComeBackToHalfAStep) {
  for (const MsmForm form : kForms) {
    const bool full = form == MsmForm::seven;
    for (const MultipleSignals& written : example_systems(form)) {
      const auto message = read(framed(written));
      ASSERT_TRUE(message.ok());
      const auto& p = std::get<MultipleSignals>(*message);
      EXPECT_EQ(p.system, written.system);
      EXPECT_EQ(p.form, form);
      EXPECT_EQ(p.station, written.station);
      EXPECT_EQ(p.epoch, written.epoch);
      EXPECT_EQ(p.more, written.more);
      EXPECT_EQ(p.channels, written.channels);
      ASSERT_EQ(p.count, written.count);
      for (std::size_t i = 0; i < p.count; ++i) {
        EXPECT_EQ(p.cells[i].satellite, written.cells[i].satellite);
        EXPECT_EQ(p.cells[i].signal, written.cells[i].signal);
        const double step_m = kLightMillisecond_m * (full ? 0x1p-29 : 0x1p-24);
        const double phase_step_m = kLightMillisecond_m * (full ? 0x1p-31 : 0x1p-29);
        expect_observation(p.cells[i].observation, written.cells[i].observation, 0.51 * step_m,
                           0.51 * phase_step_m, form != MsmForm::four, full ? 0.04 : 0.51);
      }
      EXPECT_EQ(framed(p), framed(*message)) << "what was read is written as it came";
      EXPECT_EQ(framed(p).size(), framed(written).size());
    }
  }
}

TEST(Rtcm3Message, ValuesThatAreNotThereOrDoNotFitAreNotThere) {
  MultipleSignals p = example_signals(MsmSystem::gps, MsmForm::seven, {msm_signal::kGps1C});
  p.cells[0].observation.range_m.reset();
  p.cells[1].observation.phase_m = *p.cells[1].observation.range_m + 2'000.0;
  p.cells[2].observation.rate_mps.reset();
  p.cells[3].observation = {};
  const auto message = read(framed(p));
  ASSERT_TRUE(message.ok());
  const auto& cells = std::get<MultipleSignals>(*message).cells;
  EXPECT_FALSE(cells[0].observation.range_m);
  EXPECT_TRUE(cells[0].observation.phase_m);
  EXPECT_TRUE(cells[1].observation.range_m);
  EXPECT_FALSE(cells[1].observation.phase_m);
  EXPECT_FALSE(cells[2].observation.rate_mps);
  EXPECT_FALSE(cells[3].observation.range_m || cells[3].observation.phase_m);
}

// Satellites times signals are at most 64: of 40 satellites with two signals 32 stay.
TEST(Rtcm3Message, MoreThanSixtyFourCellsAreNotWritten) {
  MultipleSignals p = example_signals(MsmSystem::gps, MsmForm::seven, {});
  for (std::uint8_t satellite = 1; satellite <= 32; ++satellite) {
    for (const std::uint8_t signal : std::to_array<std::uint8_t>({2, 16})) {
      p.cells[p.count++] = {satellite, signal, example_observation(1, 0)};
    }
  }
  ASSERT_EQ(p.count, MultipleSignals::kGreatest);
  auto message = read(framed(p));
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(std::get<MultipleSignals>(*message).count, MultipleSignals::kGreatest);
  p.cells[0].signal = 3;  // a third signal: 21 satellites
  message = read(framed(p));
  ASSERT_TRUE(message.ok());
  const auto& read_back = std::get<MultipleSignals>(*message);
  EXPECT_EQ(read_back.cells[read_back.count - 1].satellite, 21);
}

TEST(Rtcm3Message, MasksThatCannotBeAreMalformed) {
  Bytes payload(400, 0xFF);
  payload[0] = 1077 >> 4;
  payload[1] = (1077 & 0xF) << 4 | 0xF;
  EXPECT_TRUE(decode_message(payload).malformed());
}

TEST(Rtcm3Message, OlderObservationsComeBackToHalfAStep) {
  for (const bool glonass : {false, true}) {
    const LegacyObservations written = example_legacy(glonass);
    const Bytes bytes = framed(written);
    // 8 bytes and 125 bits each, 61 bits and 130 each.
    EXPECT_EQ(bytes.size(),
              6U + (glonass ? (61U + 3U * 130U + 7U) / 8U : 8U + (3U * 125U + 7U) / 8U));
    const auto message = read(bytes);
    ASSERT_TRUE(message.ok());
    const auto& p = std::get<LegacyObservations>(*message);
    EXPECT_EQ(p.glonass, glonass);
    EXPECT_EQ(p.time_ms, written.time_ms);
    ASSERT_EQ(p.count, written.count);
    for (std::size_t i = 0; i < p.count; ++i) {
      const auto& s = p.satellites[i];
      EXPECT_EQ(s.number, written.satellites[i].number);
      EXPECT_EQ(s.channel, written.satellites[i].channel);
      expect_observation(s.first, written.satellites[i].first, 0.0101, 2.6e-4, false, 0.126);
      // Both ranges are rounded.
      expect_observation(s.second, written.satellites[i].second, 0.0201, 2.6e-4, false, 0.126);
    }
    EXPECT_EQ(framed(p), bytes);
  }
}

// 1001, 1003, 1009, 1011: no milliseconds of light, no strengths; 1001, 1002, 1009, 1010: L1 alone.
TEST(Rtcm3Message, OlderObservationsOfLessContentHaveWhatTheirNumberSays) {
  struct Case {
    bool glonass;
    bool second_band;
    bool extended;
    std::uint16_t number;
    std::size_t head_bits;
    std::size_t satellite_bits;
  };
  constexpr std::array kCases{
      Case{false, false, false, 1001, 64, 58}, Case{false, false, true, 1002, 64, 74},
      Case{false, true, false, 1003, 64, 101}, Case{true, false, false, 1009, 61, 64},
      Case{true, false, true, 1010, 61, 79},   Case{true, true, false, 1011, 61, 107}};
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.number);
    const LegacyObservations written = example_legacy(c.glonass, c.second_band, c.extended);
    EXPECT_EQ(number_of(written), c.number);
    const Bytes bytes = framed(written);
    EXPECT_EQ(bytes.size(), 6U + (c.head_bits + 3U * c.satellite_bits + 7U) / 8U);
    const auto message = read(bytes);
    ASSERT_TRUE(message.ok());
    const auto& p = std::get<LegacyObservations>(*message);
    EXPECT_EQ(number_of(p), c.number);
    ASSERT_EQ(p.count, written.count);
    for (std::size_t i = 0; i < p.count; ++i) {
      const auto& s = p.satellites[i];
      const auto& w = written.satellites[i];
      EXPECT_EQ(s.channel, w.channel);
      const double modulus_m = legacy_modulus_m(c.glonass);
      const double missing_m =
          c.extended ? 0.0 : modulus_m * std::floor(*w.first.range_m / modulus_m);
      ASSERT_TRUE(s.first.range_m && s.first.phase_m);
      EXPECT_NEAR(*s.first.range_m, *w.first.range_m - missing_m, 0.0101);
      EXPECT_NEAR(*s.first.phase_m, *w.first.phase_m - missing_m, 2.6e-4);
      EXPECT_NEAR(s.first.cn0_dbhz, c.extended ? w.first.cn0_dbhz : 0.0, 0.126);
      EXPECT_EQ(s.second.range_m.has_value(), c.second_band);
      if (c.second_band) {
        EXPECT_NEAR(*s.second.range_m, *w.second.range_m - missing_m, 0.0201);
        EXPECT_NEAR(*s.second.phase_m, *w.second.phase_m - missing_m, 2.6e-4);
      }
    }
    EXPECT_EQ(framed(p), bytes);
  }
}

TEST(Rtcm3Message, OwnMovingBaseComesBackAndAForeignOneIsNotRead) {
  const MovingBase written{.station = 77,
                           .time_of_week_ms = 123'456'789,
                           .position_m = {4'139'423.1234, 550'210.9876, -4'804'002.0005},
                           .velocity_mps = {1.234, -5.678, 0.001}};
  const auto message = read(framed(written));
  ASSERT_TRUE(message.ok());
  const auto& p = std::get<MovingBase>(*message);
  EXPECT_EQ(p.station, 77);
  EXPECT_EQ(p.time_of_week_ms, 123'456'789U);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(p.position_m[axis], written.position_m[axis], 5.1e-5);
    EXPECT_NEAR(p.velocity_mps[axis], written.velocity_mps[axis], 5.1e-4);
  }
  // 4072.1 of a ZED-F9T: 14 bytes and 6 for each of 20 signals.
  Bytes foreign(134, 0);
  foreign[0] = 4072 >> 4;
  foreign[1] = static_cast<std::uint8_t>((4072 & 0xF) << 4);
  foreign[2] = 1;
  EXPECT_TRUE(decode_message(foreign).malformed());
}

TEST(Rtcm3Message, EveryMessageCutShortIsMalformed) {
  std::vector<Message> all{example_position(), GlonassBiases{.biases_m = {1.0, 2.0, 3.0, 4.0}},
                           example_descriptors(), MovingBase{}};
  for (const bool glonass : {false, true}) {
    for (const bool second_band : {false, true}) {
      for (const bool extended : {false, true}) {
        all.emplace_back(example_legacy(glonass, second_band, extended));
      }
    }
  }
  for (const MsmForm form : kForms) {
    for (const MultipleSignals& p : example_systems(form)) {
      all.emplace_back(p);
    }
  }
  for (const Message& message : all) {
    const Bytes bytes = framed(message);
    const std::span payload = std::span(bytes).subspan(kHeaderBytes, bytes.size() - 6);
    EXPECT_TRUE(decode_message(payload).ok()) << number_of(message);
    for (std::size_t size = 0; size < payload.size(); ++size) {
      EXPECT_TRUE(decode_message(payload.first(size)).malformed())
          << number_of(message) << " cut to " << size;
    }
  }
}

// Tables 3.4-2, 3.5-74 and 3.5-75: the least time of a count, and the count of that time.
TEST(Rtcm3Message, LockTimesAreThoseOfTheTables) {
  EXPECT_EQ(legacy_lock_s(23), 23.0);
  EXPECT_EQ(legacy_lock_s(24), 24.0);
  EXPECT_EQ(legacy_lock_s(47), 70.0);
  EXPECT_EQ(legacy_lock_s(48), 72.0);
  EXPECT_EQ(legacy_lock_s(72), 168.0);
  EXPECT_EQ(legacy_lock_s(96), 360.0);
  EXPECT_EQ(legacy_lock_s(120), 744.0);
  EXPECT_EQ(legacy_lock_s(127), 937.0);
  EXPECT_EQ(msm4_lock_s(0), 0.0);
  EXPECT_EQ(msm4_lock_s(1), 0.032);
  EXPECT_EQ(msm4_lock_s(15), 524.288);
  EXPECT_EQ(msm7_lock_s(63), 0.063);
  EXPECT_EQ(msm7_lock_s(64), 0.064);
  EXPECT_EQ(msm7_lock_s(95), 0.126);
  EXPECT_EQ(msm7_lock_s(96), 0.128);
  EXPECT_EQ(msm7_lock_s(703), 66'060.288);
  EXPECT_EQ(msm7_lock_s(704), 67'108.864);
  for (std::uint32_t i = 0; i <= 704; ++i) {
    EXPECT_EQ(msm7_lock_count(msm7_lock_s(i)), i);
    EXPECT_EQ(legacy_lock_count(legacy_lock_s(std::min(i, 127U))), std::min(i, 127U));
    EXPECT_EQ(msm4_lock_count(msm4_lock_s(std::min(i, 15U))), std::min(i, 15U));
  }
  EXPECT_EQ(msm7_lock_count(-1.0), 0U);
  EXPECT_EQ(msm7_lock_count(1e9), 704U);
}

TEST(Rtcm3Message, EpochsOfTheSystemsGoThereAndBack) {
  EXPECT_EQ(msm_epoch(MsmSystem::beidou, 13'000, 18), 604'799'000U);
  // Saturday 21:00:18 GPS time is midnight in Moscow.
  EXPECT_EQ(msm_epoch(MsmSystem::glonass, 6 * 86'400'000 + 21 * 3'600'000 + 18'000, 18), 0U);
  for (const MsmSystem system :
       {MsmSystem::gps, MsmSystem::glonass, MsmSystem::galileo, MsmSystem::beidou}) {
    for (const std::uint32_t time_ms : {0U, 17'999U, 18'000U, 300'000'001U, 604'799'999U}) {
      EXPECT_EQ(gps_time_of_week_ms(system, msm_epoch(system, time_ms, 18), 18), time_ms);
    }
  }
  EXPECT_FALSE(gps_time_of_week_ms(MsmSystem::gps, 604'800'000, 18));
  EXPECT_FALSE(gps_time_of_week_ms(MsmSystem::glonass, 7U << 27U, 18)) << "day not known";
}

TEST(Rtcm3Message, RandomPayloadsNeverReadBeyondTheirEnd) {
  std::mt19937 random(7);
  constexpr std::array<std::uint16_t, 18> kNumbers{1001, 1002, 1003, 1004, 1005, 1006,
                                                   1009, 1011, 1012, 1074, 1075, 1077,
                                                   1084, 1097, 1127, 1230, 4072, 1033};
  for (int round = 0; round < 20'000; ++round) {
    Bytes payload(random() % 120);
    for (auto& byte : payload) {
      byte = static_cast<std::uint8_t>(random());
    }
    if (payload.size() > 1) {
      const std::uint16_t number = kNumbers[random() % kNumbers.size()];
      payload[0] = static_cast<std::uint8_t>(number >> 4);
      payload[1] = static_cast<std::uint8_t>((number & 0xF) << 4 | (payload[1] & 0xF));
    }
    const auto message = decode_message(payload);
    if (message.ok()) {
      EXPECT_LE(message.consumed(), payload.size());
    }
  }
}

}  // namespace
}  // namespace rigwire::protocols::rtcm3

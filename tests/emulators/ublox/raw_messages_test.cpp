#include "emulators/ublox/raw_messages.h"

#include <gtest/gtest.h>

#include <vector>

#include "protocols/ubx/aiding.h"
#include "protocols/ubx/blocks.h"
#include "raw_example.h"

namespace rigwire::emulators {
namespace {

namespace gps = protocols::gps;
namespace ubx = protocols::ubx;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr UbloxTimeKnowledge kAllKnown{
    .time_known = true, .week_known = true, .leap_known = true, .leap_seconds = 18};

class RawMessages : public ::testing::Test {
 protected:
  RawMessages() { raw.begin(false, false); }

  void run(int from, int to) {
    for (int second = from; second <= to; ++second) {
      raw.update(example_sample(second, navigation), kAllKnown);
    }
  }

  ubx::FrameView frame(ubx::MessageId id, std::size_t index = 0) {
    return view(raw.encode(id, index, buffer));
  }
  ubx::FrameView answer(ubx::MessageId id, std::vector<std::uint8_t> selector = {},
                        std::size_t index = 0) {
    return view(raw.encode_answer(id, selector, index, buffer));
  }
  ubx::FrameView view(std::size_t size) {
    const auto decoded = ubx::decode_frame(std::span(buffer).first(size));
    EXPECT_TRUE(decoded.ok());
    return decoded.ok() ? *decoded : ubx::FrameView{};
  }
  auto raw_blocks() {
    return *ubx::decode_blocks<ubx::RxmRawHead, ubx::RxmRawBlock>(frame(ubx::RxmRawHead::kId));
  }
  auto rawx_blocks() {
    return *ubx::decode_blocks<ubx::RxmRawxHead, ubx::RxmRawxBlock>(frame(ubx::RxmRawxHead::kId));
  }
  auto svsi_blocks() {
    return *ubx::decode_blocks<ubx::RxmSvsiHead, ubx::RxmSvsiBlock>(frame(ubx::RxmSvsiHead::kId));
  }

  UbloxRawMessages raw{Calendar(kExampleStart), 7};
  std::shared_ptr<GpsNavigation> navigation = example_navigation();
  std::array<std::uint8_t, kLongestRawFrame> buffer{};
};

TEST_F(RawMessages, NothingIsDueBeforeTheFirstEpoch) {
  for (const auto id :
       {ubx::RxmRawHead::kId, ubx::RxmRawxHead::kId, ubx::RxmSvsiHead::kId, ubx::RxmSfrb::kId,
        ubx::RxmSfrbxHead::kId, ubx::AidEph::kId, ubx::AidAlm::kId}) {
    EXPECT_TRUE(UbloxRawMessages::handles(id));
    EXPECT_EQ(raw.count(id), 0U);
    EXPECT_EQ(raw.encode(id, 0, buffer), 0U);
  }
  EXPECT_FALSE(UbloxRawMessages::handles({0x01, 0x07}));
}

TEST_F(RawMessages, WithoutTimeTheMillisecondsSinceStartAreSaidAndNoSatellite) {
  raw.update(example_sample(0, navigation), {.since_start_ms = 23'000});
  const ubx::FrameView recorded = frame(ubx::RxmRawHead::kId);
  // Recorded from a NEO-7P in that state.
  const std::vector<std::uint8_t> expected{0xd8, 0x59, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(std::vector(recorded.payload.begin(), recorded.payload.end()), expected);
  EXPECT_EQ(rawx_blocks().head().time_of_week_s, 23.0);
  EXPECT_EQ(rawx_blocks().size(), 0U);
}

TEST_F(RawMessages, TimeIsThatOfTheReceiversClock) {
  GnssSample sample = example_sample(0, navigation);
  sample.clock_label_offset = milliseconds{-1};
  raw.update(sample, kAllKnown);
  EXPECT_EQ(raw_blocks().head().time_of_week_ms, 295'229'999);
  EXPECT_EQ(raw_blocks().head().week, kExampleWeek);
  EXPECT_DOUBLE_EQ(rawx_blocks().head().time_of_week_s, 295'229.999);
  EXPECT_EQ(rawx_blocks().head().status, ubx::kRawxLeapSecondsKnown);
}

TEST_F(RawMessages, LabelBeforeTheWeeksBeginIsOfTheWeekBefore) {
  UbloxRawMessages late(Calendar({2024, 6, 1, 23, 59, 42, 0}), 7);
  GnssSample sample;
  sample.clock_label_offset = milliseconds{-1};
  UbloxTimeKnowledge time = kAllKnown;
  time.week_shift = -1024;
  late.update(sample, time);
  const auto size = late.encode(ubx::RxmRawHead::kId, 0, buffer);
  const auto head = ubx::read_payload<ubx::RxmRawHead>(view(size).payload);
  EXPECT_EQ(head.time_of_week_ms, 604'799'999);
  EXPECT_EQ(head.week, 2316 - 1024);
}

TEST_F(RawMessages, QualityFollowsTheLock) {
  run(0, 0);
  EXPECT_EQ(raw_blocks()[0].quality, 5);
  EXPECT_EQ(raw_blocks()[0].loss_of_lock, 3);
  EXPECT_EQ(rawx_blocks()[0].locked_ms, 0);
  EXPECT_EQ(rawx_blocks()[0].status, ubx::kRawxRangeValid | ubx::kRawxCarrierValid);
  run(1, 7);
  EXPECT_EQ(raw_blocks()[0].quality, 6);
  EXPECT_EQ(raw_blocks()[0].loss_of_lock, 2);
  run(8, 8);
  EXPECT_EQ(raw_blocks()[0].quality, 7);
  EXPECT_EQ(raw_blocks()[0].loss_of_lock, 0);
  EXPECT_EQ(rawx_blocks()[0].status,
            ubx::kRawxRangeValid | ubx::kRawxCarrierValid | ubx::kRawxHalfCycleKnown);
  run(9, 70);
  EXPECT_EQ(rawx_blocks()[0].locked_ms, 64'500);
}

TEST_F(RawMessages, NoisyCarrierIsNotSaid) {
  GnssSample sample = example_sample(20, navigation);
  sample.measurements[0].carrier_sigma_cycles = 0.061;
  raw.update(sample, kAllKnown);
  EXPECT_EQ(raw_blocks()[0].quality, 4);
  EXPECT_EQ(raw_blocks()[0].loss_of_lock, 3);
  EXPECT_EQ(rawx_blocks()[0].status, ubx::kRawxRangeValid);
  EXPECT_EQ(rawx_blocks()[0].carrier_sigma, ubx::kRawxNoCarrierSigma);
  EXPECT_EQ(rawx_blocks()[0].locked_ms, 0);
}

TEST_F(RawMessages, DeviationsAreRoundedUpToTheirSteps) {
  GnssSample sample = example_sample(20, navigation);
  sample.measurements[0].pseudorange_sigma_m = 0.32;    // 0.01 * 2^5.
  sample.measurements[0].doppler_sigma_hz = 0.0021;     // 0.002 * 2^1.
  sample.measurements[0].carrier_sigma_cycles = 0.013;  // 0.004 * 4.
  sample.measurements[1].pseudorange_sigma_m = 1e9;
  sample.measurements[1].doppler_sigma_hz = 0.0;
  sample.measurements[1].carrier_sigma_cycles = 0.0;
  raw.update(sample, kAllKnown);
  EXPECT_EQ(rawx_blocks()[0].pseudorange_sigma, 5);
  EXPECT_EQ(rawx_blocks()[0].doppler_sigma, 1);
  EXPECT_EQ(rawx_blocks()[0].carrier_sigma, 4);
  EXPECT_EQ(rawx_blocks()[1].pseudorange_sigma, 15);
  EXPECT_EQ(rawx_blocks()[1].doppler_sigma, 0);
  EXPECT_EQ(rawx_blocks()[1].carrier_sigma, 1);
}

// A NEO-7P's recording shows that at a set of the clock the pseudorange jumps by 299 792 m and the
// carrier of RXM-RAW runs on; RXM-RAWX moves both.
TEST_F(RawMessages, CarrierOfRawRunsOnOverAClockReset) {
  run(0, 10);
  const double before = raw_blocks()[0].carrier_phase_cycles;
  GnssSample sample = example_sample(11, navigation);
  sample.clock_reset = true;
  for (GnssMeasurement& m : sample.measurements) {
    m.pseudorange_m += 299'792.458;
    m.carrier_phase_cycles += 1'575'420.0;
  }
  raw.update(sample, kAllKnown);
  const GnssMeasurement& m = sample.measurements[0];
  EXPECT_NEAR(raw_blocks()[0].carrier_phase_cycles - before, -m.doppler_hz, 1e-3);
  EXPECT_EQ(raw_blocks()[0].pseudorange_m, m.pseudorange_m);
  EXPECT_EQ(rawx_blocks()[0].carrier_phase_cycles, m.carrier_phase_cycles);
  EXPECT_TRUE(rawx_blocks().head().status & ubx::kRawxClockReset);
}

TEST_F(RawMessages, CarrierOfRawBeginsNearZeroWithEachLock) {
  run(0, 10);
  EXPECT_GT(std::abs(raw_blocks()[0].carrier_phase_cycles), 1000.0);
  GnssSample sample = example_sample(11, navigation);
  sample.measurements[0].slipped = true;
  raw.update(sample, kAllKnown);
  EXPECT_LT(std::abs(raw_blocks()[0].carrier_phase_cycles), 1.0);
  GnssSample without = example_sample(12, navigation);
  without.measurements.erase(without.measurements.begin() + 1);
  raw.update(without, kAllKnown);
  run(13, 13);
  EXPECT_LT(std::abs(raw_blocks()[1].carrier_phase_cycles), 1.0);
  EXPECT_GT(std::abs(raw_blocks()[2].carrier_phase_cycles), 1000.0);
}

TEST_F(RawMessages, SubframeComesWhenItIsComplete) {
  std::size_t total = 0;
  for (int second = 0; second <= 60; ++second) {
    run(second, second);
    const std::size_t due = raw.count(ubx::RxmSfrb::kId);
    EXPECT_EQ(due, second > 0 && second % 6 == 0 ? kExamplePrns.size() : 0U) << second;
    total += due;
  }
  EXPECT_EQ(total, 10 * kExamplePrns.size());
}

TEST_F(RawMessages, SubframeNeedsTheSatelliteFromBeginningToEnd) {
  for (int second = 0; second <= 12; ++second) {
    GnssSample sample = example_sample(second, navigation);
    if (second == 3) {
      sample.satellites[0].tracked = false;
    }
    raw.update(sample, kAllKnown);
    if (second == 6) {
      EXPECT_EQ(raw.count(ubx::RxmSfrb::kId), kExamplePrns.size() - 1);
    }
  }
  EXPECT_EQ(raw.count(ubx::RxmSfrb::kId), kExamplePrns.size());
}

TEST_F(RawMessages, SlowEpochsBringAllSubframesOfTheTimeBetween) {
  run(0, 0);
  run(60, 60);
  EXPECT_EQ(raw.count(ubx::RxmSfrbxHead::kId), 10 * kExamplePrns.size());
  const auto last = raw.reception().subframes().back();
  EXPECT_EQ(last.begun, (gps::Step{kExampleWeek, (295'230 + 54) / 6}));
}

TEST_F(RawMessages, WordsOfSfrbAreDataWithTheirSign) {
  run(0, 6);
  const auto message = ubx::decode<ubx::RxmSfrb>(frame(ubx::RxmSfrb::kId, 1));
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(message->satellite, 8);
  EXPECT_EQ(message->channel, 1);
  EXPECT_EQ(message->words[0], 0xFF8B'0000U);  // The preamble's first bit is the sign.
  gps::SubframeData data;
  for (std::size_t i = 0; i < gps::kWords; ++i) {
    data.words[i] = message->words[i] & gps::kDataMask;
  }
  EXPECT_EQ(gps::encode_subframe(data), raw.reception().subframes()[1].subframe);
}

TEST_F(RawMessages, ChannelStaysWhileASatelliteIsTracked) {
  run(0, 6);
  GnssSample sample = example_sample(7, navigation);
  sample.satellites[0].tracked = false;
  raw.update(sample, kAllKnown);
  run(8, 12);
  EXPECT_EQ(raw.reception().subframes()[0].prn, 8);
  EXPECT_EQ(raw.reception().subframes()[0].channel, 1);
  run(13, 18);
  EXPECT_EQ(raw.reception().subframes()[0].channel, 0) << "the lowest free one";
}

TEST_F(RawMessages, ChangeOfTheBroadcastComesWithTheNextFrame) {
  run(0, 29);
  auto later = std::make_shared<GpsNavigation>(*navigation);
  later->ephemerides[0]->issue_of_clock = 700;
  later->ephemerides[0]->issue_of_ephemeris = 700 & 0xFF;
  for (int second = 30; second <= 48; ++second) {
    raw.update(example_sample(second, later), kAllKnown);
    if (second == 30) {
      EXPECT_EQ(raw.count(ubx::RxmSfrb::kId), kExamplePrns.size());
      EXPECT_EQ(raw.reception().ephemeris(1)->issue_of_clock, 513) << "subframe 5 of the old";
    }
  }
  EXPECT_EQ(raw.reception().ephemeris(1)->issue_of_clock, 700);
  EXPECT_EQ(raw.reception().new_ephemerides(), std::bitset<32>(1));
}

TEST_F(RawMessages, EphemerisIsKnownAfterThreeSubframes) {
  run(0, 17);
  EXPECT_FALSE(raw.reception().ephemeris(1));
  EXPECT_EQ(raw.count(ubx::AidEph::kId), 0U);
  run(18, 18);
  EXPECT_EQ(raw.reception().ephemeris(1), to_message(example_ephemeris(1)));
  EXPECT_EQ(raw.count(ubx::AidEph::kId), kExamplePrns.size());
  EXPECT_EQ(ubx::decode<ubx::AidEph>(frame(ubx::AidEph::kId, 4))->satellite, 32U);
  run(19, 19);
  EXPECT_EQ(raw.count(ubx::AidEph::kId), 0U);
}

TEST_F(RawMessages, PolledEphemerisDecodesToTheOrbit) {
  run(0, 18);
  EXPECT_EQ(raw.answers(ubx::AidEph::kId, {}), 32U);
  const auto message = ubx::decode<ubx::AidEph>(answer(ubx::AidEph::kId, {23}));
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(message->satellite, 23U);
  EXPECT_EQ(message->handover_word, (295'200U / 6U << 7U) | (1U << 2U));
  std::array<gps::SubframeData, 3> data;
  const std::array words{&message->subframe1, &message->subframe2, &message->subframe3};
  for (std::uint8_t id = 1; id <= 3; ++id) {
    gps::set_head(data[id - 1U], {.next_step = 295'200 / 6, .subframe_id = id});
    std::ranges::copy(*words[id - 1U], data[id - 1U].words.begin() + 2);
  }
  const auto back = gps::decode_ephemeris(data[0], data[1], data[2], 23, kExampleWeek);
  ASSERT_TRUE(back.ok());
  GpsEphemeris expected = example_ephemeris(23);
  EXPECT_EQ(to_sample(*back), expected);
}

TEST_F(RawMessages, PollOfAnUnknownOrbitHasTheShortForm) {
  run(0, 18);
  const auto ephemeris = ubx::decode<ubx::AidEphHead>(answer(ubx::AidEph::kId, {2}));
  ASSERT_TRUE(ephemeris.ok());
  EXPECT_EQ(*ephemeris, (ubx::AidEphHead{2, 0}));
  const auto almanac = ubx::decode<ubx::AidAlmHead>(answer(ubx::AidAlm::kId, {}, 1));
  ASSERT_TRUE(almanac.ok());
  EXPECT_EQ(*almanac, (ubx::AidAlmHead{2, 0}));
  for (const std::vector<std::uint8_t>& selector :
       {std::vector<std::uint8_t>{0}, std::vector<std::uint8_t>{33},
        std::vector<std::uint8_t>{1, 2}}) {
    EXPECT_EQ(raw.answers(ubx::AidEph::kId, selector), 0U);
  }
}

TEST_F(RawMessages, RememberedOrbitsAreKnownAtOnce) {
  raw.begin(true, true);
  run(0, 0);
  EXPECT_TRUE(raw.reception().ephemeris(1));
  const auto almanac = ubx::decode<ubx::AidAlm>(answer(ubx::AidAlm::kId, {8}));
  ASSERT_TRUE(almanac.ok());
  EXPECT_EQ(almanac->week, static_cast<std::uint32_t>(kExampleWeek));
  gps::SubframeData data;
  std::ranges::copy(almanac->words, data.words.begin() + 2);
  EXPECT_EQ(*gps::decode_almanac(data, kExampleWeek), *raw.reception().almanac(8));
  raw.begin(true, false);
  run(1, 1);
  EXPECT_TRUE(raw.reception().ephemeris(1));
  EXPECT_FALSE(raw.reception().almanac(1));
  raw.begin(false, false);
  run(2, 2);
  EXPECT_FALSE(raw.reception().ephemeris(1));
}

TEST_F(RawMessages, HealthUtcAndIonosphereAreSaidWhenPage18Came) {
  run(0, 53);
  EXPECT_EQ(ubx::decode<ubx::AidHui>(answer(ubx::AidHui::kId))->flags, 0U);
  run(54, 54);
  const auto hui = ubx::decode<ubx::AidHui>(answer(ubx::AidHui::kId));
  ASSERT_TRUE(hui.ok());
  EXPECT_EQ(hui->flags, 0x6U);
  EXPECT_EQ(hui->utc_a0_s, navigation->utc.a0_s);
  EXPECT_EQ(hui->utc_a1, navigation->utc.a1);
  EXPECT_EQ(hui->utc_reference_s, 81 * 4096);
  EXPECT_EQ(hui->leap_seconds, 18);
  EXPECT_EQ(hui->klobuchar_alpha[0], static_cast<float>(navigation->ionosphere.alpha[0]));
  EXPECT_EQ(hui->klobuchar_beta[3], static_cast<float>(navigation->ionosphere.beta[3]));
  raw.begin(true, true);
  UbloxRawMessages warm{Calendar(kExampleStart), 7};
  warm.begin(true, true);
  warm.update(example_sample(0, navigation), kAllKnown);
  const auto size = warm.encode_answer(ubx::AidHui::kId, {}, 0, buffer);
  EXPECT_EQ(ubx::decode<ubx::AidHui>(view(size))->flags, 0x7U);
  EXPECT_EQ(ubx::decode<ubx::AidHui>(view(size))->health, 0x8041'0081U);
}

TEST_F(RawMessages, SatellitesInViewTellWhatIsKnownOfTheirOrbits) {
  run(0, 0);
  EXPECT_EQ(svsi_blocks().size(), kExamplePrns.size());
  EXPECT_EQ(svsi_blocks()[0].flags, 0x80);
  raw.begin(true, true);
  run(1, 1);
  EXPECT_EQ(svsi_blocks()[0].flags, 0x80) << "nothing was heard that could be remembered";
}

TEST_F(RawMessages, SatellitesInViewTellWhatIsRemembered) {
  raw.begin(true, true);
  run(1, 1);
  const auto block = svsi_blocks()[4];
  EXPECT_EQ(block.satellite, 32);
  EXPECT_EQ(block.flags, 0x71) << "index 1, healthy, ephemeris, almanac";
  EXPECT_EQ(block.azimuth_deg, 183);
  EXPECT_EQ(block.elevation_deg, 55);
  EXPECT_EQ(block.age, 0x43) << "31 s after toe; toa lies 2.2 h ahead";
}

TEST_F(RawMessages, OlderNamesOfTheAidingMessagesHaveTheSameContent) {
  run(0, 18);
  const auto old = answer({0x02, 0x31}, {1});
  EXPECT_EQ(old.id, (ubx::MessageId{0x02, 0x31}));
  const std::vector content(old.payload.begin(), old.payload.end());
  const auto now = answer(ubx::AidEph::kId, {1});
  EXPECT_EQ(std::vector(now.payload.begin(), now.payload.end()), content);
}

}  // namespace
}  // namespace rigwire::emulators

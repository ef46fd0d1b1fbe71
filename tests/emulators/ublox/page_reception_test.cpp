#include "emulators/ublox/page_reception.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "emulators/gps_broadcast.h"
#include "protocols/beidou/subframe.h"
#include "protocols/galileo/page.h"
#include "protocols/glonass/string.h"
#include "protocols/gps/cnav.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

constexpr std::int32_t kLeap = 18;

class PageReceptionTest : public ::testing::Test {
 protected:
  PageReceptionTest() {
    GpsEphemeris e;
    e.prn = 19;
    e.week = 2421;
    e.ephemeris_time_s = e.clock_time_s = 115'200.0;
    e.sqrt_semi_major_axis = std::ldexp(2'852'413'441.0, -19);
    e.issue_of_clock = 77;
    e.issue_of_ephemeris = 77;
    navigation_->galileo.push_back(e);
    e.issue_of_clock = e.issue_of_ephemeris = 1;
    navigation_->beidou.push_back(e);
    navigation_->glonass.push_back({.slot = 3, .time_of_day_s = 12 * 900, .day = 883});
    now_ = navigation_;
  }
  /// Both carriers of one satellite of each system, measured at each second; pages from there.
  void hear(int seconds, bool slipped_last = false) {
    for (int i = 0; i < seconds; ++i, ++second_) {
      GnssSample sample;
      sample.navigation = now_;
      for (const auto& [system, number] : {std::pair{GnssSystem::galileo, 19},
                                           {GnssSystem::beidou, 19},
                                           {GnssSystem::glonass, 3}}) {
        for (const bool second : {false, true}) {
          GnssMeasurement m;
          m.system = system;
          m.number = static_cast<std::uint8_t>(number);
          m.second = second;
          m.slipped = slipped_last && i + 1 == seconds;
          sample.measurements.push_back(m);
        }
      }
      reception_.update(sample, {2421, second_ * 1'000'000'000}, kLeap);
      pages_.insert(pages_.end(), reception_.pages().begin(), reception_.pages().end());
    }
  }
  [[nodiscard]] std::vector<ReceivedPage> of(GnssSystem system, bool second) const {
    std::vector<ReceivedPage> found;
    std::ranges::copy_if(pages_, std::back_inserter(found), [&](const ReceivedPage& page) {
      return page.system == system && page.second == second;
    });
    return found;
  }

  std::shared_ptr<GpsNavigation> navigation_ = std::make_shared<GpsNavigation>();
  std::shared_ptr<const GpsNavigation> now_;
  PageReception reception_;
  std::vector<ReceivedPage> pages_;
  std::int64_t second_ = 115'500;  ///< In the week: a full half minute of all systems is near.
};

TEST_F(PageReceptionTest, AMinuteBringsTheOrbitsOfAllSystemsOnBothCarriers) {
  hear(61);
  for (const bool second : {false, true}) {
    std::array<protocols::galileo::Word, 5> words{};
    for (const ReceivedPage& page : of(GnssSystem::galileo, second)) {
      EXPECT_EQ(page.count, 9);
      protocols::galileo::Page parts{};
      std::copy_n(page.words.begin(), parts.size(), parts.begin());
      const auto word = protocols::galileo::word_of(parts);
      ASSERT_TRUE(word.ok());
      const unsigned type = (*word)[0] >> 2U;
      if (type >= 1 && type <= 5) {
        words[type - 1] = *word;
      }
    }
    const auto galileo = protocols::galileo::decode_ephemeris(words);
    ASSERT_TRUE(galileo.ok());
    EXPECT_EQ(to_sample(*galileo), navigation_->galileo[0]);

    std::array<protocols::beidou::Subframe, 3> subframes{};
    for (const ReceivedPage& page : of(GnssSystem::beidou, second)) {
      EXPECT_EQ(page.count, 10);
      const unsigned id = page.words[0] >> 12U & 7U;
      ASSERT_TRUE(id >= 1 && id <= 3);
      // Those of the last whole frame.
      subframes[id - 1] = page.words;
      if (id == 3) {
        auto beidou = protocols::beidou::decode_ephemeris(subframes);
        ASSERT_TRUE(beidou.ok());
        GpsEphemeris decoded = to_sample(*beidou);
        decoded.prn = 19;
        EXPECT_EQ(decoded, navigation_->beidou[0]);
      }
    }
    EXPECT_NE(subframes[2][0], 0U);

    std::array<protocols::glonass::String, 4> strings{};
    for (const ReceivedPage& page : of(GnssSystem::glonass, second)) {
      EXPECT_EQ(page.count, 4);
      const unsigned number = page.words[0] >> 27U;
      ASSERT_TRUE(number >= 1 && number <= 5);
      if (number <= 4) {
        std::copy_n(page.words.begin(), 3, strings[number - 1].begin());
      }
    }
    const auto glonass = protocols::glonass::decode_ephemeris(strings);
    ASSERT_TRUE(glonass.ok());
    EXPECT_EQ(glonass->slot, 3);
    EXPECT_EQ(glonass->time_of_day_s, 12 * 900);
  }
}

TEST_F(PageReceptionTest, PagesBeginAndEndWhileTheSignalIsHeard) {
  hear(1);
  EXPECT_TRUE(pages_.empty());
  hear(2);  // 115'500 .. 115'502: a page of E5b; one of E1 lasts from 501 to 503
  EXPECT_EQ(of(GnssSystem::galileo, true).size(), 1U);
  EXPECT_TRUE(of(GnssSystem::galileo, false).empty());
  hear(1);
  EXPECT_EQ(of(GnssSystem::galileo, false).size(), 1U);
  const std::size_t before = pages_.size();
  hear(1, true);  // a slip at 504: what ends then was not heard whole
  hear(1);
  EXPECT_EQ(pages_.size(), before);
}

TEST_F(PageReceptionTest, WhatBeganBeforeAChangeIsOfTheOldOrbit) {
  hear(2);
  auto later = std::make_shared<GpsNavigation>(*navigation_);
  later->galileo[0].issue_of_clock = 78;
  now_ = later;
  hear(1);
  ASSERT_EQ(of(GnssSystem::galileo, true).size(), 1U);
  hear(30);
  const auto pages = of(GnssSystem::galileo, true);
  const auto issue_of = [](const ReceivedPage& page) { return page.words[0] >> 14U & 0x3FFU; };
  EXPECT_EQ(issue_of(pages.front()), 77U) << "word 1, begun before the change";
  EXPECT_EQ(issue_of(pages[1]), 78U);
}

// L2 CM of a satellite of GPS: a message begins every 12 s of the week, and only whole ones count.
TEST_F(PageReceptionTest, GpsOnL2BringsAMessageEveryTwelveSeconds) {
  GpsEphemeris e;
  e.prn = 5;
  e.week = 2421;
  e.ephemeris_time_s = e.clock_time_s = 115'200.0;
  e.sqrt_semi_major_axis = 5153.7;
  navigation_->ephemerides[4] = e;
  second_ = 115'205;
  for (int i = 0; i < 60; ++i, ++second_) {
    GnssSample sample;
    sample.navigation = now_;
    for (const bool second : {false, true}) {
      GnssMeasurement m;
      m.system = GnssSystem::gps;
      m.number = 5;
      m.second = second;
      sample.measurements.push_back(m);
    }
    reception_.update(sample, {2421, second_ * 1'000'000'000}, kLeap);
    for (const ReceivedPage& page : reception_.pages()) {
      // Begun at 115 212, 115 224, ... 115 248: 115 200 had begun before it was tracked.
      const auto index = static_cast<std::uint32_t>(pages_.size());
      EXPECT_EQ(second_, 115'224 + 12 * index);
      EXPECT_EQ(page.system, GnssSystem::gps);
      EXPECT_TRUE(page.second);
      ASSERT_EQ(page.count, 10);
      EXPECT_EQ(page.words[0] >> 24U, 0x8BU);
      EXPECT_EQ(page.words[0] >> 18U & 0x3FU, 5U);
      EXPECT_EQ(page.words[0] >> 12U & 0x3FU, protocols::gps::cnav_type_at(115'212U + 12U * index));
      pages_.push_back(page);
    }
  }
  EXPECT_EQ(pages_.size(), 4U);
}

}  // namespace
}  // namespace rigwire::emulators

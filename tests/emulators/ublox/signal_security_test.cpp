// False signals are seen when they take over and when they go, noise while it lasts; and what is no
// such thing is not taken for one.
#include "emulators/ublox/signal_security.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocols/ubx/blocks.h"
#include "protocols/ubx/key_values.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/signal_security.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using namespace protocols::ubx;
using Kind = UbloxSignalSecurity::EventKind;
using testing::ElementsAre;
using testing::Field;

/// Real strengths, from 30 dBHz upwards, of GPS and Galileo.
std::vector<SatelliteView> real_signals(std::size_t count) {
  std::vector<SatelliteView> all(count);
  for (std::size_t i = 0; i < count; ++i) {
    all[i] = {static_cast<std::uint8_t>(i + 1),    0.0,  0.5,
              31.0 + 2.0 * static_cast<double>(i), true, true};
    all[i].system = i % 2 == 0 ? GnssSystem::gps : GnssSystem::galileo;
  }
  return all;
}
std::vector<SatelliteView> false_signals(std::size_t count) {
  auto all = real_signals(count);
  for (std::size_t i = 0; i < count; ++i) {
    all[i].cn0_dbhz = 47.0 + (i % 2 == 0 ? 0.3 : -0.3);
  }
  return all;
}

class UbloxSignalSecurityTest : public testing::Test {
 protected:
  void look(const std::vector<SatelliteView>& satellites, double jamming = 0.0,
            bool sensitive = true) {
    security_.look(now_, satellites, {AntennaState::ok, jamming, 0.0}, true, sensitive);
    now_ += 1s;
  }

  UbloxSignalSecurity security_;
  SimTime now_ = kStart;
};

TEST_F(UbloxSignalSecurityTest, ATakeoverIsSeenInItsEpochAndIndicatedForTenSeconds) {
  look(real_signals(8));
  look(real_signals(8));
  EXPECT_EQ(security_.spoofing_now(), 1);
  EXPECT_EQ(security_.spoofing(), 1);
  look(false_signals(8));
  EXPECT_EQ(security_.spoofing_now(), 3) << "of two systems";
  for (int i = 0; i < 9; ++i) {
    look(false_signals(8));
    EXPECT_EQ(security_.spoofing_now(), 1) << "of this epoch alone";
    EXPECT_EQ(security_.spoofing(), 2);
  }
  look(false_signals(8));
  EXPECT_EQ(security_.spoofing(), 1);
  look(real_signals(8));
  EXPECT_EQ(security_.spoofing_now(), 3) << "the way back is as abrupt";
  EXPECT_THAT(security_.log(),
              ElementsAre(Field(&UbloxSignalSecurity::Event::kind, Kind::triggered),
                          Field(&UbloxSignalSecurity::Event::kind, Kind::timed_out),
                          Field(&UbloxSignalSecurity::Event::kind, Kind::triggered)));
}

TEST_F(UbloxSignalSecurityTest, WhoeverStartsUnderFalseSignalsSeesNone) {
  for (int i = 0; i < 20; ++i) {
    look(false_signals(8));
    EXPECT_LE(security_.spoofing(), 1);
  }
  EXPECT_TRUE(security_.log().empty());
}

// Strengths of a drive: 4 dB from one second to the next, each by itself, and whole outages.
TEST_F(UbloxSignalSecurityTest, FadingAndTunnelsAreNoTakeover) {
  std::mt19937 random(5);
  std::normal_distribution<double> fading(0.0, 4.0);
  for (int i = 0; i < 100'000; ++i) {
    auto satellites = real_signals(7);
    for (SatelliteView& view : satellites) {
      view.cn0_dbhz += fading(random);
    }
    if (i % 100 < 5) {
      satellites.clear();
    }
    look(satellites);
  }
  EXPECT_TRUE(security_.log().empty());
}

TEST_F(UbloxSignalSecurityTest, JammingStartsAndStopsByTheSensitivity) {
  look(real_signals(8));
  EXPECT_EQ(security_.jamming(), 1);
  look(real_signals(8), 0.3, false);
  EXPECT_EQ(security_.jamming(), 1);
  look(real_signals(8), 0.3);
  EXPECT_EQ(security_.jamming(), 2);
  look(real_signals(8), 0.3);
  look(real_signals(8));
  EXPECT_THAT(security_.log(),
              ElementsAre(Field(&UbloxSignalSecurity::Event::kind, Kind::started),
                          Field(&UbloxSignalSecurity::Event::kind, Kind::stopped)));
  for (int i = 0; i < 40; ++i) {
    look(real_signals(8), i % 2 == 0 ? 0.9 : 0.0);
  }
  EXPECT_EQ(security_.log().size(), UbloxSignalSecurity::kMostEvents) << "the newest sixteen";
  security_.restart();
  EXPECT_TRUE(security_.log().empty());
}

class UbloxSignalSecurityMessages : public UbloxReceiverTest {};

TEST_F(UbloxSignalSecurityMessages, StatusSignalsAndLogTellOfATakeoverUnderNoise) {
  UbloxSettings settings = quiet();
  settings.profile = &ublox_zed_f9p();
  settings.baud = 460'800;
  settings.ubx_messages = {"NAV-STATUS", "SEC-SIG", "SEC-SIGLOG"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 6900ms, [](GnssSample& s) {
    s.satellites = s.time < kStart + 4s ? real_signals(8) : false_signals(8);
    s.radio.jamming = s.radio.second_jamming = s.time < kStart + 6s ? 0.0 : 0.6;
  });
  std::vector<unsigned> states;
  for (const NavStatus& status : decoded<NavStatus>()) {
    states.push_back(status.flags2 >> 3U & 3U);
  }
  EXPECT_THAT(states, ElementsAre(1, 1, 1, 3, 1, 1));
  std::vector<unsigned> signals;
  std::vector<std::size_t> events;
  for (const auto& [id, payload] : line_.frames()) {
    const FrameView frame{id, payload};
    if (const auto m = decode_blocks<SecSigHead, SecSigBlock>(frame); m.ok()) {
      signals.push_back(m->head().flags);
      // L1 with E1, L2, E5b: each frequency once.
      ASSERT_EQ(m->size(), 3U);
      const std::uint32_t jammed = signals.size() < 6 ? 0U : 1U << 24U;
      EXPECT_EQ((*m)[0].state, 1'575'420U | jammed);
      EXPECT_EQ((*m)[1].state, 1'227'600U | jammed);
      EXPECT_EQ((*m)[2].state, 1'207'140U | jammed);
    }
    if (const auto m = decode_blocks<SecSiglogHead, SecSiglogEvent>(frame); m.ok()) {
      events.push_back(m->size());
      if (m->size() == 2) {
        EXPECT_EQ((*m)[0].elapsed_s, 2U);
        EXPECT_EQ((*m)[0].detection, 3);
        EXPECT_EQ((*m)[0].event, 2);
        EXPECT_EQ((*m)[1].detection, 4);
        EXPECT_EQ((*m)[1].event, 0);
      }
    }
  }
  // Both looked for; none, spoofing indicated, both indicated.
  EXPECT_THAT(signals, ElementsAre(0x1B, 0x1B, 0x1B, 0x2B, 0x2B, 0x2D));
  EXPECT_THAT(events, ElementsAre(0U, 0U, 0U, 1U, 1U, 2U));
}

// A jammer of L2 alone: its block of MON-RF and its frequencies of SEC-SIG.
TEST_F(UbloxSignalSecurityMessages, AJammedBandIsToldApartFromTheOther) {
  UbloxSettings settings = quiet();
  settings.profile = &ublox_zed_f9p();
  settings.baud = 460'800;
  settings.ubx_messages = {"MON-RF", "SEC-SIG"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 2900ms, [](GnssSample& s) {
    s.satellites = real_signals(8);
    s.radio.second_jamming = 0.9;
    s.radio.second_noise_db = 20.0;
  });
  bool bands = false;
  bool signals = false;
  for (const auto& [id, payload] : line_.frames()) {
    const FrameView frame{id, payload};
    if (const auto m = decode_blocks<MonRfHead, MonRfBlock>(frame); m.ok()) {
      bands = true;
      ASSERT_EQ(m->size(), 2U);
      EXPECT_EQ((*m)[0].noise_per_ms, 74);
      EXPECT_EQ((*m)[0].gain_control, 5616);
      EXPECT_LE((*m)[0].jamming_indicator, 9);
      EXPECT_EQ((*m)[1].noise_per_ms, 740);
      EXPECT_NEAR((*m)[1].gain_control, 5616 * 0.19 / std::sqrt(10.0), 1.0);
      EXPECT_GT((*m)[1].jamming_indicator, 220);
    } else if (const auto s = decode_blocks<SecSigHead, SecSigBlock>(frame); s.ok()) {
      signals = true;
      EXPECT_EQ(s->head().flags >> 1U & 3U, 2U) << "jamming is indicated";
      ASSERT_EQ(s->size(), 3U);
      EXPECT_EQ((*s)[0].state, 1'575'420U);
      EXPECT_EQ((*s)[1].state, 1'227'600U | 1U << 24U);
      EXPECT_EQ((*s)[2].state, 1'207'140U | 1U << 24U);
    }
  }
  EXPECT_TRUE(bands && signals);
}

}  // namespace
}  // namespace rigwire::emulators

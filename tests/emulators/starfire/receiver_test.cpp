#include "emulators/starfire/receiver.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "protocols/nmea/sentence.h"
#include "recorder.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> sentences(const std::string& text) {
  std::vector<std::string> found;
  const std::vector<std::uint8_t> all(text.begin(), text.end());
  for (std::size_t at = 0; at < all.size();) {
    const auto s = protocols::nmea::decode_sentence(std::span(all).subspan(at));
    if (!s.ok()) {
      ADD_FAILURE() << "garbage at " << at;
      break;
    }
    found.emplace_back(text.substr(at, s.consumed() - 2));
    at += s.consumed();
  }
  return found;
}

class StarFireReceiverTest : public testing::Test {
 protected:
  static StarFireSettings settings() {
    StarFireSettings s;
    s.start_up = 0s;
    return s;
  }
  static GnssSample sample(SimTime time) {
    GnssSample s;
    s.time = time;
    s.fix = GnssFix::three_d;
    s.latitude_deg = 49.4240123;
    s.longitude_deg = -7.7510456;
    s.ellipsoid_height_m = 328.25;
    s.geoid_separation_m = 48.0;
    s.velocity_ned_mps = {1.0, 1.0, 0.0};
    s.horizontal_dilution = 0.83;
    s.vertical_dilution = 1.24;
    s.position_dilution = 1.49;
    for (std::uint8_t prn = 1; prn <= 8; ++prn) {
      s.satellites.push_back({prn, 0.5 * prn, 0.1 * prn, 40.0, true, true});
    }
    return s;
  }
  /// Sentences of one epoch.
  std::vector<std::string> epoch(const StarFireSettings& of, const GnssSample& s) {
    test::ByteRecorder line;
    StarFireReceiver receiver(of, calendar_, line);
    receiver.update(s);
    receiver.advance(s.time + 900ms);
    return sentences(line.text());
  }
  static std::string field(const std::string& sentence, int index) {
    std::size_t at = 0;
    for (int i = 0; i < index; ++i) {
      at = sentence.find(',', at) + 1;
    }
    return sentence.substr(at, sentence.find_first_of(",*", at) - at);
  }

  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
};

TEST_F(StarFireReceiverTest, WithoutSupplyItIsSilentAndAfterItTakesItsTimeToStart) {
  StarFireSettings s = settings();
  s.start_up = 2s;
  s.supply.faults = {{{5s, 3s}, NoSupplyFault{}}};
  test::ByteRecorder line;
  StarFireReceiver receiver(s, calendar_, line);
  for (SimTime time = kStart; time <= kStart + 12s; time += 1s) {
    receiver.update(sample(time));
  }
  std::vector<std::int64_t> seconds;
  for (const auto& sent : line.sent) {
    const std::int64_t second = (sent.due - kStart) / 1s;
    if (seconds.empty() || seconds.back() != second) {
      seconds.push_back(second);
    }
  }
  EXPECT_EQ(seconds, (std::vector<std::int64_t>{2, 3, 4, 10, 11}));
}

TEST_F(StarFireReceiverTest, SendsItsFiveSentencesInOrder) {
  const auto found = epoch(settings(), sample(kStart));
  ASSERT_EQ(found.size(), 5U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].substr(0, 6), "$GP" + settings().sentences[i]);
  }
  EXPECT_EQ(field(found[0], 1), "080000.00");
  EXPECT_EQ(field(found[0], 2), "4925.4407380");
  EXPECT_EQ(field(found[0], 3), "N");
  EXPECT_EQ(field(found[0], 5), "W");
}

TEST_F(StarFireReceiverTest, QualityFollowsTheCorrections) {
  struct Case {
    CarrierSolution carrier;
    bool differential;
    const char* quality;
  };
  for (const Case& c :
       {Case{CarrierSolution::none, false, "1"}, Case{CarrierSolution::none, true, "2"},
        Case{CarrierSolution::floating, true, "5"}, Case{CarrierSolution::fixed, true, "4"}}) {
    GnssSample s = sample(kStart);
    s.carrier = c.carrier;
    s.differential = c.differential;
    EXPECT_EQ(field(epoch(settings(), s)[0], 6), c.quality);
  }
  GnssSample none = sample(kStart);
  none.fix = GnssFix::none;
  EXPECT_EQ(field(epoch(settings(), none)[0], 6), "0");
  EXPECT_EQ(field(epoch(settings(), none)[0], 2), "");
}

TEST_F(StarFireReceiverTest, TalkerIsTheOneThatIsSet) {
  StarFireSettings s = settings();
  s.talker = "GN";
  s.sentences = {"RMC", "GGA"};
  const auto found = epoch(s, sample(kStart));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].substr(0, 6), "$GNRMC");
}

TEST_F(StarFireReceiverTest, NoByteFromAClientChangesAnything) {
  const auto talk = [&](bool noise) {
    test::ByteRecorder line;
    StarFireReceiver receiver(settings(), calendar_, line);
    std::mt19937 random(7);
    for (int i = 0; i < 20; ++i) {
      const SimTime now = kStart + i * 1s;
      receiver.update(sample(now));
      if (noise) {
        std::vector<std::uint8_t> bytes(5000);
        for (auto& byte : bytes) {
          byte = static_cast<std::uint8_t>(random());
        }
        receiver.receive(now + 500ms, bytes);
      }
    }
    receiver.advance(kStart + 20s);
    return line.text();
  };
  EXPECT_EQ(talk(true), talk(false));
}

TEST_F(StarFireReceiverTest, BytesTakeTheirTimeOnTheLine) {
  test::ByteRecorder line;
  StarFireSettings s = settings();
  s.baud = 4800;
  StarFireReceiver receiver(s, calendar_, line);
  receiver.update(sample(kStart));
  receiver.advance(kStart + 900ms);
  const double seconds = to_seconds(line.sent.back().due - kStart - s.latency);
  EXPECT_NEAR(seconds, static_cast<double>(line.text().size()) * 10.0 / 4800.0, 0.02);
}

}  // namespace
}  // namespace rigwire::emulators

#include "emulators/ntrip/caster.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "protocols/rtcm3/message.h"

namespace rigwire::emulators {
namespace {

namespace rtcm3 = protocols::rtcm3;
using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

struct Output final : StreamOutput {
  void send(ConnectionId connection, SimTime due, std::span<const std::uint8_t> bytes) override {
    last = due;
    text[connection].append(bytes.begin(), bytes.end());
  }
  void close(ConnectionId connection, SimTime /*due*/) override { closed[connection] = true; }
  std::map<ConnectionId, std::string> text;
  std::map<ConnectionId, bool> closed;
  SimTime last{};
};

Bytes framed(const rtcm3::Message& message) {
  Bytes frame(rtcm3::kGreatestFrame);
  frame.resize(rtcm3::encode(message, frame));
  return frame;
}

class NtripCasterTest : public ::testing::Test {
 protected:
  void make(std::vector<CasterFault> faults = {}) {
    settings_.faults = std::move(faults);
    caster_.emplace(settings_, calendar_, output_);
    caster_->add({});
  }
  void ask(ConnectionId connection, const std::string& text, SimTime now = kStart + 1s) {
    caster_->connected(now, connection);
    more(connection, text, now);
  }
  void more(ConnectionId connection, const std::string& text, SimTime now = kStart + 1s) {
    caster_->receive(now, connection,
                     {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  std::string after_head(ConnectionId connection) {
    return output_.text[connection].substr(std::string("ICY 200 OK\r\n").size());
  }
  static std::string text_of(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

  const std::string first_ = "GET /BASE HTTP/1.0\r\nUser-Agent: NTRIP x\r\n\r\n";
  const std::string second_ = "GET /BASE HTTP/1.1\r\nNtrip-Version: Ntrip/2.0\r\n\r\n";
  const Bytes place_ = framed(rtcm3::AntennaPosition{.station = 7});
  const Bytes biases_ = framed(rtcm3::GlonassBiases{.station = 7});
  NtripCasterSettings settings_;
  Calendar calendar_{parse_utc("2026-06-01T08:00:00Z")};
  Output output_;
  std::optional<NtripCaster> caster_;
};

TEST_F(NtripCasterTest, VersionIsTheClients) {
  make();
  ask(1, first_);
  ask(2, second_);
  EXPECT_EQ(output_.text[1], "ICY 200 OK\r\n");
  EXPECT_TRUE(output_.text[2].starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_NE(output_.text[2].find("Date: Mon, 01 Jun 2026 08:00:01 GMT\r\n"), std::string::npos);
  const std::size_t head = output_.text[2].size();
  caster_->hear(kStart + 2s, 0, place_);
  EXPECT_EQ(after_head(1), text_of(place_));
  EXPECT_EQ(output_.text[2].substr(head), "19\r\n" + text_of(place_) + "\r\n") << "0x19 bytes";
  EXPECT_EQ(caster_->streaming(), 2U);
}

TEST_F(NtripCasterTest, FixedVersionHoldsForEverybody) {
  settings_.version = NtripCasterSettings::Version::first;
  make();
  ask(1, second_);
  EXPECT_EQ(output_.text[1], "ICY 200 OK\r\n");
}

TEST_F(NtripCasterTest, UnknownMountGetsTheTableOr404) {
  make();
  ask(1, "GET /NONE HTTP/1.0\r\n\r\n");
  ask(2, "GET /NONE HTTP/1.1\r\nNtrip-Version: Ntrip/2.0\r\n\r\n");
  ask(3, "GET / HTTP/1.1\r\nNtrip-Version: Ntrip/2.0\r\n\r\n");
  EXPECT_TRUE(output_.text[1].starts_with("SOURCETABLE 200 OK\r\n"));
  EXPECT_TRUE(output_.text[1].ends_with("\r\nENDSOURCETABLE\r\n"));
  EXPECT_NE(output_.text[1].find("\r\nSTR;BASE;"), std::string::npos);
  EXPECT_TRUE(output_.text[2].starts_with("HTTP/1.1 404"));
  EXPECT_NE(output_.text[3].find("Content-Type: gnss/sourcetable\r\n"), std::string::npos);
  EXPECT_TRUE(output_.closed[1] && output_.closed[2] && output_.closed[3]);
}

TEST_F(NtripCasterTest, PasswordIsAskedFor) {
  settings_.user = "u";
  settings_.password = "p";
  make();
  ask(1, first_);
  ask(2, "GET /BASE HTTP/1.0\r\nAuthorization: Basic dTpw\r\n\r\n");
  ask(3, "GET /BASE HTTP/1.0\r\nAuthorization: Basic dTp4\r\n\r\n");
  EXPECT_TRUE(output_.text[1].starts_with("HTTP/1.0 401 Unauthorized\r\n"));
  EXPECT_EQ(output_.text[2], "ICY 200 OK\r\n");
  EXPECT_TRUE(output_.text[3].starts_with("HTTP/1.0 401"));
  EXPECT_EQ(caster_->counters().refused, 2U);
}

TEST_F(NtripCasterTest, FramesGoOutWholeAndGarbageDoesNot) {
  make();
  ask(1, first_);
  const Bytes garbage{0x00, 0xD3, 0xFF, 0x12};
  caster_->hear(kStart + 2s, 0, garbage);
  for (const std::uint8_t byte : place_) {
    EXPECT_EQ(after_head(1), "");
    caster_->hear(kStart + 2s, 0, {&byte, 1});
  }
  EXPECT_EQ(after_head(1), text_of(place_));
  more(1, "$GNGGA,0*00\r\n" + std::string(100'000, 'x'));
  EXPECT_FALSE(output_.closed[1]) << "what clients say is read over";
}

TEST_F(NtripCasterTest, RequestsThatNeverEndAreClosed) {
  make();
  ask(1, "GET /BA");
  EXPECT_EQ(caster_->next_event(), kStart + 11s);
  more(1, "S", kStart + 10s);
  caster_->advance(kStart + 11s);
  EXPECT_TRUE(output_.closed[1]);
  EXPECT_EQ(caster_->counters().timed_out, 1U);
  ask(2, std::string(100'000, 'x'), kStart + 12s);
  EXPECT_TRUE(output_.closed[2]) << "no more than 4 kB of a head";
  ask(3, "SOURCE pw /BASE\r\n\r\n", kStart + 12s);
  EXPECT_TRUE(output_.text[3].starts_with("ERROR"));
}

TEST_F(NtripCasterTest, LateFramesKeepTheirOrder) {
  make({{{1s, 2s}, LateCorrectionsFault{5s}}});
  ask(1, first_);
  caster_->hear(kStart + 2s, 0, place_);
  caster_->hear(kStart + 4s, 0, biases_);
  EXPECT_EQ(after_head(1), "");
  EXPECT_EQ(caster_->next_event(), kStart + 7s);
  caster_->advance(kStart + 7s);
  EXPECT_EQ(after_head(1), text_of(place_) + text_of(biases_));
}

TEST_F(NtripCasterTest, StalledStreamSaysNothingAndStays) {
  make({{{1s, 2s}, StalledCorrectionsFault{}}});
  ask(1, first_);
  caster_->hear(kStart + 2s, 0, place_);
  caster_->hear(kStart + 4s, 0, biases_);
  EXPECT_EQ(after_head(1), text_of(biases_));
  EXPECT_FALSE(output_.closed[1]);
}

TEST_F(NtripCasterTest, WrongStationIsThatOfObservationsAlone) {
  make({{{1s, std::nullopt}, WrongStationFault{99}}});
  ask(1, first_);
  caster_->hear(kStart + 2s, 0, place_);
  caster_->hear(kStart + 2s, 0, biases_);
  const std::string sent = after_head(1);
  const Bytes all(sent.begin(), sent.end());
  const auto place = rtcm3::decode_frame(all);
  ASSERT_TRUE(place.ok());
  EXPECT_EQ(place->second_field(), 7);
  const auto biases = rtcm3::decode_frame(std::span(all).subspan(place.consumed()));
  ASSERT_TRUE(biases.ok()) << "the checksum is that of what is said";
  EXPECT_EQ(biases->second_field(), 99);
}

TEST_F(NtripCasterTest, CorruptFramesHaveOneBitTurned) {
  make({{{1s, std::nullopt}, CorruptCorrectionsFault{1.0}}});
  ask(1, first_);
  caster_->hear(kStart + 2s, 0, place_);
  const std::string sent = after_head(1);
  ASSERT_EQ(sent.size(), place_.size());
  int turned = 0;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    turned += std::popcount(static_cast<unsigned>(place_[i] ^ static_cast<std::uint8_t>(sent[i])));
  }
  EXPECT_EQ(turned, 1);
}

}  // namespace
}  // namespace rigwire::emulators

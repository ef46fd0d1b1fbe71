// A camera as field programs open it: every picture arrives as it was exposed or not at all,
// whatever network, camera and other applications do.
#include "field/gige_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "camera_link.h"
#include "emulators/gige_camera/camera_features.h"
#include "protocols/gige_vision/bootstrap.h"

namespace rigwire::field {
namespace {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

emulators::GigeCameraSettings stereo() {
  emulators::GigeCameraSettings settings;
  settings.kind = emulators::GigeCameraKind::stereo;
  settings.model = "StereoHead";
  settings.width = 64;
  settings.height = 48;
  settings.geometry = {420.5, 0.24, 31.5, 23.25, {0.0625, -2.0, 0xFFFF}};
  return settings;
}

GigeSetting component(const std::string& name, bool on) {
  return {"ComponentEnable", on ? "1" : "0", "ComponentSelector", name, false};
}

GigeClientSettings disparity_alone() {
  GigeClientSettings settings;
  settings.settings = {component("Intensity", false), component("Disparity", true),
                       component("Confidence", false)};
  settings.readings = {{"Scan3dFocalLength"}, {"Scan3dBaseline"}, {"BinningHorizontal"}};
  return settings;
}

GigeClientSettings everything() {
  GigeClientSettings settings = disparity_alone();
  settings.settings = {component("Intensity", true),
                       component("IntensityRight", true),
                       component("Disparity", true),
                       component("Confidence", true),
                       {"ChunkModeActive", "1"}};
  return settings;
}

/// Every picture that came is one that was exposed, byte by byte.
void expect_as_exposed(const CameraLink& link) {
  for (const CameraLink::Taken& block : link.taken()) {
    const auto picture = link.exposed(block.timestamp);
    ASSERT_TRUE(picture) << "block " << block.number;
    ASSERT_LE(block.pictures.size(), picture->parts.size());
    for (std::size_t i = 0; i < block.pictures.size(); ++i) {
      EXPECT_EQ(block.pictures[i].second, picture->parts[i].bytes) << "block " << block.number;
    }
  }
}

TEST(FieldGigeClient, DisparityArrivesWithTheGeometryThatItIsReadBy) {
  CameraLink link(stereo(), disparity_alone());
  link.start();
  link.run(seconds{1});
  ASSERT_EQ(link.client().state(), GigeClient::State::streaming);
  EXPECT_EQ(link.client().identity().model, "StereoHead");
  EXPECT_EQ(link.client().reading("Scan3dFocalLength"), 420.5);
  EXPECT_EQ(link.client().reading("Scan3dBaseline"), 0.24);
  EXPECT_EQ(link.client().reading("BinningHorizontal"), 1.0);
  EXPECT_FALSE(link.client().reading("Scan3dPrincipalPointU"));
  ASSERT_GE(link.taken().size(), 5U);
  ASSERT_EQ(link.taken()[0].pictures.size(), 1U);
  EXPECT_EQ(link.taken()[0].pictures[0].first.format, gev::PixelFormatCode::coord3d_c16);
  EXPECT_EQ(link.taken()[0].pictures[0].first.width, 64U);
  EXPECT_EQ(link.taken()[0].pictures[0].first.height, 48U);
  expect_as_exposed(link);
}

TEST(FieldGigeClient, SeveralPartsAndChunksAreTakenApart) {
  CameraLink link(stereo(), everything());
  link.start();
  link.run(seconds{1});
  ASSERT_FALSE(link.taken().empty());
  for (const CameraLink::Taken& block : link.taken()) {
    ASSERT_EQ(block.pictures.size(), 4U);
    EXPECT_EQ(block.pictures[2].first.purpose, 8U);  // ComponentIDValue of Disparity
    EXPECT_EQ(block.chunks, 4U);
    EXPECT_EQ(block.exposure_us, 5000.0);
  }
  expect_as_exposed(link);
}

TEST(FieldGigeClient, WithoutPartsComponentsComeOneAfterTheOther) {
  GigeClientSettings settings = everything();
  settings.multipart = false;
  CameraLink link(stereo(), settings);
  link.start();
  link.run(seconds{1});
  ASSERT_GE(link.taken().size(), 8U);
  for (std::size_t i = 0; i + 3 < link.taken().size(); i += 4) {
    const auto picture = link.exposed(link.taken()[i].timestamp);
    for (std::size_t part = 0; part < 4; ++part) {
      const CameraLink::Taken& block = link.taken()[i + part];
      EXPECT_EQ(block.timestamp, link.taken()[i].timestamp);
      ASSERT_EQ(block.pictures.size(), 1U);
      EXPECT_EQ(block.pictures[0].second, picture->parts[part].bytes);
      EXPECT_EQ(block.chunks, 4U);
    }
  }
}

TEST(FieldGigeClient, LostPacketsAreAskedForAgain) {
  emulators::GigeCameraSettings camera = stereo();
  camera.width = 320;
  camera.height = 240;
  GigeClientSettings settings = everything();
  settings.packet_size = 1500;
  CameraLink link(camera, settings);
  std::mt19937 random(7);
  link.network = [&random](const CameraLink::Bytes& bytes) {
    return random() % 100 < 5 ? CameraLink::Arrivals{} : CameraLink::Arrivals{bytes};
  };
  link.start();
  link.run(seconds{4});
  EXPECT_GE(link.taken().size(), 60U);
  EXPECT_GT(link.client().stream_counters().asked, 100U);
  EXPECT_LE(link.client().stream_counters().dropped, 2U);
  expect_as_exposed(link);
}

TEST(FieldGigeClient, ABlockWhoseLeaderAndTrailerAreLostIsStillWhole) {
  CameraLink link(stereo(), disparity_alone());
  std::map<std::pair<std::uint64_t, int>, int> seen;
  link.network = [&seen](const CameraLink::Bytes& bytes) -> CameraLink::Arrivals {
    const auto packet = gev::decode_stream_packet(bytes);
    const bool end = packet.ok() && (packet->header.format == gev::PacketFormat::leader ||
                                     packet->header.format == gev::PacketFormat::trailer);
    // The first of each is lost, what is sent again arrives.
    const bool lost =
        end && seen[{packet->header.block, static_cast<int>(packet->header.format)}]++ == 0;
    return lost ? CameraLink::Arrivals{} : CameraLink::Arrivals{bytes};
  };
  link.start();
  link.run(seconds{1});
  EXPECT_GE(link.taken().size(), 15U);
  expect_as_exposed(link);
}

TEST(FieldGigeClient, PacketsThatOvertakeOrComeTwiceChangeNothing) {
  CameraLink link(stereo(), everything());
  std::vector<CameraLink::Bytes> held;
  std::mt19937 random(3);
  link.network = [&](const CameraLink::Bytes& bytes) {
    held.push_back(bytes);
    if (random() % 4 == 0) {
      held.push_back(bytes);
    }
    if (held.size() < 5) {
      return CameraLink::Arrivals{};
    }
    std::ranges::shuffle(held, random);
    return std::exchange(held, {});
  };
  link.start();
  link.run(seconds{2});
  EXPECT_GE(link.taken().size(), 30U);
  EXPECT_GT(link.client().stream_counters().duplicates, 0U);
  expect_as_exposed(link);
}

TEST(FieldGigeClient, TruncatedPacketsAndNoiseAreCountedAndChangeNothing) {
  CameraLink link(stereo(), everything());
  std::mt19937 random(11);
  link.network = [&random](const CameraLink::Bytes& bytes) {
    CameraLink::Arrivals arrived;
    arrived.emplace_back(bytes.begin(), bytes.begin() + random() % 20);
    CameraLink::Bytes noise(random() % 60);
    std::ranges::generate(noise, [&] { return static_cast<std::uint8_t>(random()); });
    if (noise.size() > 4) {
      noise[4] &= 0x7F;  // short identifiers: no block of ours
    }
    arrived.push_back(noise);
    arrived.push_back(bytes);
    return arrived;
  };
  link.start();
  link.run(seconds{1});
  EXPECT_GE(link.taken().size(), 15U);
  EXPECT_GT(link.client().stream_counters().refused, 50U);
  expect_as_exposed(link);
}

TEST(FieldGigeClient, AnswersThatAreNoneAreCountedAndChangeNothing) {
  CameraLink link(stereo(), disparity_alone());
  link.start();
  const std::vector<std::uint8_t> garbage{0x42, 0x01, 0xFF};
  const gev::GvcpPacket foreign = gev::encode_acknowledge(gev::Status::success, 0x0083, 0x7777);
  for (int i = 0; i < 100; ++i) {
    link.client().receive_control(link.now().time_since_epoch(), garbage);
    link.client().receive_control(link.now().time_since_epoch(), foreign.view());
    link.run(milliseconds{10});
  }
  EXPECT_EQ(link.client().state(), GigeClient::State::streaming);
  EXPECT_EQ(link.client().counters().refused, 200U);
  EXPECT_TRUE(link.troubles().empty());
}

TEST(FieldGigeClient, ACameraThatIsSwitchedOffAndOnStreamsAgain) {
  CameraLink link(stereo(), disparity_alone());
  link.start();
  link.run(seconds{1});
  const std::size_t before = link.taken().size();
  link.switch_off();
  link.run(seconds{5});
  EXPECT_EQ(link.taken().size(), before);
  EXPECT_NE(link.client().state(), GigeClient::State::streaming);
  EXPECT_THAT(link.client().trouble(), HasSubstr("does not answer"));
  link.switch_on();
  link.run(seconds{4});
  EXPECT_GT(link.taken().size(), before);
  EXPECT_EQ(link.client().counters().sessions, 2U);
  EXPECT_EQ(link.client().counters().losses, 1U);
  EXPECT_TRUE(link.client().trouble().empty());
  expect_as_exposed(link);
}

TEST(FieldGigeClient, ARestartBetweenTwoBeatsIsNoticed) {
  CameraLink link(stereo(), disparity_alone());
  link.start();
  link.run(seconds{1});
  link.switch_on();  // in no time: nobody has control of it now
  link.run(seconds{4});
  EXPECT_EQ(link.client().counters().sessions, 2U);
  EXPECT_EQ(link.client().state(), GigeClient::State::streaming);
  ASSERT_EQ(link.troubles().size(), 1U);
  EXPECT_THAT(link.troubles()[0], HasSubstr("control was lost"));
}

TEST(FieldGigeClient, ACableThatIsOutForAWhileEndsTheSessionAndAnotherBegins) {
  CameraLink link(stereo(), disparity_alone());
  const SimTime out = link.now() + seconds{1};
  link.cable = [out](SimTime now) { return now < out || now > out + seconds{6}; };
  link.start();
  link.run(seconds{12});
  EXPECT_EQ(link.client().counters().sessions, 2U);
  EXPECT_EQ(link.client().state(), GigeClient::State::streaming);
  expect_as_exposed(link);
}

TEST(FieldGigeClient, AnotherApplicationKeepsTheCameraUntilItLetsGo) {
  CameraLink link(stereo(), disparity_alone());
  const auto others_control = [&link](std::uint16_t request, std::uint32_t value) {
    const gev::RegisterValue pairs[]{{boot::kControlPrivilege, value}};
    link.other_sends(gev::encode_write_registers(request, pairs));
  };
  others_control(1, gev::Privilege::kControl);
  link.start();
  link.run(seconds{1});
  EXPECT_THAT(link.client().trouble(), HasSubstr("another application has control (127.0.0.9)"));
  EXPECT_TRUE(link.taken().empty());
  others_control(2, 0);
  link.run(seconds{3});
  EXPECT_EQ(link.client().state(), GigeClient::State::streaming);
  EXPECT_FALSE(link.taken().empty());
}

TEST(FieldGigeClient, ControlIsKeptWhileNothingElseIsSaid) {
  CameraLink link(stereo(), disparity_alone());
  link.start();
  link.run(seconds{20});
  EXPECT_EQ(link.client().counters().sessions, 1U);
  EXPECT_EQ(link.client().counters().losses, 0U);
  EXPECT_TRUE(link.camera().controlled());
}

TEST(FieldGigeClient, ReleasedCameraIsFreeAtOnce) {
  CameraLink link(stereo(), disparity_alone());
  link.start();
  link.run(seconds{1});
  link.client().stop();
  EXPECT_FALSE(link.camera().controlled());
  EXPECT_FALSE(link.camera().acquiring());
}

TEST(FieldGigeClient, PacketsAreNoLargerThanTheNetworkCarries) {
  CameraLink link(stereo(), everything());
  link.network = [](const CameraLink::Bytes& bytes) {
    return bytes.size() + gev::kIpUdpHeaders > 1500 ? CameraLink::Arrivals{}
                                                    : CameraLink::Arrivals{bytes};
  };
  link.start();
  link.run(seconds{2});
  EXPECT_EQ(link.client().packet_size(), 1500U);
  EXPECT_FALSE(link.taken().empty());
  expect_as_exposed(link);
}

TEST(FieldGigeClient, ACameraThatLacksWhatIsNeededIsNamedAndLetGo) {
  emulators::GigeCameraSettings plain = stereo();
  plain.kind = emulators::GigeCameraKind::camera;
  GigeClientSettings settings;
  settings.readings = {{"Scan3dBaseline"}};
  CameraLink link(plain, settings);
  link.start();
  link.run(milliseconds{800});
  EXPECT_THAT(link.client().trouble(), HasSubstr("no feature Scan3dBaseline"));
  EXPECT_FALSE(link.camera().controlled());
}

TEST(FieldGigeClient, AValueThatTheCameraRefusesIsNamed) {
  GigeClientSettings settings = disparity_alone();
  settings.settings.push_back({"Width", "1000000"});
  CameraLink link(stereo(), settings);
  link.start();
  link.run(milliseconds{500});
  EXPECT_THAT(link.client().trouble(), HasSubstr("Width is refused: "));
  settings.settings.back() = {"PixelFormat", "Mono7"};
  CameraLink second(stereo(), settings);
  second.start();
  second.run(milliseconds{500});
  EXPECT_THAT(second.client().trouble(), HasSubstr("found 'Mono7', allowed "));
}

TEST(FieldGigeClient, CommandsThatAreLostAreSaidAgain) {
  CameraLink link(stereo(), disparity_alone());
  std::mt19937 random(5);
  link.cable = [&random](SimTime) { return random() % 100 >= 10; };
  link.start();
  link.run(seconds{60});
  EXPECT_GT(link.client().counters().repeated, 0U);
  EXPECT_GE(link.client().counters().sessions, 1U);
  EXPECT_FALSE(link.taken().empty());
  expect_as_exposed(link);
}

// --- The stream alone. -----------------------------------------------------------------------

std::vector<std::uint8_t> packet_of(const gev::PacketHeader& header,
                                    std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> bytes(2000);
  const std::size_t size = gev::write_header(bytes, header);
  std::ranges::copy(payload, bytes.begin() + static_cast<std::ptrdiff_t>(size));
  bytes.resize(size + payload.size());
  return bytes;
}

std::vector<std::uint8_t> leader_of(std::uint64_t block, std::uint32_t width,
                                    std::uint32_t height) {
  std::array<std::uint8_t, gev::kImageLeaderSize> leader{};
  gev::write_image_leader(leader, {.timestamp = block, .width = width, .height = height});
  return packet_of({.format = gev::PacketFormat::leader, .block = block}, leader);
}

class FieldGigeStream : public testing::Test {
 protected:
  void receive(const std::vector<std::uint8_t>& bytes) { stream.receive(now, bytes); }
  void block(std::uint64_t number) {
    receive(leader_of(number, 4, 2));
    const std::array<std::uint8_t, 8> pixels{1, 2, 3, 4, 5, 6, 7, 8};
    receive(packet_of({.block = number, .packet = 1}, pixels));
    std::array<std::uint8_t, 16> trailer{};
    const std::size_t size = gev::write_trailer(trailer, {false, 2, {}});
    receive(packet_of({.format = gev::PacketFormat::trailer, .block = number, .packet = 2},
                      std::span(trailer).first(size)));
  }

  GigeStream::Instant now{0};
  std::vector<gev::PacketResend> asked;
  std::vector<std::uint64_t> taken;
  GigeStream stream{{1500, 8, true},
                    [this](const gev::PacketResend& r) { asked.push_back(r); },
                    [this](const GigeBlock& b) { taken.push_back(b.number); }};
};

TEST_F(FieldGigeStream, ShortNumbersOfBlocksRunOver) {
  for (const std::uint64_t number : {65534U, 65535U, 1U, 2U}) {
    block(number);
  }
  EXPECT_THAT(taken, testing::ElementsAre(65534, 65535, 65536, 65537));
  EXPECT_EQ(stream.counters().dropped, 0U);
}

TEST_F(FieldGigeStream, BlocksThatNeverCameAreCounted) {
  block(1);
  block(4);
  EXPECT_EQ(stream.counters().blocks, 2U);
  EXPECT_EQ(stream.counters().dropped, 2U);
}

TEST_F(FieldGigeStream, ALeaderOfMoreThanTheCameraPromisedIsRefused) {
  receive(leader_of(1, 4, 3));
  receive(leader_of(1, 0xFFFF'FFFF, 0xFFFF'FFFF));
  EXPECT_EQ(stream.counters().refused, 2U);
  EXPECT_FALSE(stream.next_event());
}

TEST_F(FieldGigeStream, PayloadBeyondTheBlockIsRefused) {
  receive(leader_of(1, 4, 2));
  const std::array<std::uint8_t, 9> pixels{};
  receive(packet_of({.block = 1, .packet = 1}, pixels));
  receive(packet_of({.block = 1, .packet = 2}, std::span(pixels).first(1)));
  receive(packet_of({.block = 1, .packet = 0xFF'FFFF}, pixels));
  EXPECT_EQ(stream.counters().refused, 3U);
}

TEST_F(FieldGigeStream, NoiseFarAheadDoesNotEndTheBlocksThatCome) {
  block(1);
  const std::array<std::uint8_t, 8> pixels{};
  receive(packet_of({.block = 3000, .packet = 1}, pixels));
  block(2);
  EXPECT_THAT(taken, testing::ElementsAre(1, 2));
}

TEST_F(FieldGigeStream, ABlockThatStaysIncompleteIsDropped) {
  receive(leader_of(1, 4, 2));
  for (int i = 0; i < 20; ++i) {
    now += milliseconds{20};
    stream.advance(now);
  }
  EXPECT_EQ(asked.size(), static_cast<std::size_t>(GigeStream::kRequests));
  EXPECT_EQ(asked[0].first, 1U);
  EXPECT_EQ(asked[0].last, gev::PacketResend::kToTheEnd);
  EXPECT_EQ(stream.counters().dropped, 1U);
  EXPECT_FALSE(stream.next_event());
}

TEST_F(FieldGigeStream, WhatTheCameraNoLongerHasIsNotWaitedFor) {
  receive(leader_of(1, 4, 2));
  receive(packet_of({.status = gev::Status::packet_unavailable, .block = 1, .packet = 1}, {}));
  EXPECT_EQ(stream.counters().dropped, 1U);
  block(2);
  EXPECT_THAT(taken, testing::ElementsAre(2));
}

}  // namespace
}  // namespace rigwire::field

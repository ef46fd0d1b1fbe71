// Recordings as they are written and read again, without a run.
#include "hil/record/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "drivers/endpoints.h"
#include "hil/record/recording_export.h"
#include "protocols/pcapng/link_packet.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
namespace pcapng = protocols::pcapng;
using Bytes = std::vector<std::uint8_t>;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::size_t kGnss = 0;
constexpr std::size_t kCan = 1;

class Recording : public testing::Test {
 protected:
  Recording() {
    std::string pattern = "/tmp/rigwire-test-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  ~Recording() override { fs::remove_all(folder_); }

  [[nodiscard]] std::unique_ptr<RecordingWriter> writer(const std::string& name) {
    fs::create_directories(folder_ / name);
    RecordedRun run;
    run.version = "1";
    run.rig = "pit";
    run.config_hash = "00";
    run.clock = "free";
    run.start_utc = "2026-06-01T08:00:00Z";
    run.start_unix_ns = 1'780'300'800'000'000'000;
    run.configuration = "name: pit\n";
    return std::make_unique<RecordingWriter>(
        folder_ / name, run,
        std::vector<RecordedWire>{{"gnss", WireKind::serial, "/tmp/gnss"},
                                  {"can", WireKind::can, "slcan /tmp/can"}},
        true, [this](const std::string& what, bool over) {
          told_.push_back((over ? "over: " : "") + what);
        });
  }
  static void serial(RecordingWriter& writer, SimTime at, std::uint8_t flags,
                     const std::string& text) {
    writer.write({wire_track(kGnss),
                  flags,
                  at,
                  {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}});
  }
  static void frame(RecordingWriter& writer, SimTime at, std::uint8_t flags, std::uint32_t id) {
    const auto packet = pcapng::can_packet(protocols::can::Frame{id, true, false, 2, {0xAB, 0xCD}});
    writer.write({wire_track(kCan), flags, at, packet});
  }
  static void message(RecordingWriter& writer, SimTime at) {
    const std::string text = "{}";
    writer.write({static_cast<std::uint16_t>(TruthTrack::truth),
                  0,
                  at,
                  {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}});
  }
  /// A second of everything.
  static void fill(RecordingWriter& writer) {
    for (int i = 0; i < 10; ++i) {
      const SimTime at = kStart + i * 100ms;
      message(writer, at);
      serial(writer, at, 0, "piece " + std::to_string(i) + "\n");
      if (i % 5 == 0) {
        serial(writer, at, kInbound, "poll");
      }
      frame(writer, at + 1ms, i == 3 ? kInbound : std::uint8_t{0},
            0x18FEF100U + static_cast<unsigned>(i));
    }
  }
  [[nodiscard]] std::string text(const fs::path& path) const {
    std::ifstream file(folder_ / path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  fs::path folder_;
  std::vector<std::string> told_;
};

TEST_F(Recording, SideFilesAreWhatTheirToolsRead) {
  auto recording = writer("a");
  fill(*recording);
  const protocols::can::ErrorFrame off{protocols::can::kErrorFlag | 0x40, {}};
  recording->write({wire_track(kCan), 0, kStart + 950ms, pcapng::can_packet(off)});
  recording->finish(kStart + 1s);
  EXPECT_THAT(text("a/wires/can.log"), HasSubstr("(1780300800.201000) can 18FEF102#ABCD R\n"
                                                 "(1780300800.301000) can 18FEF103#ABCD T\n"));
  EXPECT_THAT(text("a/wires/can.log"),
              HasSubstr("(1780300800.950000) can 20000040#0000000000000000 R\n"));
  EXPECT_EQ(text("a/wires/gnss.bytes").substr(0, 16), "piece 0\npiece 1\n");
  EXPECT_EQ(text("a/wires/gnss.client"), "pollpoll");
  EXPECT_THAT(text("a/wires/gnss.index"), HasSubstr("0.000000000 > 0 8\n0.000000000 < 0 4\n"
                                                    "0.100000000 > 8 8\n"));
  EXPECT_THAT(text("a/wires/gnss.index"), HasSubstr("0.500000000 < 4 4\n"));
  const auto json = nlohmann::json::parse(text("a/recording.json"));
  EXPECT_EQ(json["end_ns"], 1'000'000'000);
  EXPECT_EQ(json["wires"][1]["packets"], 11);
}

TEST_F(Recording, WhatIsWrittenIsReadAgain) {
  auto recording = writer("a");
  fill(*recording);
  recording->finish(kStart + 1s);
  const RecordingContents contents = read_recording(folder_ / "a");
  EXPECT_EQ(contents.end, kStart + 1s);
  ASSERT_EQ(contents.wires.size(), 2U);
  EXPECT_EQ(contents.wires[kGnss].packets, 12U);
  EXPECT_EQ(contents.wires[kGnss].of_clients, 2U);
  EXPECT_EQ(contents.wires[kGnss].bytes, 10U * 8U + 2U * 4U);
  EXPECT_EQ(contents.wires[kCan].of_clients, 1U);
  EXPECT_EQ(contents.wires[kCan].last, kStart + 901ms);
  EXPECT_EQ(contents.channels.at(0).topic, "/truth");
  EXPECT_EQ(contents.channels.at(0).messages, 10U);
  EXPECT_THAT(to_text(contents), HasSubstr("foxglove.FrameTransforms"));
}

TEST_F(Recording, EqualCallsGiveEqualFiles) {
  for (const char* name : {"a", "b"}) {
    auto recording = writer(name);
    fill(*recording);
    recording->finish(kStart + 1s);
  }
  for (const char* file : {"all.pcapng", "truth.mcap", "recording.json", "wires/can.log",
                           "wires/gnss.index", "wires/gnss.pcapng"}) {
    EXPECT_FALSE(text(fs::path("a") / file).empty()) << file;
    EXPECT_EQ(text(fs::path("a") / file), text(fs::path("b") / file)) << file;
  }
}

TEST_F(Recording, WhatIsLostIsToldWithTheNextPacket) {
  auto recording = writer("a");
  frame(*recording, kStart, 0, 1);
  recording->lost(wire_track(kCan), 3);
  recording->write({wire_track(kCan), kWireLost, kStart + 1ms, {}});
  const std::string note = "fault noise of can begins";
  recording->write({wire_track(kCan),
                    kWireNote,
                    kStart + 1ms,
                    {reinterpret_cast<const std::uint8_t*>(note.data()), note.size()}});
  frame(*recording, kStart + 2ms, 0, 2);
  frame(*recording, kStart + 3ms, 0, 3);
  recording->finish(kStart + 1s);
  const RecordingContents contents = read_recording(folder_ / "a");
  EXPECT_EQ(contents.wires[kCan].lost, 3U);
  ASSERT_EQ(contents.notes.size(), 1U);
  EXPECT_EQ(contents.notes[0].at, kStart + 2ms);
  EXPECT_EQ(contents.notes[0].text,
            "fault noise of can begins; 1 before this found no room on the wire; 3 before this "
            "were not recorded");
  EXPECT_EQ(recording->totals().wires[kCan].lost, 3U);
  EXPECT_EQ(recording->totals().wires[kCan].dropped_by_wire, 1U);
}

TEST_F(Recording, ARunThatWasKilledLeavesWhatWasFlushed) {
  auto recording = writer("a");
  fill(*recording);
  recording->flush();
  recording.reset();  // without finish()
  const RecordingContents contents = read_recording(folder_ / "a");
  EXPECT_FALSE(contents.end);
  EXPECT_EQ(contents.wires[kCan].packets, 10U);
  EXPECT_THAT(to_text(contents), HasSubstr("the run was killed"));
  // And in the middle of a block.
  fs::resize_file(folder_ / "a/all.pcapng", fs::file_size(folder_ / "a/all.pcapng") - 5);
  EXPECT_EQ(read_recording(folder_ / "a").wires[kCan].packets, 9U);
  cut_recording(folder_ / "a", kStart, kNever, folder_ / "b");
  EXPECT_EQ(read_recording(folder_ / "b").end, kStart + 900ms);
}

TEST_F(Recording, APieceHasWhatWasWithinIt) {
  auto recording = writer("a");
  fill(*recording);
  recording->finish(kStart + 1s);
  cut_recording(folder_ / "a", kStart + 300ms, kStart + 600ms, folder_ / "b");
  const RecordingContents contents = read_recording(folder_ / "b");
  EXPECT_EQ(contents.wires[kGnss].packets, 4U);
  EXPECT_EQ(contents.wires[kCan].first, kStart + 301ms);
  EXPECT_EQ(contents.channels.at(0).messages, 3U);
  EXPECT_EQ(text("b/wires/gnss.bytes"), "piece 3\npiece 4\npiece 5\n");
  EXPECT_EQ(text("b/rig.yaml"), "name: pit\n");
  EXPECT_THROW(cut_recording(folder_ / "a", kStart, kNever, folder_ / "b"), drivers::EndpointError)
      << "a folder with something in it";
}

TEST_F(Recording, WhatIsNoneIsRefusedWithItsPlace) {
  const auto refusal = [&] {
    try {
      (void)read_recording(folder_ / "a");
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(refusal(), HasSubstr("recording.json: No such file"));
  auto recording = writer("a");
  fill(*recording);
  recording->finish(kStart + 1s);
  std::fstream file(folder_ / "a/all.pcapng", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(4);
  file.put(13);
  file.close();
  EXPECT_THAT(refusal(), HasSubstr("all.pcapng: the length of a block at byte 4"));
  std::ofstream(folder_ / "a/recording.json") << R"({"rigwire_recording": 2})";
  EXPECT_THAT(refusal(), HasSubstr("found 2, allowed 1"));
}

/// Files of this process may have so many bytes and no more, while it lives.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) : before_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit small{bytes, limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallDisk() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

 private:
  void (*before_)(int);
  rlimit limit_{};
};

TEST_F(Recording, ADiskThatIsFullForAWhileLeavesAGapThatIsTold) {
  auto recording = writer("a");
  frame(*recording, kStart, 0, 1);
  recording->flush();
  {
    const SmallDisk disk(700);
    for (int i = 1; i <= 20; ++i) {
      frame(*recording, kStart + i * 1ms, 0, 2);
    }
    recording->flush();
    recording->flush();
  }
  ASSERT_FALSE(told_.empty());
  EXPECT_THAT(told_[0], HasSubstr("all.pcapng loses what passes: File too large"));
  const std::size_t told = told_.size();
  frame(*recording, kStart + 50ms, 0, 3);
  recording->finish(kStart + 1s);
  EXPECT_GT(told_.size(), told) << "that it can be written again";
  EXPECT_THAT(told_.back(), HasSubstr("over: "));
  const RecordingContents contents = read_recording(folder_ / "a");
  EXPECT_EQ(contents.wires[kCan].packets, 2U) << "before and after the gap";
  EXPECT_EQ(contents.wires[kCan].lost, 20U);
  ASSERT_EQ(contents.notes.size(), 1U);
  EXPECT_EQ(contents.notes[0].text, "20 before this were not recorded");
}

TEST_F(Recording, AMemberThatOnlyLaterMessagesHaveIsAColumnOfAll) {
  auto recording = writer("a");
  const auto say = [&](SimTime at, TruthTrack track, const std::string& text) {
    recording->write({static_cast<std::uint16_t>(track),
                      0,
                      at,
                      {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}});
  };
  say(kStart + 10ms, TruthTrack::truth,
      R"({"sim_s":0.01,"joint_rad":[0.5,-1e-3],"utc":"a \"b\""})");
  say(kStart + 15ms, TruthTrack::events, R"({"message":"no row of this"})");
  say(kStart + 20ms, TruthTrack::truth,
      R"({"sim_s":0.02,"joint_rad":[1,2],"contact":{"body":"boom"}})");
  recording->finish(kStart + 1s);
  EXPECT_EQ(export_csv(folder_ / "a", TruthTrack::truth, folder_ / "truth.csv"), 2U);
  EXPECT_EQ(text("truth.csv"),
            "sim_s,joint_rad.0,joint_rad.1,utc,contact.body\n"
            "0.010000000,0.5,-0.001,\"a \"\"b\"\"\",\n"
            "0.020000000,1,2,,\"boom\"\n");
  EXPECT_EQ(export_csv(folder_ / "a", TruthTrack::location, folder_ / "none.csv"), 0U);
  EXPECT_THROW(export_csv(folder_ / "a", TruthTrack::truth, folder_ / "no/folder.csv"),
               drivers::EndpointError);
}

}  // namespace
}  // namespace rigwire::hil

// A machine that moves as it did once: its devices say what they said then, and answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "governed_run.h"
#include "hil/record/recorder.h"
#include "hil/record/recording.h"
#include "hil/record/recording_export.h"
#include "hil/rig/rig.h"
#include "private_wires.h"
#include "protocols/bytes.h"
#include "protocols/canopen/identifiers.h"
#include "protocols/canopen/sdo.h"
#include "protocols/pcapng/link_packet.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/points.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using Json = nlohmann::json;

using Openings = std::map<std::string, double>;

/// What stays of the errors: greatest and root of the mean square.
struct Spread {
  void add(double error) {
    greatest = std::max(greatest, std::abs(error));
    squares += error * error;
    ++count;
  }
  [[nodiscard]] double rms() const { return std::sqrt(squares / static_cast<double>(count)); }

  double greatest = 0.0;
  double squares = 0.0;
  std::size_t count = 0;
};

class ReplayedMotion : public testing::Test {
 protected:
  [[nodiscard]] fs::path folder(const std::string& name) const { return wires_.folder / name; }

  /// Runs and records; returns its configuration's remark of what the machine did.
  std::map<std::string, double> run(const std::string& name, const std::string& rig_file,
                                    Duration length, std::vector<std::string> sets,
                                    const Openings& hand = {}) {
    return record(name, load_rig(rig_file, std::move(sets)).configuration, length, hand);
  }
  std::map<std::string, double> record(const std::string& name,
                                       const RigConfiguration& configuration, Duration length,
                                       const Openings& hand = {}) {
    RecordedRun about;
    about.start_unix_ns = unix_time(configuration.start).count();
    about.configuration = print_rig(configuration);
    boost::asio::io_context io;
    OutputFailures failures([](const std::string& what) { ADD_FAILURE() << what; });
    RunEvents events;
    Recorder recorder(std::move(about), 10min, failures, events);
    Rig rig(configuration, io, {}, nullptr, {}, &recorder);
    for (const auto& [set_point, value] : hand) {
      HandSettings::Row row = *rig.hand().settings().find(set_point);
      row.value = value;
      rig.executive().ask(Hand::Order{row, value});
    }
    recorder.begin({folder(name).string(), {}});
    const RunOutcome outcome = rig.executive().run_free(kStart + length);
    EXPECT_FALSE(outcome.fault) << *outcome.fault;
    std::map<std::string, double> state;
    const RigStatus status = rig.status();
    for (std::size_t i = 0; i < status.machine.size(); ++i) {
      state[rig.truth().state_quantities()[i].name] = status.machine[i];
    }
    recorder.finish(outcome.reached);
    return state;
  }

  [[nodiscard]] std::string bytes_of(const fs::path& path) const {
    std::ifstream file(wires_.folder / path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::vector<Json> messages(const std::string& name, TruthTrack topic) const {
    std::vector<Json> all;
    each_message(folder(name), [&](TruthTrack track, SimTime at, std::string_view text) {
      if (track == topic) {
        all.push_back(Json::parse(text));
        all.back()["at"] = to_seconds(at);
      }
    });
    return all;
  }
  /// What left on a wire.
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> packets(const std::string& name,
                                                               const std::string& wire) const {
    const RecordingContents contents = read_recording_description(folder(name));
    std::vector<std::vector<std::uint8_t>> all;
    each_packet(folder(name),
                [&](std::size_t index, SimTime, const protocols::pcapng::Packet& packet) {
                  if (contents.wires[index].about.name == wire) {
                    all.emplace_back(packet.bytes.begin(), packet.bytes.end());
                  }
                });
    return all;
  }
  /// Differences between the link's accelerations in both runs, at all instants that both have.
  [[nodiscard]] Spread accelerations(const std::string& a, const std::string& b,
                                     const std::string& link) const {
    Spread spread;
    const auto first = messages(a, TruthTrack::motion);
    const auto second = messages(b, TruthTrack::motion);
    EXPECT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      double square = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto of = [&](const Json& m) {
          return m["links"][link]["acceleration_mps2"][k].get<double>();
        };
        square += std::pow(of(first[i]) - of(second[i]), 2);
      }
      spread.add(std::sqrt(square));
    }
    return spread;
  }
  /// Differences between the places of a link in both runs.
  [[nodiscard]] Spread places(const std::string& a, const std::string& b, std::size_t link) const {
    Spread spread;
    const auto first = messages(a, TruthTrack::transforms);
    const auto second = messages(b, TruthTrack::transforms);
    for (std::size_t i = 0; i < first.size(); ++i) {
      double square = 0.0;
      for (const char* axis : {"x", "y", "z"}) {
        const auto of = [&](const Json& m) {
          return m["transforms"][link]["translation"][axis].get<double>();
        };
        square += std::pow(of(first[i]) - of(second[i]), 2);
      }
      spread.add(std::sqrt(square));
    }
    return spread;
  }
  struct Ranges {
    Spread error;
    std::size_t points = 0;
    std::size_t apart = 0;  ///< A beam that one of them missed, or by more than 0.1 m.
  };
  /// Differences between the lidar's distances in both runs, beam by beam.
  [[nodiscard]] Ranges ranges(const std::string& a, const std::string& b) const {
    Ranges result;
    const auto first = packets(a, "lidar");
    const auto second = packets(b, "lidar");
    EXPECT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < std::min(first.size(), second.size()); ++i) {
      const auto payload = [](const std::vector<std::uint8_t>& packet) {
        const auto udp = protocols::pcapng::udp_packet(packet);
        return protocols::velodyne::decode_data_packet(udp->bytes);
      };
      const auto one = payload(first[i]);
      const auto other = payload(second[i]);
      if (!one.ok() || !other.ok()) {
        continue;  // a position packet
      }
      for (std::size_t block = 0; block < one->blocks.size(); ++block) {
        EXPECT_EQ(one->blocks[block].azimuth_counts, other->blocks[block].azimuth_counts);
        for (std::size_t k = 0; k < one->blocks[block].channels.size(); ++k) {
          const double counts = one->blocks[block].channels[k].distance_counts;
          const double other_counts = other->blocks[block].channels[k].distance_counts;
          if (counts == 0.0 && other_counts == 0.0) {
            continue;
          }
          ++result.points;
          const double error_m = 0.002 * (counts - other_counts);
          if (counts == 0.0 || other_counts == 0.0 || std::abs(error_m) > 0.1) {
            ++result.apart;
          } else {
            result.error.add(error_m);
          }
        }
      }
    }
    return result;
  }
  void print(const char* what, const Spread& spread) const {
    std::printf("%-40s greatest %.3g, rms %.3g of %zu\n", what, spread.greatest, spread.rms(),
                spread.count);
  }

  rigwire::test::PrivateWires wires_;
};

constexpr unsigned kEncoderNode = 0x20;
constexpr const char* kPit = RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_pit.yaml";
const Openings kDig{{"swing", 0.4}, {"boom", 0.5}, {"stick", -0.6}, {"bucket", 0.5}};

/// One count of the wire: what rounding makes of a range that lies between two.
constexpr double kCount_m = 0.002;

TEST_F(ReplayedMotion, OfAnExcavatorGivesItsDevicesOutputAgain) {
  constexpr Duration kLength = 3s;
  run("a", kPit, kLength, wires_.sets(), kDig);
  auto sets = wires_.sets();
  sets.push_back("machine.motion.file=" + (folder("a") / "truth.mcap").string());
  // Somebody pulls the other way, which moves nothing.
  const auto state = run("b", kPit, kLength, sets, {{"swing", -1.0}, {"boom", -1.0}});

  EXPECT_EQ(bytes_of("a/wires/gnss.bytes"), bytes_of("b/wires/gnss.bytes"));
  const Ranges lidar = ranges("a", "b");
  print("lidar range, m", lidar.error);
  EXPECT_LE(lidar.error.greatest, kCount_m + 1e-9);
  EXPECT_LT(lidar.error.rms(), 1e-4);
  EXPECT_LT(lidar.apart, lidar.points / 100'000);
  for (const char* link : {"upper", "boom", "stick", "bucket"}) {
    EXPECT_EQ(accelerations("a", "b", link).greatest, 0.0) << link;
  }
  const Json first = messages("a", TruthTrack::truth).back();
  const Json second = messages("b", TruthTrack::truth).back();
  for (const char* key : {"joint_rad", "spool", "bucket_tip_m", "bucket_soil_m3"}) {
    EXPECT_EQ(first[key], second[key]) << key;
  }
  EXPECT_GT(second["commands_without_effect"], 0);
  EXPECT_GT(state.at("commands without effect"), 0.0);
  const Json valves = messages("a", TruthTrack::motion).back()["valves"];
  EXPECT_EQ(valves, messages("b", TruthTrack::motion).back()["valves"]);
  EXPECT_EQ(messages("a", TruthTrack::joints).back()["joints"][0]["name"], "upper");
}

/// A poll of the receiver, a read of the valves and one of the encoder, while the machine moves as
/// it did once: each is answered, and with what is so then.
TEST_F(ReplayedMotion, ItsDevicesAnswerTheirClients) {
  constexpr Duration kLength = 2500ms;
  run("a", kPit, kLength, wires_.sets(), kDig);
  auto sets = wires_.sets();
  sets.push_back("machine.motion.file=" + (folder("a") / "truth.mcap").string());
  const RigConfiguration configuration = load_rig(kPit, sets).configuration;

  test::WireClients clients;
  const SimTime ask = kStart + 1500ms;
  clients.say("gnss", kStart + 1s, drivers::LineClient{true, 115200});
  const std::array<std::uint8_t, 8> poll{0xB5, 0x62, 0x0A, 0x04, 0, 0, 0x0E, 0x34};  // MON-VER
  clients.say("gnss", ask, SerialPiece{}, {poll.begin(), poll.end()});
  clients.say("valves", kStart + 1s, StreamPiece{{}, 1, StreamPiece::What::opened, {}}, {});
  // Input registers 0 .. 9 of unit 1.
  clients.say("valves", ask, StreamPiece{{}, 1, StreamPiece::What::bytes, {}},
              {0, 7, 0, 0, 0, 6, 1, 4, 0, 0, 0, 10});
  clients.say("can", kStart + 1s, drivers::CanClient{.open = true});
  clients.say("can", ask,
              protocols::canopen::make_frame(0x600 + kEncoderNode,
                                             protocols::canopen::make_upload({0x6004, 0})));
  test::run(configuration, {}, kLength, &clients);

  const auto answers = [&](const std::string& wire, const auto& is_one) {
    std::vector<test::WireClients::Unit> found;
    for (const auto& unit : clients.heard(wire)) {
      if (unit.at >= ask && is_one(unit)) {
        found.push_back(unit);
      }
    }
    return found;
  };
  std::vector<std::uint8_t> line;
  for (const auto& unit : clients.heard("gnss")) {
    line.insert(line.end(), unit.bytes.begin(), unit.bytes.end());
  }
  const std::array<std::uint8_t, 4> version{0xB5, 0x62, 0x0A, 0x04};
  EXPECT_FALSE(std::ranges::search(line, version).empty()) << "MON-VER is not answered";

  const auto registers = answers("valves", [](const auto& unit) { return !unit.bytes.empty(); });
  ASSERT_EQ(registers.size(), 1U);
  ASSERT_EQ(registers[0].bytes.size(), 9U + 20U);
  EXPECT_EQ(registers[0].bytes[1], 7) << "the request's transaction";
  EXPECT_EQ(registers[0].bytes[7], 4);

  const auto position = answers("can", [](const auto& unit) {
    return !unit.frame.extended && unit.frame.id == 0x580U + kEncoderNode;
  });
  ASSERT_EQ(position.size(), 1U);
  EXPECT_EQ(position[0].frame.data[0], 0x43);
  // The swing of the recording at that instant, in steps of 14 bits.
  const auto steps = protocols::load_little<std::uint32_t>(position[0].frame.data, 4);
  double swing_rad = 0.0;
  for (const Json& message : messages("a", TruthTrack::joints)) {
    if (message["at"].get<double>() <= to_seconds(ask - kStart)) {
      swing_rad = message["joints"][0]["position"].get<double>();
    }
  }
  ASSERT_GT(std::abs(swing_rad), 0.02) << "it has not swung";
  const double read_rad = steps / 16384.0 * 2.0 * std::numbers::pi;
  EXPECT_LT(std::abs(std::remainder(read_rad - swing_rad, 2.0 * std::numbers::pi)), 5e-3);
}

/// Wheels, steering and drive train are not the links alone.
class ReplayedDriveOf : public ReplayedMotion, public testing::WithParamInterface<const char*> {};

TEST_P(ReplayedDriveOf, AVehicleGivesItsDevicesOutputAgain) {
  const std::string rig = RIGWIRE_SOURCE_DIR "/configs/rigs/" + std::string(GetParam()) + ".yaml";
  constexpr Duration kLength = 3s;
  const Openings drive{{"parking_brake", 0.0}, {"travel_speed", 2.0}, {"front_steer", 0.2}};
  run("a", rig, kLength, wires_.driving_sets(GetParam()), drive);
  auto sets = wires_.driving_sets(GetParam());
  sets.push_back("machine.motion.file=" + (folder("a") / "truth.mcap").string());
  const auto state = run("b", rig, kLength, sets, {{"travel_speed", -2.0}});

  EXPECT_EQ(bytes_of("a/wires/gnss.bytes"), bytes_of("b/wires/gnss.bytes"));
  const Ranges lidar = ranges("a", "b");
  print("lidar range, m", lidar.error);
  EXPECT_GT(lidar.points, 10'000U);
  // A ray along the ground meets it elsewhere by much when the pose is rounded by little.
  EXPECT_LE(lidar.error.greatest, 0.05);
  EXPECT_LT(lidar.error.rms(), 1e-4);
  EXPECT_LT(lidar.apart, lidar.points / 10'000);
  const std::string body = "body";
  EXPECT_EQ(accelerations("a", "b", body).greatest, 0.0);
  const Json first = messages("a", TruthTrack::motion).back();
  const Json second = messages("b", TruthTrack::motion).back();
  EXPECT_EQ(first["vehicle"], second["vehicle"]) << "what the gateway measures";
  EXPECT_GT(std::abs(first["vehicle"]["odometry_speed_mps"].get<double>()), 0.2) << "it drove";
  EXPECT_GT(state.at("commands without effect"), 0.0);
}

INSTANTIATE_TEST_SUITE_P(, ReplayedDriveOf, testing::Values("gator_campus", "unimog_forest"),
                         [](const auto& test) { return std::string(test.param); });

/// The recorded lidar beside an emulated receiver on the recorded motion: both as they were.
TEST_F(ReplayedMotion, ARecordedLidarStandsBesideAnEmulatedReceiver) {
  constexpr Duration kLength = 1500ms;
  run("a", kPit, kLength, wires_.sets(), kDig);
  const fs::path player = wires_.folder / "player.yaml";
  std::ofstream(player)
      << "machine: {type: excavator}\ndevices:\n  lidar: {type: replay, wire: udp, "
         "address: 127.0.0.1, port: "
      << wires_.lidar_port << ", source: {file: " << (folder("a") / "wires/lidar.pcapng").string()
      << ", zero: " << unix_time(load_rig(kPit, {}).configuration.start).count() << "}}\n";
  const LoadedRig of_file = load_rig(player.string(), {});
  auto sets = wires_.sets();
  sets.push_back("machine.motion.file=" + (folder("a") / "truth.mcap").string());
  RigConfiguration mixed = load_rig(kPit, sets).configuration;
  mixed.devices.erase("lidar");
  mixed.devices.emplace("lidar", of_file.configuration.devices.at("lidar"));
  record("b", mixed, kLength);
  EXPECT_EQ(bytes_of("a/wires/gnss.bytes"), bytes_of("b/wires/gnss.bytes"));
  // Packets of both ports are compared in their order; what was due at the very end may still be on
  // its way.
  const auto recorded = packets("a", "lidar");
  const auto played = packets("b", "lidar");
  ASSERT_GT(played.size(), 2000U);
  ASSERT_LE(played.size(), recorded.size());
  EXPECT_GE(played.size() + 5, recorded.size());
  for (std::size_t i = 0; i < played.size(); ++i) {
    const auto one = protocols::pcapng::udp_packet(recorded[i]);
    const auto other = protocols::pcapng::udp_packet(played[i]);
    ASSERT_TRUE(one.ok() && other.ok());
    ASSERT_TRUE(std::ranges::equal(one->bytes, other->bytes)) << "packet " << i;
  }
}

TEST_F(ReplayedMotion, BetweenItsInstantsIsNearTheRunThatItIsOf) {
  const auto with = [&](const std::string& more, const std::string& another = "") {
    auto sets = wires_.sets();
    sets.push_back(more);
    if (!another.empty()) {
      sets.push_back(another);
    }
    return sets;
  };
  constexpr Duration kLength = 1500ms;
  run("fine", kPit, kLength, with("truth.rate=1000"), kDig);
  run("coarse", kPit, kLength, with("truth.rate=100"), kDig);
  const std::string csv = (wires_.folder / "poses.csv").string();
  (void)export_csv(folder("coarse"), TruthTrack::truth, csv);
  const std::string file = (folder("coarse") / "truth.mcap").string();
  run("of_motions", kPit, kLength, with("truth.rate=1000", "machine.motion.file=" + file));
  run("of_poses", kPit, kLength, with("truth.rate=1000", "machine.motion.file=" + csv));
  for (const auto& [link, index] : {std::pair("boom", 2U), std::pair("bucket", 4U)}) {
    for (const char* replayed : {"of_motions", "of_poses"}) {
      const std::string what = std::string(replayed) + " " + link;
      const Spread acceleration = accelerations("fine", replayed, link);
      const Spread place = places("fine", replayed, index);
      print((what + ", m/s2").c_str(), acceleration);
      print((what + ", m").c_str(), place);
      EXPECT_LT(place.rms(), 1e-4) << what;
      EXPECT_LT(acceleration.rms(), 1.0) << what;
    }
    EXPECT_LT(accelerations("fine", "of_motions", link).rms(),
              accelerations("fine", "of_poses", link).rms());
  }
}

}  // namespace
}  // namespace rigwire::hil

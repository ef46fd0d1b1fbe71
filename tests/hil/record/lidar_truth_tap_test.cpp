// The lidars' truth of a rig against what the lidar measured.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "hil/record/lidar_truth_tap.h"
#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

template <class Value>
Value at(const std::string& bytes, std::size_t offset) {
  Value value;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

TEST(LidarTruth, TellsObjectExactRangeAndInstantOfEveryShot) {
  const rigwire::test::PrivateWires wires;
  const LoadedRig loaded =
      load_rig(std::string(RIGWIRE_SOURCE_DIR) + "/configs/rigs/unimog_forest.yaml",
               wires.driving_sets("unimog_forest"));
  const auto path = wires.folder / "lidar.truth";
  {
    boost::asio::io_context io;
    Rig rig(loaded.configuration, io, {{}, path});
    ASSERT_FALSE(rig.executive().run_free(kStart + 200ms).fault.has_value());
  }
  std::ifstream file(path, std::ios::binary);
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  const auto header = nlohmann::json::parse(line);
  EXPECT_EQ(header["start_utc"], "2026-06-01T08:00:00Z");
  EXPECT_EQ(header["start_time_of_hour_us"], 0.0);
  EXPECT_EQ(header["lidars"], nlohmann::json({"lidar"}));
  ASSERT_EQ(header["record_bytes"], kLidarTruthRecordSize);
  std::stringstream rest;
  rest << file.rdbuf();
  const std::string bytes = rest.str();
  ASSERT_EQ(bytes.size() % kLidarTruthRecordSize, 0U);
  const std::size_t records = bytes.size() / kLidarTruthRecordSize;
  EXPECT_NEAR(static_cast<double>(records), 0.2 / 46.08e-6 * 32, 100.0);
  double squares = 0.0;
  std::size_t compared = 0;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < records; ++i) {
    const std::string record = bytes.substr(i * kLidarTruthRecordSize, kLidarTruthRecordSize);
    const auto laser = at<std::uint16_t>(record, 10);
    ASSERT_EQ(at<std::int64_t>(record, 0),
              46080 * static_cast<std::int64_t>(i / 32 + 1) + 1152 * laser);
    const auto instance = at<std::uint32_t>(record, 12);
    const auto truth = at<float>(record, 16);
    const auto measured = at<float>(record, 24);
    if (instance == 0xFFFFFFFFU) {
      EXPECT_EQ(truth, 0.0F);
      continue;
    }
    seen.insert(header["instances"].at(instance)["label"]);
    if (measured > 0.0F) {
      squares += std::pow(measured - truth, 2);
      ++compared;
    }
  }
  EXPECT_THAT(seen, testing::IsSupersetOf({"ground", "crown", "trunk"}));
  ASSERT_GT(compared, records / 3);
  // An HDL-32E's: 5.3 mm from shot to shot, and biases of its lasers that spread by 7.9 mm.
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(compared)), 0.0095, 0.0025)
      << "the noise alone is between them";
}

TEST(LidarTruth, NumbersLidarsByTheirPlaceAmongTheNames) {
  const rigwire::test::PrivateWires wires;
  const auto path = wires.folder / "numbers.truth";
  LidarPattern pattern;
  pattern.lasers.resize(1);
  {
    LidarTruthTap tap(path, Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}), sim::Scene(),
                      {"front", "rear"});
    tap.record("rear", pattern, {LidarFiring{}}, {sim::LidarBankTruth{}});
    tap.record("front", pattern, {LidarFiring{}}, {sim::LidarBankTruth{}});
  }
  std::ifstream file(path, std::ios::binary);
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  std::stringstream rest;
  rest << file.rdbuf();
  const std::string bytes = rest.str();
  ASSERT_EQ(bytes.size(), 2 * kLidarTruthRecordSize);
  EXPECT_EQ(at<std::uint16_t>(bytes, 8), 1U);
  EXPECT_EQ(at<std::uint16_t>(bytes, kLidarTruthRecordSize + 8), 0U);
}

TEST(LidarTruth, RefusesAFileThatCannotBeMade) {
  const rigwire::test::PrivateWires wires;
  const LoadedRig loaded =
      load_rig(std::string(RIGWIRE_SOURCE_DIR) + "/configs/rigs/unimog_forest.yaml",
               wires.driving_sets("unimog_forest"));
  boost::asio::io_context io;
  EXPECT_THAT(
      [&] {
        Rig rig(loaded.configuration, io, {{}, wires.folder / "no" / "where"});
      },
      testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("cannot be written")));
}

}  // namespace
}  // namespace rigwire::hil

// RTKLIB's convbin reads the frames; what it writes as RINEX is what went in, to the decimals that
// RINEX has.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "child_process.h"
#include "emulators/ublox/raw_messages.h"
#include "protocols/rinex/navigation.h"
#include "raw_log.h"

namespace rigwire::emulators {
namespace {

namespace fs = std::filesystem;
namespace ubx = protocols::ubx;

constexpr int kSeconds = 65;

std::string read(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// C1C, L1C, D1C, S1C.
using Row = std::array<double, 4>;

/// Rows by epoch (seconds since 10:00:00) and PRN.
std::map<std::pair<int, int>, Row> read_observations(const std::string& text) {
  std::map<std::pair<int, int>, Row> rows;
  std::istringstream lines(text.substr(text.find("END OF HEADER")));
  std::string line;
  std::getline(lines, line);
  int epoch = 0;
  while (std::getline(lines, line)) {
    if (line[0] == '>') {
      EXPECT_EQ(line.substr(2, 13), "2024 06 05 10");
      EXPECT_EQ(line.substr(21, 8), ".0000000");
      epoch = std::stoi(line.substr(16, 2)) * 60 + std::stoi(line.substr(19, 2));
      continue;
    }
    Row row{};
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = std::stod(line.substr(3 + 16 * i, 14));
    }
    rows[{epoch, std::stoi(line.substr(1, 2))}] = row;
  }
  return rows;
}

class RawMessagesToRtklib : public ::testing::Test {
 protected:
  void convert(int generation, std::array<ubx::MessageId, 2> messages) {
    write_example(directory_.path / "raw.ubx", generation, kSeconds, messages);
    test::ChildProcess convbin(
        {"convbin", "-r", "ubx", "-v", "3.04", "-od", "-os", "-oi", "-ot", "-ol", "-o",
         (directory_.path / "out.obs").string(), "-n", (directory_.path / "out.nav").string(),
         (directory_.path / "raw.ubx").string()},
        directory_.path / "convbin.log");
    ASSERT_EQ(convbin.wait(), 0) << convbin.output();
    observations_ = read(directory_.path / "out.obs");
    navigation_ = read(directory_.path / "out.nav");
    ASSERT_NE(observations_.find("END OF HEADER"), std::string::npos);
  }

  void expect_navigation() const {
    const auto file = protocols::rinex::read_navigation(navigation_, "out.nav");
    ASSERT_EQ(file.records.size(), kExamplePrns.size());
    for (std::size_t i = 0; i < kExamplePrns.size(); ++i) {
      const auto read = protocols::gps::quantised(file.records[i].ephemeris);
      EXPECT_EQ(read, to_message(example_ephemeris(kExamplePrns[i]))) << int{kExamplePrns[i]};
    }
    // Page 18 came with the second frame. RTKLIB prints four decimals of the coefficients.
    ASSERT_TRUE(file.has_ionosphere && file.has_utc && file.has_leap_seconds);
    const auto navigation = example_navigation();
    for (std::size_t i = 0; i < 4; ++i) {
      const double alpha = navigation->ionosphere.alpha[i];
      const double beta = navigation->ionosphere.beta[i];
      EXPECT_NEAR(file.ionosphere_utc.alpha[i], alpha, std::abs(alpha) * 6e-4);
      EXPECT_NEAR(file.ionosphere_utc.beta[i], beta, std::abs(beta) * 6e-4);
    }
    EXPECT_NEAR(file.ionosphere_utc.utc_a0_s, navigation->utc.a0_s, 1e-17);
    EXPECT_NEAR(file.ionosphere_utc.utc_a1, navigation->utc.a1, 1e-22);
    EXPECT_EQ(file.ionosphere_utc.utc_reference_time_s, navigation->utc.reference_time_s);
    EXPECT_EQ(file.ionosphere_utc.leap_seconds, 18);
  }

  void expect_observations(bool phase_from_zero) const {
    auto rows = read_observations(observations_);
    EXPECT_EQ(rows.size(), (kSeconds + 1) * kExamplePrns.size());
    const GnssSample first = example_sample(0, nullptr);
    for (int second = 0; second <= kSeconds; ++second) {
      const GnssSample sample = example_sample(second, nullptr);
      for (std::size_t i = 0; i < sample.measurements.size(); ++i) {
        const GnssMeasurement& m = sample.measurements[i];
        const Row& row = rows[{30 + second, m.number}];
        const double origin =
            phase_from_zero ? std::floor(first.measurements[i].carrier_phase_cycles) : 0.0;
        EXPECT_NEAR(row[0], m.pseudorange_m, 5.1e-4);
        EXPECT_NEAR(row[1], m.carrier_phase_cycles - origin, 5.1e-4);
        EXPECT_NEAR(row[2], m.doppler_hz, 7e-4);  // A float of 4200 Hz has steps of 0.0005.
        EXPECT_NEAR(row[3], m.cn0_dbhz, 0.5);
      }
    }
  }

  ExampleDirectory directory_;
  std::string observations_;
  std::string navigation_;
};

TEST_F(RawMessagesToRtklib, RawAndSfrbOfUblox7) {
  ASSERT_NO_FATAL_FAILURE(convert(7, {ubx::RxmSfrb::kId, ubx::RxmRawHead::kId}));
  expect_navigation();
  expect_observations(true);
}

// Two thirds of the subframes of a recorded NEO-7P are of SBAS satellites, one a second of each.
TEST_F(RawMessagesToRtklib, MessagesOfSbasSatellitesAreReadAsSuch) {
  for (const bool older : {true, false}) {
    const std::array<ubx::MessageId, 2> messages =
        older ? std::array{ubx::RxmRawHead::kId, ubx::RxmSfrb::kId}
              : std::array{ubx::RxmRawxHead::kId, ubx::RxmSfrbxHead::kId};
    const fs::path raw_path = directory_.path / "sbas.ubx";
    std::ofstream file(raw_path, std::ios::binary);
    UbloxRawMessages raw(Calendar(kExampleStart), older ? 7 : 8);
    raw.begin(false, false);
    std::array<std::uint8_t, kLongestRawFrame> frame{};
    for (int second = 0; second <= kSeconds; ++second) {
      GnssSample sample = example_sample(second, example_navigation());
      sample.satellites.push_back(
          {.number = 136, .cn0_dbhz = 40.0, .tracked = true, .system = GnssSystem::sbas});
      raw.update(sample, {.time_known = true, .week_known = true});
      for (const auto id : messages) {
        for (std::size_t i = 0; i < raw.count(id); ++i) {
          const std::size_t size = raw.encode(id, i, frame);
          file.write(reinterpret_cast<const char*>(frame.data()),
                     static_cast<std::streamsize>(size));
        }
      }
    }
    file.close();
    const fs::path log_path = directory_.path / "out.sbs";
    test::ChildProcess convbin({"convbin", "-r", "ubx", "-s", log_path.string(), "-o",
                                (directory_.path / "out.obs").string(), "-n",
                                (directory_.path / "out.nav").string(), raw_path.string()},
                               directory_.path / "convbin.log");
    ASSERT_EQ(convbin.wait(), 0) << convbin.output();
    // week, time of week, PRN, type: message.
    std::istringstream lines(read(log_path));
    std::map<int, int> types;
    int week = 0;
    int time_of_week = 0;
    int prn = 0;
    int type = 0;
    for (std::string line; std::getline(lines, line);) {
      ASSERT_EQ(std::sscanf(line.c_str(), "%d %d %d %d", &week, &time_of_week, &prn, &type), 4)
          << line;
      EXPECT_EQ(prn, 136);
      ++types[type];
    }
    const int all = types[1] + types[2] + types[3] + types[7] + types[63];
    EXPECT_EQ(all, kSeconds) << (older ? "RXM-SFRB" : "RXM-SFRBX");
    EXPECT_EQ(types.size(), 5U);
    EXPECT_EQ(types[1], 1);
    EXPECT_GE(types[2], 20) << "fast corrections of five satellites fit into one message";
    fs::remove(log_path);
  }
}

TEST_F(RawMessagesToRtklib, RawxAndSfrbxOfUblox8) {
  ASSERT_NO_FATAL_FAILURE(convert(8, {ubx::RxmSfrbxHead::kId, ubx::RxmRawxHead::kId}));
  expect_navigation();
  expect_observations(false);
}

TEST_F(RawMessagesToRtklib, RawxAndSfrbxOfUblox9) {
  ASSERT_NO_FATAL_FAILURE(convert(9, {ubx::RxmSfrbxHead::kId, ubx::RxmRawxHead::kId}));
  expect_navigation();
  expect_observations(false);
}

}  // namespace
}  // namespace rigwire::emulators

// Two decoders of others read what the encoder writes: gpsd's gpsdecode the stations, biases and
// older observations, RTKLIB's convbin all observations.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "child_process.h"
#include "example_messages.h"

namespace rigwire::protocols::rtcm3 {
namespace {

namespace fs = std::filesystem;

class Rtcm3ToOthers : public ::testing::Test {
 protected:
  Rtcm3ToOthers() {
    std::string pattern = (fs::temp_directory_path() / "rtcm3.XXXXXX").string();
    directory_ = ::mkdtemp(pattern.data());
  }
  ~Rtcm3ToOthers() override { fs::remove_all(directory_); }

  fs::path write(const std::vector<Message>& messages) const {
    const fs::path path = directory_ / "base.rtcm3";
    std::ofstream file(path, std::ios::binary);
    for (const Message& message : messages) {
      const auto bytes = framed(message);
      file.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    }
    return path;
  }

  std::string decoded_by_gpsd(const std::vector<Message>& messages) const {
    test::ChildProcess gpsdecode({"sh", "-c", "exec gpsdecode < " + write(messages).string()},
                                 directory_ / "out.json");
    EXPECT_EQ(gpsdecode.wait(), 0);
    return gpsdecode.output();
  }

  /// Numbers of each line by satellite, in the order of the header's types: range, phase, Doppler,
  /// strength of the first signal, then of the second.
  std::map<std::string, std::vector<double>> observed_by_rtklib(
      const std::vector<Message>& messages, std::size_t columns) const {
    const fs::path out = directory_ / "out.obs";
    test::ChildProcess convbin(
        {"convbin", "-r", "rtcm3", "-v", "3.04", "-tr", "2024/06/02", "10:00:00", "-od", "-os",
         "-o", out.string(), write(messages).string()},
        directory_ / "convbin.log");
    EXPECT_EQ(convbin.wait(), 0) << convbin.output();
    std::ifstream file(out);
    std::map<std::string, std::vector<double>> rows;
    bool body = false;
    for (std::string line; std::getline(file, line);) {
      if (body && line[0] != '>') {
        std::vector<double>& row = rows[line.substr(0, 3)];
        row.clear();  // the latest counts
        for (std::size_t i = 0; i < columns && line.size() >= 3 + 16 * i + 14; ++i) {
          const std::string number = line.substr(3 + 16 * i, 14);
          row.push_back(number.find_first_not_of(' ') == std::string::npos ? 0.0
                                                                           : std::stod(number));
        }
      } else if (body) {
        EXPECT_EQ(line.substr(2, 27), "2024 06 02 10 00 30.0000000");
      }
      body = body || line.find("END OF HEADER") != std::string::npos;
    }
    return rows;
  }

  fs::path directory_;
};

TEST_F(Rtcm3ToOthers, GpsdReadsStationHeightAndOlderObservations) {
  AntennaPosition with_height = example_position();
  with_height.antenna_height_m = 1.2345;
  const std::string lines = decoded_by_gpsd({example_position(), with_height, example_descriptors(),
                                             example_legacy(false), example_legacy(true)});
  EXPECT_NE(lines.find(R"("type":1005,"length":19,"station_id":2003)"), std::string::npos) << lines;
  EXPECT_NE(lines.find(R"("x":4139423.1234,"y":550210.9876,"z":-4804002.0005})"),
            std::string::npos);
  EXPECT_NE(lines.find(R"("type":1006,"length":21)"), std::string::npos);
  EXPECT_NE(lines.find(R"("z":-4804002.0005,"h":1.2345})"), std::string::npos);
  EXPECT_NE(lines.find(R"("type":1033,"length":51,"station_id":2003,"desc":"LEIAR25.R4      LEIT",)"
                       R"("setup_id":3,"serial":"","receiver":"LEICA GR50 ","firmware":"4.50"})"),
            std::string::npos);
  EXPECT_NE(lines.find(R"("type":1004,"length":55,"station_id":2003,"tow":36030000,"sync":"true")"),
            std::string::npos);
  // Satellite 5: 26296296.244 m are 87 light milliseconds and 214352.40 m.
  EXPECT_NE(lines.find(R"({"ident":5,"L1":{"ind":0,"prange":214352.40,"delta":41.1215,"lockt":7,)"
                       R"("amb":87,"CNR":36.00})"),
            std::string::npos);
  EXPECT_NE(lines.find(R"("type":1012,"length":57,"station_id":2003,"tow":46812000)"),
            std::string::npos);
}

/// Carriers of the two signals, Hz; GLONASS by channel.
std::pair<double, double> carriers(MsmSystem system, int channel) {
  switch (system) {
    case MsmSystem::gps:
      return {1575.42e6, 1227.60e6};
    case MsmSystem::glonass:
      return {1602e6 + 0.5625e6 * channel, 1246e6 + 0.4375e6 * channel};
    case MsmSystem::galileo:
      return {1575.42e6, 1207.14e6};
    case MsmSystem::beidou:
      return {1561.098e6, 1207.14e6};
  }
  return {};
}

TEST_F(Rtcm3ToOthers, RtklibReadsRangesPhasesAndRatesOfAllForms) {
  constexpr std::string_view kLetters = "GREC";
  for (const MsmForm form : kForms) {
    const bool full = form == MsmForm::seven;
    const bool rates = form != MsmForm::four;
    for (const MultipleSignals& p : example_systems(form)) {
      // RTKLIB learns the channels of GLONASS from MSM5 and MSM7.
      std::vector<Message> messages{example_position()};
      if (p.system == MsmSystem::glonass && !rates) {
        MultipleSignals teacher = example_systems(MsmForm::seven)[1];
        teacher.more = true;
        messages.emplace_back(teacher);
      }
      MultipleSignals alone = p;
      alone.more = false;
      messages.emplace_back(alone);
      const auto rows = observed_by_rtklib(messages, 8);
      ASSERT_EQ(rows.size(), 4U);
      for (std::size_t i = 0; i < p.count; i += 2) {
        const unsigned satellite = p.cells[i].satellite;
        std::string name{kLetters[static_cast<std::size_t>(p.system)]};
        name.append(satellite < 10 ? "0" : "").append(std::to_string(satellite));
        SCOPED_TRACE(name + " MSM" + std::to_string(static_cast<int>(form)));
        const auto found = rows.find(name);
        ASSERT_NE(found, rows.end());
        const auto& row = found->second;
        ASSERT_EQ(row.size(), rates || messages.size() > 2 ? 8U : 6U);
        const auto [first, second] = carriers(p.system, static_cast<int>(satellite % 13) - 6);
        const double range_step_m = kLightMillisecond_m * (full ? 0x1p-29 : 0x1p-24);
        for (std::size_t signal = 0; signal < 2; ++signal) {
          const SignalObservation& o = p.cells[i + signal].observation;
          const double carrier_hz = signal == 0 ? first : second;
          const std::size_t per_signal = row.size() / 2;
          const std::size_t at = per_signal * signal;
          EXPECT_NEAR(row[at], *o.range_m, 0.51 * range_step_m + 6e-4);
          EXPECT_NEAR(row[at + 1], *o.phase_m * carrier_hz / kLightSpeed_mps, 0.003);
          if (rates) {
            EXPECT_NEAR(row[at + 2], -*o.rate_mps * carrier_hz / kLightSpeed_mps, 1.1e-3);
          }
        }
      }
    }
  }
}

// Those of less content gpsd alone reads: 1001, 1003, 1009 and 1011 RTKLIB passes over.
TEST_F(Rtcm3ToOthers, GpsdReadsOlderObservationsOfLessContent) {
  std::vector<Message> messages;
  for (const bool glonass : {false, true}) {
    for (const bool second_band : {false, true}) {
      for (const bool extended : {false, true}) {
        messages.emplace_back(example_legacy(glonass, second_band, extended));
      }
    }
  }
  const std::string lines = decoded_by_gpsd(messages);
  // Satellite 5 of GPS is 87 light milliseconds and 214352.40 m away.
  EXPECT_NE(lines.find(R"("type":1001,"length":30,"station_id":2003,"tow":36030000)"),
            std::string::npos)
      << lines;
  EXPECT_NE(lines.find(R"({"ident":5,"ind":0,"prange":214352.40,"delta":41.1215,"lockt":7})"),
            std::string::npos)
      << lines;
  EXPECT_NE(lines.find(R"("type":1002,"length":36)"), std::string::npos);
  EXPECT_NE(lines.find(R"("prange":214352.40,"delta":41.1215,"lockt":7,"amb":87,"CNR":36.00)"),
            std::string::npos);
  EXPECT_NE(lines.find(R"("type":1003,"length":46)"), std::string::npos);
  EXPECT_NE(lines.find(R"("type":1009,"length":32)"), std::string::npos);
  EXPECT_NE(lines.find(R"("type":1010,"length":38)"), std::string::npos);
  EXPECT_NE(lines.find(R"("type":1011,"length":48)"), std::string::npos);
}

TEST_F(Rtcm3ToOthers, RtklibReadsOlderObservations) {
  for (const auto& [glonass, second_band] :
       {std::pair{false, false}, {false, true}, {true, false}, {true, true}}) {
    LegacyObservations p = example_legacy(glonass, second_band);
    p.more = false;
    const auto rows = observed_by_rtklib({example_position(), p}, 2);
    ASSERT_EQ(rows.size(), p.count);
    for (const auto& s : std::span(p.satellites).first(p.count)) {
      std::string name = glonass ? "R" : "G";
      name.append(s.number < 10 ? "0" : "").append(std::to_string(s.number));
      ASSERT_TRUE(rows.contains(name));
      EXPECT_NEAR(rows.at(name)[0], *s.first.range_m, 0.011);
      const double carrier_hz =
          carriers(glonass ? MsmSystem::glonass : MsmSystem::gps, s.channel).first;
      EXPECT_NEAR(rows.at(name)[1], *s.first.phase_m * carrier_hz / kLightSpeed_mps, 0.003);
    }
  }
}

}  // namespace
}  // namespace rigwire::protocols::rtcm3

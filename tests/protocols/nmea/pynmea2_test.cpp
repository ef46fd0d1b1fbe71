// Every sentence through a parser that is not ours, python3-nmea2; GRS it does not know.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "protocols/nmea/satellite_numbers.h"
#include "protocols/nmea/writers.h"
#include "sentences.h"

namespace rigwire::protocols::nmea {
namespace {

/// Prints, for each line, the parser's name of the sentence and, where it has them, latitude,
/// longitude and altitude.
constexpr const char* kScript = R"(
import sys, pynmea2
for line in open(sys.argv[1]):
    m = pynmea2.parse(line.strip(), check=True)
    name = m.sentence_type if isinstance(m, pynmea2.TalkerSentence) else type(m).__name__
    fix = bool(getattr(m, 'lat', ''))
    print(name, '%.9f %.9f' % (m.latitude, m.longitude) if fix and hasattr(m, 'latitude') else '-')
)";

std::vector<std::string> sentences_of(const Epoch& epoch) {
  std::vector<std::string> lines{text(write_rmc(epoch)),
                                 text(write_vtg(epoch)),
                                 text(write_gga(epoch)),
                                 text(write_gns(epoch)),
                                 text(write_gll(epoch)),
                                 text(write_zda(epoch)),
                                 text(write_gst(epoch)),
                                 text(write_gbs(epoch)),
                                 text(write_dtm(epoch)),
                                 text(write_pubx_position(epoch)),
                                 text(write_pubx_satellites(epoch)),
                                 text(write_pubx_time(epoch, {})),
                                 text(write_txt(epoch.talker, TextKind::notice, "ANTSTATUS=OK"))};
  for (int i = 1; i <= gsa_sentences(epoch); ++i) {
    lines.push_back(text(write_gsa(epoch, i)));
  }
  for (int i = 1; i <= gsv_pages(epoch); ++i) {
    lines.push_back(text(write_gsv(epoch, i)));
  }
  return lines;
}

TEST(NmeaPynmea2, ParsesEverySentenceOfEveryVersion) {
  std::vector<SatelliteInView> satellites;
  Epoch epoch = recorded_epoch(satellites);
  SatelliteInView galileo{11, 40, 120, 41, true};
  galileo.system = System::galileo;
  galileo.signal = 7;
  satellites.push_back(galileo);
  epoch.satellites = satellites;
  epoch.errors = ErrorStatistics{12.0, 1.2, 0.9, 2.5};
  std::vector<std::string> lines;
  for (const Version version :
       {Version::v21, Version::v23, Version::v40, Version::v410, Version::v411}) {
    epoch.version = version;
    epoch.precision = version == Version::v411 ? Precision::high : Precision::normal;
    epoch.systems = version >= Version::v40
                        ? system_bit(System::gps) | system_bit(System::sbas) |
                              system_bit(System::galileo) | system_bit(System::beidou)
                        : 0;
    epoch.talker = main_talker(epoch.systems, version);
    for (const int dimensions : {0, 3}) {
      epoch.fix_dimensions = dimensions;
      const auto more = sentences_of(epoch);
      lines.insert(lines.end(), more.begin(), more.end());
    }
  }
  const std::filesystem::path directory =
      std::filesystem::temp_directory_path() / ("rigwire_nmea_" + std::to_string(::getpid()));
  std::filesystem::create_directory(directory);
  std::ofstream(directory / "script.py") << kScript;
  std::ofstream stream(directory / "lines");
  for (const auto& line : lines) {
    stream << line;
  }
  stream.close();
  const std::string command = "/usr/bin/python3 " + (directory / "script.py").string() + " " +
                              (directory / "lines").string() + " 2>&1";
  std::FILE* const client = ::popen(command.c_str(), "r");
  ASSERT_NE(client, nullptr);
  std::string output;
  for (int c = std::fgetc(client); c != EOF; c = std::fgetc(client)) {
    output.push_back(static_cast<char>(c));
  }
  EXPECT_EQ(::pclose(client), 0) << output << "(package python3-nmea2 is in packages.txt)";
  std::filesystem::remove_all(directory);

  std::istringstream answers(output);
  for (const auto& line : lines) {
    std::string name;
    std::string latitude;
    ASSERT_TRUE(answers >> name >> latitude) << line;
    if (line.starts_with("$PUBX")) {
      EXPECT_EQ(name, "UBX" + line.substr(6, 2));
    } else {
      EXPECT_EQ(name, line.substr(3, 3));
    }
    if (latitude != "-") {
      double longitude_deg = 0.0;
      ASSERT_TRUE(answers >> longitude_deg) << line;
      const bool zero = line.find(",NF,") != std::string::npos;
      EXPECT_NEAR(std::stod(latitude), zero ? 0.0 : epoch.latitude_deg, 1e-7) << line;
      EXPECT_NEAR(longitude_deg, zero ? 0.0 : epoch.longitude_deg, 1e-7) << line;
    }
  }
}

}  // namespace
}  // namespace rigwire::protocols::nmea

// A decoder written from the manuals in Python (velodyne_points.py), which shares no table with us,
// reads from packets of every model and return mode what was put into them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "velodyne_capture.h"
#include "velodyne_comparison.h"
#include "velodyne_stream.h"

namespace rigwire {
namespace {

using namespace protocols::velodyne;

struct Case {
  const char* model;
  ReturnMode mode;
  StatusFormat format = StatusFormat::s2;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << velodyne_test_name(c.model, c.mode);
}

class VelodynePoints : public testing::TestWithParam<Case> {};

TEST_P(VelodynePoints, IndependentDecoderReadsTheTruth) {
  const Model& model = *find_model(GetParam().model);
  const ReturnMode mode = GetParam().mode;
  const auto file = std::filesystem::temp_directory_path() /
                    ("rigwire_points_" + std::to_string(getpid()) + ".pcap");
  UdpCapture capture(file);
  VelodyneStream stream(model, mode, GetParam().format);
  std::vector<TrueReturn> truth;
  // An HDL-64E needs a round of its status channel; most of those packets are left empty.
  const std::size_t packets = model.status_channel ? kStatusPeriod + kStatusCycle : 40;
  for (std::size_t i = 0; i < packets; ++i) {
    const DataPacket packet = stream.next(truth, i >= 40);
    std::array<std::uint8_t, kDataPacketSize> bytes{};
    encode(packet, bytes);
    capture.add(static_cast<std::int64_t>(i) * packet_period_ns(model, mode) / 1000, 2368, bytes,
                model.source_port);
  }
  capture.close();
  const bool first_speed_unknown = firings_per_packet(model, mode) == 1;
  const DecodedDifference worst =
      VelodyneComparison(truth, stream.lasers(), VelodyneStream::kStart_us, first_speed_unknown)
          .run(file);
  EXPECT_EQ(worst.unexpected, "");
  EXPECT_EQ(worst.missing, 0U);
  EXPECT_GT(worst.compared, 40U * 100U);
  EXPECT_LE(worst.range_m, 0.5e-3 * model.distance_unit_mm * 1.01) << "half a unit";
  EXPECT_LE(worst.azimuth_deg, 0.005);
  EXPECT_LE(worst.elevation_deg, 0.0011);
  EXPECT_LE(worst.time_us, 1.0) << "of which the stamp's rounding";
  EXPECT_LE(worst.reflectivity, model.status_channel ? 0.51 : 1e-9);
  // Points of an HDL-64E leave their beam by the difference of the near corrections in x and y.
  EXPECT_LE(worst.place_m, model.status_channel ? 0.04 : 1.5e-4);
  std::filesystem::remove(file);
}

std::string name_of(const testing::TestParamInfo<Case>& info) {
  return velodyne_test_name(info.param.model, info.param.mode);
}

INSTANTIATE_TEST_SUITE_P(
    EveryModel, VelodynePoints,
    testing::Values(Case{"HDL-32E", ReturnMode::strongest}, Case{"HDL-32E", ReturnMode::last},
                    Case{"HDL-32E", ReturnMode::dual}, Case{"VLP-16", ReturnMode::strongest},
                    Case{"VLP-16", ReturnMode::dual}, Case{"Puck Hi-Res", ReturnMode::last},
                    Case{"Puck Hi-Res", ReturnMode::dual}, Case{"VLP-32C", ReturnMode::strongest},
                    Case{"VLP-32C", ReturnMode::dual}, Case{"HDL-64E S2", ReturnMode::strongest},
                    Case{"HDL-64E S3", ReturnMode::strongest, StatusFormat::s3},
                    Case{"HDL-64E S3", ReturnMode::dual, StatusFormat::s3},
                    Case{"VLS-128", ReturnMode::strongest}, Case{"VLS-128", ReturnMode::dual}),
    name_of);

}  // namespace
}  // namespace rigwire

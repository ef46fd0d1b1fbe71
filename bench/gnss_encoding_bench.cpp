#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "bench/gnss_bench.h"
#include "emulators/ublox/receiver.h"
#include "protocols/nmea/readers.h"
#include "protocols/ubx/navigation.h"
#include "sim/local_frame.h"
#include "sim/random.h"

namespace rigwire::bench {
namespace {

namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

constexpr std::uint64_t kSeed = 4;

class Collector final : public emulators::ByteOutput {
 public:
  void send(SimTime /*due*/, std::span<const std::uint8_t> bytes) override {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::exchange(bytes_, {}); }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// The way round the circle, so that 180 deg and -180 deg are the same place.
double angle_error_deg(double read_deg, double true_deg) {
  return std::abs(std::remainder(read_deg - true_deg, 360.0));
}

/// Worst errors over all positions; latitude and longitude share a unit.
struct Worst {
  double nav_e7deg = 0.0;
  double nav_height_mm = 0.0;
  double high_precision_e9deg = 0.0;
  double gga_e5min = 0.0;
  double gga_altitude_dm = 0.0;
};

void compare(const ubx::FrameView& frame, const GnssSample& truth, Worst& worst) {
  if (const auto llh = ubx::decode<ubx::NavPosllh>(frame); llh.ok()) {
    worst.nav_e7deg = std::max(
        {worst.nav_e7deg, 1e7 * angle_error_deg(1e-7 * llh->latitude_e7deg, truth.latitude_deg),
         1e7 * angle_error_deg(1e-7 * llh->longitude_e7deg, truth.longitude_deg)});
    worst.nav_height_mm = std::max(
        worst.nav_height_mm, std::abs(llh->ellipsoid_height_mm - 1e3 * truth.ellipsoid_height_m));
  } else if (const auto fine = ubx::decode<ubx::NavHpposllh>(frame); fine.ok()) {
    const double latitude_deg = 1e-7 * fine->latitude_e7deg + 1e-9 * fine->latitude_rest_e9deg;
    const double longitude_deg = 1e-7 * fine->longitude_e7deg + 1e-9 * fine->longitude_rest_e9deg;
    worst.high_precision_e9deg = std::max(
        {worst.high_precision_e9deg, 1e9 * angle_error_deg(latitude_deg, truth.latitude_deg),
         1e9 * angle_error_deg(longitude_deg, truth.longitude_deg)});
  }
}

void compare(const nmea::Gga& gga, const GnssSample& truth, Worst& worst) {
  worst.gga_e5min =
      std::max({worst.gga_e5min, 60e5 * angle_error_deg(gga.latitude_deg, truth.latitude_deg),
                60e5 * angle_error_deg(gga.longitude_deg, truth.longitude_deg)});
  worst.gga_altitude_dm = std::max(
      worst.gga_altitude_dm,
      std::abs(10.0 * (gga.altitude_m - (truth.ellipsoid_height_m - truth.geoid_separation_m))));
}

void compare_all(std::span<const std::uint8_t> bytes, const GnssSample& truth, Worst& worst) {
  while (!bytes.empty()) {
    std::size_t used = 1;
    if (bytes[0] == ubx::kSync1) {
      if (const auto frame = ubx::decode_frame(bytes); frame.ok()) {
        compare(*frame, truth, worst);
        used = frame.consumed();
      }
    } else if (bytes[0] == '$') {
      if (const auto sentence = nmea::decode_sentence(bytes); sentence.ok()) {
        if (const auto gga = nmea::read_gga(*sentence); gga.ok() && gga->quality > 0) {
          compare(*gga, truth, worst);
        }
        used = sentence.consumed();
      }
    }
    bytes = bytes.subspan(used);
  }
}

/// Anywhere on earth, the corners more often than chance would have them.
GnssSample somewhere(sim::RandomStream& random) {
  GnssSample sample;
  sample.fix = GnssFix::three_d;
  const double corner = random.uniform();
  sample.latitude_deg = corner < 0.05   ? 90.0 - 1e-7 * random.uniform()
                        : corner < 0.10 ? -90.0 + 1e-7 * random.uniform()
                                        : random.uniform(-90.0, 90.0);
  sample.longitude_deg = corner < 0.15   ? 180.0 - 1e-7 * random.uniform()
                         : corner < 0.20 ? -180.0 + 1e-7 * random.uniform()
                                         : random.uniform(-180.0, 180.0);
  sample.ellipsoid_height_m = random.uniform(-400.0, 9000.0);
  sample.geoid_separation_m = random.uniform(-100.0, 80.0);
  sample.horizontal_accuracy_m = 2.0;
  sample.vertical_accuracy_m = 3.0;
  sample.speed_accuracy_mps = 0.1;
  sample.horizontal_dilution = sample.time_dilution = 1.0;
  sample.vertical_dilution = 1.5;
  sample.position_dilution = 1.8;
  for (std::uint8_t prn = 1; prn <= 8; ++prn) {
    sample.satellites.push_back({prn, 0.7 * prn, 0.15 * prn, 40.0, true, true});
  }
  return sample;
}

}  // namespace

std::vector<PositionEncoding> measure_position_encoding(std::size_t positions) {
  emulators::UbloxSettings settings;
  settings.profile = &emulators::ublox_zed_f9p();
  settings.baud = 460'800;
  settings.measurement_period = std::chrono::milliseconds{50};
  settings.start_up = Duration{0};
  settings.solution_latency = Duration{0};
  settings.start_banner = false;
  settings.nmea_sentences = {"GGA"};
  settings.ubx_messages = {"NAV-POSLLH", "NAV-HPPOSLLH"};
  Collector line;
  const Calendar calendar({2026, 6, 1, 8, 0, 0, 0});
  emulators::UbloxReceiver receiver(settings, calendar, line);
  sim::RandomStream random(kSeed, "positions");
  Worst worst;
  SimTime time = kStart + settings.measurement_period;
  for (std::size_t i = 0; i < positions; ++i, time += settings.measurement_period) {
    GnssSample sample = somewhere(random);
    sample.time = time;
    receiver.update(sample);
    receiver.advance(time + settings.measurement_period - Duration{1});
    const std::vector<std::uint8_t> bytes = line.take();
    compare_all(bytes, sample, worst);
  }
  return {{"NAV-POSLLH, degrees", 0.5, worst.nav_e7deg, "1e-7 deg", positions},
          {"NAV-POSLLH, height", 0.5, worst.nav_height_mm, "mm", positions},
          {"NAV-HPPOSLLH, degrees", 0.5, worst.high_precision_e9deg, "1e-9 deg", positions},
          {"GGA, minutes", 0.5, worst.gga_e5min, "1e-5 minutes", positions},
          {"GGA, altitude", 0.5, worst.gga_altitude_dm, "0.1 m", positions}};
}

}  // namespace rigwire::bench

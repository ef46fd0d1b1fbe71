// A receiver without errors, recorded as RINEX text with the truth beside it, and RTKLIB to work on
// the recording.
#pragma once

#include <unistd.h>

#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "child_process.h"
#include "fields/constants.h"
#include "rinex_text.h"
#include "sim/gnss/observations.h"
#include "sim/local_frame.h"

namespace rigwire::sim {

struct AntennaMotion {
  Eigen::Vector3d p_W;
  Eigen::Vector3d v_W;
};

/// What was true at an epoch, earth-fixed, and what the receiver's clock showed.
struct RecordedTruth {
  std::int64_t label_ns = 0;  ///< Since 1980-01-06.
  Eigen::Vector3d position_E_m;
  Eigen::Vector3d velocity_E_mps;
};

struct Recording {
  std::string observations;
  std::string navigation;
  std::vector<RecordedTruth> truth;
};

/// An epoch a second, every satellite above five degrees, delayed by the atmosphere's models or
/// not.
inline Recording record(const Constellation& constellation, const Calendar& calendar,
                        const LocalFrame& frame, ReceiverClock clock, int epochs, bool atmosphere,
                        const std::function<AntennaMotion(double)>& motion) {
  Observations observations(constellation.satellites().size(), 1, "ambiguity");
  Recording recording;
  recording.observations = test::rinex_observation_header();
  std::shared_ptr<const GpsNavigation> broadcast;
  std::vector<TrackedSignal> signals;
  std::vector<GnssMeasurement> measurements;
  for (int i = 0; i < epochs; ++i) {
    const SimTime t = kStart + i * std::chrono::seconds{1};
    const ClockEpoch epoch = clock.measure(t);
    const auto [p_W, v_W] = motion(to_seconds(t) + epoch.measured_after_s);
    const GpsTime wanted = calendar.gps(t);
    const ReceptionPoint antenna = reception_point(wanted, epoch, frame.to_ecef(p_W),
                                                   frame.world_from_ecef().transpose() * v_W);
    if (const auto now = constellation.navigation(wanted); now != broadcast) {
      if (!broadcast) {
        recording.navigation = test::rinex_navigation_header(now->ionosphere);
      }
      broadcast = now;
      for (const auto& set : broadcast->ephemerides) {
        recording.navigation += set ? test::rinex_ephemeris(*set) : "";
      }
    }

    const GeodeticPoint point = frame.to_geodetic(p_W);
    const Eigen::Matrix3d ned_from_ecef = frame.ned_from_world(p_W) * frame.world_from_ecef();
    signals.clear();
    for (std::size_t satellite = 0; satellite < constellation.satellites().size(); ++satellite) {
      const Eigen::Vector3d ned =
          ned_from_ecef * signal_path(constellation, satellite, antenna).direction_E;
      const double elevation_rad = std::asin(-ned.z());
      if (elevation_rad < 5.0 * kDegree) {
        continue;
      }
      TrackedSignal signal;
      signal.satellite = satellite;
      if (atmosphere) {
        signal.ionosphere_m =
            klobuchar_delay_m(broadcast->ionosphere, point.latitude_deg * kDegree,
                              point.longitude_deg * kDegree, std::atan2(ned.y(), ned.x()),
                              elevation_rad, static_cast<double>(wanted.time_of_week_ns) * 1e-9);
        signal.troposphere_m = saastamoinen_delay_m(point.latitude_deg * kDegree,
                                                    point.ellipsoid_height_m, elevation_rad);
      }
      signals.push_back(signal);
    }
    observations.measure(constellation, t, epoch, antenna, signals, measurements);
    const std::int64_t label_ns = std::int64_t{wanted.week} * 604'800'000'000'000 +
                                  wanted.time_of_week_ns + epoch.label_offset.count();
    recording.observations += test::rinex_epoch(label_ns, measurements);
    recording.truth.push_back({label_ns, antenna.position_E_m, antenna.velocity_E_mps});
  }
  return recording;
}

/// A line of RTKLIB's solution in earth-fixed coordinates.
struct ClientFix {
  std::int64_t time_ns = 0;  ///< Since 1980-01-06.
  int quality = 0;           ///< 1 fixed, 2 floating, 5 single.
  Eigen::Vector3d position_E_m;
  Eigen::Vector3d velocity_E_mps;
};

/// rnx2rtkp run over files in a folder of its own, which goes with the object.
class RtklibRun {
 public:
  explicit RtklibRun(const std::string& name)
      : folder_(std::filesystem::temp_directory_path() /
                ("rigwire-rtklib-" + std::to_string(::getpid()) + "-" + name)) {
    std::filesystem::create_directories(folder_);
  }
  ~RtklibRun() { std::filesystem::remove_all(folder_); }
  RtklibRun(const RtklibRun&) = delete;
  RtklibRun& operator=(const RtklibRun&) = delete;

  void file(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    files_.push_back(folder_ / name);
  }

  /// The fixes, or nothing when the program failed. Files as they were given, observations first.
  std::optional<std::vector<ClientFix>> solve(const std::string& options) {
    std::ofstream(folder_ / "options.conf")
        << options
        << "pos1-sateph=brdc\npos1-navsys=1\npos1-elmask=4\nout-solformat=xyz\nout-outvel=on\n"
           "out-timesys=gpst\nout-timeform=tow\nout-timendec=6\nout-outhead=off\n";
    std::vector<std::string> command{"rnx2rtkp", "-k", folder_ / "options.conf", "-o",
                                     folder_ / "fix.pos"};
    command.insert(command.end(), files_.begin(), files_.end());
    test::ChildProcess client(command, folder_ / "log");
    if (client.wait() != 0) {
      return std::nullopt;
    }
    std::vector<ClientFix> fixes;
    std::ifstream lines(folder_ / "fix.pos");
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line.front() == '%') {
        continue;
      }
      std::istringstream words(line);
      std::int64_t week = 0;
      double tow_s = 0.0;
      double skipped = 0.0;
      ClientFix fix;
      words >> week >> tow_s >> fix.position_E_m.x() >> fix.position_E_m.y() >>
          fix.position_E_m.z() >> fix.quality;
      for (int i = 0; i < 9; ++i) {
        words >> skipped;  // satellites, six deviations, age, ratio
      }
      words >> fix.velocity_E_mps.x() >> fix.velocity_E_mps.y() >> fix.velocity_E_mps.z();
      if (!words) {
        return std::nullopt;
      }
      fix.time_ns = week * 604'800'000'000'000 + std::llround(tow_s * 1e9);
      fixes.push_back(fix);
    }
    return fixes;
  }

 private:
  std::filesystem::path folder_;
  std::vector<std::string> files_;
};

/// The truth of the epoch that a fix is of; null when none is within two milliseconds.
inline const RecordedTruth* truth_of(const Recording& recording, const ClientFix& fix) {
  for (const RecordedTruth& truth : recording.truth) {
    if (std::abs(truth.label_ns - fix.time_ns) < 2'000'000) {
      return &truth;
    }
  }
  return nullptr;
}

}  // namespace rigwire::sim

// What a satellite receiver's antenna and navigation engine measure at one epoch, in SI units.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "sim/samples/gps_navigation.h"
#include "sim/samples/time.h"
#include "sim/samples/vector3.h"

namespace rigwire {

/// Quality of the position, in the words of Wolf et al. 2020, Eq. 3.
enum class GnssFix : std::uint8_t {
  none,     ///< No Fix: at most one satellite.
  bad,      ///< Bad Fix: two satellites; no position either.
  two_d,    ///< Three satellites (or an empty quadrant, where that rule is switched on).
  three_d,  ///< More than three satellites.
};

/// What the carrier phase adds to the position.
enum class CarrierSolution : std::uint8_t { none, floating, fixed };

/// Satellite systems; the values are those that receivers commonly number them by.
enum class GnssSystem : std::uint8_t {
  gps = 0,
  sbas = 1,
  galileo = 2,
  beidou = 3,
  imes = 4,
  qzss = 5,
  glonass = 6,
};

/// One satellite above the receiver's horizon.
struct SatelliteView {
  /// Within its system: GPS PRN 1..32, SBAS PRN 120..158, Galileo 1..36, BeiDou 1..63,
  /// QZSS 1..10, GLONASS slot 1..32.
  std::uint8_t number = 0;
  double azimuth_rad = 0.0;    ///< Clockwise from north, [0, 2 pi).
  double elevation_rad = 0.0;  ///< Above the horizon.
  double cn0_dbhz = 0.0;       ///< Carrier-to-noise density; 0 when not tracked.
  bool tracked = false;        ///< A signal arrives, strong enough.
  bool used = false;           ///< Takes part in the fix.
  GnssSystem system = GnssSystem::gps;
  bool corrected = false;   ///< Corrections for it are applied (SBAS, RTCM).
  double residual_m = 0.0;  ///< Pseudorange less what the fix explains; when used.
};

/// Raw measurement of one tracked signal (gnss_carriers.h), at the receiver's own time of
/// measurement.
struct GnssMeasurement {
  GnssSystem system = GnssSystem::gps;
  std::uint8_t number = 0;  ///< Number as in SatelliteView.
  bool second = false;      ///< On the system's second carrier, not the first.
  std::int8_t channel = 0;  ///< Channel of GLONASS' carriers.
  double pseudorange_m = 0.0;
  double carrier_phase_cycles = 0.0;  ///< Grows with the range; ambiguous by whole cycles.
  double doppler_hz = 0.0;            ///< Positive while the satellite comes nearer.
  double cn0_dbhz = 0.0;
  Duration locked{0};    ///< Carrier tracked without a slip for so long.
  bool slipped = false;  ///< The lock is younger than the epoch before.
  double pseudorange_sigma_m = 0.0;
  double carrier_sigma_cycles = 0.0;
  double doppler_sigma_hz = 0.0;
};

enum class AntennaState : std::uint8_t { ok, short_circuit, open };

/// State of the radio part.
struct RadioState {
  AntennaState antenna = AntennaState::ok;
  double jamming = 0.0;   ///< 0 none .. 1 overwhelming, continuous wave or broad.
  double noise_db = 0.0;  ///< Noise floor above that of an undisturbed receiver.
  /// Jamming and noise of the second band (L2, E5b, B2), for a receiver that has it.
  double second_jamming = 0.0;
  double second_noise_db = 0.0;
};

/// One epoch of a base station, as its messages report it to the receiver.
struct GnssCorrections {
  /// What the station measured of a signal.
  struct Signal {
    GnssSystem system = GnssSystem::gps;
    std::uint8_t number = 0;    ///< Number as in SatelliteView.
    bool second = false;        ///< Second band (L2, E5b, B2), not the first.
    double range_m = 0.0;       ///< Pseudorange; NaN: none.
    double phase_m = 0.0;       ///< Carrier phase times wavelength; NaN: none.
    double wavelength_m = 0.0;  ///< 0: unknown, for instance GLONASS without its channel.
    /// Range and phase are known up to whole multiples of this; 0: in full.
    double modulus_m = 0.0;
  };
  SimTime measured{};   ///< By GPS time.
  Vector3 station_E_m;  ///< Reported place of its antenna's reference point, earth-fixed.
  bool moving = false;  ///< It reports its place at each epoch.
  std::vector<Signal> signals;
  Duration largest_age = std::chrono::seconds{60};  ///< Older ones are not used.
  bool floating_only = false;                       ///< The receiver is set not to fix ambiguities.
};

/// What a receiver's settings and the messages at its ports ask of its navigation engine.
struct GnssCommand {
  /// Bit by GnssSystem: whose satellites may take part in the fix, and are measured.
  std::uint8_t systems = 0xFF;
  /// Bit by GnssSystem: whose second signals are measured.
  std::uint8_t second_signals = 0xFF;
  double minimum_elevation_rad = 0.0;
  double minimum_cn0_dbhz = 0.0;
  std::uint32_t maximum_satellites = 255;  ///< In the fix; the strongest ones.
  /// Fixes in two dimensions at this height above the geoid, m; empty: in three where possible.
  std::optional<double> altitude_m;
  /// Accelerations that it reckons with: white, m/s per sqrt(s), per axis.
  double horizontal_acceleration = 0.45;
  double vertical_acceleration = 0.32;
  bool stationary = false;   ///< It takes its velocity for zero.
  std::uint32_t starts = 0;  ///< Grows when the receiver starts anew: its engine forgets.
  /// Newest corrections of a base station; null: none was received yet.
  std::shared_ptr<const GnssCorrections> corrections;

  [[nodiscard]] bool uses(GnssSystem system) const {
    return (systems >> static_cast<unsigned>(system) & 1U) != 0;
  }
  [[nodiscard]] bool uses_second(GnssSystem system) const {
    return uses(system) && (second_signals >> static_cast<unsigned>(system) & 1U) != 0;
  }
  friend bool operator==(const GnssCommand&, const GnssCommand&) = default;
};

/// One navigation epoch. Position, velocity and accuracies are meaningful only when `fix` is two_d
/// or three_d, or what the receiver goes on saying of them when `predicted`; dilutions are NaN when
/// not available.
struct GnssSample {
  SimTime time{};  ///< The epoch that the receiver wanted.
  /// The receiver measures when its own clock shows a whole millisecond, the one nearest to `time`:
  /// so much later than `time` by true time, within half a millisecond. Position and velocity are
  /// of that instant.
  Duration measured_after{0};
  /// The millisecond that the receiver's clock then shows, less `time`: -1, 0 or 1 ms.
  Duration clock_label_offset{0};
  bool clock_reset =
      false;  ///< The receiver's clock was set by a millisecond since the last epoch.
  GnssFix fix = GnssFix::none;
  /// No fix, but the engine's prediction since the last one: the last position, the velocity that
  /// it holds, and accuracies that grow.
  bool predicted = false;
  CarrierSolution carrier = CarrierSolution::none;
  bool differential = false;  ///< Corrections (SBAS, RTCM, a service) are applied.
  std::optional<double> differential_age_s;
  double latitude_deg = 0.0;   ///< WGS-84 geodetic, of the antenna, error included.
  double longitude_deg = 0.0;  ///< [-180, 180).
  double ellipsoid_height_m = 0.0;
  double geoid_separation_m = 0.0;     ///< Height of the geoid above the ellipsoid, there.
  Vector3 velocity_ned_mps;            ///< x north, y east, z down; error included.
  double horizontal_accuracy_m = 0.0;  ///< The receiver's own estimate, 1 sigma.
  double vertical_accuracy_m = 0.0;
  /// Its estimate in full, m2: north-north, north-east, north-down, east-east, east-down,
  /// down-down.
  std::array<double, 6> position_covariance_ned_m2{};
  double speed_accuracy_mps = 0.0;
  double time_accuracy_s = 0.0;
  double clock_bias_s = 0.0;  ///< Receiver clock minus GPS time, at the measurement.
  double clock_drift = 0.0;   ///< Seconds per second.
  double horizontal_dilution = std::numeric_limits<double>::quiet_NaN();
  double vertical_dilution = std::numeric_limits<double>::quiet_NaN();
  double position_dilution = std::numeric_limits<double>::quiet_NaN();
  double time_dilution = std::numeric_limits<double>::quiet_NaN();
  double north_dilution = std::numeric_limits<double>::quiet_NaN();  ///< With geometric dilution.
  double east_dilution = std::numeric_limits<double>::quiet_NaN();   ///< With geometric dilution.
  RadioState radio;
  std::vector<SatelliteView> satellites;  ///< Above the horizon, by system and number.
  /// Measurements of the tracked satellites, when raw measurements are switched on: by system and
  /// number, the first signal before the second.
  std::vector<GnssMeasurement> measurements;
  /// What the satellites broadcast at that time; null when nothing needs it.
  std::shared_ptr<const GpsNavigation> navigation;
};

}  // namespace rigwire

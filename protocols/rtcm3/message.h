// Messages of RTCM 3 that reference stations send and rovers take: station, its antenna and
// receiver, observations in their older form and as multiple signal messages, GLONASS biases, and a
// moving base's own.
//
// Encoder and decoder of a message walk one description of its fields, so that what one writes the
// other reads. Values are SI and full: ranges in metres, put together from what a message splits
// them into; a value that a message says it has not is nothing (std::optional), and so is one that
// does not fit its field when it is written. Decoders check every length, and that the masks of
// multiple signal messages can be; bits beyond a message's own are ignored, as the standard asks.
//
// Sources: RTCM 10403.3, sections 3.3 to 3.5 (fields, multiple signal messages, "MSM"), as RTKLIB
// (rtcm3.c, rtcm3e.c), gpsd (driver_rtcm3.c) and pyrtcm read it; lengths by recordings of ZED-F9P
// and ZED-F9T. 4072 is not published: the content here is our own, and a real receiver does not
// take it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

#include "protocols/result.h"
#include "protocols/rtcm3/frame.h"

namespace rigwire::protocols::rtcm3 {

/// Added to the frequency channels of GLONASS, -7 .. 13, where they are sent (DF040).
inline constexpr int kChannelOffset = 7;

inline constexpr double kLightSpeed_mps = 299'792'458.0;
inline constexpr double kLightMillisecond_m = kLightSpeed_mps * 1e-3;

inline constexpr std::uint16_t kGreatestStation = 4095;

/// 1005, and 1006 with the height of the antenna.
struct AntennaPosition {
  std::uint16_t station = 0;   ///< DF003.
  std::uint8_t itrf_year = 0;  ///< DF021; 0: not said.
  bool gps = true;             ///< Systems that the station serves.
  bool glonass = true;
  bool galileo = true;
  bool computed = false;               ///< A network's, at no physical place (DF141).
  bool single_oscillator = true;       ///< All systems are measured by one clock (DF142).
  std::uint8_t quarter_cycles = 0;     ///< DF364.
  std::array<double, 3> position_m{};  ///< Earth-fixed, of the antenna's reference point; 0.1 mm.
  std::optional<double> antenna_height_m{};  ///< 1006; 0 .. 6.5535 m.

  friend bool operator==(const AntennaPosition&, const AntennaPosition&) = default;
};

/// 1230: what the station's GLONASS code is ahead of its carrier, by signal.
struct GlonassBiases {
  std::uint16_t station = 0;
  bool aligned = true;  ///< The observations are corrected by them already.
  /// L1 C/A, L1 P, L2 C/A, L2 P, m in steps of 0.02.
  std::array<std::optional<double>, 4> biases_m{};

  friend bool operator==(const GlonassBiases&, const GlonassBiases&) = default;
};

/// 1033: what the station's antenna and receiver are, by which rovers know its GLONASS biases.
struct StationDescriptors {
  /// Up to 31 characters, as the counter in front of them may say (DF029).
  struct Text {
    static constexpr std::size_t kGreatest = 31;

    std::uint8_t size = 0;
    std::array<char, kGreatest> characters{};

    Text() = default;
    /// What is longer is cut.
    explicit Text(std::string_view text);
    [[nodiscard]] std::string_view text() const { return {characters.data(), size}; }
    friend bool operator==(const Text& a, const Text& b) { return a.text() == b.text(); }
  };

  std::uint16_t station = 0;
  Text antenna;             ///< Antenna name of the IGS, with its radome.
  std::uint8_t set_up = 0;  ///< Changes with every change of the antenna (DF031).
  Text antenna_serial;
  Text receiver;
  Text firmware;
  Text receiver_serial;

  friend bool operator==(const StationDescriptors&, const StationDescriptors&) = default;
};

/// What is measured of one signal, in the older messages and in the newer ones.
struct SignalObservation {
  std::optional<double> range_m;   ///< Pseudorange.
  std::optional<double> phase_m;   ///< Carrier phase times wavelength; grows with the range.
  std::optional<double> rate_mps;  ///< Rate of the phase; in MSM5 and MSM7 only.
  double locked_s = 0.0;           ///< Min time since the last slip.
  bool half_cycle = false;         ///< The phase may be off by half a cycle; MSM only.
  double cn0_dbhz = 0.0;           ///< 0: not said.

  friend bool operator==(const SignalObservation&, const SignalObservation&) = default;
};

/// 1001 to 1004 GPS, 1009 to 1012 GLONASS: one carrier or both, each extended or not. Messages that
/// are not extended have no strengths, and their ranges, and with them the phases, are known except
/// for whole multiples of a light millisecond, of GLONASS two: they are read as less than one of
/// these.
struct LegacyObservations {
  struct Satellite {
    std::uint8_t number = 0;       ///< DF009 (40 .. are SBAS), DF038.
    std::int8_t channel = 0;       ///< GLONASS: -7 .. 13.
    bool first_precise = false;    ///< P(Y) or P code on L1.
    std::uint8_t second_code = 0;  ///< DF016, DF046.
    SignalObservation first;       ///< L1. Without a range the satellite is not written.
    SignalObservation second;      ///< L2; within 163 m of the first one's range.

    friend bool operator==(const Satellite&, const Satellite&) = default;
  };
  static constexpr std::size_t kGreatest = 31;

  bool glonass = false;
  bool second_band = true;
  bool extended = true;
  std::uint16_t station = 0;
  std::uint32_t time_ms = 0;  ///< GPS: of week. GLONASS: of day, Moscow time.
  bool more = false;          ///< Other systems' observations of that time follow (DF005).
  bool divergence_free = false;
  std::uint8_t smoothing = 0;
  std::size_t count = 0;
  std::array<Satellite, kGreatest> satellites{};

  friend bool operator==(const LegacyObservations&, const LegacyObservations&) = default;
};

/// What ranges of messages that are not extended are known to.
[[nodiscard]] constexpr double legacy_modulus_m(bool glonass) {
  return (glonass ? 2.0 : 1.0) * kLightMillisecond_m;
}

enum class MsmSystem : std::uint8_t { gps, glonass, galileo, beidou };

/// Numbers of signals within the mask (DF395), and what they are: RINEX 3 codes.
namespace msm_signal {
inline constexpr std::uint8_t kGps1C = 2;
inline constexpr std::uint8_t kGps2L = 16;
inline constexpr std::uint8_t kGlonass1C = 2;
inline constexpr std::uint8_t kGlonass2C = 8;
inline constexpr std::uint8_t kGalileo1C = 2;
inline constexpr std::uint8_t kGalileo7Q = 15;
inline constexpr std::uint8_t kBeidou2I = 2;
inline constexpr std::uint8_t kBeidou7I = 14;
}  // namespace msm_signal

/// MSM4: ranges, phases; MSM5: and range rates; MSM7: all of that, finer. The value is the last
/// digit of the message's number.
enum class MsmForm : std::uint8_t { four = 4, five = 5, seven = 7 };

/// 1074, 1084, 1094, 1124 (MSM4), 1075, 1085, 1095, 1125 (MSM5) and 1077, 1087, 1097, 1127 (MSM7).
struct MultipleSignals {
  struct Cell {
    std::uint8_t satellite = 0;  ///< 1 .. 64.
    std::uint8_t signal = 0;     ///< 1 .. 32.
    SignalObservation observation;

    friend bool operator==(const Cell&, const Cell&) = default;
  };
  static constexpr std::size_t kGreatest = 64;  ///< Cells, and satellites times signals.

  MsmSystem system = MsmSystem::gps;
  MsmForm form = MsmForm::seven;
  std::uint16_t station = 0;
  std::uint32_t epoch =
      0;                   ///< DF004, DF248, DF427, or day and time of day of GLONASS; msm_epoch().
  bool more = false;       ///< Further messages of this epoch follow.
  std::uint8_t issue = 0;  ///< Issue of the station's data (DF409).
  std::uint8_t clock_steering = 0;
  std::uint8_t external_clock = 0;
  bool divergence_free = false;
  std::uint8_t smoothing = 0;
  std::size_t count = 0;
  /// By satellite, then signal; satellites times signals at most kGreatest, of a satellite at
  /// least one with a range. MSM5 and MSM7 of GLONASS: the channels of `channels`.
  std::array<Cell, kGreatest> cells{};
  /// By satellite less 1, -7 .. 7; empty: not said.
  std::array<std::optional<std::int8_t>, kGreatest> channels{};

  friend bool operator==(const MultipleSignals&, const MultipleSignals&) = default;
};

/// 4072 subtype 0, in this project's own form: where a base is that moves, and how fast, at its
/// epoch.
struct MovingBase {
  std::uint16_t station = 0;
  std::uint32_t time_of_week_ms = 0;     ///< GPS.
  std::array<double, 3> position_m{};    ///< Earth-fixed; 0.1 mm.
  std::array<double, 3> velocity_mps{};  ///< Within 262 m/s; 1 mm/s.

  friend bool operator==(const MovingBase&, const MovingBase&) = default;
};

using Message = std::variant<AntennaPosition, GlonassBiases, StationDescriptors, LegacyObservations,
                             MultipleSignals, MovingBase>;

[[nodiscard]] std::uint16_t number_of(const Message& message);

/// What a frame's payload says. Malformed: a number that is none of the above, a length that is too
/// short for it, or masks or lengths of texts that cannot be.
[[nodiscard]] Decoded<Message> decode_message(std::span<const std::uint8_t> payload);

/// Writes the frame; its size, at most kGreatestFrame. Precondition: `out` holds that.
std::size_t encode(const Message& message, std::span<std::uint8_t> out);

/// Returns an epoch as a system's messages count it, from GPS time of week: BeiDou is 14 s behind,
/// GLONASS goes by Moscow time and its day of the week.
[[nodiscard]] std::uint32_t msm_epoch(MsmSystem system, std::uint32_t gps_time_of_week_ms,
                                      int leap_seconds);
/// Converts back. Empty: not an epoch of that system, such as GLONASS without a day (7), which only
/// a caller that knows the day can resolve.
[[nodiscard]] std::optional<std::uint32_t> gps_time_of_week_ms(MsmSystem system,
                                                               std::uint32_t epoch,
                                                               int leap_seconds);

/// Lock times as messages count them: DF013 (older), DF402 (MSM4, MSM5), DF407 (MSM7). The counts
/// grow with the time, a time is the minimum of its count.
[[nodiscard]] std::uint32_t legacy_lock_count(double locked_s);
[[nodiscard]] double legacy_lock_s(std::uint32_t count);
[[nodiscard]] std::uint32_t msm4_lock_count(double locked_s);
[[nodiscard]] double msm4_lock_s(std::uint32_t count);
[[nodiscard]] std::uint32_t msm7_lock_count(double locked_s);
[[nodiscard]] double msm7_lock_s(std::uint32_t count);

}  // namespace rigwire::protocols::rtcm3

// What a u-blox receiver gets from a base station, assembled from the RTCM 3 messages of all its
// ports: the station's position (1005, 1006, or 4072 of a moving one), and one epoch of its
// observations (MSM4, MSM5, MSM7, 1001 to 1004, 1009 to 1012), complete with the message that says
// that no other follows.
//
// Observations count only with the position of the same station. 1230 and 1033, by which GLONASS
// carriers of another make could be fixed, are understood but have no effect: the engine does not
// use the carriers of GLONASS. Of the messages that a ZED-F9P takes, 1007, an antenna's name, is
// counted and not used; a ZED-F9P of this firmware no longer takes 4072.1 (it is "only valid with
// firmware version HPG 1.12").
//
// Sources: ZED-F9P integration manual UBX-18010802, tables 6 and 7 (messages), section 3.1.5 (which
// of them make a solution); interface description HPG 1.50, CFG-RTCM (stations).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "emulators/ublox/solution.h"
#include "protocols/rtcm3/message.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

/// CFG-RTCM-DF003_IN_FILTER and DF003_IN, CFG-NAVSPG-CONSTR_DGNSSTO and CFG-NAVHPG-DGNSSMODE.
struct UbloxCorrectionRules {
  enum class Filter : std::uint8_t { off, relaxed, strict };
  Filter filter = Filter::off;
  std::uint16_t station = 0;
  Duration largest_age = std::chrono::seconds{60};
  bool floating_only = false;
};

class UbloxCorrectionInput {
 public:
  explicit UbloxCorrectionInput(const Calendar& calendar) : calendar_(calendar) {}

  /// Takes a message that came at `now`; whether it is of use (RXM-RTCM: "used").
  bool take(SimTime now, const protocols::rtcm3::FrameView& frame,
            const UbloxCorrectionRules& rules);
  void forget();

  /// Null before the first complete epoch; another object with each.
  [[nodiscard]] const std::shared_ptr<const GnssCorrections>& newest() const { return newest_; }
  /// The station that it is of.
  [[nodiscard]] const std::optional<UbloxBase>& base() const { return base_; }

 private:
  bool take(const protocols::rtcm3::AntennaPosition& m);
  bool take(const protocols::rtcm3::MovingBase& m, SimTime now);
  bool take(const protocols::rtcm3::MultipleSignals& m, SimTime now);
  bool take(const protocols::rtcm3::LegacyObservations& m, SimTime now);
  /// The epoch that observations of that station and instant belong to; null: they are of no use.
  [[nodiscard]] GnssCorrections* epoch_of(std::uint16_t station, std::optional<SimTime> measured);
  void close();

  Calendar calendar_;
  UbloxCorrectionRules rules_;
  std::optional<protocols::rtcm3::AntennaPosition> place_;
  std::optional<UbloxBase> moving_;
  std::optional<GnssCorrections> open_;  ///< The epoch being put together ...
  std::uint16_t open_station_ = 0;       ///< ... and whose it is.
  std::shared_ptr<const GnssCorrections> newest_;
  std::optional<UbloxBase> base_;
};

}  // namespace rigwire::emulators

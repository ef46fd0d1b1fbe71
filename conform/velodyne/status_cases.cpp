// The status channel of an HDL-64E: the last two bytes of its data packets.
#include <algorithm>
#include <array>
#include <cmath>

#include "conform/velodyne/velodyne_rows.h"
#include "protocols/velodyne/status_channel.h"

namespace rigwire::conform {

namespace velodyne = protocols::velodyne;

namespace {

using Log = VelodyneLog;
using Claims = VelodyneClaims;

constexpr const char* kStatus = "63-HDL64ES3 Rev. K, appendix E";
constexpr std::string_view kLive = "HMSDNYGTV";

std::string status_channel(const Log& log, const Claims& claims) {
  return log.model() != nullptr && !log.model()->status_channel ? "the model has no status channel"
                                                                : a_model(log, claims);
}

void order(Trial& trial, const Log& log, const Claims&) {
  std::optional<std::size_t> place;  // Position of the packet before, in the cycle of sixteen.
  each(trial, log.data(), "H M S D N Y G T V and seven bytes of the record, in turn",
       [&](const VelodyneData& packet) {
         const char type = static_cast<char>(packet.return_mode());
         const std::size_t live = kLive.find(type);
         if (!place) {
           place = type == 'H' ? std::optional<std::size_t>(0) : std::nullopt;
           return Wrong();
         }
         place = (*place + 1) % velodyne::kStatusCycle;
         const bool right = *place < kLive.size() ? live == *place : live == std::string_view::npos;
         return right ? Wrong()
                      : byte_text(packet.return_mode()) + " at place " + std::to_string(*place);
       });
  if (!place) {
    trial.expect(false, "an hour (H) in the status channel", "none");
  }
}

void values(Trial& trial, const Log& log, const Claims&) {
  struct Limits {
    char type;
    unsigned least;
    unsigned greatest;
  };
  static constexpr std::array<Limits, 6> kLimits{
      {{'H', 0, 23}, {'M', 0, 59}, {'S', 0, 60}, {'D', 1, 31}, {'N', 1, 12}, {'Y', 0, 99}}};
  each(trial, log.data(), "a time and a date that there are", [](const VelodyneData& packet) {
    const auto* const known =
        std::ranges::find(kLimits, static_cast<char>(packet.return_mode()), &Limits::type);
    return known != kLimits.end() &&
                   (packet.product() < known->least || packet.product() > known->greatest)
               ? Wrong(std::string(1, known->type) + " of " + std::to_string(packet.product()))
               : Wrong();
  });
}

void gps(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.data(), "G of A, V, P or 0", [](const VelodyneData& packet) {
    const auto value = static_cast<char>(packet.product());
    return packet.return_mode() == 'G' && value != 'A' && value != 'V' && value != 'P' && value != 0
               ? byte_text(packet.product())
               : Wrong();
  });
}

std::string whole_record(const Log& log, const Claims& claims) {
  // From anywhere in one to the end of the next.
  return log.data().size() < 2 * velodyne::kStatusPeriod ? "fewer than 8320 packets came"
                                                         : status_channel(log, claims);
}

struct Records {
  std::optional<velodyne::StatusRecord> last;
  std::uint64_t rejected = 0;
};
Records records_in(const Log& log) {
  velodyne::StatusReader reader;
  Records found;
  for (const VelodyneData& packet : log.data()) {
    if (auto record = reader.add({packet.return_mode(), packet.product()})) {
      found.last = std::move(record);
    }
  }
  found.rejected = reader.rejected();
  return found;
}

void record(Trial& trial, const Log& log, const Claims&) {
  const Records found = records_in(log);
  trial.expect(found.last.has_value(), "a whole record in 8320 packets", "none");
  trial.expect(found.rejected == 0, "no record with a wrong check", std::to_string(found.rejected));
}

void speed_of_record(Trial& trial, const Log& log, const Claims&) {
  const Records found = records_in(log);
  const double rpm = log.rotor_rpm().value_or(0.0);
  if (!found.last) {
    return trial.not_applicable("no whole record came");
  }
  trial.expect(std::abs(found.last->motor_rpm - rpm) <= 0.02 * rpm + 1.0,
               "the speed that azimuths show, " + number_text(rpm) + " rpm",
               std::to_string(found.last->motor_rpm) + " rpm");
}

void echoes_of_record(Trial& trial, const Log& log, const Claims&) {
  const Records found = records_in(log);
  if (!found.last) {
    return trial.not_applicable("no whole record came");
  }
  const bool both = found.last->echoes == velodyne::StatusEchoes::both;
  trial.expect(both == log.dual(), log.dual() ? "two returns (2)" : "one return (0, 1)",
               std::to_string(static_cast<unsigned>(found.last->echoes)));
}

}  // namespace

std::vector<VelodyneRow> velodyne_status_rows() {
  return {
      {"status", "Its bytes come in turn", kStatus, kMust, status_channel, order},
      {"status", "Time and date can be", kStatus, kMust, status_channel, values},
      {"status", "The state of GPS is one that there is", kStatus, kMust, status_channel, gps},
      {"status", "The record is whole and passes its check", kStatus, kMust, whole_record, record},
      {"status", "The record's speed is the rotor's", kStatus, kShould, whole_record,
       speed_of_record},
      {"status", "The record gives the number of returns", kStatus, kMust, whole_record,
       echoes_of_record},
  };
}

}  // namespace rigwire::conform

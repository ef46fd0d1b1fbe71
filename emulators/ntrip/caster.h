// An NTRIP caster: hands what base stations send it to the clients that ask for their mount points.
//
// It answers in version 1 ("ICY 200 OK", bytes as they are) unless the client says Ntrip-Version 2,
// as casters must for str2str and others to understand them; `version` fixes it. Unknown mount
// points: the source table in version 1, 404 in version 2. Frames go out whole, as they are
// complete; bytes that belong to no RTCM 3 frame are not handed on. What clients send after their
// request (GGA sentences) is read over.
//
// Bounds: a request is at most 4 kB, and whole within ten seconds (a client that trickles it is
// closed); clients and what they may leave unread, the server bounds.
//
// Faults are of simulated time: frames late, none at all while the connection stays, observations
// of another station than the place, bits turned over.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "emulators/device.h"
#include "emulators/random_bits.h"
#include "fields/rules.h"
#include "protocols/ntrip/message.h"
#include "protocols/rtcm3/frame.h"
#include "sim/samples/calendar.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

struct LateCorrectionsFault {
  static constexpr fields::Named kNamed{"delayed", "Frames leave later."};

  Duration delay = std::chrono::seconds{5};
  Duration ramp{0};

  void grow(double share) { delay = from_seconds(share * to_seconds(delay)); }
};
struct StalledCorrectionsFault {
  static constexpr fields::Named kNamed{"silent", "Nothing comes; the connection stays."};
};
struct WrongStationFault {
  static constexpr fields::Named kNamed{
      "wrong_station", "Observations carry another station number than the reference position."};

  unsigned station = 4095;
};
struct CorruptCorrectionsFault {
  static constexpr fields::Named kNamed{"corrupted", "A bit of some frames is turned over."};

  double share = 0.5;
  Duration ramp{0};

  void grow(double of_it) { share *= of_it; }
};
void visit(fields::Visitor& v, LateCorrectionsFault& p);
inline void visit(fields::Visitor&, StalledCorrectionsFault&) {}
void visit(fields::Visitor& v, WrongStationFault& p);
void visit(fields::Visitor& v, CorruptCorrectionsFault& p);

struct CasterFault {
  FaultPeriod when;
  std::variant<LateCorrectionsFault, StalledCorrectionsFault, WrongStationFault,
               CorruptCorrectionsFault>
      what;
};
void visit(fields::Visitor& v, CasterFault& p);

struct NtripCasterSettings {
  enum class Version : unsigned char { automatic, first, second };
  Version version = Version::automatic;
  bool chunked = true;  ///< Streams of version 2.
  std::string user;     ///< User name; empty: no password is required.
  std::string password;
  std::vector<CasterFault> faults;
  std::uint64_t noise_seed = 1;  ///< Seed of the fault `corrupt`.
};
void visit(fields::Visitor& v, NtripCasterSettings& p);

struct NtripCasterCounters {
  std::uint64_t frames = 0;     ///< From all base stations.
  std::uint64_t refused = 0;    ///< Requests: password, bad, unknown.
  std::uint64_t timed_out = 0;  ///< Clients that never finished their request.
};

class NtripCaster final : public StreamDevice {
 public:
  static constexpr Duration kRequestWithin = std::chrono::seconds{10};

  /// `output` must outlive it.
  NtripCaster(const NtripCasterSettings& settings, const Calendar& calendar, StreamOutput& output);

  /// A mount point; its number.
  std::size_t add(const protocols::ntrip::Stream& stream);
  /// Bytes of the base station behind that mount point.
  void hear(SimTime now, std::size_t mount, std::span<const std::uint8_t> bytes);

  void connected(SimTime now, ConnectionId connection) override;
  void receive(SimTime now, ConnectionId connection, std::span<const std::uint8_t> bytes) override;
  void disconnected(SimTime now, ConnectionId connection) override;
  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;

  [[nodiscard]] SamplePlan sample_plan() const override { return {}; }
  [[nodiscard]] ReceiveCounters received() const override { return received_; }
  /// Method and beginning of the target of the last request.
  [[nodiscard]] const LastRequest& last_request() const { return last_request_; }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const Quantity> quantities() const override { return {}; }
  /// Adds a fault; it begins no earlier than the caster was advanced to.
  FaultBook<CasterFault>::Id begin(const CasterFault& fault) { return faults_.add(fault); }
  /// Ends a fault from `now` on. Returns false if there is none of that number or it is over.
  bool end(FaultBook<CasterFault>::Id id, SimTime now) { return faults_.end(id, now); }
  [[nodiscard]] const NtripCasterCounters& counters() const { return counters_; }
  [[nodiscard]] std::uint64_t frames_sent() const { return frames_sent_; }
  [[nodiscard]] std::size_t streaming() const;

 private:
  struct Client {
    SimTime since{};
    bool asked = false;                ///< Its request is answered.
    std::optional<std::size_t> mount;  ///< While it is given a stream.
    bool chunked = false;
    std::vector<std::uint8_t> request;
  };
  struct Mount {
    protocols::ntrip::Stream stream;
    std::array<std::uint8_t, protocols::rtcm3::kGreatestFrame> input{};
    std::size_t size = 0;
  };
  struct Waiting {
    SimTime due{};
    std::size_t mount = 0;
    std::vector<std::uint8_t> frame;
  };

  void answer(SimTime now, ConnectionId connection, Client& client,
              const protocols::ntrip::Request& request);
  void say(SimTime now, ConnectionId connection, std::string_view text, bool and_close);
  void take_frame(SimTime now, std::size_t mount, std::span<const std::uint8_t> frame);
  void hand_out(SimTime now, std::size_t mount, std::span<const std::uint8_t> frame);
  [[nodiscard]] std::string date(SimTime now) const;

  NtripCasterSettings settings_;
  FaultBook<CasterFault> faults_;
  Calendar calendar_;
  StreamOutput& output_;
  RandomBits random_;
  std::map<ConnectionId, Client> clients_;
  std::vector<Mount> mounts_;
  std::deque<Waiting> waiting_;  ///< By due time.
  ReceiveCounters received_;
  LastRequest last_request_;
  NtripCasterCounters counters_;
  std::uint64_t frames_sent_ = 0;
};

}  // namespace rigwire::emulators

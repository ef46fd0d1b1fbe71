#include "hil/devices/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/udp_socket.h"
#include "fields/constants.h"
#include "fields/visitor.h"
#include "hil/devices/can_device.h"
#include "hil/devices/device.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/device_types.h"
#include "hil/devices/rig_check.h"
#include "hil/executive/executive.h"
#include "hil/files/gps_alignment.h"
#include "hil/files/replay_source.h"
#include "hil/wires/line_ports.h"
#include "hil/wires/outlets.h"
#include "protocols/can/bits.h"

namespace rigwire::hil {
namespace {

constexpr std::array<fields::Choice<ReplayWire>, 3> kReplayWires{
    {{ReplayWire::pty, "pty", "A serial line."},
     {ReplayWire::udp, "udp", "Datagrams."},
     {ReplayWire::can, "can", "A node of one of the rig's buses."}}};

constexpr std::array<ReplayedKind, 3> kKinds{ReplayedKind::bytes, ReplayedKind::datagrams,
                                             ReplayedKind::frames};
constexpr std::array<const char*, 3> kKindNames{"bytes of a serial line", "UDP datagrams",
                                                "CAN frames"};

/// Sends each unit at the instant at which it is due; ignores what it receives.
class Player final : public emulators::CanDevice {
 public:
  using Send = std::function<void(const ReplayedUnit&)>;
  /// Whether a unit can be handed over now.
  using Room = std::function<bool()>;

  Player(const ReplaySourceSettings& settings, std::optional<std::int64_t> zero_ns,
         std::optional<std::uint32_t> bit_rate_bps)
      : source_(settings, zero_ns), bit_rate_bps_(bit_rate_bps) {
    take();
  }
  /// `room`: empty for wires that take whatever comes.
  void send_by(Send send, Room room = {}) {
    send_ = std::move(send);
    room_ = std::move(room);
  }
  [[nodiscard]] const ReplayedSummary& summary() const { return source_.summary(); }

  void advance(SimTime now) override {
    while (next_ != nullptr && begin_ <= now) {
      // A file can wait where a controller has a queue. What is late by more than a moment goes all
      // the same, and the node counts what it loses: a bus that stays off ends no run.
      if (room_ && now < next_->due + kPatience && !room_()) {
        begin_ = now + Duration{kSecond_ns / bit_rate_bps_.value_or(1) *
                                std::int64_t{protocols::can::exact_bits(next_->frame)}};
        return;
      }
      send_(*next_);
      take();
    }
  }
  [[nodiscard]] SimTime next_event() const override { return next_ == nullptr ? kNever : begin_; }
  [[nodiscard]] SamplePlan sample_plan() const override { return {}; }
  [[nodiscard]] emulators::ReceiveCounters received() const override { return received_; }
  [[nodiscard]] double nominal_rate_hz() const override {
    const double length_s = to_seconds(summary().length);
    return length_s > 0.0 ? static_cast<double>(summary().units) / length_s : 0.0;
  }
  [[nodiscard]] std::span<const emulators::Quantity> quantities() const override { return {}; }
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view /*name*/) const override {
    return {};
  }
  void receive(SimTime /*now*/, const protocols::can::Frame& /*frame*/) override {
    ++received_.ignored;
  }
  void hear(SimTime now, std::span<const std::uint8_t> bytes) {
    received_.bytes += bytes.size();
    ++received_.ignored;
    last_ = now;
  }
  [[nodiscard]] std::optional<ClientRequest> last_request() const {
    return last_ ? std::optional(ClientRequest{*last_, "unanswered"}) : std::nullopt;
  }

 private:
  static constexpr Duration kPatience = std::chrono::seconds{2};

  void take() {
    next_ = source_.next();
    if (next_ == nullptr) {
      return;
    }
    begin_ = next_->due;
    if (bit_rate_bps_) {
      // Recorded is where a frame was complete: it begins as much earlier as it lasts, without the
      // three bits of interframe space that exact_bits() counts.
      constexpr unsigned kInterframe = 3;
      const std::int64_t bits = protocols::can::exact_bits(next_->frame) - kInterframe;
      begin_ = std::max({begun_, kStart, begin_ - Duration{bits * 1'000'000'000 / *bit_rate_bps_}});
    }
    begun_ = begin_;
  }

  ReplaySource source_;
  std::optional<std::uint32_t> bit_rate_bps_;  ///< On a bus.
  Send send_;
  Room room_;
  const ReplayedUnit* next_ = nullptr;
  SimTime begin_{};  ///< When it is handed over.
  SimTime begun_{};
  emulators::ReceiveCounters received_;
  std::optional<SimTime> last_;
};

class ReplayDevice final : public Device, private EventSource {
 public:
  ReplayDevice(const ReplayConfiguration& configuration, Site& site)
      : wire_(configuration.wire),
        alignment_(aligned(configuration.source)),
        player_(configuration.source, zero_ns(configuration.source, site),
                wire_ == ReplayWire::can
                    ? std::optional(site.bus(configuration.bus).bus().settings().bit_rate_bps)
                    : std::nullopt) {
    Executive& executive = site.executive();
    executive.add(static_cast<EventSource&>(*this));
    switch (wire_) {
      case ReplayWire::pty:
        open_line(configuration, site);
        break;
      case ReplayWire::udp:
        open_sockets(configuration, site);
        break;
      case ReplayWire::can:
        bus_ = &site.bus(configuration.bus);
        node_ = &bus_->add_node(own_statistics());
        bus_->attach(*node_, player_);
        player_.send_by(
            [this](const ReplayedUnit& unit) { node_->send(player_.next_event(), unit.frame); },
            [this] {
              const std::size_t queue = bus_->bus().settings().queue_frames;
              return bus_->bus().counters(*node_).queued <
                     std::clamp<std::uint64_t>(queue / 2, 1, kMaxWaiting);
            });
        break;
    }
  }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override {
    return line_             ? line_->status()
           : bus_ != nullptr ? bus_->endpoint()
                             : sockets_.front()->status();
  }
  [[nodiscard]] const emulators::Device& emulator() const override { return player_; }
  [[nodiscard]] std::optional<ClientRequest> last_request() const override {
    return player_.last_request();
  }
  [[nodiscard]] std::uint64_t dropped() const override {
    return statistics().dropped + (node_ == nullptr ? 0 : bus_->bus().counters(*node_).overflowed);
  }
  [[nodiscard]] std::vector<NamedCount> counts() const override {
    return {{"units of the file", player_.summary().units},
            {"requests unanswered", wire_ == ReplayWire::can ? 0 : player_.received().ignored}};
  }
  [[nodiscard]] std::string remark() const override {
    const ReplayedSummary& piece = player_.summary();
    std::string text =
        fmt::format("replays {} units, {:.3f} s", piece.units, to_seconds(piece.length));
    if (piece.truncated) {
      text += "; the file ends in the middle of one, what is whole is played";
    }
    if (!piece.notes.empty()) {
      text += "; left out or unknown: " + text_of_notes(piece.notes);
    }
    if (alignment_) {
      text += fmt::format("; by GPS time its stamps are {:.6f} s {} ({}, found {} times)",
                          1e-9 * std::abs(static_cast<double>(alignment_->ahead_ns)),
                          alignment_->ahead_ns < 0 ? "ahead" : "behind", alignment_->by,
                          alignment_->told);
    }
    if (piece.went_back != 0) {
      text += fmt::format("; the time of {} goes back by less than a second", piece.went_back);
    }
    return text;
  }

 private:
  static std::optional<GpsAlignment> aligned(const ReplaySourceSettings& source) {
    return source.align == ReplayedAlignment::gps ? std::optional(find_gps_alignment(source))
                                                  : std::nullopt;
  }
  /// Returns the instant of the run's start in the file's own clock when it is aligned by GPS time;
  /// nullopt otherwise.
  [[nodiscard]] std::optional<std::int64_t> zero_ns(const ReplaySourceSettings& source,
                                                    const Site& site) const {
    if (!alignment_) {
      return std::nullopt;
    }
    const std::int64_t start_ns = unix_time(site.calendar().utc(kStart)).count();
    if (alignment_->first_utc_ns - start_ns > kHour_ns) {
      const auto utc =
          std::chrono::floor<std::chrono::seconds>(std::chrono::sys_time<std::chrono::nanoseconds>(
              std::chrono::nanoseconds(alignment_->first_utc_ns)));
      throw std::invalid_argument(fmt::format(
          "devices.{}.source.align: {} begins more than an hour after the rig's start, found {}, "
          "allowed before: write it as the rig's `start`",
          site.name(), source.file, text_of_utc(utc)));
    }
    return start_ns - alignment_->ahead_ns;
  }
  static std::string text_of_utc(std::chrono::sys_seconds at) {
    const auto day = std::chrono::floor<std::chrono::days>(at);
    const std::chrono::year_month_day date(day);
    const std::chrono::hh_mm_ss time(at - day);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", static_cast<int>(date.year()),
                       static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                       time.hours().count(), time.minutes().count(), time.seconds().count());
  }

  void open_line(const ReplayConfiguration& configuration, Site& site) {
    line_ = open_serial_ports(site.io(), configuration.path, configuration.ports,
                              configuration.source.baud);
    stream_.emplace(*line_, own_statistics());
    site.executive().add(*stream_);
    stream_->start([this, &executive = site.executive()](std::span<const std::uint8_t> bytes) {
      player_.hear(client_arrived(executive), bytes);
    });
    player_.send_by([this](const ReplayedUnit& unit) { stream_->send(unit.due, unit.bytes); });
  }

  void open_sockets(const ReplayConfiguration& configuration, Site& site) {
    std::vector<std::uint16_t> ports{configuration.port};
    if (configuration.port == 0) {
      ports = player_.summary().to_ports;
    }
    constexpr std::size_t kMost = 16;
    if (ports.size() > kMost) {
      throw std::invalid_argument(
          fmt::format("devices.{}.source: datagrams to {} ports, allowed {}: name one by to_port",
                      site.name(), ports.size(), kMost));
    }
    for (const std::uint16_t port : ports) {
      drivers::UdpSettings settings;
      settings.destination = drivers::UdpEndpoint{configuration.address, port};
      settings.broadcast = true;  // where it may go is checked against the rig's permission
      sockets_.push_back(std::make_unique<drivers::UdpSocket>(site.io(), settings));
      outlets_.push_back(std::make_unique<DatagramOutlet>(*sockets_.back(), own_statistics()));
      site.executive().add(*outlets_.back());
    }
    player_.send_by([this, ports](const ReplayedUnit& unit) {
      const auto at = std::ranges::find(ports, unit.to.port);
      outlets_[at == ports.end() ? 0 : static_cast<std::size_t>(at - ports.begin())]->send(
          unit.due, unit.bytes);
    });
  }

  [[nodiscard]] SimTime next_event() const override { return player_.next_event(); }
  [[nodiscard]] SimTime next_wakeup() const override { return player_.next_event(); }
  void advance(SimTime now) override { player_.advance(now); }

  /// Frames of the file that wait at the node at most, where its queue has room for twice as many.
  static constexpr std::uint64_t kMaxWaiting = 32;

  ReplayWire wire_;
  std::optional<GpsAlignment> alignment_;
  Player player_;
  std::unique_ptr<drivers::ByteStream> line_;
  std::optional<StreamOutlet> stream_;
  std::vector<std::unique_ptr<drivers::UdpSocket>> sockets_;
  std::vector<std::unique_ptr<DatagramOutlet>> outlets_;
  RigCan* bus_ = nullptr;
  emulators::FrameOutput* node_ = nullptr;
};

}  // namespace

void ReplayConfiguration::visit(fields::Visitor& v) {
  v.required("source");
  v.section("source", source, "The file, and which piece of it.");
  v.choice("wire", wire, kReplayWires, "What it is played on.");
  v.only_if(wire == ReplayWire::pty, "wire", "wire: pty", [this](fields::Visitor& w) {
    w.text("path", path, "Symbolic link to the pty; what a client opens.");
    w.integer("ports", ports, kPorts, kSerialPortsText);
  });
  v.only_if(wire == ReplayWire::udp, "wire", "wire: udp", [this](fields::Visitor& w) {
    w.text("address", address, "Where datagrams go, IPv4.");
    w.integer("port", port, fields::IntegerRule{0, 65535},
              "Where they go; 0 = each to the port that it went to.");
    w.boolean("allow_remote", allow_remote, "Permits an address outside this machine.");
  });
  v.only_if(wire == ReplayWire::can, "wire", "wire: can", [this](fields::Visitor& w) {
    w.text("bus", bus, "Name of the rig's bus that the node is on.");
  });
}
void ReplayConfiguration::check(const std::string& at, RigCheck& check) const {
  check_source(at, check);
  switch (wire) {
    case ReplayWire::pty:
      check.port_paths(at, path, ports);
      break;
    case ReplayWire::udp:
      check.address(at + ".address", address, allow_remote);
      break;
    case ReplayWire::can:
      check.bus(at, bus);
      break;
  }
}
/// Reads the file as a run would.
void ReplayConfiguration::check_source(const std::string& at, RigCheck& check) const {
  try {
    const ReplaySource piece(source);
    const auto kind = static_cast<std::size_t>(piece.summary().kind);
    if (piece.summary().kind != kKinds[static_cast<std::size_t>(wire)]) {
      check.report(at + ".wire", "the file has another kind of wire", kKindNames[kind],
                   kKindNames[static_cast<std::size_t>(wire)]);
    }
    if (source.align == ReplayedAlignment::gps) {
      (void)find_gps_alignment(source);
    }
  } catch (const std::invalid_argument& error) {
    check.report(at + ".source", error.what());
  } catch (const drivers::EndpointError& error) {
    check.report(at + ".source", error.what());
  }
}

void ReplayConfiguration::each_fault(const FaultEar& /*take*/) {}

DevicePlan ReplayConfiguration::plan(const RigView& rig) const {
  const std::string where = wire == ReplayWire::pty   ? "pty " + port_list(path, ports)
                            : wire == ReplayWire::udp ? fmt::format("udp {}:{}", address, port)
                                                      : can_wire(rig, bus, "as recorded");
  return {where, "as recorded", "", source.file};
}
std::optional<BusShare> ReplayConfiguration::bus_share(std::string_view /*name*/) const {
  return wire == ReplayWire::can ? std::optional(BusShare{bus, 0.0, {}}) : std::nullopt;
}
DeviceDescription ReplayConfiguration::describe() const {
  DeviceDescription description;
  description.wire = "a serial line on a pty, UDP, or a node on CAN";
  description.document = "the file's own";
  description.page = "replay.md";
  description.messages = {{"units of the file", "as recorded", "byte by byte"}};
  return description;
}

std::unique_ptr<Device> ReplayConfiguration::make(Site& site) const {
  return std::make_unique<ReplayDevice>(*this, site);
}

}  // namespace rigwire::hil

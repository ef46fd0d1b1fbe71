#include "emulators/ntrip/caster.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "fields/visitor.h"
#include "protocols/rtcm3/message.h"

namespace rigwire::emulators {
namespace {

namespace ntrip = protocols::ntrip;
namespace rtcm3 = protocols::rtcm3;
using namespace std::chrono_literals;

constexpr std::array<fields::Choice<NtripCasterSettings::Version>, 3> kVersions{
    {{NtripCasterSettings::Version::automatic, "automatic", "The version that the client names."},
     {NtripCasterSettings::Version::first, "1", "Version 1 to everybody."},
     {NtripCasterSettings::Version::second, "2", "Version 2 to everybody."}}};

/// Frames that are late wait here at most.
constexpr std::size_t kMostWaiting = 4096;

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Whether the twelve bits after its number are a station, and the message is not of its place.
bool names_station(std::uint16_t number) {
  constexpr std::uint16_t kPlace = 1005;
  constexpr std::uint16_t kPlaceAndHeight = 1006;
  constexpr std::uint16_t kProprietary = 4072;
  return number != kPlace && number != kPlaceAndHeight && number != kProprietary;
}

}  // namespace

void visit(fields::Visitor& v, LateCorrectionsFault& p) {
  v.duration("delay", p.delay, {0, 3'600'000'000'000}, "By which frames leave later.");
  visit_ramp(v, p.ramp);
}
void visit(fields::Visitor& v, WrongStationFault& p) {
  v.integer("station", p.station, fields::IntegerRule{0, rtcm3::kGreatestStation},
            "Reference station (DF003) that the observations name.");
}
void visit(fields::Visitor& v, CorruptCorrectionsFault& p) {
  v.number("share", p.share, fields::in("%").above(0).at_most(100),
           "Share of the frames that are affected, drawn for each frame.");
  visit_ramp(v, p.ramp);
}
void visit(fields::Visitor& v, CasterFault& p) {
  visit_fault(v, p);
}

void visit(fields::Visitor& v, NtripCasterSettings& p) {
  v.choice("version", p.version, kVersions, "Version of NTRIP in which it answers.");
  v.boolean("chunked", p.chunked, "Streams of version 2 come in chunks of HTTP.");
  v.text("user", p.user, "Name that clients must give; empty = clients need no name.");
  v.text("password", p.password, "Password that goes with `user`.");
}

NtripCaster::NtripCaster(const NtripCasterSettings& settings, const Calendar& calendar,
                         StreamOutput& output)
    : settings_(settings),
      faults_(settings.faults),
      calendar_(calendar),
      output_(output),
      random_(settings.noise_seed) {}

std::size_t NtripCaster::add(const ntrip::Stream& stream) {
  Mount& mount = mounts_.emplace_back();
  mount.stream = stream;
  mount.stream.needs_password = !settings_.user.empty();
  return mounts_.size() - 1;
}

std::size_t NtripCaster::streaming() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      clients_, [](const auto& entry) { return entry.second.mount.has_value(); }));
}

// From base stations.

void NtripCaster::hear(SimTime now, std::size_t number, std::span<const std::uint8_t> bytes) {
  advance(now);
  Mount& mount = mounts_[number];
  for (const std::uint8_t byte : bytes) {
    mount.input[mount.size++] = byte;
    while (mount.size > 0) {
      const auto input = std::span<const std::uint8_t>(mount.input).first(mount.size);
      const auto frame = rtcm3::decode_frame(input);
      if (frame.incomplete()) {
        break;
      }
      const std::size_t used = frame.ok() ? frame.consumed() : 1;
      if (frame.ok()) {
        ++counters_.frames;
        take_frame(now, number, input.first(used));
      }
      std::copy(mount.input.begin() + static_cast<std::ptrdiff_t>(used),
                mount.input.begin() + static_cast<std::ptrdiff_t>(mount.size), mount.input.begin());
      mount.size -= used;
    }
  }
}

void NtripCaster::take_frame(SimTime now, std::size_t mount, std::span<const std::uint8_t> frame) {
  if (faults_.first<StalledCorrectionsFault>(now) != nullptr) {
    return;
  }
  std::vector<std::uint8_t> bytes(frame.begin(), frame.end());
  if (const auto* wrong = faults_.first<WrongStationFault>(now)) {
    const std::size_t payload = bytes.size() - rtcm3::kHeaderBytes - rtcm3::kChecksumBytes;
    const std::span<std::uint8_t> inner = std::span(bytes).subspan(rtcm3::kHeaderBytes, payload);
    if (payload >= 3 && names_station(rtcm3::FrameView{inner}.message())) {
      inner[1] = static_cast<std::uint8_t>((inner[1] & 0xF0U) | wrong->station >> 8U);
      inner[2] = static_cast<std::uint8_t>(wrong->station);
      const std::vector<std::uint8_t> changed(inner.begin(), inner.end());
      rtcm3::encode_frame(changed, bytes);
    }
  }
  if (const auto corrupt = faults_.first_grown<CorruptCorrectionsFault>(now);
      corrupt && random_.uniform() < corrupt->share) {
    const std::uint32_t bit = random_.below(static_cast<std::uint32_t>(bytes.size() * 8));
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ 1U << bit % 8);
  }
  const auto late = faults_.first_grown<LateCorrectionsFault>(now);
  const SimTime due = late ? now + late->delay : now;
  if (due <= now && waiting_.empty()) {
    hand_out(now, mount, bytes);
  } else if (waiting_.size() < kMostWaiting) {
    // In their order: none overtakes one that is late.
    waiting_.push_back(
        {waiting_.empty() ? due : std::max(due, waiting_.back().due), mount, std::move(bytes)});
  }
}

void NtripCaster::hand_out(SimTime now, std::size_t mount, std::span<const std::uint8_t> frame) {
  for (const auto& [connection, client] : clients_) {
    if (client.mount != mount) {
      continue;
    }
    ++frames_sent_;
    if (client.chunked) {
      output_.send(connection, now, bytes_of(ntrip::chunk(frame)));
    } else {
      output_.send(connection, now, frame);
    }
  }
}

// Life.

SimTime NtripCaster::next_event() const {
  SimTime next = waiting_.empty() ? kNever : waiting_.front().due;
  for (const auto& [connection, client] : clients_) {
    next = client.asked ? next : std::min(next, client.since + kRequestWithin);
  }
  return next;
}

void NtripCaster::advance(SimTime now) {
  while (!waiting_.empty() && waiting_.front().due <= now) {
    const Waiting late = std::move(waiting_.front());
    waiting_.pop_front();
    hand_out(late.due, late.mount, late.frame);
  }
  for (auto& [connection, client] : clients_) {
    if (!client.asked && client.since + kRequestWithin <= now) {
      client.asked = true;
      ++counters_.timed_out;
      output_.close(connection, now);
    }
  }
}

// From clients.

void NtripCaster::connected(SimTime now, ConnectionId connection) {
  advance(now);
  clients_[connection].since = now;
}

void NtripCaster::disconnected(SimTime now, ConnectionId connection) {
  advance(now);
  clients_.erase(connection);
}

void NtripCaster::receive(SimTime now, ConnectionId connection,
                          std::span<const std::uint8_t> bytes) {
  advance(now);
  received_.bytes += bytes.size();
  const auto found = clients_.find(connection);
  if (found == clients_.end()) {
    return;
  }
  Client& client = found->second;
  if (client.asked) {
    ++received_.ignored;  // where it is (GGA), or anything else
    return;
  }
  const std::size_t room = ntrip::kGreatestHead - client.request.size();
  client.request.insert(client.request.end(), bytes.begin(),
                        bytes.begin() + static_cast<std::ptrdiff_t>(std::min(room, bytes.size())));
  const auto request = ntrip::decode_request(client.request);
  if (request.incomplete()) {
    return;
  }
  client.asked = true;
  if (request.malformed()) {
    ++received_.malformed;
    ++counters_.refused;
    say(now, connection, ntrip::bad_request(), true);
  } else {
    ++received_.accepted;
    std::string head = request->method;
    head.append(" ").append(request->target);
    last_request_.note(now, bytes_of(head));
    answer(now, connection, client, *request);
  }
  client.request = {};
}

void NtripCaster::say(SimTime now, ConnectionId connection, std::string_view text, bool and_close) {
  output_.send(connection, now, bytes_of(text));
  if (and_close) {
    output_.close(connection, now);
  }
}

std::string NtripCaster::date(SimTime now) const {
  constexpr std::array<const char*, 7> kDays{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  constexpr std::array<const char*, 12> kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  constexpr std::int64_t kDay_ns = 86'400'000'000'000;
  const UtcTime utc = calendar_.utc(now);
  // The day of the week of UTC: that of GPS time before the leap seconds.
  const SimTime behind = now - std::chrono::seconds{calendar_.leap_seconds(now)};
  const auto day = static_cast<std::size_t>(calendar_.gps(behind).time_of_week_ns / kDay_ns);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%s, %02d %s %d %02d:%02d:%02d GMT", kDays[day % 7],
                utc.day, kMonths[static_cast<std::size_t>(utc.month - 1) % 12], utc.year, utc.hour,
                utc.minute, utc.second);
  return text.data();
}

void NtripCaster::answer(SimTime now, ConnectionId connection, Client& client,
                         const ntrip::Request& request) {
  using Version = NtripCasterSettings::Version;
  const bool second = settings_.version == Version::second ||
                      (settings_.version == Version::automatic && request.second_version);
  const std::string today = date(now);
  const ntrip::Caster caster{.date = today};
  if (request.method != "GET") {  // base stations are wired to it, none sends by NTRIP
    ++counters_.refused;
    say(now, connection,
        request.method == "SOURCE" ? "ERROR - Bad Password\r\n" : ntrip::not_implemented(), true);
    return;
  }
  const auto found = std::ranges::find_if(
      mounts_, [&](const Mount& mount) { return mount.stream.mount == request.mount(); });
  if (found == mounts_.end()) {
    if (second && !request.mount().empty()) {
      ++counters_.refused;
      say(now, connection, ntrip::not_found(caster), true);
      return;
    }
    std::string lines;
    for (const Mount& mount : mounts_) {
      lines.append(ntrip::table_line(mount.stream));
    }
    say(now, connection, ntrip::source_table(second, caster, lines), true);
    return;
  }
  if (!settings_.user.empty() && request.credentials != settings_.user + ":" + settings_.password) {
    ++counters_.refused;
    say(now, connection, ntrip::unauthorized(second, caster, request.mount()), true);
    return;
  }
  client.chunked = second && settings_.chunked;
  client.mount = static_cast<std::size_t>(found - mounts_.begin());
  say(now, connection, ntrip::stream_head(second, client.chunked, caster), false);
}

}  // namespace rigwire::emulators

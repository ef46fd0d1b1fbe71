#include "hil/record/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "drivers/endpoints.h"
#include "hil/configuration/outside_file.h"
#include "hil/executive/executive.h"
#include "hil/files/mcap_file.h"
#include "hil/files/new_folder.h"
#include "protocols/mcap/mcap.h"
#include "protocols/pcapng/link_packet.h"
#include "protocols/pcapng/pcapng.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
namespace pcapng = protocols::pcapng;
namespace mcap = protocols::mcap;
using Json = nlohmann::ordered_json;

constexpr std::string_view kDescriptionFile = "recording.json";

std::string text_of(const fs::path& path) {
  try {
    return read_outside_file(path, kResultFile);
  } catch (const FileRefused& refused) {
    throw drivers::EndpointError(fmt::format("the recording {}", refused.what()));
  }
}

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
  throw std::invalid_argument(fmt::format("the recording {}: {}", path.string(), why));
}

/// Says whose file it is.
template <class Read>
void read_file(const fs::path& path, Read&& read) {
  try {
    read();
  } catch (const drivers::EndpointError& error) {
    throw drivers::EndpointError(fmt::format("the recording {}", error.what()));
  } catch (const std::invalid_argument& error) {
    const std::string_view what = error.what();
    throw std::invalid_argument(what.starts_with(path.string())
                                    ? fmt::format("the recording {}", what)
                                    : std::string(what));
  }
}

void read_packets(const fs::path& path,
                  const std::function<void(const pcapng::Packet&, const pcapng::Interface&)>& use) {
  pcapng::Reader reader;
  std::uint64_t read = 0;
  read_file(path, [&] {
    read_pieces(path, kRecordingFile, [&](std::span<const std::uint8_t> bytes) -> std::size_t {
      const auto block = reader.next(bytes);
      if (block.malformed()) {
        refuse(path,
               fmt::format("{} at byte {}", block.fault().reason, read + block.fault().offset));
      }
      if (block.ok()) {
        if (const auto* packet = std::get_if<pcapng::Packet>(&*block)) {
          use(*packet, reader.interfaces()[packet->interface]);
        }
      }
      read += block.consumed();
      return block.consumed();
    });
  });
}

void read_records(const fs::path& path, const std::function<void(const mcap::Record&)>& use) {
  read_file(path, [&] { each_mcap_record(path, kRecordingFile, use); });
}

std::optional<WireKind> kind_of(std::string_view name) {
  for (const WireKind kind : {WireKind::serial, WireKind::can, WireKind::ethernet}) {
    if (name == name_of(kind)) {
      return kind;
    }
  }
  return std::nullopt;
}

/// Reads the description; everything else is counted from the files.
RecordingContents read_description(const fs::path& folder, bool& with_truth) {
  const fs::path path = folder / kDescriptionFile;
  RecordingContents contents;
  try {
    const Json json = Json::parse(text_of(path));
    if (json.at("rigwire_recording") != 1) {
      refuse(path, fmt::format("a recording of another kind, found {}, allowed 1",
                               json.at("rigwire_recording").dump()));
    }
    contents.run.version = json.at("version").get<std::string>();
    contents.run.rig = json.at("rig").get<std::string>();
    contents.run.seed = json.at("seed").get<std::uint64_t>();
    contents.run.config_hash = json.at("config_hash").get<std::string>();
    contents.run.clock = json.at("clock").get<std::string>();
    contents.run.start_utc = json.at("start_utc").get<std::string>();
    contents.run.start_unix_ns = json.at("start_unix_ns").get<std::int64_t>();
    const auto instant = [&json](const char* key) {
      return SimTime{Duration{json.value(key, std::int64_t{0})}};
    };
    contents.run.begin = instant("begin_ns");
    contents.run.truth_begin = instant("truth_begin_ns");
    contents.run.clients_before = json.value("clients_before", false);
    std::error_code error;
    contents.run.tells_requests = fs::exists(folder / "requests.log", error);
    if (!json.at("end_ns").is_null()) {
      contents.end = SimTime{Duration{json.at("end_ns").get<std::int64_t>()}};
    }
    with_truth = json.contains("truth");
    for (const Json& row : json.at("wires")) {
      const auto name = row.at("name").get<std::string>();
      const auto kind = kind_of(row.at("kind").get<std::string>());
      if (!kind || name.empty() || name.find('/') != std::string::npos) {
        refuse(path, fmt::format("a wire that is none, found {}", row.dump()));
      }
      contents.wires.push_back(
          {{name, *kind, row.at("address").get<std::string>()}, 0, 0, 0, 0, {}, {}});
    }
  } catch (const Json::exception& error) {
    refuse(path, error.what());
  }
  contents.run.configuration = text_of(folder / "rig.yaml");
  return contents;
}

class RecordingReader {
 public:
  explicit RecordingReader(fs::path folder)
      : folder_(std::move(folder)), contents_(read_description(folder_, with_truth_)) {}

  [[nodiscard]] RecordingContents& contents() { return contents_; }
  [[nodiscard]] bool with_truth() const { return with_truth_; }

  void each_packet(const std::function<void(std::size_t wire, SimTime at,
                                            const pcapng::Packet& packet)>& use) const {
    if (contents_.wires.empty()) {
      return;
    }
    read_packets(folder_ / "all.pcapng",
                 [&](const pcapng::Packet& packet, const pcapng::Interface& interface) {
                   if (packet.interface >= contents_.wires.size() ||
                       contents_.wires[packet.interface].about.name != interface.name) {
                     refuse(folder_ / "all.pcapng", fmt::format("interface {} is no wire of {}",
                                                                interface.name, kDescriptionFile));
                   }
                   use(packet.interface, sim_time(packet.time_ns), packet);
                 });
  }
  void each_record(const std::function<void(const mcap::Record&)>& use) const {
    if (with_truth_) {
      read_records(folder_ / "truth.mcap", use);
    }
  }
  void each_message(
      const std::function<void(TruthTrack track, SimTime at, std::string_view text)>& use) const {
    each_record([&](const mcap::Record& record) {
      if (record.opcode != mcap::Opcode::message) {
        return;
      }
      const auto message = mcap::read_message(record.content);
      if (!message.ok() || message->channel >= kTruthTracks) {
        refuse(folder_ / "truth.mcap", "a message that is none of a recording");
      }
      use(static_cast<TruthTrack>(message->channel), sim_time(message->time_ns), message->data);
    });
  }
  [[nodiscard]] SimTime sim_time(std::uint64_t unix_ns) const {
    return SimTime{Duration{static_cast<std::int64_t>(unix_ns) - contents_.run.start_unix_ns}};
  }

 private:
  fs::path folder_;
  bool with_truth_ = false;
  RecordingContents contents_;
};

}  // namespace

RecordingContents read_recording(const fs::path& folder) {
  RecordingReader reader(folder);
  RecordingContents& contents = reader.contents();
  reader.each_packet([&](std::size_t index, SimTime at, const pcapng::Packet& packet) {
    RecordingContents::Wire& wire = contents.wires[index];
    wire.first = wire.packets == 0 ? at : std::min(wire.first, at);
    wire.last = wire.packets == 0 ? at : std::max(wire.last, at);
    ++wire.packets;
    wire.of_clients += packet.direction == pcapng::Direction::inbound ? 1 : 0;
    wire.bytes += wire.about.kind == WireKind::serial ? pcapng::serial_bytes(packet.bytes).size()
                                                      : packet.bytes.size();
    wire.lost += packet.lost_before;
    if (!packet.comment.empty()) {
      contents.notes.push_back({at, wire.about.name, std::string(packet.comment)});
    }
  });
  std::map<std::uint16_t, std::string> schemas;
  std::map<std::uint16_t, std::size_t> places;
  reader.each_record([&](const mcap::Record& record) {
    if (record.opcode == mcap::Opcode::schema) {
      if (const auto schema = mcap::read_schema(record.content); schema.ok()) {
        schemas[schema->id] = schema->name;
      }
    } else if (record.opcode == mcap::Opcode::channel) {
      const auto channel = mcap::read_channel(record.content);
      if (channel.ok() && places.try_emplace(channel->id, contents.channels.size()).second) {
        contents.channels.push_back({channel->topic, schemas[channel->schema], 0});
      }
    } else if (record.opcode == mcap::Opcode::message) {
      const auto message = mcap::read_message(record.content);
      if (message.ok() && places.contains(message->channel)) {
        ++contents.channels[places[message->channel]].messages;
      }
    }
  });
  return contents;
}

namespace {

/// Seconds with nine decimals.
std::optional<SimTime> instant_of(std::string_view text) {
  const std::size_t point = text.find('.');
  std::int64_t seconds = 0;
  std::int64_t fraction = 0;
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  const bool is_one = point != std::string_view::npos && text.size() == point + 10 &&
                      std::from_chars(begin, begin + point, seconds).ptr == begin + point &&
                      std::from_chars(begin + point + 1, end, fraction).ptr == end &&
                      seconds >= 0 && seconds < 9'000'000'000 && fraction >= 0;
  return is_one ? std::optional(SimTime{Duration{seconds * 1'000'000'000 + fraction}})
                : std::nullopt;
}

/// Lines of an instant and a text; none where there is no such file.
std::vector<RecordedAct> read_acts(const fs::path& path) {
  std::vector<RecordedAct> acts;
  std::optional<LineReader> file;
  try {
    file.emplace(path, kRecordingFile);
  } catch (const FileRefused& refused) {
    if (refused.missing()) {
      return acts;
    }
    throw drivers::EndpointError(fmt::format("the recording {}", refused.what()));
  }
  std::size_t number = 0;
  for (std::string line; file->next(line);) {
    ++number;
    if (line.empty() || line.front() == '#') {
      continue;
    }
    if (!file->whole()) {
      break;  // the run was killed while it was written
    }
    const std::size_t space = line.find(' ');
    const auto at = instant_of(std::string_view(line).substr(0, space));
    if (!at || space == std::string::npos) {
      refuse(path, fmt::format("line {}: no instant in seconds with nine decimals", number));
    }
    acts.push_back({*at, line.substr(space + 1)});
  }
  return acts;
}

}  // namespace

std::vector<RecordedAct> client_acts(const fs::path& folder, const std::string& wire) {
  return read_acts(folder / "wires" / (wire + ".ends"));
}

std::vector<RecordedAct> recorded_commands(const fs::path& folder) {
  return read_acts(folder / "commands.log");
}

std::vector<RequestHandover> recorded_handovers(const fs::path& folder) {
  const fs::path path = folder / "requests.log";
  std::vector<RequestHandover> handovers;
  for (const RecordedAct& act : read_acts(path)) {
    const bool promised = act.text.ends_with(kPromised);
    const std::string_view text(act.text);
    const auto taken = instant_of(
        promised ? text.substr(0, text.size() - std::string_view(kPromised).size()) : text);
    if (!taken) {
      refuse(path, fmt::format("at {:.9f} s: found \"{}\", allowed seconds with nine decimals",
                               to_seconds(act.at), act.text));
    }
    handovers.push_back({act.at, *taken, promised});
  }
  return handovers;
}

RecordingContents read_recording_description(const fs::path& folder) {
  return RecordingReader(folder).contents();
}

void each_packet(const fs::path& folder,
                 const std::function<void(std::size_t, SimTime, const pcapng::Packet&)>& use) {
  RecordingReader(folder).each_packet(use);
}

void each_message(const fs::path& folder,
                  const std::function<void(TruthTrack, SimTime, std::string_view)>& use) {
  RecordingReader(folder).each_message(use);
}

std::string to_text(const RecordingContents& contents) {
  const RecordedRun& run = contents.run;
  std::string text =
      fmt::format("{}, seed {}, configuration {}, clock {}, rigwire {}\nfrom {}{}\n", run.rig,
                  run.seed, run.config_hash, run.clock, run.version, run.start_utc,
                  contents.end ? fmt::format(" to {:.3f} s", to_seconds(*contents.end))
                               : std::string("; the run was killed"));
  const auto out = std::back_inserter(text);
  if (!contents.wires.empty()) {
    fmt::format_to(out, "\n{:<16} {:<9} {:>10} {:>10} {:>13} {:>8} {:>12} {:>12}\n", "wire", "kind",
                   "packets", "of clients", "bytes", "lost", "first s", "last s");
  }
  for (const RecordingContents::Wire& wire : contents.wires) {
    fmt::format_to(out, "{:<16} {:<9} {:>10} {:>10} {:>13} {:>8}", wire.about.name,
                   name_of(wire.about.kind), wire.packets, wire.of_clients, wire.bytes, wire.lost);
    if (wire.packets != 0) {
      fmt::format_to(out, " {:>12.6f} {:>12.6f}", to_seconds(wire.first), to_seconds(wire.last));
    }
    text += '\n';
  }
  if (!contents.channels.empty()) {
    fmt::format_to(out, "\n{:<16} {:<28} {:>10}\n", "channel", "schema", "messages");
  }
  for (const RecordingContents::Channel& channel : contents.channels) {
    fmt::format_to(out, "{:<16} {:<28} {:>10}\n", channel.topic, channel.schema, channel.messages);
  }
  if (!contents.notes.empty()) {
    text += '\n';
  }
  constexpr std::size_t kNotesShown = 20;
  const std::size_t shown = std::min(contents.notes.size(), kNotesShown);
  for (const RecordingContents::Note& note : std::span(contents.notes).first(shown)) {
    fmt::format_to(out, "{:.6f} s {}: {}\n", to_seconds(note.at), note.wire, note.text);
  }
  if (shown < contents.notes.size()) {
    fmt::format_to(out, "+{} more notes (--json has them)\n", contents.notes.size() - shown);
  }
  return text;
}

std::string to_json(const RecordingContents& contents) {
  const RecordedRun& run = contents.run;
  Json json{{"version", run.version},
            {"rig", run.rig},
            {"seed", run.seed},
            {"config_hash", run.config_hash},
            {"clock", run.clock},
            {"start_utc", run.start_utc},
            {"end_s", contents.end ? Json(to_seconds(*contents.end)) : Json(nullptr)},
            {"wires", Json::object()},
            {"channels", Json::object()},
            {"notes", Json::array()}};
  for (const RecordingContents::Wire& wire : contents.wires) {
    const bool any = wire.packets != 0;
    json["wires"][wire.about.name] = {{"kind", name_of(wire.about.kind)},
                                      {"address", wire.about.address},
                                      {"packets", wire.packets},
                                      {"of_clients", wire.of_clients},
                                      {"bytes", wire.bytes},
                                      {"lost", wire.lost},
                                      {"first_s", any ? Json(to_seconds(wire.first)) : nullptr},
                                      {"last_s", any ? Json(to_seconds(wire.last)) : nullptr}};
  }
  for (const RecordingContents::Channel& channel : contents.channels) {
    json["channels"][channel.topic] = {{"schema", channel.schema}, {"messages", channel.messages}};
  }
  for (const RecordingContents::Note& note : contents.notes) {
    json["notes"].push_back(
        {{"sim_s", to_seconds(note.at)}, {"wire", note.wire}, {"text", note.text}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void cut_recording(const fs::path& folder, SimTime from, SimTime to, const fs::path& out) {
  RecordingReader reader(folder);
  std::vector<RecordedWire> wires;
  for (const RecordingContents::Wire& wire : reader.contents().wires) {
    wires.push_back(wire.about);
  }
  make_new_folder("-o", out);
  std::string trouble;
  RecordedRun run = reader.contents().run;
  run.begin = std::max(run.begin, from);
  run.truth_begin = std::max(run.truth_begin, from);
  reader.each_packet([&](std::size_t, SimTime at, const pcapng::Packet& packet) {
    run.clients_before |= at < from && packet.direction == pcapng::Direction::inbound;
  });
  RecordingWriter writer(
      out, std::move(run), wires, reader.with_truth(),
      [&](const std::string& what, bool over) { trouble = over ? trouble : what; });
  const auto within = [&](SimTime at) { return from <= at && at < to; };
  SimTime last = from;
  reader.each_packet([&](std::size_t wire, SimTime at, const pcapng::Packet& packet) {
    if (!within(at)) {
      return;
    }
    last = std::max(last, at);
    const std::uint16_t track = wire_track(wire);
    if (packet.lost_before != 0) {
      writer.lost(track, packet.lost_before);
    }
    if (!packet.comment.empty()) {
      writer.write(
          {track,
           kWireNote,
           at,
           {reinterpret_cast<const std::uint8_t*>(packet.comment.data()), packet.comment.size()}});
    }
    const bool inbound = packet.direction == pcapng::Direction::inbound;
    writer.write(
        {track, inbound ? kInbound : std::uint8_t{0}, at,
         wires[wire].kind == WireKind::serial ? pcapng::serial_bytes(packet.bytes) : packet.bytes});
  });
  reader.each_message([&](TruthTrack track, SimTime at, std::string_view text) {
    if (within(at)) {
      last = std::max(last, at);
      writer.write({static_cast<std::uint16_t>(track),
                    0,
                    at,
                    {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}});
    }
  });
  // Commands, hand-overs and changes of clients are copied from the run's start on: they decide
  // the state at `from`, and a replay repeats them.
  const auto copy = [&](std::uint16_t track, std::uint8_t flags,
                        const std::vector<RecordedAct>& acts) {
    for (const RecordedAct& act : acts) {
      if (act.at < to) {
        writer.write({track,
                      flags,
                      act.at,
                      {reinterpret_cast<const std::uint8_t*>(act.text.data()), act.text.size()}});
      }
    }
  };
  copy(kCommandTrack, 0, recorded_commands(folder));
  copy(kRequestTrack, 0, read_acts(folder / "requests.log"));
  for (std::size_t wire = 0; wire < wires.size(); ++wire) {
    copy(wire_track(wire), kWireEnd, client_acts(folder, wires[wire].name));
  }
  writer.finish(std::min(to, reader.contents().end.value_or(last)));
  if (!trouble.empty()) {
    throw drivers::EndpointError(trouble);
  }
}

}  // namespace rigwire::hil

#include "hil/record/recording_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "drivers/endpoints.h"
#include "hil/record/output_file.h"
#include "protocols/bytes.h"
#include "protocols/can/frame_text.h"
#include "protocols/pcapng/link_packet.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
namespace pcapng = protocols::pcapng;

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

void append(std::vector<std::uint8_t>& out, std::string_view text) {
  out.insert(out.end(), text.begin(), text.end());
}

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

pcapng::LinkType link_of(WireKind kind) {
  switch (kind) {
    case WireKind::serial:
      return pcapng::LinkType::rtac_serial;
    case WireKind::can:
      return pcapng::LinkType::socketcan;
    case WireKind::ethernet:
      break;
  }
  return pcapng::LinkType::ethernet;
}

/// Throws drivers::EndpointError.
void write_whole(const fs::path& path, std::string_view text, const TellTrouble& tell) {
  RecordingFile file(path, tell);
  if (!file.write(bytes_of(text))) {
    throw drivers::EndpointError(fmt::format("the recording {}: no room", path.string()));
  }
}

}  // namespace

std::string instant_text(SimTime at) {
  const std::int64_t at_ns = at.time_since_epoch().count();
  return fmt::format("{}.{:09}", at_ns / 1'000'000'000, at_ns % 1'000'000'000);
}

std::string_view name_of(WireKind kind) {
  switch (kind) {
    case WireKind::serial:
      return "serial";
    case WireKind::can:
      return "can";
    case WireKind::ethernet:
      break;
  }
  return "ethernet";
}

struct RecordingWriter::Wire {
  RecordedWire about;
  std::uint32_t index = 0;
  std::unique_ptr<BlockFile> packets;
  std::unique_ptr<BlockFile> frames;  ///< Frames of a CAN bus in candump format.
  /// Changes of the client's end of a bus or a serial line.
  std::unique_ptr<BlockFile> ends;
  /// For a serial line: bytes that the device sent, bytes that it received, and their times.
  std::unique_ptr<RecordingFile> sent;
  std::unique_ptr<RecordingFile> received;
  std::unique_ptr<BlockFile> pieces;
  std::vector<std::uint8_t> sent_waiting;
  std::vector<std::uint8_t> received_waiting;
  std::string notes;            ///< For the next packet.
  std::uint64_t not_there = 0;  ///< Lost before they came to the writer, since the last packet.
  std::uint64_t dropped = 0;    ///< By the wire, since the last packet.
  std::optional<LidarClouds> clouds;
};

RecordingWriter::RecordingWriter(const fs::path& folder, RecordedRun run,
                                 std::vector<RecordedWire> wires, bool with_truth,
                                 const TellTrouble& tell)
    : folder_(folder), run_(std::move(run)) {
  totals_.wires.resize(wires.size());
  write_whole(folder_ / "rig.yaml", run_.configuration, tell);
  const pcapng::Section section{
      "rigwire " + run_.version,
      fmt::format("rig {}, seed {}, configuration {}", run_.rig, run_.seed, run_.config_hash)};
  if (!wires.empty()) {
    fs::create_directory(folder_ / "wires");
    all_ = std::make_unique<BlockFile>(folder_ / "all.pcapng", tell);
    pcapng::append(all_->bytes(), section);
  }
  commands_ = std::make_unique<BlockFile>(folder_ / "commands.log", tell);
  hil::append(commands_->bytes(), "# seconds, and what governed the run\n");
  if (run_.tells_requests) {
    requests_ = std::make_unique<BlockFile>(folder_ / "requests.log", tell);
    hil::append(requests_->bytes(),
                "# seconds up to when the truth had been asked, and from when on it followed\n");
  }
  for (RecordedWire& about : wires) {
    auto wire = std::make_unique<Wire>();
    wire->index = static_cast<std::uint32_t>(wires_.size());
    const auto path = [&](std::string_view extension) {
      return folder_ / "wires" / fmt::format("{}.{}", about.name, extension);
    };
    const pcapng::Interface interface { link_of(about.kind), about.name, about.address };
    wire->packets = std::make_unique<BlockFile>(path("pcapng"), tell);
    pcapng::append(wire->packets->bytes(), section);
    for (const auto& file : {all_.get(), wire->packets.get()}) {
      pcapng::append(file->bytes(), interface);
    }
    if (about.kind == WireKind::can) {
      wire->frames = std::make_unique<BlockFile>(path("log"), tell);
    } else if (about.kind == WireKind::serial) {
      wire->sent = std::make_unique<RecordingFile>(path("bytes"), tell);
      wire->received = std::make_unique<RecordingFile>(path("client"), tell);
      wire->pieces = std::make_unique<BlockFile>(path("index"), tell);
      hil::append(wire->pieces->bytes(),
                  fmt::format("# {0}: seconds, > offset and length in {0}.bytes, < in {0}.client\n",
                              about.name));
    }
    if (about.kind != WireKind::ethernet) {
      wire->ends = std::make_unique<BlockFile>(path("ends"), tell);
      hil::append(wire->ends->bytes(),
                  fmt::format("# {}: seconds, and what the client did with its end\n", about.name));
    }
    const auto lidar = std::ranges::find(run_.clouds.lidars, about.name, &RecordedLidar::name);
    if (lidar != run_.clouds.lidars.end() && run_.clouds.every > Duration{0} && with_truth) {
      wire->clouds.emplace(*lidar, run_.clouds.every);
    }
    wire->about = std::move(about);
    wires_.push_back(std::move(wire));
  }
  if (with_truth) {
    truth_ = std::make_unique<RecordingFile>(folder_ / "truth.mcap", tell);
    messages_.emplace("rigwire " + run_.version);
    for (const ChannelRow& row : channel_rows()) {
      const std::uint16_t schema = messages_->add_schema(row.schema_name, "jsonschema", row.schema);
      (void)messages_->add_channel(schema, row.topic, "json");
    }
    messages_->attach("rig.yaml", "application/yaml",
                      static_cast<std::uint64_t>(run_.start_unix_ns), run_.configuration);
    messages_->describe("rigwire", {{"version", run_.version},
                                    {"rig", run_.rig},
                                    {"seed", std::to_string(run_.seed)},
                                    {"config_hash", run_.config_hash},
                                    {"clock", run_.clock},
                                    {"start", run_.start_utc}});
    if (!truth_->write(messages_->bytes())) {
      throw drivers::EndpointError(
          fmt::format("the recording {}: no room", truth_->path().string()));
    }
    messages_->taken();
  }
  write_description(std::nullopt);
  flush();
}

RecordingWriter::~RecordingWriter() = default;

std::uint64_t RecordingWriter::unix_ns(SimTime at) const {
  return static_cast<std::uint64_t>(run_.start_unix_ns + at.time_since_epoch().count());
}

void RecordingWriter::lost(std::uint16_t track, std::uint64_t count) {
  if (track < kTruthTracks) {
    totals_.lost_messages += count;
  } else if (track > kRequestTrack) {
    const std::size_t index = track - wire_track(0);
    wires_[index]->not_there += count;
    totals_.wires[index].lost += count;
  }
}

void RecordingWriter::write_message(TruthTrack track, SimTime at, std::string_view text) {
  if (messages_) {
    const auto channel = static_cast<std::uint16_t>(track);
    messages_->write(channel, unix_ns(at), text);
    ++totals_.messages[channel];
    flush_messages();
  }
}

void RecordingWriter::write_cloud(Wire& wire, const RecordEntry& entry) {
  const auto datagram = pcapng::udp_packet(entry.bytes);
  if (datagram.ok()) {
    if (const auto cloud = wire.clouds->take(entry.at, datagram->bytes)) {
      write_message(TruthTrack::points, entry.at, json_message(*cloud, run_.start_unix_ns));
    }
  }
}

void RecordingWriter::write(const RecordEntry& entry) {
  if (entry.track < kTruthTracks) {
    write_message(static_cast<TruthTrack>(entry.track), entry.at, text_of(entry.bytes));
    return;
  }
  if (entry.track == kCommandTrack) {
    write_line(*commands_, entry);
    return;
  }
  if (entry.track == kRequestTrack) {
    write_line(*requests_, entry);
    return;
  }
  const std::size_t index = entry.track - wire_track(0);
  Wire& wire = *wires_[index];
  if ((entry.flags & kWireLost) != 0) {
    ++wire.dropped;
    ++totals_.wires[index].dropped_by_wire;
    return;
  }
  if ((entry.flags & kWireNote) != 0) {
    wire.notes += (wire.notes.empty() ? "" : "; ") + std::string(text_of(entry.bytes));
    return;
  }
  if ((entry.flags & kWireEnd) != 0) {
    if (wire.ends) {
      write_line(*wire.ends, entry);
    }
    return;
  }
  ++totals_.wires[index].packets;
  totals_.wires[index].bytes += entry.bytes.size();
  write_packet(wire, entry);
  if (wire.clouds && (entry.flags & kInbound) == 0) {
    write_cloud(wire, entry);
  }
  if (wire.frames) {
    write_frame(wire, entry);
  }
  if (wire.pieces) {
    write_piece(wire, entry);
  }
}

void RecordingWriter::write_packet(Wire& wire, const RecordEntry& entry) {
  pcapng::Packet packet;
  packet.time_ns = unix_ns(entry.at);
  packet.direction =
      (entry.flags & kInbound) != 0 ? pcapng::Direction::inbound : pcapng::Direction::outbound;
  pcapng::Bytes line;
  packet.bytes = entry.bytes;
  if (wire.about.kind == WireKind::serial) {
    pcapng::append_serial(line, packet.time_ns, packet.direction, entry.bytes);
    packet.bytes = line;
  }
  std::string notes = std::exchange(wire.notes, {});
  const auto note = [](std::string& all, const std::string& text) {
    all += (all.empty() ? "" : "; ") + text;
  };
  if (const std::uint64_t dropped = std::exchange(wire.dropped, 0); dropped != 0) {
    note(notes, fmt::format("{} before this found no room on the wire", dropped));
  }
  const std::uint64_t not_there = std::exchange(wire.not_there, 0);
  const auto put = [&](BlockFile& file, std::uint32_t interface) {
    // Packets that this file has lost since its last one, because the disk did not take them.
    const std::uint64_t lost = file.take_lost(wire.index);
    if (&file == wire.packets.get()) {
      totals_.wires[wire.index].lost += lost;
    }
    std::string comment = notes;
    packet.interface = interface;
    packet.lost_before = not_there + lost;
    if (packet.lost_before != 0) {
      note(comment, fmt::format("{} before this were not recorded", packet.lost_before));
    }
    packet.comment = comment;
    pcapng::append(file.bytes(), packet);
    file.end_unit(wire.index);
  };
  put(*all_, wire.index);
  put(*wire.packets, 0);
}

void RecordingWriter::write_frame(Wire& wire, const RecordEntry& entry) {
  std::string text;
  if (const auto frame = pcapng::can_frame(entry.bytes); frame.ok()) {
    text = protocols::can::frame_text(*frame);
  } else {  // an error frame
    text = fmt::format("{:08X}#", protocols::load_big<std::uint32_t>(entry.bytes, 0));
    for (const std::uint8_t byte : entry.bytes.subspan(8)) {
      fmt::format_to(std::back_inserter(text), "{:02X}", byte);
    }
  }
  const std::uint64_t time_us = unix_ns(entry.at) / 1000;
  // "R": received by a client, "T": sent by it.
  hil::append(wire.frames->bytes(),
              fmt::format("({}.{:06}) {} {} {}\n", time_us / 1'000'000, time_us % 1'000'000,
                          wire.about.name, text, (entry.flags & kInbound) != 0 ? 'T' : 'R'));
  wire.frames->end_unit(wire.index);
}

void RecordingWriter::write_piece(Wire& wire, const RecordEntry& entry) {
  const bool inbound = (entry.flags & kInbound) != 0;
  std::vector<std::uint8_t>& waiting = inbound ? wire.received_waiting : wire.sent_waiting;
  const RecordingFile& file = inbound ? *wire.received : *wire.sent;
  hil::append(wire.pieces->bytes(),
              fmt::format("{} {} {} {}\n", instant_text(entry.at), inbound ? '<' : '>',
                          file.size() + waiting.size(), entry.bytes.size()));
  waiting.insert(waiting.end(), entry.bytes.begin(), entry.bytes.end());
  if (waiting.size() >= BlockFile::kWorthWriting) {
    flush_serial(wire);
  }
}

void RecordingWriter::write_line(BlockFile& file, const RecordEntry& entry) {
  hil::append(file.bytes(), fmt::format("{} {}\n", instant_text(entry.at), text_of(entry.bytes)));
  file.end_unit(0);
}

/// Writes the bytes before their lines of the index, which names only bytes that are in the files.
void RecordingWriter::flush_serial(Wire& wire) {
  const bool sent = wire.sent_waiting.empty() || wire.sent->write(wire.sent_waiting);
  const bool received =
      wire.received_waiting.empty() || wire.received->write(wire.received_waiting);
  wire.sent_waiting.clear();
  wire.received_waiting.clear();
  if (sent && received) {
    wire.pieces->flush();
  } else {
    wire.pieces->bytes().clear();
    hil::append(wire.pieces->bytes(), "# pieces before this were not recorded\n");
  }
}

void RecordingWriter::flush_messages() {
  if (messages_->bytes().empty()) {
    return;
  }
  if (truth_->write(messages_->bytes())) {
    messages_->taken();
  } else {
    totals_.lost_messages += messages_->forget();
  }
}

void RecordingWriter::flush() {
  if (all_) {
    all_->flush();
  }
  commands_->flush();
  if (requests_) {
    requests_->flush();
  }
  for (const auto& wire : wires_) {
    wire->packets->flush();
    if (wire->frames) {
      wire->frames->flush();
    }
    if (wire->ends) {
      wire->ends->flush();
    }
    if (wire->pieces) {
      flush_serial(*wire);
    }
  }
}

void RecordingWriter::finish(SimTime end) {
  flush();
  for (const auto& wire : wires_) {
    RecordingTotals::Wire& total = totals_.wires[wire->index];
    const auto put = [&](BlockFile& file, std::uint32_t interface, bool counts) {
      const std::uint64_t lost = file.take_lost(wire->index);
      total.lost += counts ? lost : 0;
      pcapng::append(file.bytes(),
                     pcapng::Statistics{interface, unix_ns(end), total.packets, total.lost});
    };
    put(*all_, wire->index, false);
    put(*wire->packets, 0, true);
  }
  flush();
  if (messages_) {
    messages_->finish();
    flush_messages();
  }
  write_description(end);
}

void RecordingWriter::write_description(std::optional<SimTime> end) const {
  nlohmann::ordered_json json{{"rigwire_recording", 1},
                              {"version", run_.version},
                              {"rig", run_.rig},
                              {"seed", run_.seed},
                              {"config_hash", run_.config_hash},
                              {"clock", run_.clock},
                              {"start_utc", run_.start_utc},
                              {"start_unix_ns", run_.start_unix_ns},
                              {"begin_ns", run_.begin.time_since_epoch().count()},
                              {"truth_begin_ns", run_.truth_begin.time_since_epoch().count()},
                              {"clients_before", run_.clients_before},
                              {"configuration", "rig.yaml"}};
  if (messages_) {
    json["truth"] = "truth.mcap";
  }
  json["wires"] = nlohmann::ordered_json::array();
  for (const auto& wire : wires_) {
    nlohmann::ordered_json row{{"name", wire->about.name},
                               {"kind", name_of(wire->about.kind)},
                               {"address", wire->about.address},
                               {"file", fmt::format("wires/{}.pcapng", wire->about.name)}};
    if (end) {
      const RecordingTotals::Wire& total = totals_.wires[wire->index];
      row["packets"] = total.packets;
      row["bytes"] = total.bytes;
      row["lost"] = total.lost;
      row["dropped_by_wire"] = total.dropped_by_wire;
    }
    json["wires"].push_back(std::move(row));
  }
  // Whole at the end: a recording without is of a run that was killed.
  json["end_ns"] = end ? nlohmann::ordered_json(end->time_since_epoch().count())
                       : nlohmann::ordered_json(nullptr);
  if (messages_ && end) {
    json["lost_messages"] = totals_.lost_messages;
  }
  const WholeFile file("the recording's description", (folder_ / "recording.json").string());
  file.write(json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace rigwire::hil

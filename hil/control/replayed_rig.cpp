#include "hil/control/replayed_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hil/devices/device_types.h"
#include "hil/devices/replay.h"
#include "hil/record/recording.h"
#include "protocols/pcapng/link_packet.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
namespace pcapng = protocols::pcapng;

ConfiguredDevice replay_device(ReplayConfiguration configuration) {
  const auto types = device_types();
  const auto row = std::ranges::find(types, std::string_view("replay"),
                                     [](const DeviceType& type) { return type.named.name; });
  ConfiguredDevice device(static_cast<std::size_t>(row - types.begin()));
  dynamic_cast<ReplayConfiguration&>(*device) = std::move(configuration);
  return device;
}

/// Count of what the device of one wire sent within the piece.
struct Sent {
  std::uint64_t units = 0;
  std::uint64_t datagrams = 0;
};

}  // namespace

ReplayedRig replayed_rig(const fs::path& folder, const ReplayedPiece& piece) {
  const RecordingContents contents = read_recording_description(folder);
  ReplayedRig result;
  result.configuration = load_rig((folder / "rig.yaml").string(), {}).configuration;
  const std::map<std::string, ConfiguredDevice> recorded =
      std::exchange(result.configuration.devices, {});
  result.configuration.modbus.clear();
  result.configuration.truth = {};

  std::vector<Sent> sent(contents.wires.size());
  SimTime last = kStart;
  const SimTime from = kStart + piece.from;
  const SimTime to = piece.to == Duration{0} ? kNever : kStart + piece.to;
  each_packet(folder, [&](std::size_t wire, SimTime at, const pcapng::Packet& packet) {
    last = std::max(last, at);
    if (packet.direction == pcapng::Direction::inbound || at < from || at >= to) {
      return;
    }
    ++sent[wire].units;
    sent[wire].datagrams += contents.wires[wire].about.kind == WireKind::ethernet &&
                                    pcapng::udp_packet(packet.bytes).ok()
                                ? 1
                                : 0;
  });
  for (std::size_t i = 0; i < contents.wires.size(); ++i) {
    const RecordedWire& wire = contents.wires[i].about;
    ReplayConfiguration device;
    device.source.file = fs::absolute(folder / "wires" / (wire.name + ".pcapng")).string();
    device.source.zero_unix_ns = static_cast<std::uint64_t>(contents.run.start_unix_ns);
    device.source.start = piece.from;
    device.source.end = piece.to == Duration{0} ? last - kStart + Duration{1} : piece.to;
    device.source.speed = piece.speed;
    device.source.loop = piece.loop;
    const auto refuse = [&](const std::string& why) {
      result.remarks.push_back(fmt::format("{}: not played: {}", wire.name, why));
    };
    if (sent[i].units == 0) {
      refuse("its device sent nothing in this piece");
      continue;
    }
    if (wire.kind == WireKind::can) {
      device.wire = ReplayWire::can;
      device.bus = wire.name;
      if (!result.configuration.buses.contains(wire.name)) {
        refuse("the rig has no such bus");
        continue;
      }
    } else if (wire.kind == WireKind::serial) {
      device.path = wire.address;
      if (!wire.address.starts_with("/")) {
        refuse(wire.address + " is no pty");
        continue;
      }
    } else if (sent[i].datagrams == 0) {
      refuse("a server on TCP answers its clients, and a replay does not");
      continue;
    } else {
      device.wire = ReplayWire::udp;
      const std::size_t colon = wire.address.rfind(':');
      if (!wire.address.starts_with("udp ") || colon == std::string::npos) {
        refuse(wire.address + " is no place that datagrams go to");
        continue;
      }
      device.address = wire.address.substr(4, colon - 4);
      device.allow_remote = !device.address.starts_with("127.");  // as the recorded rig permitted
    }
    result.configuration.devices.emplace(wire.name, replay_device(std::move(device)));
  }
  if (result.configuration.devices.empty()) {
    throw std::invalid_argument(
        fmt::format("the recording {}: nothing in it can be played", folder.string()));
  }
  const Duration whole = std::min(to, contents.end.value_or(last)) - from;
  if (whole <= Duration{0}) {
    throw std::invalid_argument(
        fmt::format("the recording {}: it ends before --from", folder.string()));
  }
  result.length = Duration{std::llround(static_cast<long double>(whole.count()) / piece.speed)};
  return result;
}

}  // namespace rigwire::hil

#include "conform/gige_vision/gige_vision_trial.h"

#include <algorithm>
#include <cstdio>

#include "protocols/bytes.h"

namespace rigwire::conform {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
using protocols::load_big;
using std::chrono::milliseconds;

namespace {

constexpr std::size_t kHeader = 8;

std::string command_name(std::uint16_t command) {
  switch (command) {
    case Gvcp::kDiscovery:
      return "DISCOVERY";
    case Gvcp::kPacketResend:
      return "PACKETRESEND";
    case Gvcp::kReadRegisters:
      return "READREG";
    case Gvcp::kWriteRegisters:
      return "WRITEREG";
    case Gvcp::kReadMemory:
      return "READMEM";
    case Gvcp::kWriteMemory:
      return "WRITEMEM";
    default:
      return gige_address_text(command);
  }
}

std::uint32_t address_number(const std::string& dotted) {
  std::array<unsigned, 4> parts{};
  std::sscanf(dotted.c_str(), "%u.%u.%u.%u", &parts[0], &parts[1], &parts[2], &parts[3]);
  return parts[0] << 24U | parts[1] << 16U | parts[2] << 8U | parts[3];
}

}  // namespace

GigeBytes gige_word(std::uint32_t value) {
  return {static_cast<std::uint8_t>(value >> 24U), static_cast<std::uint8_t>(value >> 16U),
          static_cast<std::uint8_t>(value >> 8U), static_cast<std::uint8_t>(value)};
}

std::string gige_address_text(std::uint32_t address) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%04X", address);
  return text.data();
}

std::string gige_status_text(std::uint16_t status) {
  struct Word {
    GigeStatus status;
    const char* text;
  };
  static constexpr std::array<Word, 11> kWords{
      {{GigeStatus::success, "success"},
       {GigeStatus::not_implemented, "not implemented"},
       {GigeStatus::invalid_parameter, "invalid parameter"},
       {GigeStatus::invalid_address, "invalid address"},
       {GigeStatus::write_protect, "write protect"},
       {GigeStatus::bad_alignment, "bad alignment"},
       {GigeStatus::access_denied, "access denied"},
       {GigeStatus::busy, "busy"},
       {GigeStatus::packet_unavailable, "packet unavailable"},
       {GigeStatus::invalid_header, "invalid header"},
       {GigeStatus::error, "error"}}};
  const auto* const known =
      std::ranges::find(kWords, static_cast<GigeStatus>(status), &Word::status);
  return gige_address_text(status) +
         (known == kWords.end() ? "" : std::string(" (") + known->text + ")");
}

std::uint32_t GigeVisionTrial::Answer::word(std::size_t index) const {
  return load_big<std::uint32_t>(payload, 4 * index);
}

GigeVisionTrial::GigeVisionTrial(CaseIdentity identity, GigeVisionDevice& device)
    : Trial(std::move(identity),
            [&device] {
              return device.line ? device.line->now() : DatagramLine::Clock::time_point();
            }),
      device_(&device) {
  if (device_->line == nullptr) {
    device_->bounds->check();
    device_->line = bounded(device_->open(), device_->bounds);
    restart_clock();
  }
  drain();
}

void GigeVisionTrial::drain() {
  const auto end = now() + kDrain;
  while (now() < end && device_->line->receive(now())) {
  }
  for (auto& waiting : device_->arrived) {
    waiting.clear();
  }
  device_->waiting_bytes = 0;
}

void GigeVisionTrial::keep_waiting(DatagramLine::Datagram datagram) {
  device_->waiting_bytes += datagram.bytes.size() + kItem_bytes;
  if (device_->waiting_bytes > kDatagramLimits.question) {
    const std::string most = std::to_string(kDatagramLimits.question >> 20U) + " MiB";
    drain();
    throw TooMuch("at most " + most + " of data that was not requested", "more than " + most);
  }
  device_->arrived.at(datagram.at_port).push_back(std::move(datagram));
}

void GigeVisionTrial::wait(std::chrono::nanoseconds span) {
  const auto deadline = now() + span;
  while (auto datagram = device_->line->receive(deadline)) {
    keep_waiting(std::move(*datagram));
    if (now() >= deadline && span.count() > 0) {
      break;
    }
  }
}

std::optional<DatagramLine::Datagram> GigeVisionTrial::hear(
    std::size_t port, DatagramLine::Clock::time_point deadline) {
  auto& waiting = device_->arrived.at(port);
  while (waiting.empty()) {
    auto datagram = device_->line->receive(deadline);
    if (!datagram) {
      return std::nullopt;
    }
    keep_waiting(std::move(*datagram));
  }
  DatagramLine::Datagram first = std::move(waiting.front());
  waiting.pop_front();
  device_->waiting_bytes -= first.bytes.size() + kItem_bytes;
  return first;
}

std::vector<DatagramLine::Datagram> GigeVisionTrial::listen(std::chrono::nanoseconds span) {
  std::vector<DatagramLine::Datagram> all;
  const auto deadline = now() + span;
  while (auto datagram = hear(kStream, deadline)) {
    all.push_back(std::move(*datagram));
    if (now() >= deadline) {
      break;
    }
  }
  return all;
}

GigeBytes GigeVisionTrial::framed(std::uint16_t command, const GigeBytes& payload,
                                  std::uint16_t request, std::uint8_t flags) {
  const GigeBytes header{0x42,
                         flags,
                         static_cast<std::uint8_t>(command >> 8U),
                         static_cast<std::uint8_t>(command),
                         static_cast<std::uint8_t>(payload.size() >> 8U),
                         static_cast<std::uint8_t>(payload.size()),
                         static_cast<std::uint8_t>(request >> 8U),
                         static_cast<std::uint8_t>(request)};
  return header + payload;
}

std::uint16_t GigeVisionTrial::next_request() {
  device_->request = static_cast<std::uint16_t>(device_->request % 0xFFFFU + 1U);
  return device_->request;
}

bool GigeVisionTrial::send(const GigeBytes& bytes, const std::string& words, std::size_t port) {
  sent(bytes, words + (port == kOther ? ", of another application" : ""));
  return expect(device_->line->send(port, device_->camera, bytes), "the network takes a command",
                "it does not");
}

std::optional<GigeVisionTrial::Answer> GigeVisionTrial::answer(std::uint16_t command,
                                                               std::uint16_t request,
                                                               std::size_t port) {
  auto deadline = now() + claims().patience;
  constexpr std::chrono::seconds kLongestPending{70};  // One PENDING_ACK says at most 65.5 s.
  const auto end = deadline + kLongestPending;
  while (const auto datagram = hear(port, deadline)) {
    const GigeBytes& bytes = datagram->bytes;
    const bool whole =
        bytes.size() >= kHeader && load_big<std::uint16_t>(bytes, 4) == bytes.size() - kHeader;
    received(bytes, whole ? gige_status_text(load_big<std::uint16_t>(bytes, 0)) : "no answer");
    if (!demand(whole, "an answer as long as it says", std::to_string(bytes.size()) + " bytes")) {
      return std::nullopt;
    }
    Answer found{load_big<std::uint16_t>(bytes, 0),
                 load_big<std::uint16_t>(bytes, 2),
                 load_big<std::uint16_t>(bytes, 6),
                 {bytes.begin() + kHeader, bytes.end()}};
    if (found.code == Gvcp::kPending && found.request == request && found.payload.size() >= 4) {
      deadline = std::min(now() + milliseconds(load_big<std::uint16_t>(found.payload, 2)), end);
      continue;
    }
    if (!demand(found.request == request, "an answer to request " + std::to_string(request),
                "to " + std::to_string(found.request)) ||
        !demand(found.code == command + 1U, "the code " + gige_address_text(command + 1U),
                gige_address_text(found.code)) ||
        !demand(datagram->from == device_->camera, "an answer from where it was asked",
                datagram->from.address + ":" + std::to_string(datagram->from.port))) {
      return std::nullopt;
    }
    return found;
  }
  expect(false,
         "an answer to " + command_name(command) + " within " +
             std::to_string(claims().patience.count()) + " ms",
         "none");
  return std::nullopt;
}

std::optional<GigeVisionTrial::Answer> GigeVisionTrial::ask(std::uint16_t command,
                                                            const GigeBytes& payload,
                                                            std::size_t port) {
  const std::uint16_t request = next_request();
  return send(framed(command, payload, request), command_name(command), port)
             ? answer(command, request, port)
             : std::nullopt;
}

bool GigeVisionTrial::silent(const std::string& about, std::size_t port) {
  const auto heard = hear(port, now() + std::min(claims().patience, milliseconds(300)));
  if (heard) {
    received(heard->bytes, "an answer");
  }
  return expect(!heard, "no answer to " + about, heard ? hex_text(heard->bytes, 16) : "");
}

void GigeVisionTrial::refused(std::uint16_t command, const GigeBytes& payload, GigeStatus right,
                              std::size_t port) {
  if (const auto found = ask(command, payload, port)) {
    demand(!found->good(), "an error", gige_status_text(found->status));
    expect(found->status == static_cast<std::uint16_t>(right),
           gige_status_text(static_cast<std::uint16_t>(right)), gige_status_text(found->status));
  }
}

std::optional<std::uint16_t> GigeVisionTrial::status_of_read(std::uint32_t address,
                                                             std::size_t port) {
  const auto found = ask(Gvcp::kReadRegisters, gige_word(address), port);
  return found ? std::optional(found->status) : std::nullopt;
}

std::optional<std::uint16_t> GigeVisionTrial::status_of_write(std::uint32_t address,
                                                              std::uint32_t value,
                                                              std::size_t port) {
  const auto found = ask(Gvcp::kWriteRegisters, gige_word(address) + gige_word(value), port);
  return found ? std::optional(found->status) : std::nullopt;
}

std::optional<std::uint32_t> GigeVisionTrial::read(std::uint32_t address, std::size_t port) {
  const auto found = ask(Gvcp::kReadRegisters, gige_word(address), port);
  if (!found ||
      !expect(found->good(), "register " + gige_address_text(address) + " read",
              gige_status_text(found->status)) ||
      !demand(found->payload.size() == 4, "a value of four bytes",
              std::to_string(found->payload.size()) + " bytes")) {
    return std::nullopt;
  }
  return found->word(0);
}

std::optional<GigeBytes> GigeVisionTrial::read_memory(std::uint32_t address, unsigned count) {
  const auto found = ask(Gvcp::kReadMemory, gige_word(address) + gige_word(count));
  if (!found ||
      !expect(found->good(),
              std::to_string(count) + " bytes from " + gige_address_text(address) + " read",
              gige_status_text(found->status)) ||
      !demand(found->payload.size() == 4 + std::size_t{count} && found->word(0) == address,
              "the address and as many bytes as were asked for",
              std::to_string(found->payload.size()) + " bytes")) {
    return std::nullopt;
  }
  return GigeBytes(found->payload.begin() + 4, found->payload.end());
}

std::optional<std::string> GigeVisionTrial::read_text(std::uint32_t address, unsigned count) {
  const auto bytes = read_memory(address, count);
  return bytes ? std::optional(
                     std::string(bytes->begin(), std::find(bytes->begin(), bytes->end(), 0)))
               : std::nullopt;
}

bool GigeVisionTrial::write(std::uint32_t address, std::uint32_t value, std::size_t port) {
  const auto status = status_of_write(address, value, port);
  return status &&
         expect((*status & 0x8000U) == 0, "register " + gige_address_text(address) + " written",
                gige_status_text(*status));
}

bool GigeVisionTrial::take_control() {
  return write(boot::kControlPrivilege, gev::Privilege::kControl);
}

void GigeVisionTrial::leave() {
  for (const std::size_t port : {kOwn, kOther}) {
    const std::uint16_t request = next_request();
    const GigeBytes bytes =
        framed(Gvcp::kWriteRegisters, gige_word(boot::kControlPrivilege) + gige_word(0), request);
    if (device_->line->send(port, device_->camera, bytes)) {
      static_cast<void>(hear(port, now() + claims().patience));
    }
  }
  drain();
}

std::optional<GigeStreamPacket> gige_stream_packet(const DatagramLine::Datagram& datagram) {
  const GigeBytes& bytes = datagram.bytes;
  if (bytes.size() < 8) {
    return std::nullopt;
  }
  GigeStreamPacket packet;
  packet.datagram = datagram;
  packet.status = load_big<std::uint16_t>(bytes, 0);
  const unsigned format = bytes[4];
  packet.extended_ids = (format & 0x80U) != 0;
  packet.format = format & 0x7FU;
  if (packet.extended_ids && bytes.size() < 20) {
    return std::nullopt;
  }
  packet.block =
      packet.extended_ids ? load_big<std::uint64_t>(bytes, 8) : load_big<std::uint16_t>(bytes, 2);
  packet.packet = packet.extended_ids ? load_big<std::uint32_t>(bytes, 16)
                                      : load_big<std::uint32_t>(bytes, 4) & 0xFF'FFFFU;
  packet.payload = {bytes.begin() + (packet.extended_ids ? 20 : 8), bytes.end()};
  return packet;
}

namespace {

/// Blocks from what came, in the order in which they began; the last may go on.
void collect(GigeStream& stream, const std::vector<DatagramLine::Datagram>& datagrams) {
  for (const DatagramLine::Datagram& datagram : datagrams) {
    auto packet = gige_stream_packet(datagram);
    if (!packet) {
      stream.strange.push_back({datagram, 0, 0, 0, 0, false, {}});
      continue;
    }
    if (stream.blocks.empty() || stream.blocks.back().number != packet->block) {
      const auto known = std::ranges::find(stream.blocks, packet->block, &GigeBlock::number);
      if (known != stream.blocks.end()) {
        known->in_order = false;
        known->packets.try_emplace(packet->packet, std::move(*packet));
        continue;
      }
      stream.blocks.push_back({packet->block, {}, 0, true});
    }
    GigeBlock& block = stream.blocks.back();
    const bool next = block.packets.empty() ? packet->packet == 0
                                            : packet->packet == block.packets.rbegin()->first + 1;
    const auto [place, added] = block.packets.try_emplace(packet->packet, std::move(*packet));
    block.repeated += added ? 0U : 1U;
    block.in_order = block.in_order && (next || !added);
  }
  if (!stream.blocks.empty() && stream.blocks.back().packets.rbegin()->second.format != 2) {
    stream.blocks.pop_back();
  }
}

GigeStream listened(GigeVisionTrial& trial) {
  GigeStream stream;
  const GigeVisionClaims& claims = trial.claims();
  GigeVisionDevice& device = trial.device();
  const auto high = trial.read(boot::kTickFrequencyHigh);
  const auto low = trial.read(boot::kTickFrequencyLow);
  const std::uint16_t own_port = device.line->own(GigeVisionTrial::kStream).port;
  if (!high || !low || !trial.take_control() ||
      !trial.write(boot::kStreamDestination, address_number(device.own_address)) ||
      !trial.write(boot::kStreamPort, own_port)) {
    stream.failure = "control or stream channel not had";
    return stream;
  }
  stream.tick_frequency_hz = std::uint64_t{*high} << 32U | *low;
  const auto size = trial.read(boot::kStreamPacketSize);
  stream.packet_size = size.value_or(0) & gev::PacketSize::kSize;
  if (const auto port = trial.status_of_read(boot::kStreamSourcePort);
      port && (*port & 0x8000U) == 0) {
    stream.source_port =
        static_cast<std::uint16_t>(trial.read(boot::kStreamSourcePort).value_or(0));
  }
  if (claims.payload_size) {
    stream.payload_size = trial.read(*claims.payload_size).value_or(0);
  }
  const std::uint64_t lost_before = device.line->lost_here();
  if (!trial.write(claims.start->address, claims.start->value)) {
    stream.failure = "the acquisition did not begin";
    return stream;
  }
  std::vector<DatagramLine::Datagram> all;
  // Heartbeats keep control meanwhile.
  for (int i = 0; i < 4; ++i) {
    auto some = trial.listen(milliseconds(500));
    std::ranges::move(some, std::back_inserter(all));
    static_cast<void>(trial.read(boot::kControlPrivilege));
  }
  static_cast<void>(trial.write(claims.stop->address, claims.stop->value));
  collect(stream, all);
  stream.lost_here = device.line->lost_here() - lost_before;
  if (stream.blocks.empty()) {
    stream.failure = "no whole block came in two seconds";
  }
  return stream;
}

}  // namespace

const GigeStream& gige_stream(GigeVisionTrial& trial) {
  GigeVisionDevice& device = trial.device();
  if (!device.stream) {
    device.stream = listened(trial);
    trial.leave();
  }
  return *device.stream;
}

std::vector<GigeVisionCase> gige_cases_of(std::span<const GigeVisionRow> rows) {
  static constexpr const char* kSource =
      "GVCP and GVSP as Wireshark 4.0 (packet-gvcp.c, packet-gvsp.c) and Aravis 0.8.26 speak them";
  std::vector<GigeVisionCase> all;
  Citations citations("gige-vision", "");
  for (const GigeVisionRow& row : rows) {
    all.push_back({citations.next_in(row.chapter, row.title, kSource, row.strength, row.danger),
                   row.capability, row.acquires, row.run});
  }
  return all;
}

std::vector<GigeVisionCase> gige_cases_in_control_of(std::span<const GigeVisionRow> rows) {
  std::vector<GigeVisionCase> all = gige_cases_of(rows);
  for (GigeVisionCase& each : all) {
    each.run = [run = std::move(each.run)](GigeVisionTrial& trial) {
      try {
        run(trial);
      } catch (const TooMuch&) {
        trial.leave();
        throw;
      }
      trial.leave();
    };
  }
  return all;
}

}  // namespace rigwire::conform

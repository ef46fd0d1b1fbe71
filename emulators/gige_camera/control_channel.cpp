#include "emulators/gige_camera/control_channel.h"

#include <algorithm>

#include "protocols/bytes.h"

namespace rigwire::emulators {
namespace {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
using gev::CommandCode;
using gev::GvcpPacket;
using gev::Status;

constexpr std::uint32_t kBroadcast = 0xFFFF'FFFF;

/// Begins the acknowledge of a read command.
GvcpPacket begin(CommandCode command, std::uint16_t request, Status status = Status::success) {
  return gev::begin_acknowledge(status, gev::acknowledge_code(static_cast<std::uint16_t>(command)),
                                request);
}

}  // namespace

ControlChannel::ControlChannel(RegisterBank& bank, ControlledDevice& device, DatagramOutput& output,
                               const CameraAddress& permitted)
    : bank_(bank), device_(device), output_(output), permitted_(permitted) {}

void ControlChannel::receive(SimTime now, const UdpEnd& from,
                             std::span<const std::uint8_t> datagram) {
  received_.bytes += datagram.size();
  advance(now);
  if (!permitted_.contains(from.address)) {
    ++received_.ignored;
    return;
  }
  const auto packet = gev::decode_command(datagram);
  if (!packet.ok()) {
    ++received_.malformed;
    if (const auto header = gev::peek_header(datagram)) {
      refuse(now, from, *header, Status::invalid_header);
    }
    return;
  }
  requester_ = from;
  if (is_primary(from)) {
    heard_ = now;
  }
  act(now, from, *packet, datagram);
}

void ControlChannel::act(SimTime now, const UdpEnd& from, const gev::CommandPacket& packet,
                         std::span<const std::uint8_t> datagram) {
  const std::variant<gev::Command, Status> interpreted = gev::interpret(packet);
  if (const auto* const status = std::get_if<Status>(&interpreted)) {
    ++(*status == Status::not_implemented ? received_.ignored : received_.malformed);
    refuse(now, from, packet, *status);
    return;
  }
  const gev::Command& command = std::get<gev::Command>(interpreted);
  ++received_.accepted;
  if (const auto* const discovery = std::get_if<gev::Discovery>(&command)) {
    discover(now, from, packet, discovery->broadcast_answer);
    return;
  }
  if (const auto* const resend = std::get_if<gev::PacketResend>(&command)) {
    // It comes from the socket of the stream: same host, another port. Packets are its answer.
    if (primary_ && primary_->address == from.address) {
      device_.resend(now, *resend);
    }
    return;
  }
  if (const auto* const read = std::get_if<gev::ReadRegisters>(&command)) {
    if (packet.wants_acknowledge()) {
      send(now, from, answer(from, packet.request, *read));
    }
    return;
  }
  if (const auto* const read = std::get_if<gev::ReadMemory>(&command)) {
    if (packet.wants_acknowledge()) {
      send(now, from, answer(from, packet.request, *read));
    }
    return;
  }
  // What is left has an effect, which a command that comes again must not have again.
  GvcpPacket acknowledge;
  if (const Answered* const before = answered_before(from, datagram)) {
    acknowledge = before->acknowledge;
  } else {
    if (const auto* const force = std::get_if<gev::ForceIp>(&command)) {
      const Status status = primary_ ? Status::access_denied : device_.force_ip(now, *force);
      if (status == Status::invalid_address) {  // another device is meant
        return;
      }
      acknowledge = begin(CommandCode::force_ip, packet.request, status);
    } else if (const auto* const words = std::get_if<gev::WriteRegisters>(&command)) {
      acknowledge = answer(from, packet.request, *words);
    } else {
      acknowledge = answer(from, packet.request, std::get<gev::WriteMemory>(command));
    }
    remember(from, datagram, acknowledge);
  }
  if (packet.wants_acknowledge()) {
    send(now, from, acknowledge);
  }
}

void ControlChannel::refuse(SimTime now, const UdpEnd& from, const gev::CommandPacket& packet,
                            Status status) {
  if (packet.wants_acknowledge()) {
    send(now, from,
         gev::encode_acknowledge(status, gev::acknowledge_code(packet.command), packet.request));
  }
}

void ControlChannel::discover(SimTime now, const UdpEnd& from, const gev::CommandPacket& packet,
                              bool broadcast_answer) {
  if (!packet.wants_acknowledge()) {
    return;
  }
  GvcpPacket acknowledge = begin(CommandCode::discovery, packet.request);
  [[maybe_unused]] const Status status =
      bank_.read(0, acknowledge.extend(gev::kDiscoverySize), device_);
  assert(status == Status::success);
  acknowledge.finish();
  // A client in another network than the device is reached by broadcast, where it allows that.
  const CameraAddress own{bank_.word(boot::kCurrentAddress), bank_.word(boot::kCurrentMask), 0};
  const bool broadcast = broadcast_answer && !own.contains(from.address);
  send(now, broadcast ? UdpEnd{kBroadcast, from.port} : from, acknowledge);
}

bool ControlChannel::may_read(const UdpEnd& from, std::uint32_t address) const {
  const bool exclusive = (bank_.word(boot::kControlPrivilege) & gev::Privilege::kExclusive) != 0;
  return !exclusive || is_primary(from) || address == boot::kControlPrivilege;
}

bool ControlChannel::may_write(const UdpEnd& from, std::uint32_t address) const {
  return primary_ ? is_primary(from) : address == boot::kControlPrivilege;
}

GvcpPacket ControlChannel::answer(const UdpEnd& from, std::uint16_t request,
                                  const gev::ReadRegisters& command) {
  GvcpPacket acknowledge = begin(CommandCode::read_registers, request);
  for (std::size_t i = 0; i < command.addresses.size(); ++i) {
    const std::uint32_t address = command.addresses[i];
    std::array<std::uint8_t, 4> value{};
    const Status status =
        may_read(from, address) ? bank_.read(address, value, device_) : Status::access_denied;
    if (is_error(status)) {
      return begin(CommandCode::read_registers, request, status);
    }
    acknowledge.append(value);
  }
  acknowledge.finish();
  return acknowledge;
}

GvcpPacket ControlChannel::answer(const UdpEnd& from, std::uint16_t request,
                                  const gev::ReadMemory& command) {
  GvcpPacket acknowledge = begin(CommandCode::read_memory, request);
  acknowledge.word(command.address);
  // Only CCP as a whole can be read by everybody.
  const bool allowed = may_read(from, command.address) &&
                       (command.count == 4 || may_read(from, command.address + 4));
  const Status status =
      allowed ? bank_.read(command.address, acknowledge.extend(command.count), device_)
              : Status::access_denied;
  if (is_error(status)) {
    return begin(CommandCode::read_memory, request, status);
  }
  acknowledge.finish();
  return acknowledge;
}

GvcpPacket ControlChannel::answer(const UdpEnd& from, std::uint16_t request,
                                  const gev::WriteRegisters& command) {
  Status status = Status::success;
  std::uint16_t written = 0;
  for (std::size_t i = 0; i < command.size() && !is_error(status); ++i) {
    const std::uint32_t address = command.address(i);
    if (!may_write(from, address)) {
      status = Status::access_denied;
      break;
    }
    std::array<std::uint8_t, 4> value{};
    protocols::store_big(std::span<std::uint8_t>(value), 0, command.value(i));
    status = bank_.write(address, value, device_).status;
    written = static_cast<std::uint16_t>(written + (is_error(status) ? 0 : 1));
  }
  return gev::encode_written(status, CommandCode::write_registers, request, written);
}

GvcpPacket ControlChannel::answer(const UdpEnd& from, std::uint16_t request,
                                  const gev::WriteMemory& command) {
  const bool allowed = may_write(from, command.address) &&
                       (command.bytes.size() == 4 || may_write(from, command.address + 4));
  const RegisterBank::Written written = allowed
                                            ? bank_.write(command.address, command.bytes, device_)
                                            : RegisterBank::Written{Status::access_denied, 0};
  return gev::encode_written(written.status, CommandCode::write_memory, request,
                             static_cast<std::uint16_t>(written.bytes));
}

const ControlChannel::Answered* ControlChannel::answered_before(
    const UdpEnd& from, std::span<const std::uint8_t> datagram) const {
  const auto found = std::ranges::find_if(answered_, [&](const Answered& a) {
    return a.size == datagram.size() && a.from == from &&
           std::ranges::equal(std::span(a.command).first(a.size), datagram);
  });
  return found == answered_.end() ? nullptr : &*found;
}

void ControlChannel::remember(const UdpEnd& from, std::span<const std::uint8_t> datagram,
                              const GvcpPacket& acknowledge) {
  auto place = std::ranges::find_if(
      answered_, [&from](const Answered& a) { return a.size > 0 && a.from == from; });
  if (place == answered_.end()) {
    place = answered_.begin() + static_cast<std::ptrdiff_t>(next_answered_);
    next_answered_ = (next_answered_ + 1) % answered_.size();
  }
  place->from = from;
  std::ranges::copy(datagram, place->command.begin());
  place->size = datagram.size();
  place->acknowledge = acknowledge;
}

void ControlChannel::send(SimTime now, const UdpEnd& to, const GvcpPacket& packet) {
  output_.send(now, to, packet.view(), false);
}

Status ControlChannel::privilege_written(SimTime now, std::uint32_t value) {
  if ((value & ~(gev::Privilege::kControl | gev::Privilege::kExclusive)) != 0) {
    return Status::invalid_parameter;
  }
  if (value == 0) {
    end_control(now);
    return Status::success;
  }
  primary_ = requester_;
  heard_ = now;
  bank_.set_word(boot::kPrimaryAddress, requester_.address);
  bank_.set_word(boot::kPrimaryPort, requester_.port);
  return Status::success;
}

void ControlChannel::end_control(SimTime now) {
  const bool had = primary_.has_value();
  // The next client may have the same port, and count its requests from the same number.
  for (Answered& answered : answered_) {
    answered.size = is_primary(answered.from) ? 0 : answered.size;
  }
  primary_.reset();
  bank_.set_word(boot::kControlPrivilege, 0);
  bank_.set_word(boot::kPrimaryAddress, 0);
  bank_.set_word(boot::kPrimaryPort, 0);
  if (had) {
    device_.control_ended(now);
  }
}

SimTime ControlChannel::next_event() const {
  const bool for_ever =
      (bank_.word(boot::kConfiguration) & gev::Configuration::kHeartbeatDisable) != 0;
  if (!primary_ || for_ever) {
    return kNever;
  }
  return heard_ + std::chrono::milliseconds{bank_.word(boot::kHeartbeatTimeout)};
}

void ControlChannel::advance(SimTime now) {
  if (next_event() <= now) {
    end_control(now);
  }
}

}  // namespace rigwire::emulators

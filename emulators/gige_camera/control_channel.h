// The control channel of a GigE Vision device: who controls it, for how long, and what it answers.
//
// One application at a time can control the device: it writes CCP and is then the primary
// application, known by its address and port, until it writes 0 or is silent for the heartbeat
// timeout. Without a primary application nothing but CCP can be written. With control access others
// may read; with exclusive access they may read CCP only. Every command of the primary application
// that can be understood is a heartbeat. DISCOVERY is always answered.
//
// A command that writes and comes once more (same sender, same bytes, so the same request number)
// is answered once more and not acted on: a lost acknowledge must not trigger twice.
//
// A device's answer to what it cannot understand: nothing when it is no command at all, otherwise
// an acknowledge with the status of interpret() (protocols/gige_vision/gvcp.h).
//
// Source: Aravis 0.8.26 (src/arvgvdevice.c: what a client expects; src/arvgvfakecamera.c).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "emulators/device.h"
#include "emulators/gige_camera/datagram.h"
#include "emulators/gige_camera/gige_camera_settings.h"
#include "emulators/gige_camera/register_bank.h"
#include "protocols/gige_vision/gvcp.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// The device behind the channel.
class ControlledDevice : public RegisterOwner {
 public:
  /// The primary application has gone, by its own will or by its silence.
  virtual void control_ended(SimTime now) = 0;
  /// invalid_address: another device is meant, and nothing is answered.
  [[nodiscard]] virtual protocols::gige_vision::Status force_ip(
      SimTime now, const protocols::gige_vision::ForceIp& command) = 0;
  /// Called only for a sender with the address of the primary application.
  virtual void resend(SimTime now, const protocols::gige_vision::PacketResend& command) = 0;
};

class ControlChannel {
 public:
  using Status = protocols::gige_vision::Status;

  /// They must outlive it. Requests from outside `permitted` are not answered.
  ControlChannel(RegisterBank& bank, ControlledDevice& device, DatagramOutput& output,
                 const CameraAddress& permitted);

  void receive(SimTime now, const UdpEnd& from, std::span<const std::uint8_t> datagram);
  /// Ends the control of an application that has been silent for too long.
  void advance(SimTime now);
  /// Returns when that will be, if it stays silent.
  [[nodiscard]] SimTime next_event() const;

  /// Called when the command in work has written CCP. Returns whether the write is permitted.
  [[nodiscard]] Status privilege_written(SimTime now, std::uint32_t value);
  /// Ends the control as if the primary application had gone.
  void end_control(SimTime now);
  /// Forgets the answers kept for repeated commands (power-on).
  void forget() { answered_ = {}; }
  [[nodiscard]] const std::optional<UdpEnd>& primary() const { return primary_; }
  [[nodiscard]] const ReceiveCounters& received() const { return received_; }

 private:
  /// The last writing command of one client, and what it was answered.
  struct Answered {
    UdpEnd from;
    std::array<std::uint8_t, protocols::gige_vision::kGvcpSizeMaximum> command{};
    std::size_t size = 0;  ///< 0: nothing.
    protocols::gige_vision::GvcpPacket acknowledge;
  };

  [[nodiscard]] bool is_primary(const UdpEnd& from) const { return primary_ && *primary_ == from; }
  [[nodiscard]] bool may_read(const UdpEnd& from, std::uint32_t address) const;
  [[nodiscard]] bool may_write(const UdpEnd& from, std::uint32_t address) const;

  void act(SimTime now, const UdpEnd& from, const protocols::gige_vision::CommandPacket& packet,
           std::span<const std::uint8_t> datagram);
  void refuse(SimTime now, const UdpEnd& from, const protocols::gige_vision::CommandPacket& packet,
              Status status);
  void discover(SimTime now, const UdpEnd& from,
                const protocols::gige_vision::CommandPacket& packet, bool broadcast_answer);
  [[nodiscard]] protocols::gige_vision::GvcpPacket answer(
      const UdpEnd& from, std::uint16_t request,
      const protocols::gige_vision::ReadRegisters& command);
  [[nodiscard]] protocols::gige_vision::GvcpPacket answer(
      const UdpEnd& from, std::uint16_t request, const protocols::gige_vision::ReadMemory& command);
  [[nodiscard]] protocols::gige_vision::GvcpPacket answer(
      const UdpEnd& from, std::uint16_t request,
      const protocols::gige_vision::WriteRegisters& command);
  [[nodiscard]] protocols::gige_vision::GvcpPacket answer(
      const UdpEnd& from, std::uint16_t request,
      const protocols::gige_vision::WriteMemory& command);
  [[nodiscard]] const Answered* answered_before(const UdpEnd& from,
                                                std::span<const std::uint8_t> datagram) const;
  void remember(const UdpEnd& from, std::span<const std::uint8_t> datagram,
                const protocols::gige_vision::GvcpPacket& acknowledge);
  void send(SimTime now, const UdpEnd& to, const protocols::gige_vision::GvcpPacket& packet);

  RegisterBank& bank_;
  ControlledDevice& device_;
  DatagramOutput& output_;
  const CameraAddress& permitted_;

  std::optional<UdpEnd> primary_;
  UdpEnd requester_;  ///< Sender of the command in work.
  SimTime heard_{};   ///< When the primary application last sent something.
  std::array<Answered, 4> answered_;
  std::size_t next_answered_ = 0;
  ReceiveCounters received_;
};

}  // namespace rigwire::emulators

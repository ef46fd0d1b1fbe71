// A GigE Vision camera on the wire: one image, stereo or depth, by its settings.
//
// Wire face: datagrams of clients to its port 3956 go to receive(); answers leave by `control`, the
// stream by `stream`, each with its due time. Backend face: what the camera wants of its sensor is
// command() and sample_plan(), pictures come by update().
//
// What it does:
// - It is found (DISCOVERY), described (GenICam XML at 0x10000), controlled by one application with
//   a heartbeat (control_channel.h), and streams to where that application says (stream_channel.h).
// - Time stamps are nanoseconds of simulated time since the start or the last reset.
// - Settings that change the size of a block are refused while it acquires; the others act from the
//   next exposure on.
// - With several components it sends one multi-part block for each exposure where the client has
//   switched that on (bit 6 of SCCFG), otherwise one block for each component, one after the other
//   with the same time stamp.
// - User-defined name, persistent address and IP configuration are kept in its memory.
// - FORCEIP is carried out only while no application has control; it changes address().
// - When control ends the acquisition ends and the stream is closed.
// - Without supply it is off the network; when the supply comes back it starts with its power-on
//   registers and what its memory has, as after DeviceReset.
//
// What it is not: certified, or tested with other clients than Aravis and Wireshark. It has no
// message channel, no actions, no IEEE 1588.
//
// Sources: protocols/gige_vision/; SFNC 2.x for the features.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "emulators/device.h"
#include "emulators/gige_camera/acquisition.h"
#include "emulators/gige_camera/camera_backend.h"
#include "emulators/gige_camera/camera_features.h"
#include "emulators/gige_camera/control_channel.h"
#include "emulators/gige_camera/faulty_stream.h"
#include "emulators/gige_camera/gige_camera_settings.h"
#include "emulators/gige_camera/register_bank.h"
#include "emulators/gige_camera/stream_channel.h"
#include "emulators/live_setting.h"
#include "emulators/nonvolatile_memory.h"
#include "emulators/random_bits.h"
#include "emulators/supply.h"

namespace rigwire::emulators {

struct GigeCameraCounters {
  std::uint64_t pictures = 0;          ///< Pictures received from the sensor while acquiring.
  std::uint64_t late_pictures = 0;     ///< Those of them that came after the processing time.
  std::uint64_t skipped_pictures = 0;  ///< Exposures skipped because the sensor was busy.
  std::uint64_t ignored_triggers = 0;  ///< Triggers too early or not awaited.
  std::uint64_t lost_triggers = 0;     ///< Triggers lost by a fault.
  std::uint64_t lost_datagrams = 0;    ///< Datagrams lost by a fault, in and out.
  StreamCounters stream;
};

class GigeCamera final : public Device, public CameraBackend, private ControlledDevice {
 public:
  /// Validates. Memory and outputs must outlive it.
  GigeCamera(const GigeCameraSettings& settings, NonvolatileMemory& memory, DatagramOutput& control,
             DatagramOutput& stream);

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  /// Starts of exposures; kNever when it does not acquire or waits for a client's trigger.
  [[nodiscard]] SamplePlan sample_plan() const override { return plan_; }
  [[nodiscard]] ReceiveCounters received() const override { return control_.received(); }
  /// Packets of the stream.
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;

  [[nodiscard]] const CameraCommand& command() const override { return command_; }
  void update(const PictureSample& sample) override;

  /// A datagram that reached port 3956, by the camera's own address or by broadcast.
  void receive(SimTime now, const UdpEnd& from, std::span<const std::uint8_t> datagram);

  /// The port that the stream comes from, as the system gave it.
  void set_stream_port(std::uint16_t port);
  /// Where it is on the network at present.
  [[nodiscard]] CameraAddress address() const;
  /// Rises whenever a client has given it another address.
  [[nodiscard]] std::uint32_t address_changes() const { return address_changes_; }
  /// Where it could be put after all.
  void set_address(const CameraAddress& address);

  /// Writes a register as the application in control would. Why it is refused; empty: it is not.
  [[nodiscard]] std::string_view configure(SimTime now, std::uint32_t address,
                                           std::span<const std::uint8_t> bytes);
  using Live = LiveSetting<GigeCamera, GigeCameraSettings>;
  [[nodiscard]] static std::span<const Live> live_settings();

  [[nodiscard]] std::string_view description() const { return description_; }
  [[nodiscard]] bool controlled() const { return control_.primary().has_value(); }
  [[nodiscard]] bool acquiring() const { return acquisition_.running(); }
  /// One more fault; it begins no earlier than the device was advanced to.
  GigeCameraFaults::Id begin(const GigeCameraFault& fault);
  /// Ends a fault like FaultBook::end().
  bool end(GigeCameraFaults::Id id, SimTime now);

  [[nodiscard]] Supply& supply() { return supply_; }
  /// `moved` is called when it has another address by itself: a forced one does not outlive the
  /// supply.
  void inform_of_moves(std::function<void()> moved) { moved_ = std::move(moved); }

  [[nodiscard]] GigeCameraCounters counters() const;
  /// From exposure to exposure: what sensor and network allow as it is set, and what it keeps.
  [[nodiscard]] Duration shortest_period() const;
  [[nodiscard]] Duration frame_period() const;

 private:
  using Status = protocols::gige_vision::Status;

  // ControlledDevice
  void refresh(const BankRegister& target) override;
  [[nodiscard]] Status written(const BankRegister& target) override;
  void control_ended(SimTime now) override;
  [[nodiscard]] Status force_ip(SimTime now,
                                const protocols::gige_vision::ForceIp& command) override;
  void resend(SimTime now, const protocols::gige_vision::PacketResend& command) override;

  void power_up();
  void recall();
  /// Where its registers put it when it looks for an address.
  [[nodiscard]] CameraAddress configured_address() const;
  [[nodiscard]] bool keep();
  void identify();
  void live_until(SimTime now);
  /// But for the supply.
  void work_until(SimTime now);
  [[nodiscard]] SimTime next_work() const;
  void switch_supply();
  void step();
  void restart();

  [[nodiscard]] Status written_bootstrap(const BankRegister& target);
  [[nodiscard]] Status written_feature(const BankRegister& target);
  [[nodiscard]] Status written_stream_port();
  [[nodiscard]] Status written_packet_size();
  [[nodiscard]] Status written_destination();
  void follow_stream_registers();
  [[nodiscard]] Status start_acquisition();
  [[nodiscard]] Status trigger();
  void end_acquisition();
  void latch_time();
  /// What follows from what a client has set: limits, size of a block, pace, plan and command.
  void derive();
  void derive_image();
  void derive_rates();
  void pace_acquisition();
  void derive_command();
  void reset_region();
  [[nodiscard]] AcquisitionMeans means() const;

  [[nodiscard]] std::uint64_t ticks(SimTime instant) const;
  [[nodiscard]] bool on(std::uint32_t address) const { return bank_.word(address) != 0; }
  [[nodiscard]] bool component_enabled(std::size_t index) const;
  [[nodiscard]] bool chunk_enabled(CameraChunk chunk) const;
  [[nodiscard]] bool multipart() const;
  [[nodiscard]] std::size_t chunk_bytes(bool with_image) const;
  [[nodiscard]] std::uint32_t packet_size() const;
  [[nodiscard]] bool extended_ids() const;
  /// What is asked, or where it is stuck.
  [[nodiscard]] Duration command_exposure() const;
  [[nodiscard]] double temperature_degc() const;
  [[nodiscard]] bool link_down() const { return faults_.first<LinkDownFault>(now_) != nullptr; }

  /// Sends the parts of `shown`; time stamp and chunks describe `exposed`.
  void send(const std::shared_ptr<const Picture>& shown, const Picture& exposed);
  void append_chunks(StreamBlock& block, std::uint64_t number, const Picture& exposed) const;

  GigeCameraSettings settings_;
  GigeCameraFaults faults_;
  Supply supply_;
  NonvolatileMemory& memory_;
  std::vector<CameraComponent> components_;
  std::string description_;
  RegisterBank bank_;
  ControlChannel control_;
  FaultyStream cable_;
  StreamChannel stream_;
  RandomBits trigger_faults_;

  SimTime now_{};
  SimTime time_zero_{};  ///< Zero of the time stamps.
  Acquisition acquisition_;
  SamplePlan plan_;
  CameraCommand command_;
  Duration asked_exposure_{0};  ///< Set by a client, or the camera's last choice.
  double asked_gain_db_ = 0.0;
  Duration stuck_exposure_{0};  ///< Exposure while it is stuck.
  std::shared_ptr<const Picture> last_picture_;
  std::size_t bytes_per_exposure_ = 0;     ///< Bytes of all components that are sent.
  std::uint32_t command_packet_size_ = 0;  ///< Packet size in force.
  std::uint32_t chunk_layout_ = 1;
  bool reset_asked_ = false;
  std::uint32_t address_changes_ = 0;
  std::function<void()> moved_ = [] {};
  GigeCameraCounters counters_;
};

}  // namespace rigwire::emulators

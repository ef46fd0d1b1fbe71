// An emulated u-blox satellite receiver on its UART; what type it is, UbloxProfile says.
//
// Wire face: the TXT banner after power-on, then every epoch's messages in the order of the real
// device, paced at 10 bits per byte; UBX configuration with true acknowledgements, polls, PUBX
// commands. A client at another speed receives garbage and is not understood. Backend face: one
// GnssSample per epoch, at the instants of sample_plan(). docs/devices/ublox-neo-7p.md lists the
// messages, constants and deviations with their sources.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/live_setting.h"
#include "emulators/supply.h"
#include "emulators/ublox/base_station.h"
#include "emulators/ublox/configuration.h"
#include "emulators/ublox/correction_input.h"
#include "emulators/ublox/correction_output.h"
#include "emulators/ublox/line_quality.h"
#include "emulators/ublox/monitor.h"
#include "emulators/ublox/navigator.h"
#include "emulators/ublox/raw_messages.h"
#include "emulators/ublox/second_port.h"
#include "emulators/ublox/settings.h"
#include "emulators/ublox/solution.h"
#include "emulators/ublox/transmitter.h"
#include "protocols/nmea/writers.h"
#include "protocols/rtcm3/frame.h"
#include "protocols/ubx/frame.h"
#include "sim/samples/calendar.h"

namespace rigwire::emulators {

struct UbloxCounters {
  std::uint64_t epochs = 0;           ///< Solutions computed.
  std::uint64_t samples_refused = 0;  ///< Samples while off, starting, stopped, or > 8 behind.
  std::uint64_t messages_sent = 0;    ///< Handed to the line.
  std::uint64_t messages_lost = 0;    ///< The transmit buffer was full.
  std::uint64_t acknowledged = 0;     ///< ACK-ACK.
  std::uint64_t refused = 0;          ///< ACK-NAK.
  std::uint64_t resets = 0;
};

class UbloxReceiver final : public SerialDevice, public GnssBackend {
 public:
  /// Powered on at kStart, where no fault says otherwise. Throws as validate(settings). The outputs
  /// must outlive the receiver; `second` is what its second UART sends to, of types that have one.
  UbloxReceiver(const UbloxSettings& settings, const Calendar& calendar, ByteOutput& output,
                ByteOutput& second = nowhere());

  void receive(SimTime now, std::span<const std::uint8_t> bytes) override;
  /// Bytes on the second UART, sent at that speed.
  void receive_second(SimTime now, std::span<const std::uint8_t> bytes, std::uint32_t baud);
  [[nodiscard]] std::uint32_t second_baud() const { return configuration_.second_uart().baud; }
  void update(const GnssSample& sample) override;
  [[nodiscard]] const Command& command() const override { return command_; }
  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  void set_client(SimTime now, const SerialClient& client) override;
  /// Aligned to GPS or UTC seconds; follows CFG-RATE, resets, power, and stopping and starting by
  /// CFG-RST.
  [[nodiscard]] SamplePlan sample_plan() const override { return plan_; }

  /// Without supply nothing is sent or received; a chunk that is on the line is finished. With a
  /// backup battery time, orbits (for four hours) and the saved configuration survive that;
  /// without, nothing does.
  [[nodiscard]] Supply& supply() { return supply_; }
  [[nodiscard]] const Supply& supply() const { return supply_; }

  /// One more fault; it begins no earlier than the receiver was advanced to.
  FaultBook<UbloxFault>::Id begin(const UbloxFault& fault) { return faults_.add(fault); }
  /// Ends a fault like FaultBook::end().
  bool end(FaultBook<UbloxFault>::Id id, SimTime now) { return faults_.end(id, now); }

  /// Carries out a set of class CFG that another port of the device brings: none of these answers.
  /// Why it is refused; empty: it is not.
  [[nodiscard]] std::string_view configure(SimTime now, const protocols::ubx::FrameView& frame);
  [[nodiscard]] const UbloxConfiguration& configuration() const { return configuration_; }
  /// Those of the second UART are of types that have one.
  using Live = LiveSetting<UbloxReceiver, UbloxSettings>;
  [[nodiscard]] static std::span<const Live> live_settings();

  /// An edge on the external interrupt pin: TIM-TM2 reports it in the next epoch.
  void external_interrupt(SimTime now, bool rising);

  /// NMEA sentences and UBX messages per second as they are configured at present: rates, protocols
  /// of the port, ratio of CFG-RATE. GSA and GSV count with their present number of sentences,
  /// subframes by the satellites tracked; what comes with an event does not count.
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::uint64_t messages_sent() const override {
    return transmitter_.messages_sent();
  }
  [[nodiscard]] std::uint32_t baud() const override { return transmitter_.baud(); }
  [[nodiscard]] ReceiveCounters received() const override { return received_; }
  /// Class and number of the UBX message that came last, or "$" and the beginning of the sentence.
  [[nodiscard]] const LastRequest& last_request() const { return last_request_; }
  [[nodiscard]] std::span<const Quantity> quantities() const override;
  [[nodiscard]] UbloxCounters counters() const;
  [[nodiscard]] const UbloxSolution& solution() const { return navigator_.solution(); }

 private:
  static constexpr std::size_t kPending = 8;
  static constexpr std::size_t kMaximumPayload = 1024;
  static constexpr std::size_t kInputBytes = 2048;
  static_assert(kInputBytes > kMaximumPayload + protocols::ubx::kOverheadBytes);
  static_assert(kInputBytes > protocols::nmea::kMaximumSentence);

  // receiver.cpp: life and epochs.
  /// But for the supply.
  void live_until(SimTime now);
  [[nodiscard]] SimTime next_work() const;
  void switch_supply(SimTime now);
  void start(SimTime now, const UbloxMemory& memory);
  void begin_navigation(SimTime now, const UbloxMemory& memory);
  void plan_from(SimTime now);
  void greet(SimTime now);
  void solve(SimTime now);
  /// Whether a slow receiver has time for the epoch.
  [[nodiscard]] bool has_time_for(SimTime epoch);
  [[nodiscard]] bool refuses(SimTime now) const {
    return faults_.first<RefusedConfigurationFault>(now) != nullptr;
  }
  void watch_antenna(SimTime now);
  void follow_line_noise(SimTime now);
  void set_baud(std::uint32_t baud);
  void refresh_command();
  [[nodiscard]] static ByteOutput& nowhere();

  // What it says.
  /// At a navigation epoch all, at a measurement between two of them what is measured.
  void publish(SimTime now, bool navigated);
  /// How often that message comes, per navigation epoch, when its rate is 1.
  [[nodiscard]] double sentences_per_epoch(const UbloxMessage& message) const;
  /// True of messages that follow an event and not the epochs.
  [[nodiscard]] bool waits_for_event(protocols::ubx::MessageId id) const;
  void send_message(SimTime now, const UbloxMessage& message);
  void send_raw(SimTime now, protocols::ubx::MessageId id);
  /// RTCM 3 on both ports.
  void publish_corrections(SimTime now);
  [[nodiscard]] UbloxCorrectionContent correction_content() const;
  void send_sentence(SimTime now, std::string_view name);
  void send_sentence(SimTime now, std::string_view name, const protocols::nmea::Epoch& epoch);
  void send_text(SimTime now, protocols::nmea::TextKind kind, std::string_view text);
  void send(SimTime now, std::span<const std::uint8_t> message);
  [[nodiscard]] std::size_t encode(protocols::ubx::MessageId id, std::span<std::uint8_t> out);
  [[nodiscard]] UbloxMonitorView monitor_view() const;
  [[nodiscard]] bool speaks(std::uint16_t protocol) const;

  // What clients say.
  void take_in(SimTime now, std::span<const std::uint8_t> bytes);
  void parse(SimTime now);
  void handle(SimTime now, const protocols::ubx::FrameView& frame);
  void handle_configuration(SimTime now, const protocols::ubx::FrameView& frame);
  /// Carries out a set; false when it is refused.
  [[nodiscard]] bool set(SimTime now, const protocols::ubx::FrameView& frame);
  [[nodiscard]] bool handle_command(SimTime now, const protocols::ubx::FrameView& frame);
  void handle(SimTime now, const protocols::rtcm3::FrameView& frame, UbloxPortStatistics& port);
  /// RXM-RTCM, with its flags.
  void tell_received(SimTime now, const protocols::rtcm3::FrameView& frame, std::uint8_t flags);
  [[nodiscard]] bool handle_aiding(SimTime now, const protocols::ubx::FrameView& frame);
  [[nodiscard]] bool answer_raw(SimTime now, const protocols::ubx::FrameView& frame);
  [[nodiscard]] bool answer_poll(SimTime now, const protocols::ubx::FrameView& frame);
  void reset(SimTime now, const protocols::ubx::CfgRst& request);
  void answer(SimTime now, protocols::ubx::MessageId request, bool accepted);

  // What clients say in NMEA.
  void handle(SimTime now, const protocols::nmea::SentenceView& sentence);
  void note_request(SimTime now, const protocols::nmea::SentenceView& sentence);
  [[nodiscard]] bool handle_proprietary(SimTime now, const protocols::nmea::SentenceView& s);
  [[nodiscard]] bool handle_port_command(const protocols::nmea::SentenceView& s);
  [[nodiscard]] bool handle_rate_command(const protocols::nmea::SentenceView& s);
  [[nodiscard]] bool handle_query(SimTime now, const protocols::nmea::SentenceView& s);

  UbloxSettings settings_;
  FaultBook<UbloxFault> faults_;
  const UbloxProfile& profile_;
  Calendar calendar_;
  UbloxConfiguration configuration_;
  UbloxLineQuality quality_;
  UbloxTransmitter transmitter_;
  UbloxNavigator navigator_;
  Command command_;
  UbloxRawMessages raw_;
  UbloxSecondPort second_;
  UbloxCorrectionInput corrections_;
  UbloxBaseStation base_;
  std::vector<std::uint8_t> version_;  ///< Payload of MON-VER.

  Supply supply_;
  std::optional<SimTime> off_since_;  ///< nullopt: it has not been on yet.
  SimTime ready_ = kStart;            ///< End of start-up.
  bool running_ = false;              ///< Start-up is over.
  bool navigating_ = true;            ///< Not stopped by CFG-RST.
  SamplePlan plan_;
  std::uint64_t epoch_number_ = 0;
  double epochs_owed_ = 0.0;  ///< Slow receiver: the next epoch is solved when this reaches 1.

  std::array<GnssSample, kPending> pending_;  ///< Ring of samples being worked on.
  std::size_t pending_head_ = 0;
  std::size_t pending_count_ = 0;
  GnssSample latest_;  ///< Behind the present solution.
  UbloxAntenna antenna_;
  UbloxTimeMark mark_;
  std::vector<protocols::nmea::SatelliteInView> in_view_;

  std::array<std::uint8_t, kInputBytes> input_{};
  std::size_t input_size_ = 0;
  bool in_garbage_ = false;
  bool overflow_to_report_ = false;
  UbloxPortStatistics port_;
  ReceiveCounters received_;
  LastRequest last_request_;
  UbloxCounters counters_;
};

}  // namespace rigwire::emulators

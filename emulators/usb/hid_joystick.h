// The operator's levers of an excavator as one USB joystick: two sticks, two pedals, a dial and
// sixteen buttons.
//
// Input report, 16 bytes, no report id, little endian, in this order: X Y (left stick), Rx Ry
// (right stick), Z (left pedal), Rz (right pedal), each -32767 .. 32767 of full travel; slider
// (dial) 0 .. 32767; buttons 1 .. 16, bit 0 the first.
//
// A report goes out when it differs from the last one that did, at most every `interval`, or
// after the idle time of SET_IDLE, if one is set. The first report after configuration goes out
// at once, so that the host knows where the levers are. Requests: GET_REPORT (input),
// GET and SET_IDLE, the class's descriptors; GET and SET_PROTOCOL and SET_REPORT stall, as in
// devices without a boot protocol and without outputs.
//
// Source: see protocols/usb/hid.h. The device is no maker's product; its vendor and product id are
// those that pid.codes gives for tests.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/usb/usb_device.h"
#include "fields/rules.h"

namespace rigwire::emulators {

struct HidJoystickSettings {
  std::uint16_t vendor = 0x1209;
  std::uint16_t product = 0x0001;
  std::string manufacturer = "Rigwire";
  std::string product_name = "Excavator operator levers";
  std::string serial_number;
  /// Polling interval of the interrupt endpoint, 1 .. 255 ms.
  Duration interval = std::chrono::milliseconds(10);
};
void visit(fields::Visitor& v, HidJoystickSettings& p);
/// Throws std::invalid_argument.
void validate(const HidJoystickSettings& settings);

class HidJoystick final : public UsbDevice, public Device, public JoystickBackend {
 public:
  static constexpr std::uint8_t kEndpoint = 0x81;
  static constexpr std::size_t kReportSize = kJoystickAxes * 2 + kJoystickButtons / 8;
  static constexpr double kFullTravel = 32767.0;

  /// Throws std::invalid_argument.
  explicit HidJoystick(const HidJoystickSettings& settings);

  /// Values beyond the range are taken as its end, those that are no number as 0.
  void update(const JoystickSample& sample) override;

  [[nodiscard]] const protocols::usb::DeviceDescription& description() const override {
    return description_;
  }
  [[nodiscard]] std::span<const std::uint8_t> report_descriptor() const {
    return report_descriptor_;
  }
  void plugged(SimTime now, UsbHost& host) override;
  void unplugged(SimTime now) override;
  void configured(SimTime now, std::uint8_t configuration) override;
  void control(SimTime now, UsbTransfer transfer, const protocols::usb::Setup& setup,
               std::span<const std::uint8_t> data) override;
  void read(SimTime now, UsbTransfer transfer, std::uint8_t endpoint, std::size_t length) override;
  void write(SimTime now, UsbTransfer transfer, std::uint8_t endpoint,
             std::span<const std::uint8_t> data) override;
  [[nodiscard]] bool cancel(SimTime now, UsbTransfer transfer) override;

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SamplePlan sample_plan() const override { return {}; }
  [[nodiscard]] ReceiveCounters received() const override { return counters_; }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const Quantity> quantities() const override;
  /// The SETUP packet of the request to its interface that it carried out last.
  [[nodiscard]] const std::optional<UsbRequest>& last_request() const { return last_request_; }
  [[nodiscard]] std::uint64_t reports_sent() const { return reports_sent_; }

 private:
  using Report = std::array<std::uint8_t, kReportSize>;
  struct Read {
    UsbTransfer transfer = 0;
    std::size_t length = 0;
  };

  void reset();
  [[nodiscard]] bool serve(SimTime now, UsbTransfer transfer, const protocols::usb::Setup& setup);

  HidJoystickSettings settings_;
  std::vector<std::uint8_t> report_descriptor_;
  std::vector<std::uint8_t> hid_descriptor_;
  protocols::usb::DeviceDescription description_;
  UsbHost* host_ = nullptr;
  std::vector<Read> reads_;
  Report report_{};
  Report sent_{};
  bool news_ = true;           ///< report_ has to go out.
  SimTime lived_{};            ///< Lived up to here.
  SimTime last_report_{};      ///< When one went out.
  bool reported_ = false;      ///< last_report_ is one of this configuration.
  std::uint8_t idle_4ms_ = 0;  ///< SET_IDLE, in units of 4 ms; 0: only when something changes.
  ReceiveCounters counters_;
  std::optional<UsbRequest> last_request_;
  std::uint64_t reports_sent_ = 0;
};

}  // namespace rigwire::emulators

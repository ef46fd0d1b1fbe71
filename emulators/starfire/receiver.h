// The serial side of an emulated John Deere StarFire 3000: NMEA sentences on RS232, and nothing
// back: whatever a client sends is counted and has no effect.
//
// Positions have seven decimals of minutes, as an RTK receiver needs; the real one's number of
// decimals is not known. docs/devices/starfire-3000.md has the sentences, sources and deviations.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/starfire/settings.h"
#include "emulators/supply.h"
#include "emulators/ublox/transmitter.h"
#include "protocols/nmea/epoch.h"
#include "sim/samples/calendar.h"

namespace rigwire::emulators {

class StarFireReceiver final : public SerialDevice, public GnssBackend {
 public:
  /// `output` must outlive the receiver. Throws like validate(settings).
  StarFireReceiver(const StarFireSettings& settings, const Calendar& calendar, ByteOutput& output);

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  /// Aligned to GPS time.
  [[nodiscard]] SamplePlan sample_plan() const override { return plan_; }
  [[nodiscard]] ReceiveCounters received() const override { return received_; }
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;
  [[nodiscard]] std::uint64_t messages_sent() const override {
    return transmitter_.messages_sent();
  }
  [[nodiscard]] std::uint32_t baud() const override { return transmitter_.baud(); }

  void receive(SimTime now, std::span<const std::uint8_t> bytes) override;
  void update(const GnssSample& sample) override;
  /// Without supply nothing is sent; a chunk that is on the line is finished.
  [[nodiscard]] Supply& supply() { return supply_; }

 private:
  /// But for the supply.
  void live_until(SimTime now);
  [[nodiscard]] SimTime next_work() const {
    return std::min(transmitter_.next_event(), publish_at_);
  }
  /// The last sample in the words of the writers.
  [[nodiscard]] protocols::nmea::Epoch epoch();
  void publish(SimTime now);

  StarFireSettings settings_;
  Calendar calendar_;
  UbloxTransmitter transmitter_;
  Supply supply_;
  SamplePlan plan_;
  SimTime ready_at_ = kNever;  ///< Without supply never.
  GnssSample sample_;
  SimTime publish_at_ = kNever;
  std::vector<protocols::nmea::SatelliteInView> in_view_;
  ReceiveCounters received_;
};

}  // namespace rigwire::emulators

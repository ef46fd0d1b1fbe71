// The bus side of an emulated John Deere StarFire 3000: position, direction and speed five times a
// second, its quality every five seconds.
//
// Source address 28 unless it is lost; on the bus it behaves as J1939Node. Its proprietary messages
// (PGN 65535) are not sent: their layout is known from one forum's guesses only.
// docs/devices/starfire-3000.md has bytes, sources and deviations.
#pragma once

#include <cstdint>
#include <span>

#include "emulators/backends.h"
#include "emulators/j1939/j1939_device.h"
#include "emulators/j1939/position_report.h"
#include "emulators/starfire/settings.h"
#include "sim/samples/calendar.h"

namespace rigwire::emulators {

class StarFireNode final : public J1939Device, public GnssBackend {
 public:
  /// `output` must outlive the node. Throws like validate(settings).
  StarFireNode(const StarFireSettings& settings, const Calendar& calendar, FrameOutput& output);

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  /// Aligned to GPS time.
  [[nodiscard]] SamplePlan sample_plan() const override { return plan_; }
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override;
  void update(const GnssSample& sample) override;

 private:
  /// Epochs between two VP2.
  static constexpr std::uint64_t kQualityEpochs = 25;

  /// Sends one group of the last report.
  J1939Answer answer_group(SimTime now, std::uint32_t pgn, std::uint8_t destination) override;
  J1939Reception obey(SimTime now, const J1939Message& message) override;
  [[nodiscard]] bool is_command(std::uint32_t /*pgn*/) const override { return false; }
  void send_group(SimTime now, std::uint32_t pgn);
  void switched(SimTime now) override;

  StarFireSettings settings_;
  SamplePlan plan_;
  PositionReport report_;
  SimTime ready_at_ = kNever;  ///< Without supply never.
  SimTime publish_at_ = kNever;
  std::uint64_t epochs_ = 0;
};

}  // namespace rigwire::emulators

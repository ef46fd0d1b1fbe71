// A kind of sensor that no file of the product knows, from the sample to the emulator: a probe in
// the soil that tells how moist it is, and heats itself when it wants to. Whatever carries it knows
// no kind.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/device.h"
#include "sim/samples/time.h"

namespace rigwire::test {

struct MoistureSample {
  SimTime time{};
  double share = 0.0;
};

struct HeaterCommand {
  double power_w = 0.0;
  friend bool operator==(const HeaterCommand&, const HeaterCommand&) = default;
};

class MoistureBackend {
 public:
  using Sample = MoistureSample;
  using Command = HeaterCommand;

  virtual ~MoistureBackend() = default;
  virtual void update(const Sample& sample) = 0;
  [[nodiscard]] virtual const Command& command() const = 0;
};

/// Remembers what it was given; sends one byte per sample, 3 ms after it.
class MoistureProbe final : public emulators::Device, public MoistureBackend {
 public:
  MoistureProbe(Duration period, emulators::ByteOutput& output)
      : plan{kStart, period}, output_(output) {}

  void advance(SimTime now) override {
    went_back |= now < time_;
    time_ = now;
  }
  [[nodiscard]] SimTime next_event() const override { return stuck ? time_ : kNever; }
  [[nodiscard]] SamplePlan sample_plan() const override { return plan; }
  [[nodiscard]] emulators::ReceiveCounters received() const override { return {}; }
  [[nodiscard]] double nominal_rate_hz() const override { return 1.0 / to_seconds(plan.period); }
  [[nodiscard]] std::span<const emulators::Quantity> quantities() const override { return {}; }

  void update(const MoistureSample& sample) override {
    advance(sample.time);
    samples.push_back(sample);
    const std::array<std::uint8_t, 1> byte{static_cast<std::uint8_t>(samples.size())};
    output_.send(sample.time + std::chrono::milliseconds{3}, byte);
    if (heats_from && sample.time >= *heats_from) {
      heater.power_w = 20.0;
    }
  }
  [[nodiscard]] const HeaterCommand& command() const override { return heater; }

  SamplePlan plan;
  HeaterCommand heater;
  std::optional<SimTime> heats_from;
  std::vector<MoistureSample> samples;
  bool stuck = false;
  bool went_back = false;  ///< In time.

 private:
  emulators::ByteOutput& output_;
  SimTime time_ = kStart;
};

}  // namespace rigwire::test

// A device's own clock: what its crystal makes of the run's time.
//
// Everything that a device does by itself (cycles, timers, time-outs, the times that it writes into
// its messages) it does by its own clock. That one runs a little fast or slow, so that the phases
// of two nodes of a bus sweep over each other, as they do on every real bus. The error is constant:
// of a crystal it changes by some ppm with temperature and 5 ppm a year, which no run sees.
//
// OwnClock converts both ways in whole numbers, without drift. It starts with the device's supply
// and shows the run's time until then. So that one sampling period is a whole number of nanoseconds
// of the run, the error is rounded to 1 ns of that period: 0.1 ppm at 100 Hz, 1 ppm at 1 kHz.
//
// OnOwnClock<Emulator, Backend> is the emulator as the run sees it: times go in and out converted,
// nothing else changes. With an error of 0 and no jitter it changes nothing at all.
//
// Receivers that are disciplined by satellites (starfire/node.h) have no such clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/device.h"
#include "emulators/random_bits.h"
#include "fields/rules.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// How a node's clock is made.
struct OwnClockSettings {
  /// Tolerance of the crystal, relative: its error is drawn uniformly from +-tolerance. 50e-6 is
  /// what makers of microcontrollers ask of a crystal over its temperature (Texas Instruments
  /// MSP432E411Y, SLASEK6, table 5-40: +-50 ppm, and 5 ppm in the first year). 0 .. 1e-3.
  double tolerance = 50e-6;
  /// Added to what was drawn; positive runs fast. -1e-3 .. 1e-3.
  double error = 0.0;
  /// A frame may be late by up to this, drawn evenly: interrupts and tasks of the node's own
  /// program. This project's choice, some 1000 instructions; a crystal's own jitter is a nanosecond
  /// (the same table). 0 .. 10 ms.
  Duration jitter = std::chrono::microseconds{20};
};

void visit(fields::Visitor& v, OwnClockSettings& p);
/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const OwnClockSettings& settings);

class OwnClock {
 public:
  /// The run's own.
  OwnClock() = default;
  /// Runs fast by `error` from `start` on. `period`: of the device's samples, more than 0 and up to
  /// 1 s.
  OwnClock(double error, SimTime start, Duration period);

  /// When the clock shows `own`, to the nanosecond below it. kNever stays kNever, in both.
  [[nodiscard]] SimTime run_time(SimTime own) const;
  /// The latest that the clock has shown at `run`: own_time(run_time(x)) is x, or 1 ns more.
  [[nodiscard]] SimTime own_time(SimTime run) const;
  /// Converts an instant given as a setting: time since the start of the run.
  [[nodiscard]] Duration own_time(Duration since_start) const {
    return own_time(kStart + since_start) - kStart;
  }
  [[nodiscard]] double error() const;

 private:
  SimTime start_ = kStart;
  Duration own_period_{1};  ///< This much of its own time
  Duration run_period_{1};  ///< is this much of the run's.
};

/// The error of a device's clock. `seed` is of that alone; with a tolerance of 0 nothing is drawn.
[[nodiscard]] double drawn_clock_error(const OwnClockSettings& settings, std::uint64_t seed);

/// Between an emulator on its own clock and the bus: due times of the run, each frame late by the
/// jitter. Frames that the emulator hands over for one instant are one task's and stay together;
/// no frame overtakes another.
class OwnClockOutput final : public FrameOutput {
 public:
  /// `output` must outlive it.
  OwnClockOutput(const OwnClock& clock, Duration jitter, std::uint64_t seed, FrameOutput& output)
      : clock_(clock), jitter_(jitter), random_(seed), output_(output) {}

  void send(SimTime due, const protocols::can::Frame& frame) override;

 private:
  OwnClock clock_;
  Duration jitter_;
  RandomBits random_;
  FrameOutput& output_;
  SimTime last_own_due_ = kNever;
  SimTime last_due_ = kStart;
};

namespace own_clock_details {

/// The backend face: samples in the device's own time.
template <class Emulator, class Backend>
class Samples : public Backend {
 public:
  Samples(const OwnClock& clock, Emulator& emulator) : clock_(clock), emulator_(emulator) {}
  void update(const typename Backend::Sample& sample) override {
    typename Backend::Sample seen = sample;
    seen.time = clock_.own_time(sample.time);
    emulator_.update(seen);
  }

 protected:
  OwnClock clock_;
  Emulator& emulator_;
};

/// Backend of a device that also returns a command.
template <class Emulator, class Backend>
class Commands : public Samples<Emulator, Backend> {
 public:
  using Samples<Emulator, Backend>::Samples;
  [[nodiscard]] const typename Backend::Command& command() const override {
    return this->emulator_.command();
  }
};

template <class Emulator, class Backend>
struct FaceOf {
  using Type = Samples<Emulator, Backend>;
};
template <class Emulator, class Backend>
requires requires {
  typename Backend::Command;
}
struct FaceOf<Emulator, Backend> {
  using Type = Commands<Emulator, Backend>;
};

}  // namespace own_clock_details

/// Wire face and backend face of an emulator, in the run's time. The time in a command is the
/// device's own.
template <class Emulator, class Backend>
class OnOwnClock final : public CanDevice,
                         public own_clock_details::FaceOf<Emulator, Backend>::Type {
  using Face = typename own_clock_details::FaceOf<Emulator, Backend>::Type;

 public:
  /// `emulator` must outlive it, and sends through an OwnClockOutput of the same clock.
  OnOwnClock(const OwnClock& clock, Emulator& emulator) : Face(clock, emulator) {}

  void advance(SimTime now) override { this->emulator_.advance(own(now)); }
  [[nodiscard]] SimTime next_event() const override {
    return this->clock_.run_time(this->emulator_.next_event());
  }
  [[nodiscard]] SamplePlan sample_plan() const override {
    const SamplePlan plan = this->emulator_.sample_plan();
    if (plan.first == kNever) {
      return plan;
    }
    const SimTime first = this->clock_.run_time(plan.first);
    return {first, this->clock_.run_time(plan.first + plan.period) - first};
  }
  [[nodiscard]] ReceiveCounters received() const override { return this->emulator_.received(); }
  [[nodiscard]] double nominal_rate_hz() const override {
    return this->emulator_.nominal_rate_hz();
  }
  [[nodiscard]] std::span<const Quantity> quantities() const override {
    return this->emulator_.quantities();
  }
  void receive(SimTime now, const protocols::can::Frame& frame) override {
    this->emulator_.receive(own(now), frame);
  }
  void controller(SimTime now, const protocols::can::ControllerReport& report) override {
    this->emulator_.controller(own(now), report);
  }
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override {
    return this->emulator_.messages(name);
  }

 private:
  [[nodiscard]] SimTime own(SimTime run) const { return this->clock_.own_time(run); }
};

}  // namespace rigwire::emulators

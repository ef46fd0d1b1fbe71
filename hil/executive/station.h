// One device of the rig as the executive runs it: the emulator and the samples on their way to it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "hil/executive/event_source.h"
#include "hil/executive/truth_source.h"

namespace rigwire::hil {

/// Samples of one kind that wait until the device's time has reached them. Memory stays within
/// twice of what ever waited at once.
template <class Sample>
class SampleInbox {
 public:
  void put(const Sample& sample) {
    if (taken_ > 0 && 2 * taken_ >= waiting_.size()) {
      waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(taken_));
      taken_ = 0;
    }
    waiting_.push_back(sample);
  }
  [[nodiscard]] SimTime next() const {
    return taken_ == waiting_.size() ? kNever : waiting_[taken_].time;
  }
  /// Precondition: next() != kNever. The reference holds until put().
  const Sample& take() { return waiting_[taken_++]; }
  /// Samples that there is memory for.
  [[nodiscard]] std::size_t capacity() const { return waiting_.capacity(); }

 private:
  std::vector<Sample> waiting_;
  std::size_t taken_ = 0;
};

/// Common part of all stations; one subclass per class of backend gives it its samples.
class Station : public EventSource {
 public:
  explicit Station(emulators::Device& device) : device_(device) {}

  [[nodiscard]] emulators::Device& device() { return device_; }
  [[nodiscard]] const emulators::Device& device() const { return device_; }
  /// Adds to `requests` what the device wants of the truth and has not asked for yet.
  virtual void collect(DeviceIndex self, TruthRequests& requests);

 private:
  emulators::Device& device_;
  SamplePlan announced_plan_;
};

/// A station whose device takes samples of one kind.
template <class Sample, class Backend>
class SampledStation : public Station {
 public:
  SampledStation(emulators::Device& device, Backend& backend)
      : Station(device), backend_(backend) {}

  void put(const Sample& sample) { inbox_.put(sample); }

  [[nodiscard]] SimTime next_event() const override {
    return std::min(device().next_event(), inbox_.next());
  }
  [[nodiscard]] SimTime next_wakeup() const override { return next_event(); }

  void advance(SimTime now) override {
    while (inbox_.next() <= now) {
      backend_.update(inbox_.take());
    }
    device().advance(now);
  }

 protected:
  [[nodiscard]] Backend& backend() { return backend_; }
  [[nodiscard]] const Backend& backend() const { return backend_; }

 private:
  Backend& backend_;
  SampleInbox<Sample> inbox_;
};

using GnssStation = SampledStation<GnssSample, emulators::GnssBackend>;
using ImuStation = SampledStation<ImuSample, emulators::ImuBackend>;
using EncoderStation = SampledStation<EncoderSample, emulators::EncoderBackend>;

/// Also carries what the device asks of its head. Firings come too often to wake up for
/// each: they are taken when the packet that they belong to is complete.
class LidarStation : public SampledStation<LidarFiring, emulators::LidarBackend> {
 public:
  using SampledStation::SampledStation;
  [[nodiscard]] SimTime next_wakeup() const override;
  void collect(DeviceIndex self, TruthRequests& requests) override;

 private:
  LidarCommand announced_command_;
};

/// Also carries the spool commands that the device gives.
class ValveStation : public SampledStation<ValveSample, emulators::ValveBackend> {
 public:
  using SampledStation::SampledStation;
  void collect(DeviceIndex self, TruthRequests& requests) override;

 private:
  ValveCommand announced_command_;
};

/// Also carries what the controllers ask of drive train, steering and brakes.
class VehicleStation : public SampledStation<VehicleSample, emulators::VehicleBackend> {
 public:
  using SampledStation::SampledStation;
  void collect(DeviceIndex self, TruthRequests& requests) override;

 private:
  VehicleCommand announced_command_;
};

}  // namespace rigwire::hil

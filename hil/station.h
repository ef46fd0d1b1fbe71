// One device of the rig at run time: the emulator, the samples on their way to it, its statistics.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "hil/event_source.h"
#include "hil/truth_source.h"
#include "hil/wire_statistics.h"

namespace rigwire::hil {

/// Samples of one kind that wait until the device's time has reached them.
template <class Sample>
class SampleInbox {
 public:
  void put(const Sample& sample) {
    if (taken_ == waiting_.size()) {
      waiting_.clear();
      taken_ = 0;
    }
    waiting_.push_back(sample);
  }
  [[nodiscard]] SimTime next() const {
    return taken_ == waiting_.size() ? kNever : waiting_[taken_].time;
  }
  /// Precondition: next() != kNever. The reference holds until put().
  const Sample& take() { return waiting_[taken_++]; }

 private:
  std::vector<Sample> waiting_;
  std::size_t taken_ = 0;
};

/// Common part of all stations; one subclass per class of backend gives it its samples.
class Station : public EventSource {
 public:
  Station(std::string name, std::string type, emulators::Device& device)
      : name_(std::move(name)), type_(std::move(type)), device_(device) {}

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& type() const { return type_; }
  [[nodiscard]] emulators::Device& device() { return device_; }
  [[nodiscard]] const emulators::Device& device() const { return device_; }
  [[nodiscard]] WireStatistics& statistics() { return statistics_; }
  [[nodiscard]] const WireStatistics& statistics() const { return statistics_; }

  [[nodiscard]] SimTime next_wakeup() const override { return device_.next_event(); }

  /// Adds to `requests` what the device wants of the truth and has not asked for yet.
  virtual void collect(DeviceIndex self, TruthRequests& requests);

 private:
  std::string name_;
  std::string type_;
  emulators::Device& device_;
  WireStatistics statistics_;
  SamplePlan announced_plan_;
};

/// A station whose device takes samples of one kind.
template <class Sample, class Backend>
class SampledStation : public Station {
 public:
  SampledStation(std::string name, std::string type, emulators::Device& device, Backend& backend)
      : Station(std::move(name), std::move(type), device), backend_(backend) {}

  void put(const Sample& sample) { inbox_.put(sample); }

  [[nodiscard]] SimTime next_event() const override {
    return std::min(device().next_event(), inbox_.next());
  }

  void advance(SimTime now) override {
    while (inbox_.next() <= now) {
      backend_.update(inbox_.take());
    }
    device().advance(now);
  }

 protected:
  [[nodiscard]] Backend& backend() { return backend_; }

 private:
  Backend& backend_;
  SampleInbox<Sample> inbox_;
};

using GnssStation = SampledStation<GnssSample, emulators::GnssBackend>;
using ImuStation = SampledStation<ImuSample, emulators::ImuBackend>;

/// Also carries the rotor speed that the device asks for.
class LidarStation : public SampledStation<LidarFiring, emulators::LidarBackend> {
 public:
  using SampledStation::SampledStation;
  void collect(DeviceIndex self, TruthRequests& requests) override;

 private:
  double announced_rate_radps_ = 0.0;
};

/// Also carries the spool commands that the device gives.
class ValveStation : public SampledStation<ValveSample, emulators::ValveBackend> {
 public:
  using SampledStation::SampledStation;
  void collect(DeviceIndex self, TruthRequests& requests) override;

 private:
  ValveCommand announced_command_;
};

}  // namespace rigwire::hil

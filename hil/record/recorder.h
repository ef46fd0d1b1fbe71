// Records a run: everything that passes on its wires, its truth, its events, into a folder
// (hil/record/recording_writer.h), beside the run and without any device knowing of it.
//
// Order. Wires tell of what is due in order of time; what a client sent waits in an outlet of the
// recorder's own until its instant comes in that order, first among equals. So the files are in
// order of time, and a free run gives the same bytes each time.
//
// Cost. The threads of the run copy what they tell into a bounded queue; a thread of the recorder's
// own does the rest. When the queue is full, because a disk is slower than the wires for long, what
// passes is lost, counted and told at once. Nothing waits for it but simulated time where that does
// not follow the wall's.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "hil/configuration/fault_window.h"
#include "hil/executive/event_source.h"
#include "hil/record/output_file.h"
#include "hil/record/record_queue.h"
#include "hil/record/recording_writer.h"
#include "hil/record/run_log.h"
#include "hil/wires/wire_statistics.h"
#include "hil/wires/wire_tap.h"
#include "hil/world/truth_observer.h"
#include "sim/machine.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {

class Executive;
class QueuedOutlet;

struct RecordOptions {
  std::string folder;             ///< Made where it is not there; empty: nothing is recorded.
  std::vector<std::string> only;  ///< Names of wires, or "truth"; empty: everything.
};

/// What the recorder asks of a run from time to time.
struct RecordedStatus {
  struct Device {
    std::string name;
    std::string wire;
    std::uint64_t frames = 0;
    std::uint64_t bytes = 0;
    std::uint64_t dropped = 0;
    Duration lateness_p99{0};
    Duration lateness_max{0};
  };
  std::vector<Device> devices;
  std::vector<FaultWindow> faults;  ///< That act now.
};

class Recorder {
 public:
  /// Makes the folder. `patience`: how long simulated time may wait for the disk, zero where it
  /// follows the wall's. `failures` must outlive it. Throws drivers::EndpointError where the folder
  /// cannot be had or is not empty.
  Recorder(RecordOptions options, RecordedRun run, std::chrono::milliseconds patience,
           OutputFailures& failures);
  /// Without finish() the files end as those of a run that was killed.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // While the rig is made, in this order.

  /// Before the first outlet; the executive must outlive every call but the destructor's.
  void attach(Executive& executive);
  /// The tap of a wire; nullptr where it is not wanted. A name that another wire has is told apart
  /// by the wire's kind. The tap lives as long as the recorder.
  [[nodiscard]] WireTap* add_wire(const std::string& name, WireKind kind,
                                  const std::string& address);
  /// That outlet is of the wire of that tap, which add_wire() returned.
  void join(WireTap& tap, QueuedOutlet& outlet) const;
  /// Who is given each outlet that joins, with the name of its wire. Before the first.
  using OutletUser = std::function<void(const std::string& wire, QueuedOutlet& outlet)>;
  void on_outlet(OutletUser user) { outlet_user_ = std::move(user); }
  /// Who is to be told the truth; nullptr where it is not wanted.
  [[nodiscard]] std::unique_ptr<TruthObserver> truth_observer(
      const Calendar& calendar, std::span<const sim::TruthField> fields,
      std::span<const std::string_view> links);
  /// When all are there: makes the files and begins. `status` is asked on the wire thread;
  /// `faults` are known to come. Throws drivers::EndpointError, std::invalid_argument for a name in
  /// `only` that is none.
  void start(std::function<RecordedStatus()> status, const std::vector<FaultWindow>& faults);

  /// On the wire thread, after start(): that fault has been added, or ends otherwise.
  void expect(const FaultWindow& fault);

  /// From any thread, after start().
  void event(LogLevel level, std::string_view text);
  /// No more of the executive's: the run is over. Ends the files.
  void finish(SimTime end);

  /// Memory for what the disk has not taken yet, and as much again for what it is taking.
  static constexpr std::size_t kQueueBytes = 32 * 1024 * 1024;
  /// How long something waits in memory at most, on its way to the disk.
  static constexpr std::chrono::milliseconds kFlushPeriod{200};

 private:
  class Wire;
  class Truth;
  class Arrivals;
  class Watch;

  [[nodiscard]] bool wanted(const std::string& name) const;
  void put(std::uint16_t track, std::uint8_t flags, SimTime at,
           std::span<const std::uint8_t> bytes);
  void put(TruthTrack track, SimTime at, std::string_view text);
  [[nodiscard]] std::string event_text(SimTime at, LogLevel level, std::string_view text) const;
  void write_all();
  /// The writer has written all that there was.
  void end_thread();

  RecordOptions options_;
  RecordedRun run_;
  OutputFailures& failures_;
  bool with_truth_ = true;
  Executive* executive_ = nullptr;
  std::vector<std::string> names_;  ///< Of all wires, wanted or not.
  std::vector<RecordedWire> about_;
  std::vector<std::unique_ptr<Wire>> wires_;
  OutletUser outlet_user_;
  std::unique_ptr<Arrivals> arrivals_;
  std::unique_ptr<Watch> watch_;
  RecordQueue queue_;
  std::atomic<bool> told_full_{false};
  std::unique_ptr<RecordingWriter> writer_;
  std::deque<std::pair<LogLevel, std::string>> trouble_;  ///< Of the writer's thread.
  std::thread thread_;
};

}  // namespace rigwire::hil

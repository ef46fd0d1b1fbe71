// Records a run: everything that passes on its wires, its truth, its events, into a folder
// (hil/record/recording_writer.h), without any device knowing of it. It exists from the run's
// start; recordings begin and end, one at a time. Between recordings it only reports the run's
// events.
//
// Beginning and end. A recording holds what is due from its beginning up to and including its end,
// and of the truth what lies beyond what had been computed when it began.
//
// Order. Wires report what is due in order of time; what a client sent waits in an outlet of the
// recorder's own until its instant comes in that order, first among equals. So the files are in
// order of time, and a free run gives the same bytes each time.
//
// Cost. The threads of the run copy their data into a bounded queue; a thread of the recorder's own
// does the rest. When the queue is full, because a disk is slower than the wires for long, further
// data is lost, counted and reported at once. Only simulated time waits for the disk, and only
// where it does not follow the wall's.
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
#include "hil/record/run_events.h"
#include "hil/record/run_log.h"
#include "hil/wires/wire_statistics.h"
#include "hil/wires/wire_tap.h"
#include "hil/world/truth_observer.h"
#include "sim/machine.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {

class Executive;
class QueuedOutlet;
struct RequestHandover;

struct RecordOptions {
  std::string folder;             ///< Created, or an empty one; "": no recording.
  std::vector<std::string> only;  ///< Names of wires, or "truth"; empty: everything.
};

/// State of a run that the recorder queries periodically.
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
  std::vector<FaultWindow> faults;  ///< Faults that act now.
};

class Recorder {
 public:
  /// `patience`: how long simulated time may wait for the disk, zero where it follows the wall's.
  /// `failures` and `events` must outlive it; it listens to the events until its end.
  Recorder(RecordedRun run, std::chrono::milliseconds patience, OutputFailures& failures,
           RunEvents& events);
  /// Without finish() the files end as those of a run that was killed.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  [[nodiscard]] RunEvents& events() { return events_; }

  // While the rig is made, in this order.

  /// Before the first outlet; the executive must outlive every call but the destructor's.
  void attach(Executive& executive);
  /// Returns the tap of a wire, which lives as long as the recorder. If another wire has that name,
  /// the kind is added to it.
  [[nodiscard]] WireTap& add_wire(const std::string& name, WireKind kind,
                                  const std::string& address);
  /// Called with each wire that is added, whether it is recorded or not; returns a tap that also
  /// receives it. To be set before the first wire.
  using WireUser = std::function<WireTap&(const std::string& wire, WireKind kind)>;
  void pass_on(WireUser user) { wire_user_ = std::move(user); }
  /// Adds an outlet to the wire of `tap`, which add_wire() returned.
  void join(WireTap& tap, QueuedOutlet& outlet) const;
  /// Called with each outlet that is added and the name of its wire. To be set before the first.
  using OutletUser = std::function<void(const std::string& wire, QueuedOutlet& outlet)>;
  void on_outlet(OutletUser user) { outlet_user_ = std::move(user); }
  /// Returns the observer that records the truth.
  [[nodiscard]] std::unique_ptr<TruthObserver> truth_observer(
      const Calendar& calendar, std::span<const sim::TruthField> fields,
      std::span<const std::string_view> links);
  /// Starts the recorder; to be called when all wires exist. `status` is called on the wire thread;
  /// `faults` are those known in advance.
  void start(std::function<RecordedStatus()> status, const std::vector<FaultWindow>& faults);

  // On the wire thread, after start().

  /// Notes a fault that has been added, or whose end has changed.
  void expect(const FaultWindow& fault);
  /// Notes a command, one line, that has just changed the run. It is written into every present
  /// recording, and the first kCommandBytes of a run also into later ones. A recording that begins
  /// when there were more is marked as incomplete (RecordedRun::clients_before).
  void command(std::string text);
  /// Notes a hand-over that depended on the wall clock (Executive::on_handover()). It is written
  /// into every present recording, and the first kHandovers of a run also into later ones.
  void handover(const RequestHandover& handover);

  /// Creates the files and begins: before the run with all of it, otherwise with what is due from
  /// now on. Precondition: there is no present recording. Throws drivers::EndpointError when the
  /// folder cannot be used or is not empty, std::invalid_argument for an unknown name in `only`.
  void begin(const RecordOptions& options);
  /// Begins before the run, for what is due from `from` on, and the truth from `truth_from` on.
  void begin(const RecordOptions& options, SimTime from, SimTime truth_from);
  /// Returns the folder of the present recording; empty: there is none.
  [[nodiscard]] const std::optional<std::string>& folder() const { return folder_; }
  /// Ends the recording at `end`: what is due later is not recorded. finish() must follow when what
  /// is due by then has been sent.
  void leave_out_after(SimTime end) { until_ = end; }
  /// Closes the files; does nothing without a recording.
  void finish(SimTime end);

  /// Maximum memory for data that waits for the disk, and as much again for data being written,
  /// bytes.
  static constexpr std::size_t kQueueBytes = 32 * 1024 * 1024;
  /// Maximum size of the commands, and number of the hand-overs, since the run's start that are
  /// kept for recordings that begin later.
  static constexpr std::size_t kCommandBytes = 1024 * 1024;
  static constexpr std::size_t kHandovers = 65536;
  /// Maximum time that data waits in memory before it is written.
  static constexpr std::chrono::milliseconds kFlushPeriod{200};

 private:
  class Wire;
  class Truth;
  class Arrivals;
  class Watch;

  /// Returns false when there was no room.
  bool put(std::uint16_t track, std::uint8_t flags, SimTime at,
           std::span<const std::uint8_t> bytes);
  /// Puts the entry and reports the first one that finds no room.
  void put_told(std::uint16_t track, std::uint8_t flags, SimTime at,
                std::span<const std::uint8_t> bytes);
  void put(TruthTrack track, SimTime at, std::string_view text);
  /// Puts a line into the present recording. Wire thread only.
  void put_line(std::uint16_t track, SimTime at, std::string_view text);
  void put_line(const RequestHandover& handover);
  /// Returns whether what is due at `at` on a wire belongs to the recording.
  [[nodiscard]] bool records(SimTime at) const {
    return folder_.has_value() && at >= from_ && at <= until_.load(std::memory_order_relaxed);
  }
  /// Returns whether the truth of `at` belongs to the recording. To be called on the truth's
  /// thread.
  [[nodiscard]] bool records_truth(SimTime at) const {
    return truth_on_.load(std::memory_order_acquire) && at >= truth_from_.load() &&
           at <= until_.load();
  }
  void hear(const RunEvent& event);
  void write_all();
  /// Waits until the writer has written everything.
  void end_thread();

  RecordedRun run_;
  OutputFailures& failures_;
  RunEvents& events_;
  std::optional<std::string> folder_;
  SimTime from_{};
  std::atomic<SimTime> until_{kNever};
  std::atomic<bool> truth_on_{false};
  std::atomic<SimTime> truth_from_{};
  // Since the run's start.
  std::vector<std::pair<SimTime, std::string>> commands_;
  std::size_t command_bytes_ = 0;
  std::vector<RequestHandover> handovers_;
  bool forgotten_ = false;  ///< There were more commands or hand-overs.
  bool clients_acted_ = false;
  Executive* executive_ = nullptr;
  std::vector<RecordedWire> about_;  ///< Description of each wire.
  std::vector<std::unique_ptr<Wire>> wires_;
  OutletUser outlet_user_;
  WireUser wire_user_;
  std::unique_ptr<Arrivals> arrivals_;
  std::unique_ptr<Watch> watch_;
  RecordQueue queue_;
  std::atomic<bool> told_full_{false};
  std::unique_ptr<RecordingWriter> writer_;
  /// Problems that the writer's thread has reported.
  std::deque<std::pair<LogLevel, std::string>> trouble_;
  std::thread thread_;
};

}  // namespace rigwire::hil

// Ground truth of the pictures of a run: files in a folder, never sent to a device.
//
//   labels.json                     what the numbers mean, when the run begins
//   CAMERA.jsonl                    a line for each picture, in the order of its exposures
//   CAMERA_000012_image.png         its parts as the camera was handed them: image, right,
//                                   disparity, range, confidence (hil/world/picture_layers.h, raw)
//   CAMERA_000012_depth.png         true distance along the optical axis, mm in 16 bits;
//                                   0: nothing, 65535: farther
//   CAMERA_000012_labels.png        16 bits: place in the table `labels`; 0: nothing
//   CAMERA_000012_instances.png     place in the table `instances`, red + 256 green + 65536 blue,
//                                   as panoptic segmentations of COCO have it; 0: nothing
//
// The truth of each pixel of the picture's first part is that at the middle of that pixel's
// exposure. 12 is the number of the exposure, counted from 0 for each camera; those that were
// skipped are missing. A client finds its picture by the time stamp, `sim_s` since power-on: block
// numbers begin anew with each client, and a picture that was made need not reach a client, as the
// last of a run that ends before the picture is sent.
//
// labels.json: {"rigwire_camera_truth": 1, "start_utc", "labels": ["", …], "instances":
// [null, {"name", "label"}, …]}. A line: {"exposure", "sim_s", "utc", "exposure_us", "gain_db",
// "region" (offset_x, offset_y, width, height), "files" (by layer)}; its files are complete before
// the line is written. Other files in the folder stay, but for those of the same names.
//
// Files are made by a thread of their own. Where simulated time does not follow the wall's, a run
// waits for it, and the folder holds every picture, the same bytes whatever the threads. A paced
// run does not: a picture that finds the queue full is left out, which is reported once.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "hil/record/output_file.h"
#include "hil/world/truth_observer.h"
#include "sim/samples/calendar.h"
#include "sim/scene/scene.h"

namespace rigwire::hil {

class CameraTruthTap final : public CameraTruthObserver {
 public:
  /// `cameras`: the names of those whose pictures are written. Makes the folder where it is
  /// missing. Throws drivers::EndpointError with path and reason when it cannot be written to, and
  /// std::invalid_argument for a camera whose name no file can have. Reports a later write error to
  /// `failures`, which may be null, and writes nothing more. `waits`: wait while the queue is full.
  CameraTruthTap(std::filesystem::path folder, const Calendar& calendar, const sim::Scene& scene,
                 const std::vector<std::string>& cameras, OutputFailures* failures, bool waits);
  /// Writes what is left.
  ~CameraTruthTap() override;

  [[nodiscard]] bool wants(std::string_view camera, SimTime start) const override;
  void record(std::string_view camera, CameraTruthRecord record) override;

 private:
  struct Entry {
    std::string camera;
    CameraTruthRecord record;
  };

  void write_tables(const sim::Scene& scene);
  void run();
  void write(Entry entry);
  void fail(const std::string& what);

  std::filesystem::path folder_;
  Calendar calendar_;
  OutputFailures* failures_;
  bool waits_;
  std::vector<std::uint16_t> label_of_;                                     ///< By instance.
  std::map<std::string, std::unique_ptr<GrowingFile>, std::less<>> lines_;  ///< By camera.

  std::mutex mutex_;
  std::condition_variable work_;
  std::condition_variable room_;
  std::deque<Entry> queue_;
  bool left_out_ = false;  ///< A picture was left out, and that was reported.
  bool failed_ = false;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace rigwire::hil

#include "hil/record/camera_truth_tap.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <utility>

#include "drivers/endpoints.h"
#include "fields/failure_text.h"
#include "hil/executive/background_thread.h"
#include "hil/files/image_file.h"
#include "hil/world/picture_layers.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;

/// Maximum number of pictures, of some megabytes each, that wait to be written.
constexpr std::size_t kMostWaiting = 16;
constexpr const char* kWhat = "the camera truth";

Image truth_image(const sim::CameraTruth& truth, std::size_t channels, int bits) {
  Image image;
  image.columns = static_cast<std::size_t>(truth.width);
  image.rows = static_cast<std::size_t>(truth.height);
  image.channels = channels;
  image.bits = bits;
  image.samples.resize(image.columns * image.rows * channels);
  return image;
}

Image label_image(const sim::CameraTruth& truth, const std::vector<std::uint16_t>& label_of) {
  Image image = truth_image(truth, 1, 16);
  std::ranges::transform(truth.instance, image.samples.begin(), [&](std::uint32_t instance) {
    return instance < label_of.size() ? label_of[instance] : std::uint16_t{0};
  });
  return image;
}

Image instance_image(const sim::CameraTruth& truth, std::size_t instances) {
  Image image = truth_image(truth, 3, 8);
  std::size_t at = 0;
  for (const std::uint32_t instance : truth.instance) {
    const std::uint32_t place = instance < instances ? instance + 1 : 0;
    image.samples[at++] = static_cast<std::uint16_t>(place & 0xFFU);
    image.samples[at++] = static_cast<std::uint16_t>(place >> 8U & 0xFFU);
    image.samples[at++] = static_cast<std::uint16_t>(place >> 16U & 0xFFU);
  }
  return image;
}

std::string dumped(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

CameraTruthTap::CameraTruthTap(fs::path folder, const Calendar& calendar, const sim::Scene& scene,
                               const std::vector<std::string>& cameras, OutputFailures* failures,
                               bool waits)
    : folder_(std::move(folder)), calendar_(calendar), failures_(failures), waits_(waits) {
  for (const std::string& camera : cameras) {
    if (camera.empty() || camera.find('/') != std::string::npos || camera.front() == '.') {
      throw std::invalid_argument(
          fmt::format("{}: the camera's name, found \"{}\", allowed what can begin a file's name",
                      kWhat, camera));
    }
  }
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) {
    throw drivers::EndpointError(fmt::format("{} {}: the folder cannot be made: {}", kWhat,
                                             folder_.string(), error.message()));
  }
  write_tables(scene);
  for (const std::string& camera : cameras) {
    lines_.emplace(camera, std::make_unique<GrowingFile>(
                               kWhat, (folder_ / (camera + ".jsonl")).string(), failures,
                               waits ? std::chrono::milliseconds(kReaderPatience)
                                     : std::chrono::milliseconds{0}));
  }
  thread_ = std::thread([this] {
    yield_to_the_loop();
    run();
  });
}

CameraTruthTap::~CameraTruthTap() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  work_.notify_one();
  thread_.join();
}

void CameraTruthTap::write_tables(const sim::Scene& scene) {
  std::set<std::string> labels;
  for (sim::Scene::InstanceId id = 0; id < scene.instance_count(); ++id) {
    labels.insert(scene.label(id));
  }
  if (labels.size() > std::numeric_limits<std::uint16_t>::max()) {
    throw std::invalid_argument(
        fmt::format("{}: found {} labels in the scene, allowed 65535", kWhat, labels.size()));
  }
  nlohmann::ordered_json tables{{"rigwire_camera_truth", 1},
                                {"start_utc", format_utc(calendar_.utc(kStart))},
                                {"labels", {""}},
                                {"instances", {nullptr}}};
  for (const std::string& label : labels) {
    tables["labels"].push_back(label);
  }
  label_of_.reserve(scene.instance_count());
  for (sim::Scene::InstanceId id = 0; id < scene.instance_count(); ++id) {
    const std::string& label = scene.label(id);
    // Labels are numbered from 1 in alphabetical order; 0 is no label.
    const auto place = std::distance(labels.begin(), labels.find(label));
    label_of_.push_back(static_cast<std::uint16_t>(place + 1));
    tables["instances"].push_back({{"name", scene.name(id)}, {"label", label}});
  }
  try {
    WholeFile(kWhat, (folder_ / "labels.json").string()).write(dumped(tables));
  } catch (const drivers::EndpointError&) {
    throw;
  } catch (const std::runtime_error& refusal) {
    throw drivers::EndpointError(refusal.what());
  }
}

bool CameraTruthTap::wants(std::string_view camera, SimTime /*start*/) const {
  return lines_.contains(camera);
}

void CameraTruthTap::record(std::string_view camera, CameraTruthRecord record) {
  std::unique_lock lock(mutex_);
  if (waits_) {
    room_.wait(lock, [this] { return failed_ || queue_.size() < kMostWaiting; });
  }
  if (failed_) {
    return;
  }
  if (queue_.size() >= kMostWaiting) {
    if (!std::exchange(left_out_, true) && failures_ != nullptr) {
      failures_->report(fmt::format(
          "{} {} is not complete: pictures come faster than they are written; exposure {} of {} "
          "is the first that is missing",
          kWhat, folder_.string(), record.exposure, camera));
    }
    return;
  }
  queue_.push_back({std::string(camera), std::move(record)});
  work_.notify_one();
}

void CameraTruthTap::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    work_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (queue_.empty()) {
      return;
    }
    Entry entry = std::move(queue_.front());
    queue_.pop_front();
    room_.notify_one();
    const bool writes = !failed_;
    lock.unlock();
    if (writes) {
      try {
        write(std::move(entry));
      } catch (const std::exception& refusal) {
        fail(fmt::format("{}; no more of it is written",
                         fields::failure_text(refusal, "the cameras' truth")));
      }
    }
    lock.lock();
  }
}

void CameraTruthTap::write(Entry entry) {
  const Picture& picture = *entry.record.picture;
  nlohmann::ordered_json files;
  const auto put = [&](std::string_view layer, const Image& image) {
    const std::string name =
        fmt::format("{}_{:06}_{}.png", entry.camera, entry.record.exposure, layer);
    const std::vector<std::uint8_t> bytes = encode_png(image);
    WholeFile(kWhat, (folder_ / name).string())
        .write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    files[layer] = name;
  };
  const KeptPicture kept{entry.record.picture, std::move(entry.record.truth), {}, std::nullopt};
  for (const std::string& name : layers_of(kept)) {
    const auto at = std::ranges::find(kPictureLayers, name) - kPictureLayers.begin();
    const auto layer = static_cast<PictureLayer>(at);
    put(name, layer == PictureLayer::labels ? label_image(kept.truth, label_of_)
                                            : layer_image(kept, layer, true));
  }
  put("instances", instance_image(kept.truth, label_of_.size()));
  const PictureRegion& region = picture.parts.front().region;
  const SimTime start = picture.exposure_start;
  const nlohmann::ordered_json line{
      {"exposure", entry.record.exposure},
      {"sim_s", to_seconds(start)},
      {"utc", format_utc(calendar_.utc(start))},
      {"exposure_us", static_cast<double>(picture.exposure.count()) * 1e-3},
      {"gain_db", picture.gain_db},
      {"region", {region.offset_x, region.offset_y, region.width, region.height}},
      {"files", files}};
  lines_.find(entry.camera)->second->write(dumped(line));
}

void CameraTruthTap::fail(const std::string& what) {
  {
    const std::scoped_lock lock(mutex_);
    failed_ = true;
    room_.notify_one();
  }
  if (failures_ != nullptr) {
    failures_->report(what);
  }
}

}  // namespace rigwire::hil

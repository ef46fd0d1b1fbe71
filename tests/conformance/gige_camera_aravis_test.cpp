// libaravis against cameras of a running rig: time stamps, chunks, triggers, several parts, several
// cameras, ranges against the truth.
#include <arv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gige_camera_rig.h"
#include "hil/files/image_file.h"

namespace rigwire::conformance {
namespace {

using namespace std::chrono_literals;

struct Release {
  void operator()(void* object) const { g_object_unref(object); }
};
using Buffer = std::unique_ptr<ArvBuffer, Release>;

/// Fails the test where Aravis tells of an error.
class Outcome {
 public:
  explicit Outcome(const char* doing) : doing_(doing) {}
  ~Outcome() {
    if (error_ != nullptr) {
      ADD_FAILURE() << doing_ << ": " << error_->message;
      g_error_free(error_);
    }
  }
  Outcome(const Outcome&) = delete;
  Outcome& operator=(const Outcome&) = delete;
  operator GError**() { return &error_; }  // NOLINT: as Aravis takes it

 private:
  const char* doing_;
  GError* error_ = nullptr;
};

/// One camera under our control.
class Client {
 public:
  /// Tries until it is there.
  explicit Client(const std::string& address) {
    EXPECT_TRUE(test::eventually([&] {
      GError* error = nullptr;
      camera_.reset(arv_camera_new(address.c_str(), &error));
      g_clear_error(&error);
      return camera_ != nullptr;
    })) << "no camera at "
        << address;
    arv_camera_gv_set_stream_options(camera_.get(), ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    arv_camera_gv_set_packet_size_adjustment(camera_.get(), ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
  }
  [[nodiscard]] ArvCamera* get() const { return camera_.get(); }

  void start() {
    stream_.reset(arv_camera_create_stream(get(), nullptr, nullptr, Outcome("stream")));
    ASSERT_NE(stream_, nullptr);
    // Patience: the machine of a test may be busy.
    g_object_set(stream_.get(), "frame-retention", 3'000'000U, "packet-request-ratio", 2.0,
                 nullptr);
    const guint payload = arv_camera_get_payload(get(), Outcome("payload"));
    for (int i = 0; i < 30; ++i) {
      arv_stream_push_buffer(stream_.get(), arv_buffer_new_allocate(payload));
    }
    arv_camera_start_acquisition(get(), Outcome("start"));
  }
  void stop() { arv_camera_stop_acquisition(get(), Outcome("stop")); }

  /// The next picture, whole; null when none comes within the patience.
  Buffer next(std::chrono::milliseconds patience = test::kPatience) {
    Buffer buffer(arv_stream_timeout_pop_buffer(
        stream_.get(), static_cast<guint64>(std::chrono::microseconds(patience).count())));
    if (buffer) {
      EXPECT_EQ(arv_buffer_get_status(buffer.get()), ARV_BUFFER_STATUS_SUCCESS);
    }
    return buffer;
  }

 private:
  std::unique_ptr<ArvCamera, Release> camera_;
  std::unique_ptr<ArvStream, Release> stream_;
};

TEST(GigeCameraAravis, time_stamps_are_simulated_time_to_the_nanosecond) {
  const std::string address = own_address();
  GigeCameraRig rig(camera_yaml("stamp", "gige-camera", address));
  Client client(address);
  arv_camera_set_frame_rate(client.get(), 20.0, Outcome("rate"));
  client.start();
  guint64 before = 0;
  for (int i = 0; i < 20; ++i) {
    const Buffer picture = client.next();
    ASSERT_TRUE(picture) << i;
    const guint64 stamp = arv_buffer_get_timestamp(picture.get());
    if (i > 0) {
      EXPECT_GT(stamp, before);
      EXPECT_EQ((stamp - before) % 50'000'000, 0U) << i;
    }
    before = stamp;
    EXPECT_EQ(arv_buffer_get_image_width(picture.get()), 640);
    EXPECT_EQ(arv_buffer_get_image_height(picture.get()), 480);
    EXPECT_EQ(arv_buffer_get_image_pixel_format(picture.get()), ARV_PIXEL_FORMAT_MONO_8);
  }
}

TEST(GigeCameraAravis, chunks_say_what_the_picture_was_taken_with) {
  const std::string address = own_address();
  GigeCameraRig rig(camera_yaml("chunk", "gige-camera", address));
  Client client(address);
  arv_camera_set_exposure_time(client.get(), 1500.0, Outcome("exposure"));
  arv_camera_set_gain(client.get(), 6.5, Outcome("gain"));
  arv_camera_set_chunks(client.get(), "Timestamp,FrameID,ExposureTime,Gain", Outcome("chunks"));
  const std::unique_ptr<ArvChunkParser, Release> parser(
      arv_camera_create_chunk_parser(client.get()));
  client.start();
  for (int i = 0; i < 5; ++i) {
    const Buffer picture = client.next();
    ASSERT_TRUE(picture) << i;
    ASSERT_TRUE(arv_buffer_has_chunks(picture.get()));
    const auto integer = [&](const char* chunk) {
      return arv_chunk_parser_get_integer_value(parser.get(), picture.get(), chunk, Outcome(chunk));
    };
    const auto real = [&](const char* chunk) {
      return arv_chunk_parser_get_float_value(parser.get(), picture.get(), chunk, Outcome(chunk));
    };
    EXPECT_EQ(static_cast<guint64>(integer("ChunkTimestamp")),
              arv_buffer_get_timestamp(picture.get()));
    EXPECT_EQ(static_cast<guint64>(integer("ChunkFrameID")),
              arv_buffer_get_frame_id(picture.get()));
    EXPECT_DOUBLE_EQ(real("ChunkExposureTime"), 1500.0);
    EXPECT_DOUBLE_EQ(real("ChunkGain"), 6.5);
  }
}

TEST(GigeCameraAravis, trigger_by_software_makes_one_picture_and_none_comes_without) {
  const std::string address = own_address();
  GigeCameraRig rig(camera_yaml("soft", "gige-camera", address, "    processing: 1 s\n"));
  Client client(address);
  arv_camera_set_trigger(client.get(), "Software", Outcome("trigger"));
  client.start();
  EXPECT_FALSE(client.next(1500ms));
  guint64 before = 0;
  for (int i = 0; i < 3; ++i) {
    arv_camera_software_trigger(client.get(), Outcome("software trigger"));
    const Buffer picture = client.next();
    ASSERT_TRUE(picture) << i;
    EXPECT_GT(arv_buffer_get_timestamp(picture.get()), before);
    before = arv_buffer_get_timestamp(picture.get());
    EXPECT_FALSE(client.next(300ms)) << "a second picture of trigger " << i;
  }
}

TEST(GigeCameraAravis, cameras_on_one_line_expose_together) {
  const std::string left = own_address();
  const std::string right = own_address();
  const std::string line = "    line: {first: 130 ms, period: 200 ms}\n    processing: 1 s\n";
  // A second of the wall's time for a pair of pictures: neither camera skips a pulse.
  GigeCameraRig rig(camera_yaml("left", "gige-camera", left, line) +
                        camera_yaml("right", "gige-camera", right, line),
                    {"--clock", "scaled:0.2"});
  Client a(left);
  Client b(right);
  for (const Client* client : {&a, &b}) {
    arv_camera_set_trigger(client->get(), "Line0", Outcome("trigger"));
  }
  a.start();
  b.start();
  std::set<guint64> of_a;
  std::set<guint64> of_b;
  std::vector<guint64> both;
  // One starts a little later, and a busy machine may let one of them skip a pulse; they see the
  // same.
  while (both.size() < 3) {
    const Buffer one = a.next();
    const Buffer other = b.next();
    ASSERT_TRUE(one && other);
    of_a.insert(arv_buffer_get_timestamp(one.get()));
    of_b.insert(arv_buffer_get_timestamp(other.get()));
    EXPECT_EQ(*of_a.rbegin() % 200'000'000, 130'000'000U);
    EXPECT_EQ(*of_b.rbegin() % 200'000'000, 130'000'000U);
    ASSERT_LT(of_a.size(), 100U) << "they never expose together";
    both.clear();
    std::ranges::set_intersection(of_a, of_b, std::back_inserter(both));
  }
}

/// Values of ComponentIDValue (SFNC).
constexpr guint kIntensity = 1;
constexpr guint kRange = 4;
constexpr guint kConfidence = 6;
constexpr guint kDisparity = 8;

TEST(GigeCameraAravis, stereo_camera_sends_image_disparity_and_confidence_in_one_block) {
  const std::string address = own_address();
  GigeCameraRig rig(camera_yaml("pair", "gige-stereo", address,
                                "    rate: 2 Hz\n    processing: 2 s\n    exposure_auto: true\n"));
  Client client(address);
  arv_camera_gv_set_multipart(client.get(), TRUE, Outcome("multipart"));
  const double scale =
      arv_camera_get_float(client.get(), "Scan3dCoordinateScale", Outcome("scale"));
  const double focal_px =
      arv_camera_get_float(client.get(), "Scan3dFocalLength", Outcome("focal length"));
  const double baseline_m =
      arv_camera_get_float(client.get(), "Scan3dBaseline", Outcome("baseline"));
  client.start();
  Buffer picture;
  for (int i = 0; i < 4; ++i) {  // automatic exposure settles
    picture = client.next();
    ASSERT_TRUE(picture) << i;
  }
  ASSERT_EQ(arv_buffer_get_n_parts(picture.get()), 3U);
  const auto part = [&](guint component) {
    const gint found = arv_buffer_find_component(picture.get(), component);
    EXPECT_GE(found, 0) << component;
    return static_cast<guint>(std::max(found, 0));
  };
  const guint disparity = part(kDisparity);
  EXPECT_EQ(arv_buffer_get_part_pixel_format(picture.get(), part(kIntensity)),
            ARV_PIXEL_FORMAT_MONO_8);
  EXPECT_EQ(arv_buffer_get_part_pixel_format(picture.get(), disparity),
            ARV_PIXEL_FORMAT_COORD3D_C_16);
  EXPECT_NE(part(kConfidence), disparity);
  const gint width = arv_buffer_get_part_width(picture.get(), disparity);
  const gint height = arv_buffer_get_part_height(picture.get(), disparity);
  std::size_t bytes = 0;
  const auto* data =
      static_cast<const std::uint8_t*>(arv_buffer_get_part_data(picture.get(), disparity, &bytes));
  ASSERT_EQ(bytes, static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 2);
  // The box ahead begins at 7 m, 5.5 m before the camera; its middle is 1 m to the left.
  std::vector<double> depths_m;
  for (gint row = height / 2 - 20; row < height / 2 + 20; ++row) {
    for (gint column = width / 2 - 80; column < width / 2; ++column) {
      const std::size_t at = 2 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(column));
      if (const int value = data[at] | data[at + 1] << 8; value != 0) {
        depths_m.push_back(focal_px * baseline_m / (scale * value));
      }
    }
  }
  ASSERT_GT(depths_m.size(), 300U);
  std::ranges::nth_element(depths_m,
                           depths_m.begin() + static_cast<std::ptrdiff_t>(depths_m.size() / 2));
  EXPECT_NEAR(depths_m[depths_m.size() / 2], 5.5, 0.4);
}

/// What the run wrote as the truth behind the picture of that time stamp.
hil::Image true_depth(const std::filesystem::path& folder, const std::string& camera,
                      guint64 stamp) {
  std::ifstream lines(folder / (camera + ".jsonl"));
  for (std::string text; std::getline(lines, text);) {
    const auto line = nlohmann::json::parse(text);
    if (static_cast<guint64>(std::llround(1e9 * line["sim_s"].get<double>())) == stamp) {
      return hil::read_png(folder / line["files"]["depth"].get<std::string>(), "truth: ");
    }
  }
  ADD_FAILURE() << "there is no truth of " << stamp;
  return {};
}

TEST(GigeCameraAravis, depth_camera_sends_ranges_that_are_true) {
  const std::string address = own_address();
  const test::PrivateWires scratch;
  const auto folder = scratch.folder / "truth";
  GigeCameraRig rig(
      camera_yaml("tof", "gige-depth", address, "    rate: 2 Hz\n    processing: 2 s\n"),
      {"--camera-truth", folder.string()});
  Client client(address);
  arv_camera_gv_set_multipart(client.get(), TRUE, Outcome("multipart"));
  const auto feature = [&](const char* name) {
    return arv_camera_get_float(client.get(), name, Outcome(name));
  };
  const double scale_mm = feature("Scan3dCoordinateScale");
  const double offset_mm = feature("Scan3dCoordinateOffset");
  const double invalid = feature("Scan3dInvalidDataValue");
  EXPECT_TRUE(arv_camera_get_boolean(client.get(), "Scan3dInvalidDataFlag", Outcome("flag")));
  EXPECT_GT(scale_mm, 0.0);
  client.start();
  const Buffer picture = client.next();
  ASSERT_TRUE(picture);
  ASSERT_EQ(arv_buffer_get_n_parts(picture.get()), 3U);
  const gint found = arv_buffer_find_component(picture.get(), kRange);
  ASSERT_GE(found, 0);
  const auto range = static_cast<guint>(found);
  EXPECT_EQ(arv_buffer_get_part_pixel_format(picture.get(), range), ARV_PIXEL_FORMAT_COORD3D_C_16);
  std::size_t bytes = 0;
  const auto* data =
      static_cast<const std::uint8_t*>(arv_buffer_get_part_data(picture.get(), range, &bytes));
  const auto width = static_cast<std::size_t>(arv_buffer_get_part_width(picture.get(), range));
  const auto height = static_cast<std::size_t>(arv_buffer_get_part_height(picture.get(), range));
  ASSERT_EQ(bytes, 2 * width * height);
  client.stop();
  (void)rig.report();  // the lists of the truth are whole now
  const hil::Image truth = true_depth(folder, "tof", arv_buffer_get_timestamp(picture.get()));
  ASSERT_EQ(truth.columns, width);
  ASSERT_EQ(truth.rows, height);
  // The camera works up to 10 m of way; its error there is 5 mm through a cycle and 20 mm of noise
  // at most. On edges it floats between front and back.
  std::vector<double> errors_mm;
  std::size_t sky = 0;
  std::size_t far = 0;
  for (std::size_t v = 1; v + 1 < height; ++v) {
    for (std::size_t u = 1; u + 1 < width; ++u) {
      const std::size_t at = 2 * (v * width + u);
      const int value = data[at] | data[at + 1] << 8;
      const bool valid = value != static_cast<int>(invalid);
      const int here_mm = truth.sample(u, v, 0);
      int nearest_mm = here_mm;
      int farthest_mm = here_mm;
      for (const auto& [du, dv] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const int beside_mm =
            truth.sample(u + static_cast<std::size_t>(du), v + static_cast<std::size_t>(dv), 0);
        nearest_mm = std::min(nearest_mm, beside_mm);
        farthest_mm = std::max(farthest_mm, beside_mm);
      }
      if (farthest_mm == 0) {
        ++sky;
        EXPECT_FALSE(valid) << u << ", " << v << " is of the sky";
      } else if (nearest_mm > 10'100) {
        ++far;
        EXPECT_FALSE(valid) << u << ", " << v << " is " << here_mm << " mm away";
      } else if (valid && nearest_mm > 0 && farthest_mm - nearest_mm < 60) {
        errors_mm.push_back(std::abs(offset_mm + scale_mm * value - here_mm));
      }
    }
  }
  EXPECT_GT(sky, 1000U);
  EXPECT_GT(far, 1000U);
  ASSERT_GT(errors_mm.size(), 20'000U);
  std::ranges::sort(errors_mm);
  EXPECT_LT(errors_mm[errors_mm.size() / 2], 10.0);
  EXPECT_LT(errors_mm.back(), 150.0);
}

}  // namespace
}  // namespace rigwire::conformance

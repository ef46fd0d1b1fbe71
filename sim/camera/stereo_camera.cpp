#include "sim/camera/stereo_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/camera/shot_parts.h"

namespace rigwire::sim {

using fields::in;

namespace {

/// Steps of a disparity in a pixel.
constexpr double kSteps = 16.0;
constexpr std::string_view kKind = "stereo camera";

bool distorted(const LensParameters& p) {
  return p.k1 != 0.0 || p.k2 != 0.0 || p.p1 != 0.0 || p.p2 != 0.0 || p.k3 != 0.0 ||
         p.image_circle_rad != 0.0;
}

/// The pinhole camera that pictures are rectified to.
CameraParameters rectified(const CameraParameters& given) {
  CameraParameters p = given;
  LensParameters& lens = p.lens;
  lens.k1 = lens.k2 = lens.p1 = lens.p2 = lens.k3 = 0.0;
  lens.image_circle_rad = 0.0;
  p.sensor.dirt_blobs = 0;
  return p;
}

StereoCameraParameters valid(const StereoCameraParameters& parameters) {
  validate(parameters);
  return parameters;
}

/// Where each rectified pixel lies in a head's own picture.
class Rectification {
 public:
  Rectification(const Lens& own, const Lens& ideal)
      : width_(own.width_px()), height_(own.height_px()) {
    places_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    for (int row = 0; row < height_; ++row) {
      for (int column = 0; column < width_; ++column) {
        const auto direction = ideal.direction(Eigen::Vector2d(column, row));
        const auto place = direction ? own.project(*direction) : std::nullopt;
        const bool within = place && place->x() >= 0.0 && place->y() >= 0.0 &&
                            place->x() <= width_ - 1 && place->y() <= height_ - 1;
        places_.push_back(within ? place->cast<float>() : Eigen::Vector2f(kNowhere, kNowhere));
      }
    }
  }

  /// Numbers between four pixels of the head's; 0 where it has no picture.
  void apply(const std::vector<std::uint16_t>& own, std::vector<std::uint16_t>& rectified) const {
    rectified.resize(places_.size());
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Eigen::Vector2f& place = places_[i];
      if (place.x() < 0.0F) {
        rectified[i] = 0;
        continue;
      }
      const int x = std::min(static_cast<int>(place.x()), width_ - 2);
      const int y = std::min(static_cast<int>(place.y()), height_ - 2);
      const float a = place.x() - static_cast<float>(x);
      const float b = place.y() - static_cast<float>(y);
      const std::uint16_t* const n = own.data() + static_cast<std::ptrdiff_t>(y) * width_ + x;
      const float number = (1.0F - b) * ((1.0F - a) * n[0] + a * n[1]) +
                           b * ((1.0F - a) * n[width_] + a * n[width_ + 1]);
      const float rounded = number + 0.5F;
      rectified[i] = static_cast<std::uint16_t>(rounded);
    }
  }

 private:
  static constexpr float kNowhere = -1.0F;
  int width_;
  int height_;
  std::vector<Eigen::Vector2f> places_;
};

class StereoCamera final : public CameraSensor {
 public:
  StereoCamera(const StereoCameraParameters& parameters, std::uint64_t seed, std::string_view name)
      : parameters_(valid(parameters)),
        heads_{Head(parameters.camera, seed, std::string(name) + "/left"),
               Head(parameters.camera, seed, std::string(name) + "/right")},
        matcher_(make_stereo_matcher(parameters.matching, parameters.camera.threads)) {
    heads_[1].X_SC.translation().y() = -parameters.baseline_m;
    calibrated_right_ = heads_[1].X_SC;
    const Eigen::Vector3d& turn = parameters.misalignment_rad;
    heads_[1].X_SC.linear() = (Eigen::AngleAxisd(turn.z(), Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(turn.y(), Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(turn.x(), Eigen::Vector3d::UnitX()))
                                  .toRotationMatrix();
    if (distorted(parameters.camera.lens)) {
      ideal_.emplace(rectified(parameters.camera), seed, std::string(name) + "/rectified");
      rectification_.emplace(heads_[0].renderer.lens(), ideal_->lens());
    }
    const ReportedGeometry geometry = stereo_geometry(parameters);
    focal_baseline_px_m_ = geometry.focal_length_px * geometry.baseline_m;
  }

  [[nodiscard]] Duration span(const CameraCommand& command, Duration exposure) const override {
    return whole_span(command, exposure, parameters_.camera.sensor);
  }

  [[nodiscard]] Taken take(const Scene& scene, const CameraShot& shot,
                           CameraTruth* truth) override {
    const CameraCommand& command = shot.command;
    const ImageSensorParameters& sensor = parameters_.camera.sensor;
    require_fits(command, kKind, kStereoParts, sensor_formats(false));
    require_region(command, kKind, sensor.width_px, sensor.height_px);
    const ReadOut read_out = whole_read_out(shot, sensor);
    const bool matching = command.disparity || command.confidence;
    const bool left = command.intensity || (matching && !matcher_->needs_truth());
    const bool right = command.intensity_right || (matching && !matcher_->needs_truth());
    if (left) {
      expose(heads_[0], scene, shot, read_out);
    }
    if (right) {
      expose(heads_[1], scene, shot, read_out);
    }
    const bool of_left = command.intensity || matching;
    // Automatic exposure looks at the left head where it was exposed.
    const double mean = left ? heads_[0].rendered.mean : right ? heads_[1].rendered.mean : 0.0;
    if (truth != nullptr) {
      tell(scene, shot, read_out, of_left ? heads_[0].X_SC : heads_[1].X_SC, heads_[0].known);
      *truth = crop(heads_[0].known, command.region);
    }
    if (matching) {
      match(scene, shot, read_out, truth != nullptr && of_left);
    }

    Picture picture = empty_picture(shot);
    if (command.intensity) {
      add_intensity(picture, command, 0);
    }
    if (command.intensity_right) {
      add_intensity(picture, command, 1);
    }
    if (command.disparity) {
      add_disparity(picture, command);
    }
    if (command.confidence) {
      add_part(picture, PictureComponent::confidence, PixelFormat::confidence8, command.region,
               found_.confidence, sensor.width_px);
    }
    return {std::make_shared<const Picture>(std::move(picture)), mean};
  }

 private:
  struct Head {
    Head(const CameraParameters& parameters, std::uint64_t seed, const std::string& name)
        : renderer(parameters, seed, name) {}
    CameraRenderer renderer;
    Eigen::Isometry3d X_SC = Eigen::Isometry3d::Identity();
    RenderedPicture rendered;
    std::vector<std::uint16_t> rectified;
    std::vector<std::uint8_t> grey;  ///< Upper eight bits.
    RenderedPicture known;           ///< What is true behind the rectified pixels.
  };

  void expose(Head& head, const Scene& scene, const CameraShot& shot, const ReadOut& read_out) {
    head.renderer.render(scene, job_of(shot, read_out, head.X_SC), head.rendered);
    if (rectification_) {
      rectification_->apply(head.rendered.numbers, head.rectified);
    } else {
      head.rectified = head.rendered.numbers;
    }
    head.grey.resize(head.rectified.size());
    const int surplus = read_out.bits - 8;
    for (std::size_t i = 0; i < head.grey.size(); ++i) {
      head.grey[i] = static_cast<std::uint8_t>(head.rectified[i] >> surplus);
    }
  }

  /// Renders the truth behind the pixels of a rectified camera at `X_SC`.
  void tell(const Scene& scene, const CameraShot& shot, const ReadOut& read_out,
            const Eigen::Isometry3d& X_SC, RenderedPicture& known) {
    CameraRenderer& renderer = ideal_ ? *ideal_ : heads_[0].renderer;
    renderer.measure(scene, job_of(shot, read_out, X_SC), known);
  }

  void match(const Scene& scene, const CameraShot& shot, const ReadOut& read_out,
             bool left_is_known) {
    StereoPair pair;
    pair.width = parameters_.camera.sensor.width_px;
    pair.height = parameters_.camera.sensor.height_px;
    pair.left = heads_[0].grey;
    pair.right = heads_[1].grey;
    pair.focal_baseline_px_m = focal_baseline_px_m_;
    if (matcher_->needs_truth()) {
      if (!left_is_known) {
        tell(scene, shot, read_out, heads_[0].X_SC, heads_[0].known);
      }
      tell(scene, shot, read_out, calibrated_right_, heads_[1].known);
      pair.left_depth_m = heads_[0].known.depth_m;
      pair.right_depth_m = heads_[1].known.depth_m;
    }
    matcher_->match(pair, shot.command.confidence, found_);
  }

  void add_intensity(Picture& picture, const CameraCommand& command, std::uint8_t head) {
    const int bits = static_cast<int>(significant_bits(command.format));
    pack_numbers(heads_[head].rectified, bits, packed_);
    PicturePart& part = add_part(picture, PictureComponent::intensity, command.format,
                                 command.region, packed_, parameters_.camera.sensor.width_px);
    part.source = head;
  }

  void add_disparity(Picture& picture, const CameraCommand& command) {
    packed_.resize(2 * found_.disparity_px.size());
    for (std::size_t i = 0; i < found_.disparity_px.size(); ++i) {
      // None, as one below half a step, is 0.
      const double steps = std::max(0.0, kSteps * static_cast<double>(found_.disparity_px[i]));
      put_16(static_cast<std::uint16_t>(std::lround(steps)), packed_.data() + 2 * i);
    }
    add_part(picture, PictureComponent::disparity, PixelFormat::coord3d_c16, command.region,
             packed_, parameters_.camera.sensor.width_px);
  }

  StereoCameraParameters parameters_;
  std::array<Head, 2> heads_;
  Eigen::Isometry3d calibrated_right_ = Eigen::Isometry3d::Identity();
  std::unique_ptr<StereoMatcher> matcher_;
  /// Only of heads whose pictures are not rectified already.
  std::optional<CameraRenderer> ideal_;
  std::optional<Rectification> rectification_;
  double focal_baseline_px_m_ = 0.0;
  DisparityPicture found_;
  std::vector<std::uint8_t> packed_;
};

}  // namespace

CameraParameters StereoCameraParameters::heads() {
  CameraParameters p;
  p.sensor.width_px = 640;
  p.sensor.height_px = 480;
  p.sensor.pixel_pitch_m = 7.5e-6;
  p.lens.focal_length_m = 0.004;
  return p;
}

void visit(fields::Visitor& v, StereoCameraParameters& p) {
  visit(v, p.camera);
  v.number("baseline", p.baseline_m, in("m").between(0.001, 10), "Between left and right head.");
  v.vector3("misalignment", p.misalignment_rad, in("deg").between(-5, 5),
            "Error of the right head, unknown to the calibration: roll, pitch, yaw.");
  v.section("matching", p.matching, "How the pictures become disparities.");
}

void validate(const StereoCameraParameters& p) {
  fields::check(p);
  validate(p.camera);
  fields::require(!p.camera.sensor.colour, "image_sensor.colour", "true",
                  "false: grey pictures are matched");
  fields::require(p.camera.lens.model == LensModel::brown_conrady, "lens.model", "another",
                  "brown_conrady: pictures are rectified to a pinhole camera");
  const int searched = p.matching.least_disparity + p.matching.disparities;
  fields::require(
      searched < p.camera.sensor.width_px, "matching.disparities",
      std::to_string(p.matching.disparities),
      "with least_disparity below the width, " + std::to_string(p.camera.sensor.width_px));
}

ReportedGeometry stereo_geometry(const StereoCameraParameters& p) {
  const Lens lens(p.camera.lens, p.camera.sensor.pixel_pitch_m, p.camera.sensor.width_px,
                  p.camera.sensor.height_px);
  ReportedGeometry geometry;
  geometry.focal_length_px = lens.focal_length_px();
  geometry.baseline_m = p.baseline_m;
  geometry.principal_u_px = lens.principal_point_px().x();
  geometry.principal_v_px = lens.principal_point_px().y();
  geometry.coding = {1.0 / kSteps, 0.0, 0};
  return geometry;
}

std::unique_ptr<CameraSensor> make_stereo_camera(const StereoCameraParameters& parameters,
                                                 std::uint64_t seed, std::string_view name) {
  return std::make_unique<StereoCamera>(parameters, seed, name);
}

}  // namespace rigwire::sim

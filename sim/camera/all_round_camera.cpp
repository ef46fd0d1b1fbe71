#include "sim/camera/all_round_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/camera/shot_parts.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;

namespace {

constexpr double kHalfTurn = std::numbers::pi;
/// Rounding of angles that a file gives in degrees.
constexpr double kRounding_rad = 1e-9;

constexpr std::array<fields::Choice<AllRoundMethod>, 2> kMethods{
    {{AllRoundMethod::rays, "rays", "Each pixel's ray is cast where it looks."},
     {AllRoundMethod::views, "views", "Pictures of several cameras are joined."}}};

constexpr std::string_view kKind = "all-round camera";
constexpr std::array kColour{PixelFormat::rgb8};

AllRoundCameraParameters valid(const AllRoundCameraParameters& parameters) {
  validate(parameters);
  return parameters;
}

/// What looks where each pixel of the joined picture does.
CameraParameters ray_camera(const AllRoundCameraParameters& p) {
  CameraParameters camera = p.camera;
  camera.sensor.width_px = p.width_px;
  camera.sensor.height_px = p.height_px;
  LensParameters lens;
  lens.model = LensModel::equirectangular;
  lens.f_number = p.camera.lens.f_number;
  const double per_rad = p.width_px / (2.0 * kHalfTurn);
  lens.focal_length_m = per_rad * camera.sensor.pixel_pitch_m;
  // From the middle of the picture to elevation 0, in pixels down.
  lens.principal_offset_px = {0.0, p.elevation_upper_rad * per_rad - 0.5 * p.height_px};
  camera.lens = lens;
  return camera;
}

/// One of the views: the middles of its outermost columns are at the seams.
CameraParameters view_camera(const AllRoundCameraParameters& p) {
  CameraParameters camera = p.camera;
  LensParameters lens;
  lens.f_number = p.camera.lens.f_number;
  lens.vignetting = p.camera.lens.vignetting;
  lens.focal_length_m = 0.5 * (p.camera.sensor.width_px - 1) / std::tan(kHalfTurn / p.views) *
                        p.camera.sensor.pixel_pitch_m;
  camera.lens = lens;
  return camera;
}

/// Interpolates a mosaic: each of a pixel's three colours is the mean of the nearest pixels with
/// that filter. `round`: columns wrap around.
void demosaic(const std::vector<std::uint16_t>& mosaic, int width, int height, bool round,
              std::vector<std::uint16_t>& colours) {
  colours.resize(3 * mosaic.size());
  const auto column_of = [&](int x) {
    return round ? (x + width) % width : (x < 0 ? -x : x >= width ? 2 * width - 2 - x : x);
  };
  const auto row_of = [&](int y) { return y < 0 ? -y : y >= height ? 2 * height - 2 - y : y; };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::array<unsigned, 3> sum{};
      std::array<unsigned, 3> count{};
      const int own = ImageSensor::bayer_band(x, y);
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          // Mirrored, and of even widths round, a neighbour's filter is what it would be beyond.
          const auto band = static_cast<std::size_t>(ImageSensor::bayer_band(x + dx, y + dy));
          if (static_cast<int>(band) == own && (dx != 0 || dy != 0)) {
            continue;
          }
          sum[band] +=
              mosaic[static_cast<std::size_t>(row_of(y + dy)) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column_of(x + dx))];
          ++count[band];
        }
      }
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(x);
      for (std::size_t band = 0; band < 3; ++band) {
        colours[3 * at + band] =
            static_cast<std::uint16_t>((sum[band] + count[band] / 2) / count[band]);
      }
    }
  }
}

class AllRoundCamera final : public CameraSensor {
 public:
  AllRoundCamera(const AllRoundCameraParameters& parameters, std::uint64_t seed,
                 std::string_view name)
      : parameters_(valid(parameters)) {
    if (parameters.method == AllRoundMethod::rays) {
      views_.push_back(std::make_unique<View>(ray_camera(parameters), seed, std::string(name)));
      return;
    }
    for (int i = 0; i < parameters.views; ++i) {
      views_.push_back(std::make_unique<View>(view_camera(parameters), seed,
                                              std::string(name) + "/view" + std::to_string(i)));
      views_.back()->X_SC.linear() =
          Eigen::AngleAxisd(-2.0 * kHalfTurn * i / parameters.views, Eigen::Vector3d::UnitZ())
              .toRotationMatrix();
    }
    look_up_places();
  }

  [[nodiscard]] Duration span(const CameraCommand& command, Duration exposure) const override {
    CameraShot shot;
    shot.command = command;
    shot.exposure = exposure;
    const ImageSensorParameters& sensor = views_.front()->renderer.sensor().parameters();
    return exposure_span(job_of(shot, read_out(shot, sensor)), sensor);
  }

  [[nodiscard]] Taken take(const Scene& scene, const CameraShot& shot,
                           CameraTruth* truth) override {
    const AllRoundCameraParameters& p = parameters_;
    const CameraCommand& command = shot.command;
    const bool colour = p.camera.sensor.colour;
    require_fits(command, kKind, {},
                 colour ? std::span<const PixelFormat>(kColour) : sensor_formats(false));
    require_region(command, kKind, p.width_px, p.height_px);
    for (std::size_t i = 0; i < views_.size(); ++i) {
      View& view = *views_[i];
      view.exposed = places_.empty() || sees(i, command.region);
      if (!view.exposed) {
        continue;
      }
      const ImageSensorParameters& sensor = view.renderer.sensor().parameters();
      PictureJob job = job_of(shot, read_out(shot, sensor), view.X_SC);
      job.truth = truth != nullptr;
      view.renderer.render(scene, job, view.rendered);
      if (colour) {
        demosaic(view.rendered.numbers, sensor.width_px, sensor.height_px, places_.empty(),
                 view.colours);
      }
    }

    Picture picture = empty_picture(shot);
    PicturePart& part = picture.parts.emplace_back();
    part.format = command.format;
    part.region = command.region;
    const double mean = places_.empty() ? take_rays(shot, part, truth) : join(shot, part, truth);
    return {std::make_shared<const Picture>(std::move(picture)), mean};
  }

 private:
  struct View {
    View(const CameraParameters& parameters, std::uint64_t seed, const std::string& name)
        : renderer(parameters, seed, name) {}
    CameraRenderer renderer;
    Eigen::Isometry3d X_SC = Eigen::Isometry3d::Identity();
    bool exposed = false;
    RenderedPicture rendered;
    std::vector<std::uint16_t> colours;  ///< Red, green, blue; of colour sensors.

    [[nodiscard]] std::span<const std::uint16_t> numbers(bool colour) const {
      return colour ? colours : rendered.numbers;
    }
  };
  /// Where a pixel of the joined picture lies.
  struct Place {
    int view = -1;  ///< -1: no view sees it.
    Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
  };

  /// A region alone where nothing has to be joined or interpolated.
  [[nodiscard]] ReadOut read_out(const CameraShot& shot,
                                 const ImageSensorParameters& sensor) const {
    return parameters_.method == AllRoundMethod::rays && !sensor.colour
               ? read_out_of(shot)
               : whole_read_out(shot, sensor);
  }

  void look_up_places() {
    const AllRoundCameraParameters& p = parameters_;
    const CameraParameters joined = ray_camera(p);
    const Lens lens(joined.lens, joined.sensor.pixel_pitch_m, p.width_px, p.height_px);
    const Lens& own = views_.front()->renderer.lens();
    places_.resize(static_cast<std::size_t>(p.width_px) * static_cast<std::size_t>(p.height_px));
    for (std::size_t at = 0; at < places_.size(); ++at) {
      const auto width = static_cast<std::size_t>(p.width_px);
      const std::size_t row = at / width;
      const Eigen::Vector2d pixel(static_cast<double>(at % width), static_cast<double>(row));
      const Eigen::Vector3d direction_S = lens_to_mount(*lens.direction(pixel));
      // The view whose axis is nearest in azimuth.
      const double right_rad = std::atan2(-direction_S.y(), direction_S.x());
      const int nearest = static_cast<int>(std::lround(right_rad * p.views / (2.0 * kHalfTurn)));
      const int view = (nearest + p.views) % p.views;
      const auto seen = own.project(mount_to_lens(
          views_[static_cast<std::size_t>(view)]->X_SC.linear().transpose() * direction_S));
      // At the seams, which are the middles of the outermost columns, up to rounding.
      constexpr double kRounding_px = 1e-6;
      if (seen && seen->x() >= -kRounding_px && seen->y() >= 0.0 &&
          seen->x() <= own.width_px() - 1 + kRounding_px && seen->y() <= own.height_px() - 1) {
        places_[at] = {view, seen->cast<float>()};
      }
    }
  }

  template <class Work>
  void each_pixel(const PictureRegion& region, const Work& work) const {
    std::size_t to = 0;
    for (int row = 0; row < region.height; ++row) {
      for (int column = 0; column < region.width; ++column, ++to) {
        work(to, static_cast<std::size_t>(region.offset_y + row) *
                         static_cast<std::size_t>(parameters_.width_px) +
                     static_cast<std::size_t>(region.offset_x + column));
      }
    }
  }

  [[nodiscard]] bool sees(std::size_t view, const PictureRegion& region) const {
    bool any = false;
    each_pixel(region, [&](std::size_t, std::size_t at) {
      any = any || places_[at].view == static_cast<int>(view);
    });
    return any;
  }

  double take_rays(const CameraShot& shot, PicturePart& part, CameraTruth* truth) {
    const View& view = *views_.front();
    const RenderedPicture& rendered = view.rendered;
    const PictureRegion& region = part.region;
    const CameraTruth known{rendered.width, rendered.height, rendered.range_m, rendered.depth_m,
                            rendered.instance};
    if (!parameters_.camera.sensor.colour) {
      pack_numbers(rendered.numbers, static_cast<int>(significant_bits(part.format)), part.bytes);
      if (truth != nullptr) {
        *truth = known;
      }
      return rendered.mean;
    }
    pack_numbers(view.colours, 8, packed_);
    crop(packed_, parameters_.width_px, region, bytes_per_pixel(part.format), part.bytes);
    if (truth != nullptr) {
      *truth = crop(known, region);
    }
    return mean_of(part.bytes, shot, 8, part.bytes.size());
  }

  /// Each pixel between four of the view that sees it.
  double join(const CameraShot& shot, PicturePart& part, CameraTruth* truth) {
    const bool colour = parameters_.camera.sensor.colour;
    const std::size_t bands = colour ? 3 : 1;
    const Lens& own = views_.front()->renderer.lens();
    const int width = own.width_px();
    const int height = own.height_px();
    const PictureRegion& region = part.region;
    const auto pixels =
        static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
    joined_.assign(pixels * bands, 0);
    if (truth != nullptr) {
      truth->width = region.width;
      truth->height = region.height;
      truth->range_m.assign(pixels, 0.0F);
      truth->depth_m.assign(pixels, 0.0F);
      truth->instance.assign(pixels, ~0U);
    }
    std::size_t seen = 0;
    each_pixel(region, [&](std::size_t to, std::size_t from) {
      const Place& place = places_[from];
      if (place.view < 0) {
        return;
      }
      ++seen;
      const View& view = *views_[static_cast<std::size_t>(place.view)];
      const auto numbers = view.numbers(colour);
      const int x = std::clamp(static_cast<int>(place.pixel.x()), 0, width - 2);
      const int y = std::clamp(static_cast<int>(place.pixel.y()), 0, height - 2);
      const float a = place.pixel.x() - static_cast<float>(x);
      const float b = place.pixel.y() - static_cast<float>(y);
      const std::size_t row_bands = static_cast<std::size_t>(width) * bands;
      const std::size_t first =
          static_cast<std::size_t>(y) * row_bands + static_cast<std::size_t>(x) * bands;
      for (std::size_t band = 0; band < bands; ++band) {
        const std::uint16_t* const n = numbers.data() + first + band;
        const float number = (1.0F - b) * ((1.0F - a) * n[0] + a * n[bands]) +
                             b * ((1.0F - a) * n[row_bands] + a * n[row_bands + bands]);
        const float rounded = std::max(number, 0.0F) + 0.5F;
        joined_[to * bands + band] = static_cast<std::uint16_t>(rounded);
      }
      if (truth != nullptr) {
        // Truth of the nearest pixel, at that pixel's own instant.
        const std::size_t nearest =
            static_cast<std::size_t>(b < 0.5F ? y : y + 1) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(a < 0.5F ? x : x + 1);
        truth->range_m[to] = view.rendered.range_m[nearest];
        truth->instance[to] = view.rendered.instance[nearest];
        truth->depth_m[to] = view.rendered.range_m[nearest] * ahead(from);
      }
    });
    const int bits = static_cast<int>(significant_bits(part.format));
    pack_numbers(joined_, bits, part.bytes);
    return mean_of(joined_, shot, bits, seen * bands);
  }

  /// Share of a range that lies along the camera's axis.
  [[nodiscard]] float ahead(std::size_t at) const {
    const auto width = static_cast<std::size_t>(parameters_.width_px);
    const double pixel_rad = 2.0 * kHalfTurn / parameters_.width_px;
    const double azimuth = (static_cast<double>(at % width) + 0.5) * pixel_rad - kHalfTurn;
    const std::size_t row = at / width;
    const double elevation =
        parameters_.elevation_upper_rad - (static_cast<double>(row) + 0.5) * pixel_rad;
    return static_cast<float>(std::cos(elevation) * std::cos(azimuth));
  }

  /// Share of full scale without the black level, over `count` numbers.
  template <class Numbers>
  [[nodiscard]] static double mean_of(const Numbers& numbers, const CameraShot& shot, int bits,
                                      std::size_t count) {
    double sum = 0.0;
    for (const auto number : numbers) {
      sum += number;
    }
    const double black = shot.command.black_level * (1 << (bits - 8));
    return std::max(0.0, sum / static_cast<double>(std::max<std::size_t>(count, 1)) - black) /
           ((1 << bits) - 1);
  }

  AllRoundCameraParameters parameters_;
  /// `rays`: a single view with the picture's own lens.
  std::vector<std::unique_ptr<View>> views_;
  std::vector<Place> places_;  ///< Empty: rays.
  std::vector<std::uint16_t> joined_;
  std::vector<std::uint8_t> packed_;
};

}  // namespace

CameraParameters AllRoundCameraParameters::optics() {
  CameraParameters p;
  p.sensor.width_px = 640;
  p.sensor.height_px = 744;
  p.lens.vignetting = 0.0;
  return p;
}

void visit(fields::Visitor& v, AllRoundCameraParameters& p) {
  v.choice("method", p.method, kMethods, "Where the picture comes from.");
  v.integer("width", p.width_px, kPictureSide, "Columns of the joined picture, 360 degrees.");
  v.integer("height", p.height_px, kPictureSide, "Rows of the joined picture.");
  v.number("elevation_upper", p.elevation_upper_rad, in("deg").between(-90, 90),
           "Elevation of the picture's upper edge; a row is 360 degrees / width high.");
  v.only_if(p.method == AllRoundMethod::views, "method", "method: views",
            [&p](fields::Visitor& keys) {
              keys.integer("views", p.views, IntegerRule{3, 12}, "Cameras that share the round.");
              keys.group(
                  "view", [&p](fields::Visitor& view) { visit_size(view, p.camera.sensor); },
                  "Sensor of each view.");
            });
  v.group(
      "lens", [&p](fields::Visitor& lens) { visit_light(lens, p.camera.lens); },
      "How much light comes through the lens.");
  v.group(
      "image_sensor", [&p](fields::Visitor& sensor) { visit_figures(sensor, p.camera.sensor); },
      "What turns light into numbers.");
  visit_pictures(v, p.camera);
}

void validate(const AllRoundCameraParameters& p) {
  fields::check(p);
  const double height_rad = 2.0 * kHalfTurn * p.height_px / p.width_px;
  fields::require(
      p.elevation_upper_rad - height_rad >= -0.5 * kHalfTurn - kRounding_rad, "height",
      std::to_string(p.height_px),
      "rows down to -90 degrees, " +
          std::to_string(static_cast<int>(
              (p.elevation_upper_rad + 0.5 * kHalfTurn) / (2.0 * kHalfTurn) * p.width_px + 1e-6)) +
          " with such an upper edge and width");
  if (p.method == AllRoundMethod::rays) {
    // A direction of the joined picture has no angle from an axis.
    fields::require(p.camera.lens.vignetting == 0.0, "lens.vignetting",
                    fields::plain().print(p.camera.lens.vignetting), "0 with method: rays");
    fields::require(!p.camera.sensor.colour || p.width_px % 2 == 0, "width",
                    std::to_string(p.width_px), "even numbers with a mosaic that goes round");
  }
  validate(p.camera);
}

std::unique_ptr<CameraSensor> make_all_round_camera(const AllRoundCameraParameters& parameters,
                                                    std::uint64_t seed, std::string_view name) {
  return std::make_unique<AllRoundCamera>(parameters, seed, name);
}

}  // namespace rigwire::sim

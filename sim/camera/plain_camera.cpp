#include "sim/camera/plain_camera.h"

#include <utility>

#include "sim/camera/shot_parts.h"

namespace rigwire::sim {
namespace {

constexpr std::string_view kPlainKind = "camera";

class PlainCamera final : public CameraSensor {
 public:
  PlainCamera(const CameraParameters& parameters, std::uint64_t seed, std::string_view name)
      : renderer_(parameters, seed, name) {}

  [[nodiscard]] Duration span(const CameraCommand& command, Duration exposure) const override {
    CameraShot shot;
    shot.command = command;
    shot.exposure = exposure;
    return exposure_span(job_of(shot, read_out_of(shot)), renderer_.sensor().parameters());
  }

  [[nodiscard]] Taken take(const Scene& scene, const CameraShot& shot,
                           CameraTruth* truth) override {
    const CameraCommand& command = shot.command;
    require_fits(command, kPlainKind, {}, sensor_formats(renderer_.sensor().parameters().colour));
    PictureJob job = job_of(shot, read_out_of(shot));
    job.truth = truth != nullptr;
    renderer_.render(scene, job, rendered_);

    Picture picture = empty_picture(shot);
    PicturePart& part = picture.parts.emplace_back();
    part.format = command.format;
    part.region = command.region;
    pack_numbers(rendered_.numbers, job.read_out.bits, part.bytes);
    if (truth != nullptr) {
      *truth = crop(rendered_, {0, 0, rendered_.width, rendered_.height});
    }
    return {std::make_shared<const Picture>(std::move(picture)), rendered_.mean};
  }

 private:
  CameraRenderer renderer_;
  RenderedPicture rendered_;
};

}  // namespace

std::unique_ptr<CameraSensor> make_plain_camera(const CameraParameters& parameters,
                                                std::uint64_t seed, std::string_view name) {
  return std::make_unique<PlainCamera>(parameters, seed, name);
}

}  // namespace rigwire::sim

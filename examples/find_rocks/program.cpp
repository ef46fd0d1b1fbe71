#include "find_rocks/program.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "field/geometry.h"

namespace rigwire::find_rocks {
namespace {

using namespace std::chrono_literals;
namespace gev = protocols::gige_vision;

constexpr auto kTick = 100ms;
/// A camera that is silent for so long is reported.
constexpr auto kSilence = 5s;
/// The camera has settled when the exposures of so many pictures are within this share.
constexpr std::size_t kSettledPictures = 4;
constexpr double kSettledShare = 0.05;

constexpr std::string_view kGeometry[] = {"Scan3dFocalLength",     "Scan3dBaseline",
                                          "Scan3dPrincipalPointU", "Scan3dPrincipalPointV",
                                          "Scan3dCoordinateScale", "Scan3dCoordinateOffset",
                                          "Scan3dInvalidDataFlag", "Scan3dInvalidDataValue"};

std::string text(const char* format, auto... values) {
  char buffer[200];
  (void)std::snprintf(buffer, sizeof(buffer), format, values...);
  return buffer;
}

/// Whether the bytes are a whole picture without padding, of so many bytes a pixel.
bool whole(const field::GigePicture& picture, std::size_t bytes_per_pixel) {
  return picture.info.padding_x == 0 && picture.info.width > 0 && picture.info.height > 0 &&
         picture.bytes.size() ==
             bytes_per_pixel * std::size_t{picture.info.width} * picture.info.height;
}

}  // namespace

field::GigeClientSettings camera_settings(std::uint32_t packet_size) {
  const auto component = [](std::string name, bool on, bool optional) {
    return field::GigeSetting{"ComponentEnable", on ? "1" : "0", "ComponentSelector",
                              std::move(name), optional};
  };
  field::GigeClientSettings settings;
  settings.packet_size = packet_size;
  // The geometry is that of the whole picture, without binning.
  settings.settings = {
      {"BinningHorizontal", "1", {}, {}, true}, {"BinningVertical", "1", {}, {}, true},
      {"TriggerMode", "Off", {}, {}, true},     component("Intensity", false, true),
      component("IntensityRight", false, true), component("Disparity", true, false),
      component("Confidence", true, true),      {"ChunkModeActive", "1", {}, {}, true}};
  for (const std::string_view name : kGeometry) {
    settings.readings.push_back({std::string(name), true});
  }
  return settings;
}

Program::Program(boost::asio::io_context& context, const Options& options)
    : context_(context),
      options_(options),
      log_(options.log),
      csv_(options.csv),
      camera_(context, options.camera, camera_settings(options.packet_size),
              [this](const field::GigeBlock& block) { take(block); }),
      signals_(context, SIGINT, SIGTERM),
      timer_(context) {
  csv_.write("uptime_s,camera_s,block,number,x_m,y_m,z_m,width_m,height_m,confidence");
}

Program::~Program() {
  worker_.join();
}

int Program::run() {
  signals_.async_wait([this](boost::system::error_code error, int /*signal*/) {
    if (!error) {
      stop(field::exit_done, "interrupted");
    }
  });
  camera_.start();
  tick();
  while (!status_) {
    context_.run_one();
  }
  return *status_;
}

void Program::tick() {
  const auto time = now();
  if (options_.duration > 0ns && time > options_.duration) {
    return stop(field::exit_done, "time is over");
  }
  const bool silent =
      time - heard_ > std::min<std::chrono::nanoseconds>(kSilence, options_.patience);
  const std::string& client_trouble = camera_.client().trouble();
  const std::string why = !geometry_trouble_.empty() ? geometry_trouble_
                          : !client_trouble.empty()  ? client_trouble
                                                     : "it sends no pictures";
  if (silent && !options_.wait && time - heard_ > options_.patience) {
    return stop(field::exit_silent_sensor,
                "the stereo camera at " + options_.camera + " is silent: " + why);
  }
  if (silent) {
    const std::string state = "waiting for the stereo camera at " + options_.camera + ": " + why;
    if (state != std::exchange(said_, state)) {
      say(state);
    }
  }
  if (!options_.quiet && time >= next_table_ && pictures_ > 0) {
    next_table_ = time + options_.period;
    print_table();
  }
  timer_.expires_after(kTick);
  timer_.async_wait([this](boost::system::error_code error) {
    if (!error && !status_) {
      tick();
    }
  });
}

void Program::take(const field::GigeBlock& block) {
  const auto of_format = [&block](gev::PixelFormatCode format) {
    return std::ranges::find_if(
        block.pictures, [format](const field::GigePicture& p) { return p.info.format == format; });
  };
  const auto disparity = of_format(gev::PixelFormatCode::coord3d_c16);
  if (disparity == block.pictures.end()) {
    // Without multi-part blocks the confidence comes by itself, and is not needed.
    return;
  }
  Taken picture;
  try {
    picture.geometry = StereoGeometry::read(
        [this](std::string_view name) { return camera_.client().reading(name); });
    geometry_trouble_.clear();
  } catch (const std::invalid_argument& error) {
    geometry_trouble_ = error.what();
    return;
  }
  if (!whole(*disparity, 2)) {
    ++unusable_;
    return;
  }
  heard_ = now();
  if (!std::exchange(said_, {}).empty()) {
    say("pictures come");
  }
  picture.geometry.principal_u_px -= disparity->info.offset_x;
  picture.geometry.principal_v_px -= disparity->info.offset_y;
  picture.width = static_cast<int>(disparity->info.width);
  picture.height = static_cast<int>(disparity->info.height);
  picture.block = block.number;
  picture.timestamp = block.timestamp;
  const double ticks_hz = camera_.client().tick_frequency_hz();
  picture.camera_s = ticks_hz > 0.0 ? static_cast<double>(block.timestamp) / ticks_hz : 0.0;
  picture.exposure_us = camera_.client().chunk(block, "ChunkExposureTime");
  picture.disparity.assign(disparity->bytes.begin(), disparity->bytes.end());
  const auto confidence = of_format(gev::PixelFormatCode::confidence8);
  if (confidence != block.pictures.end() && whole(*confidence, 1) &&
      confidence->info.width == disparity->info.width &&
      confidence->info.height == disparity->info.height) {
    picture.confidence.assign(confidence->bytes.begin(), confidence->bytes.end());
  }
  if (!settled(picture.exposure_us)) {
    ++unsettled_;
    return;
  }
  passed_over_ += next_ ? 1U : 0U;
  next_ = std::move(picture);
  look();
}

bool Program::settled(std::optional<double> exposure_us) {
  if (!exposure_us) {
    return true;  // the camera does not report it
  }
  exposures_us_.push_back(*exposure_us);
  if (exposures_us_.size() > kSettledPictures) {
    exposures_us_.pop_front();
  }
  const auto [least, most] = std::ranges::minmax(exposures_us_);
  return exposures_us_.size() == kSettledPictures && most - least <= kSettledShare * most;
}

void Program::look() {
  if (looking_ || !next_) {
    return;
  }
  looking_ = true;
  boost::asio::post(worker_, [this, picture = *std::exchange(next_, std::nullopt)]() mutable {
    const StereoPicture stereo(picture.geometry, picture.width, picture.height, picture.disparity,
                               picture.confidence, options_.least_confidence);
    FoundRocks found = find_rocks(stereo, options_.rocks);
    boost::asio::post(context_, [this, picture = std::move(picture), found = std::move(found)] {
      looking_ = false;
      seen(picture, found);
      look();
    });
  });
}

void Program::seen(const Taken& picture, const FoundRocks& found) {
  ++pictures_;
  found_ = found;
  tracker_.update(found.rocks);
  log(picture, found);
}

void Program::print_table() const {
  const field::GigeStreamCounters stream = camera_.client().stream_counters();
  std::string table = text(
      "%7.1f s  %llu pictures, %llu passed over, %llu unsettled, %llu lost, %llu unusable  ",
      std::chrono::duration<double>(now()).count(), static_cast<unsigned long long>(pictures_),
      static_cast<unsigned long long>(passed_over_), static_cast<unsigned long long>(unsettled_),
      static_cast<unsigned long long>(stream.dropped), static_cast<unsigned long long>(unusable_));
  if (!found_.ground) {
    table += "no ground found\n";
  } else {
    table += text("camera %.2f m above the ground, %.1f deg down, rocks up to %.1f m ahead\n",
                  found_.camera_height_m, found_.pitch_rad / field::kDegree, found_.farthest_m);
    table += "      no   ahead    left      up   width  height  confidence\n";
    for (const TrackedRock& rock : tracker_.rocks()) {
      table += text("  %6llu %7.2f %7.2f %7.2f %7.2f %7.2f  %10.2f\n",
                    static_cast<unsigned long long>(rock.number), rock.x_m, rock.y_m, rock.z_m,
                    rock.width_m, rock.height_m, rock.confidence());
    }
  }
  (void)std::fputs(table.c_str(), stdout);
  (void)std::fflush(stdout);
}

void Program::log(const Taken& picture, const FoundRocks& found) {
  const double uptime_s = std::chrono::duration<double>(now()).count();
  const std::vector<TrackedRock> rocks = tracker_.rocks();
  if (csv_.open()) {
    for (const TrackedRock& rock : rocks) {
      csv_.write(text("%.3f,%.6f,%llu,%llu,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f", uptime_s,
                      picture.camera_s, static_cast<unsigned long long>(picture.block),
                      static_cast<unsigned long long>(rock.number), rock.x_m, rock.y_m, rock.z_m,
                      rock.width_m, rock.height_m, rock.confidence()));
    }
  }
  if (!log_.open()) {
    return;
  }
  field::JsonLine line;
  line.number("uptime_s", uptime_s, 3);
  line.number("camera_s", picture.camera_s, 6);
  line.whole("block", static_cast<std::int64_t>(picture.block));
  line.number("exposure_us", picture.exposure_us, 1);
  line.boolean("ground", found.ground);
  line.number("camera_height_m", found.camera_height_m, 3);
  line.number("pitch_deg", found.pitch_rad / field::kDegree, 2);
  line.number("farthest_m", found.farthest_m, 2);
  line.number("disparities", found.disparities, 3);
  line.open("rocks");
  for (const TrackedRock& rock : rocks) {
    line.open(std::to_string(rock.number));
    line.number("x_m", rock.x_m, 3);
    line.number("y_m", rock.y_m, 3);
    line.number("z_m", rock.z_m, 3);
    line.number("width_m", rock.width_m, 3);
    line.number("height_m", rock.height_m, 3);
    line.number("confidence", rock.confidence(), 3);
    line.close();
  }
  line.close();
  log_.write(std::move(line).take());
}

void Program::stop(int status, const std::string& why) {
  if (status_) {
    return;
  }
  status_ = status;
  camera_.stop();
  if (status == field::exit_done) {
    if (!options_.quiet && pictures_ > 0) {
      print_table();
    }
    say(why);
  } else {
    (void)std::fprintf(stderr, "find_rocks: %s\n", why.c_str());
  }
}

void Program::say(const std::string& text) const {
  if (!options_.quiet) {
    (void)std::fprintf(stderr, "find_rocks: %s\n", text.c_str());
  }
}

}  // namespace rigwire::find_rocks

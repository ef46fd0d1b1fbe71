#include "find_rocks/options.h"

namespace rigwire::find_rocks {
namespace {

using field::number;
using field::refuse;
using field::split;
using field::whole;

void set_own_area(Options& options, std::string_view option, std::string_view text) {
  constexpr std::string_view kAllowed = "LEFT,TOP,RIGHT,BOTTOM in pixels, right and bottom greater";
  const auto parts = split(text);
  if (parts.size() != 4) {
    refuse(option, text, kAllowed);
  }
  int values[4] = {};
  for (std::size_t i = 0; i < 4; ++i) {
    values[i] = static_cast<int>(whole(option, parts[i], 65535, kAllowed));
  }
  const PictureArea area{values[0], values[1], values[2], values[3]};
  if (area.left >= area.right || area.top >= area.bottom) {
    refuse(option, text, kAllowed);
  }
  options.rocks.own_areas.push_back(area);
}

void set_own_box(Options& options, std::string_view option, std::string_view text) {
  constexpr std::string_view kAllowed = "FROM,TO,AHEAD in m: left of the camera, FROM below TO";
  const auto parts = split(text);
  if (parts.size() != 3) {
    refuse(option, text, kAllowed);
  }
  const OwnBox box{number(option, parts[0], -50, 50, kAllowed),
                   number(option, parts[1], -50, 50, kAllowed),
                   number(option, parts[2], 0, 50, kAllowed)};
  if (!(box.left_from_m < box.left_to_m)) {
    refuse(option, text, kAllowed);
  }
  options.rocks.own_boxes.push_back(box);
}

void set_mount(Options& options, std::string_view option, std::string_view text) {
  constexpr std::string_view kAllowed = "HEIGHT,PITCH: m above the ground, degrees nose down";
  const auto parts = split(text);
  if (parts.size() != 2) {
    refuse(option, text, kAllowed);
  }
  options.rocks.ground.mount = CameraMount{number(option, parts[0], 0.2, 20, kAllowed),
                                           number(option, parts[1], -30, 80, kAllowed)};
}

const field::Setters<Options>& setters() {
  static const field::Setters<Options> kSetters{
      {"--camera", [](Options& o, auto, auto v) { o.camera = v; }},
      {"--packet-size",
       [](Options& o, auto n, auto v) {
         o.packet_size = static_cast<std::uint32_t>(number(n, v, 576, 16356, "bytes, 576..16356"));
       }},
      {"--least-confidence",
       [](Options& o, auto n, auto v) {
         o.least_confidence = static_cast<std::uint8_t>(whole(n, v, 255, "0..255"));
       }},
      {"--mount", set_mount},
      {"--disparity-sigma",
       [](Options& o, auto n, auto v) {
         o.rocks.ground.disparity_sigma_px = number(n, v, 0.01, 5, "pixels, 0.01..5");
       }},
      {"--own-area", set_own_area},
      {"--own-box", set_own_box},
      {"--least", [](Options& o, auto n,
                     auto v) { o.rocks.least_m = number(n, v, 0.1, 5, "metres, 0.1..5"); }},
      {"--largest", [](Options& o, auto n,
                       auto v) { o.rocks.largest_m = number(n, v, 0.1, 10, "metres, 0.1..10"); }},
      {"--nearest", [](Options& o, auto n,
                       auto v) { o.rocks.nearest_m = number(n, v, 0, 25, "metres, 0..25"); }},
      {"--farthest", [](Options& o, auto n,
                        auto v) { o.rocks.farthest_m = number(n, v, 1, 25, "metres, 1..25"); }},
      {"--duration", [](Options& o, auto n, auto v) { o.duration = field::seconds(n, v); }},
      {"--patience", [](Options& o, auto n, auto v) { o.patience = field::seconds(n, v); }},
      {"--period", [](Options& o, auto n, auto v) { o.period = field::seconds(n, v); }},
      {"--log", [](Options& o, auto, auto v) { o.log = v; }},
      {"--csv", [](Options& o, auto, auto v) { o.csv = v; }},
  };
  return kSetters;
}

}  // namespace

Options parse_options(std::span<const std::string_view> arguments) {
  static const field::Flags<Options> kFlags{{"--help", &Options::help},
                                            {"-h", &Options::help},
                                            {"--quiet", &Options::quiet},
                                            {"--wait", &Options::wait}};
  Options options = field::parse(arguments, setters(), kFlags);
  if (options.rocks.largest_m <= options.rocks.least_m) {
    throw UsageError("--largest: found " + std::to_string(options.rocks.largest_m) +
                     ", allowed above --least, " + std::to_string(options.rocks.least_m));
  }
  return options;
}

std::string_view usage() {
  return R"(find_rocks: finds rocks on the ground from a stereo camera's disparities alone.

usage: find_rocks [options]

wire
  --camera ADDRESS        GigE Vision stereo camera                (127.0.0.2)
  --packet-size N         tried first, bytes; 1500 and 576 follow  (8192)
  --least-confidence N    of a disparity, 0..255                   (128)
fitting
  --mount HEIGHT,PITCH    of the camera: m above level ground, degrees nose down;
                          without it the ground is what most of the picture shows
  --own-box FROM,TO,AHEAD where the machine's own arm moves: m left of the camera, m ahead;
                          nothing in it is a rock; more than one may be given
  --own-area L,T,R,B      part of the picture that shows the machine itself, pixels
  --disparity-sigma PX    standard deviation of the camera's matching (0.18)
work
  --least M               diameter of the smallest rock            (0.4)
  --largest M             what is larger is no rock                (2.5)
  --nearest M             ahead along the ground                   (2)
  --farthest M            as far as the smallest rock is recognised when not given
  --duration S            stop after S seconds
  --patience S            with a camera that sends nothing         (10)
  --wait                  wait for a silent camera, however long
output
  --period S              from table to table                      (1)
  --log FILE              every picture, one JSON object per line
  --csv FILE              every rock in every picture, one line each
  --quiet                 no table

exit status: 0 done or interrupted, 2 usage, 3 a wire does not open, 4 the camera is silent
example: find_rocks --mount 3.1,17 --own-box -1.7,0,9 --least 0.4 --log /tmp/rocks.jsonl
)";
}

}  // namespace rigwire::find_rocks

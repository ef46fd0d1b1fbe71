// roll_lane: a field program. It knows wires only: NMEA on a serial line, J1939 and ISO 11783
// frames on CAN. It cannot distinguish a real roller from an emulated one at the other ends.
#include <boost/asio/io_context.hpp>
#include <optional>
#include <string>

#include "field/drive_program.h"
#include "field/geometry.h"
#include "roll_lane/lane_mission.h"

namespace rigwire::roll_lane {
namespace {

struct Options : field::DriveOptions {
  LaneMissionSettings mission;
};

field::Setters<Options> make_setters() {
  using field::number;
  field::Setters<Options> setters;
  setters["--lanes"] = [](Options& o, auto n, auto v) {
    o.mission.lanes.lanes = static_cast<int>(field::whole(n, v, 1000, "a number, 1..1000"));
  };
  setters["--length"] = [](Options& o, auto n, auto v) {
    o.mission.lanes.length_m = number(n, v, 5, 5000, "metres, 5..5000");
  };
  setters["--transition"] = [](Options& o, auto n, auto v) {
    o.mission.lanes.transition_m = number(n, v, 2, 5000, "metres, 2 or more");
  };
  setters["--offset"] = [](Options& o, auto n, auto v) {
    o.mission.lanes.crab_offset_m = number(n, v, 0, 1.7, "metres, 0..1.7");
  };
  setters["--overlap"] = [](Options& o, auto n, auto v) {
    o.mission.lanes.overlap_m = number(n, v, 0, 1.5, "metres, 0..1.5");
  };
  setters["--side"] = [](Options& o, auto n, auto v) {
    if (v != "left" && v != "right") {
      field::refuse(n, v, "left or right");
    }
    o.mission.lanes.to_the_left = v == "left";
  };
  setters["--speed"] = [](Options& o, auto n, auto v) {
    o.mission.control.speed_mps = number(n, v, 0.2, 4, "m/s, 0.2..4");
  };
  setters["--heading"] = [](Options& o, auto n, auto v) {
    o.mission.direction_rad =
        field::turned_compass(number(n, v, -360, 360, "degrees, -360..360") * field::kDegree);
  };
  setters["--off-line"] = [](Options& o, auto n, auto v) {
    o.mission.control.off_line_m = number(n, v, 0.1, 100, "metres, 0.1..100");
  };
  setters["--vibration"] = [](Options& o, auto n, auto v) {
    if (v != "on" && v != "off") {
      field::refuse(n, v, "on or off");
    }
    o.mission.vibration = v == "on";
  };
  return setters;
}

Options parse_options(std::span<const std::string_view> arguments) {
  Options options = field::parse_drive(arguments, make_setters());
  options.reference_between_axles = true;
  return options;
}

const std::string kUsage =
    std::string(R"(roll_lane: rolls lanes with a tandem roller, drums in crab offset.

The first lane begins where the machine is and points where it points; forward on it, back on
its neighbour with the other crab side, and so on.

usage: roll_lane [options]

work
  --lanes N               side by side                             (4)
  --length M              of each, transition included             (60)
  --transition M          at its begin, from lane to lane          (18)
  --offset M              of one drum against the other            (0.6)
  --overlap M             of neighbouring lanes                    (0.15)
  --side left|right       where the next lane lies                 (left)
  --heading DEG           compass heading of the machine           (90)
  --speed V               m/s                                      (1.2)
  --vibration on|off      of the drums while they roll             (off)
  --off-line M            farther off than this it stops           (2.5)
)") +
    std::string(field::kDriveUsage) +
    "example: roll_lane --lanes 2 --length 80 --log /tmp/rolled.jsonl\n";

int run(const Options& options) {
  LaneMission mission(options.mission);
  boost::asio::io_context context(1);
  return field::DriveProgram(context, "roll_lane", options, std::nullopt, mission).run();
}

}  // namespace
}  // namespace rigwire::roll_lane

int main(int count, char** values) {
  using namespace rigwire;
  return field::run_program("roll_lane", count, values, roll_lane::parse_options, roll_lane::kUsage,
                            roll_lane::run);
}

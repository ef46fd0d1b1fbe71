// Prints what our stereo matcher and OpenCV's StereoSGBM cost, and how far from the truth their
// disparities are, on the scenes of `rigwire bench camera`.
//
//     opencv_stereo_bench [--json]
//
// One thread, CPU time, least of three runs.
#include <cstdio>
#include <cstring>
#include <iostream>
#include <sstream>
#include <utility>

#include "bench/camera_bench.h"
#include "bench/stereo_table.h"
#include "opencv_matcher.h"

namespace {

using namespace rigwire;

constexpr int kRounds = 3;

void compare(const bench::CameraCase& scene, const bench::StereoTable& table,
             nlohmann::json& rows) {
  sim::StereoMatchingParameters own;
  for (const auto& [name, paths] :
       {std::pair{"census 3", sim::MatchingPaths::three}, {"census 5", sim::MatchingPaths::five}}) {
    own.paths = paths;
    table.add(measure_stereo(scene, name, own, kRounds), rows);
  }
  for (const auto& [name, paths] : {std::pair{"OpenCV 3", oracle::OpenCvPaths::three},
                                    {"OpenCV 5", oracle::OpenCvPaths::five},
                                    {"OpenCV 8", oracle::OpenCvPaths::eight}}) {
    oracle::OpenCvMatcherParameters parameters;
    parameters.least_disparity = own.least_disparity;
    parameters.disparities = own.disparities;
    parameters.paths = paths;
    const auto matcher = make_opencv_matcher(parameters);
    table.add(measure_matcher(scene, name, *matcher, own, kRounds), rows);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool json = argc == 2 && std::strcmp(argv[1], "--json") == 0;
  if (argc > 1 && !json) {
    std::fprintf(stderr, "opencv_stereo_bench [--json]\n");
    return 2;
  }
  std::ostringstream unseen;
  nlohmann::json rows = nlohmann::json::array();
  const bench::StereoTable table(json ? static_cast<std::ostream&>(unseen) : std::cout);
  for (const bench::CameraCase& scene : bench::camera_cases()) {
    compare(scene, table, rows);
  }
  table.end();
  if (json) {
    std::cout << nlohmann::json{{"stereo", rows}}.dump(2) << '\n';
  }
}

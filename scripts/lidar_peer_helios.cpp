// Casts the rays of scripts/lidar-peer.py with HELIOS++'s own ray caster: its k-d tree, built as
// its command line does by default, and Scene::getIntersection, one thread.
//
//   lidar_peer_helios FOLDER     reads scene.ply and rays.f64, writes ranges_helios.f64, prints the
//                                seconds of CPU time that the rays took: the least of five rounds
//
// Not built with Rigwire: docs/accuracy/depth-images.md says how.
#include <FastSAHKDTreeFactory.h>
#include <RandomnessGenerator.h>
#include <Scene.h>
#include <ScenePart.h>
#include <logging.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

// Its library expects the program to say what it logs.
bool logging::LOGGING_SHOW_TRACE = false;
bool logging::LOGGING_SHOW_DEBUG = false;
bool logging::LOGGING_SHOW_INFO = false;
bool logging::LOGGING_SHOW_TIME = false;
bool logging::LOGGING_SHOW_WARN = true;
bool logging::LOGGING_SHOW_ERR = true;

namespace {

constexpr int kRounds = 5;
constexpr double kReach_m = 100.0;

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <class Number>
Number take(std::istream& file) {
  Number number{};
  file.read(reinterpret_cast<char*>(&number), sizeof(number));
  return number;
}

void load(const std::string& path, Scene& scene) {
  std::ifstream file(path, std::ios::binary);
  std::size_t vertex_count = 0;
  std::size_t face_count = 0;
  for (std::string line; std::getline(file, line) && line != "end_header";) {
    if (line.rfind("element vertex ", 0) == 0) {
      vertex_count = std::stoul(line.substr(15));
    } else if (line.rfind("element face ", 0) == 0) {
      face_count = std::stoul(line.substr(13));
    }
  }
  std::vector<Vertex> vertices(vertex_count);
  for (Vertex& vertex : vertices) {
    vertex.pos.x = take<double>(file);
    vertex.pos.y = take<double>(file);
    vertex.pos.z = take<double>(file);
  }
  const auto material = std::make_shared<Material>();
  const auto part = std::make_shared<ScenePart>();
  for (std::size_t i = 0; i < face_count; ++i) {
    take<std::uint8_t>(file);
    const auto a = static_cast<std::size_t>(take<std::int32_t>(file));
    const auto b = static_cast<std::size_t>(take<std::int32_t>(file));
    const auto c = static_cast<std::size_t>(take<std::int32_t>(file));
    auto* triangle = new Triangle(vertices.at(a), vertices.at(b), vertices.at(c));
    triangle->material = material;
    triangle->part = part;
    part->mPrimitives.push_back(triangle);
    scene.primitives.push_back(triangle);
  }
  if (!file) {
    throw std::runtime_error(path + " ends early");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: lidar_peer_helios FOLDER\n");
    return 2;
  }
  const std::string folder = argv[1];
  setDefaultRandomnessGeneratorSeed("1");
  Scene scene;
  scene.setKDGroveFactory(
      std::make_shared<KDGroveFactory>(std::make_shared<FastSAHKDTreeFactory>()));
  load(folder + "/scene.ply", scene);
  scene.finalizeLoading();
  const glm::dvec3 shift = scene.getShift();

  std::vector<double> rays;
  std::ifstream file(folder + "/rays.f64", std::ios::binary);
  file.seekg(0, std::ios::end);
  rays.resize(static_cast<std::size_t>(file.tellg()) / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(rays.data()),
            static_cast<std::streamsize>(rays.size() * sizeof(double)));

  std::vector<double> ranges(rays.size() / 6);
  double least_s = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    const double before_s = cpu_seconds();
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double* ray = &rays[6 * i];
      const glm::dvec3 start = glm::dvec3(ray[0], ray[1], ray[2]) - shift;
      const auto hit = scene.getIntersection(start, glm::dvec3(ray[3], ray[4], ray[5]), false);
      ranges[i] = hit != nullptr && hit->hitDistance <= kReach_m ? hit->hitDistance : 0.0;
    }
    least_s = std::min(least_s, cpu_seconds() - before_s);
  }
  std::ofstream(folder + "/ranges_helios.f64", std::ios::binary)
      .write(reinterpret_cast<const char*>(ranges.data()),
             static_cast<std::streamsize>(ranges.size() * sizeof(double)));
  std::printf("%.6f\n", least_s);
  return 0;
}

// The example of raw_example.h as a file of UBX frames, for programs to read.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include "emulators/ublox/raw_messages.h"
#include "tests/emulators/ublox/raw_example.h"

namespace rigwire::emulators {

/// A directory of the running test, gone with the object.
struct ExampleDirectory {
  std::filesystem::path path = std::filesystem::temp_directory_path() /
                               ("rigwire-raw-" + std::to_string(::getpid()) + "-" +
                                ::testing::UnitTest::GetInstance()->current_test_info()->name());

  ExampleDirectory() { std::filesystem::create_directories(path); }
  ~ExampleDirectory() { std::filesystem::remove_all(path); }
  ExampleDirectory(const ExampleDirectory&) = delete;
  ExampleDirectory& operator=(const ExampleDirectory&) = delete;
};

/// What a receiver that knows the time says of `messages` in `seconds` + 1 epochs; returns the
/// number of frames.
inline std::size_t write_example(const std::filesystem::path& path, int generation, int seconds,
                                 std::span<const protocols::ubx::MessageId> messages) {
  const auto navigation = example_navigation();
  UbloxRawMessages raw(Calendar(kExampleStart), generation);
  raw.begin(false, false);
  std::array<std::uint8_t, kLongestRawFrame> frame{};
  std::ofstream file(path, std::ios::binary);
  std::size_t frames = 0;
  for (int second = 0; second <= seconds; ++second) {
    raw.update(example_sample(second, navigation),
               {.time_known = true, .week_known = true, .leap_known = true, .leap_seconds = 18});
    for (const auto id : messages) {
      for (std::size_t i = 0; i < raw.count(id); ++i, ++frames) {
        const std::size_t size = raw.encode(id, i, frame);
        file.write(reinterpret_cast<const char*>(frame.data()), static_cast<std::streamsize>(size));
      }
    }
  }
  return frames;
}

}  // namespace rigwire::emulators

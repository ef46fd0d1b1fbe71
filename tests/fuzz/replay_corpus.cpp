// Feeds stored inputs to a fuzz function without libFuzzer: every file of the named directory, and
// every beginning of each, because truncation is what wires do most. Inputs are copied into a
// buffer of their exact size, so that the address sanitizer sees a read past the end.
//
//   corpus_tests NAME CORPUS_DIRECTORY
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

#include "fuzz_functions.h"

namespace {

constexpr std::size_t kLongestTruncatedInput = 4096;

void feed(FuzzFunction& function, const std::vector<std::uint8_t>& bytes, std::size_t size) {
  const auto exact = std::make_unique<std::uint8_t[]>(size);
  std::copy_n(bytes.begin(), size, exact.get());
  function(exact.get(), size);
}

}  // namespace

int main(int argument_count, char** arguments) {
  const auto named = std::ranges::find_if(kFuzzFunctions, [&](const NamedFuzzFunction& row) {
    return argument_count == 3 && std::strcmp(row.name, arguments[1]) == 0;
  });
  if (named == kFuzzFunctions.end()) {
    std::fprintf(stderr, "usage: %s NAME CORPUS_DIRECTORY, with the name of a fuzz function\n",
                 arguments[0]);
    return 2;
  }
  FuzzFunction& function = *named->function;
  std::size_t inputs = 0;
  feed(function, {}, 0);
  for (int value = 0; value < 256; ++value) {
    feed(function, std::vector<std::uint8_t>(64, static_cast<std::uint8_t>(value)), 64);
  }
  const std::filesystem::path corpus = arguments[2];
  if (std::filesystem::is_directory(corpus)) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(corpus)) {
      if (!entry.is_regular_file()) {
        continue;
      }
      std::ifstream file(entry.path(), std::ios::binary);
      const std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(file), {});
      std::printf("%s: %zu bytes\n", entry.path().filename().c_str(), bytes.size());
      std::fflush(stdout);
      feed(function, bytes, bytes.size());
      for (std::size_t size = 1; size < std::min(bytes.size(), kLongestTruncatedInput); ++size) {
        feed(function, bytes, size);
      }
      ++inputs;
    }
  }
  std::printf("%zu inputs from %s\n", inputs, corpus.c_str());
  return 0;
}

#include "hil/files/geoid_file.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "hil/configuration/outside_file.h"

namespace rigwire::hil {
namespace {

constexpr std::size_t kHeaderBytes = 4 * sizeof(double) + 2 * sizeof(std::int32_t);
static_assert(kHeaderBytes == 40);

template <class Unsigned>
Unsigned big_endian(const char* bytes) {
  Unsigned value = 0;
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
    value = static_cast<Unsigned>(value << 8) | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

double real(const char* bytes) {
  return std::bit_cast<double>(big_endian<std::uint64_t>(bytes));
}

std::size_t count(const char* bytes, const char* name) {
  const auto value = std::bit_cast<std::int32_t>(big_endian<std::uint32_t>(bytes));
  if (value < 0) {
    throw std::invalid_argument(fmt::format("{} is {}, allowed are 2 .. 65536", name, value));
  }
  return static_cast<std::size_t>(value);
}

std::shared_ptr<const sim::GeoidGrid> read(OutsideFile& file,
                                           sim::GeoidInterpolation interpolation) {
  const auto read_bytes = [&file](std::span<char> into) {
    return file.read({reinterpret_cast<std::uint8_t*>(into.data()), into.size()}) == into.size();
  };
  std::array<char, kHeaderBytes> header{};
  if (!read_bytes(header)) {
    throw std::invalid_argument(
        fmt::format("it has {} bytes, a GTX header {}", file.size(), kHeaderBytes));
  }
  sim::GeoidGridLayout layout;
  layout.south_deg = real(&header[0]);
  layout.west_deg = real(&header[8]);
  layout.latitude_step_deg = real(&header[16]);
  layout.longitude_step_deg = real(&header[24]);
  layout.rows = count(&header[32], "rows");
  layout.columns = count(&header[36], "columns");
  sim::validate(layout);
  const std::size_t points = layout.rows * layout.columns;
  const std::size_t needed = kHeaderBytes + points * sizeof(float);
  if (file.size() != needed) {
    throw std::invalid_argument(fmt::format("it has {} bytes, {} rows of {} heights need {}",
                                            file.size(), layout.rows, layout.columns, needed));
  }
  std::vector<char> bytes(points * sizeof(float));
  if (!read_bytes(bytes)) {
    throw std::invalid_argument("it cannot be read to its end");
  }
  std::vector<float> heights_m(points);
  for (std::size_t i = 0; i < points; ++i) {
    heights_m[i] = std::bit_cast<float>(big_endian<std::uint32_t>(&bytes[i * sizeof(float)]));
  }
  return std::make_shared<const sim::GeoidGrid>(layout, std::move(heights_m), interpolation);
}

}  // namespace

std::shared_ptr<const sim::GeoidGrid> load_geoid(const std::filesystem::path& file,
                                                 sim::GeoidInterpolation interpolation) {
  const auto fail = [&file](const std::string& what) {
    throw std::invalid_argument(fmt::format("geoid file {}: {}", file.string(), what));
  };
  try {
    OutsideFile opened(file, kGeoidFile);
    return read(opened, interpolation);
  } catch (const FileRefused& refused) {
    fail(refused.rest() +
         (refused.missing() && file == kEgm96File ? "; install the package proj-data" : ""));
  } catch (const std::invalid_argument& problem) {
    fail(problem.what());
  }
  return nullptr;
}

}  // namespace rigwire::hil

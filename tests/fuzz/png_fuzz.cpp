// Any bytes as a PNG file are refused or become an image of their header's shape, which encoded is
// read as the same image again. Checksums are put right for a second try: what no damage of a file
// would pass, somebody's program would.
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "hil/files/image_file.h"
#include "png_checksums.h"

namespace hil = rigwire::hil;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

static void read(std::span<const std::uint8_t> bytes) {
  std::optional<hil::Image> image;
  try {
    image = hil::decode_png(bytes, "input: ");
  } catch (const std::invalid_argument&) {
    return;
  }
  require(image->samples.size() == image->columns * image->rows * image->channels);
  const hil::Image again = hil::decode_png(hil::encode_png(*image), "again: ");
  require(again.columns == image->columns && again.rows == image->rows);
  require(again.channels == image->channels && again.bits == image->bits);
  require(again.samples == image->samples);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);
  read(bytes);
  rigwire::fuzz::put_checksums_right(bytes);
  read(bytes);
  return 0;
}

// Any OBJ file with any material library and any picture is refused with a reason, or becomes
// meshes that a scene takes. An input is the three files in this order with a zero byte after each
// of the first two; the OBJ file finds them as model.mtl and picture.png.
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "hil/files/mesh_file.h"
#include "png_checksums.h"
#include "sim/scene/colour_texture.h"

namespace hil = rigwire::hil;
namespace sim = rigwire::sim;

/// assimp 5.2.5 forgets some kB of some damaged files, once as a rig is loaded. What is our own
/// must give back everything.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libassimp";
}

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

namespace {

/// Gone with the program.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "rigwire_model_XXXXXX").string();
    require(::mkdtemp(name.data()) != nullptr);
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] std::string write(const char* name, std::span<const std::uint8_t> bytes) const {
    const std::filesystem::path file = path_ / name;
    std::ofstream stream(file, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    return file.string();
  }

 private:
  std::filesystem::path path_;
};

/// What is in front of the next zero byte, which is taken off with it.
std::span<const std::uint8_t> part(std::span<const std::uint8_t>& rest) {
  const auto zero = std::ranges::find(rest, std::uint8_t{0});
  const std::span<const std::uint8_t> front(rest.begin(), zero);
  rest = rest.subspan(std::min(rest.size(), front.size() + 1));
  return front;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  std::span<const std::uint8_t> rest(data, size);
  const std::string model = folder.write("model.obj", part(rest));
  (void)folder.write("model.mtl", part(rest));
  std::vector<std::uint8_t> picture(rest.begin(), rest.end());
  rigwire::fuzz::put_checksums_right(picture);
  (void)folder.write("picture.png", picture);
  try {
    for (const sim::TriangleMesh& mesh : hil::load_model(model, "model").parts) {
      sim::validate(mesh);
    }
  } catch (const std::invalid_argument& refusal) {
    require(*refusal.what() != '\0');
  }
  return 0;
}

#include "hil/files/settings_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>

namespace rigwire::hil {
namespace {

constexpr std::size_t kGreatestBytes = 65536;

}  // namespace

SettingsFile::SettingsFile(std::string path) : path_(std::move(path)) {
  errno = 0;
  std::ifstream file(path_, std::ios::binary);
  if (!file && errno == ENOENT) {
    return;
  }
  content_.resize(kGreatestBytes + 1);
  file.read(reinterpret_cast<char*>(content_.data()),
            static_cast<std::streamsize>(content_.size()));
  if (file.bad() || (!file && !file.eof())) {
    throw std::runtime_error("settings file " + path_ + " cannot be read: " + std::strerror(errno));
  }
  content_.resize(static_cast<std::size_t>(file.gcount()));
  if (content_.size() > kGreatestBytes) {
    throw std::runtime_error("settings file " + path_ + " has more than " +
                             std::to_string(kGreatestBytes) + " bytes");
  }
}

bool SettingsFile::store(std::span<const std::uint8_t> block) {
  const std::string draft = path_ + ".new";
  {
    std::ofstream file(draft, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(block.data()),
               static_cast<std::streamsize>(block.size()));
    file.flush();
    if (!file) {
      return false;
    }
  }
  if (std::rename(draft.c_str(), path_.c_str()) != 0) {
    return false;
  }
  content_.assign(block.begin(), block.end());
  return true;
}

std::unique_ptr<emulators::NonvolatileMemory> open_settings(const std::string& path) {
  if (path.empty()) {
    return std::make_unique<emulators::VolatileMemory>();
  }
  return std::make_unique<SettingsFile>(path);
}

}  // namespace rigwire::hil

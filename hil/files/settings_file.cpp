#include "hil/files/settings_file.h"

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <utility>

#include "hil/configuration/outside_file.h"

namespace rigwire::hil {

SettingsFile::SettingsFile(std::string path) : path_(std::move(path)) {
  try {
    const std::string content = read_outside_file(path_, kSettingsFile);
    content_.assign(content.begin(), content.end());
  } catch (const FileRefused& refused) {
    if (refused.error() != ENOENT) {
      throw std::runtime_error(std::string("settings file ") + refused.what());
    }
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

#include "field/silence_watch.h"

#include <utility>

namespace rigwire::field {

SilenceWatch::SilenceWatch(std::vector<Device> devices)
    : devices_(std::move(devices)), last_(devices_.size()) {}

bool SilenceWatch::alive(std::size_t device, Instant now) const {
  return last_[device] && now - *last_[device] <= devices_[device].limit;
}

std::optional<std::size_t> SilenceWatch::silent(Instant now) const {
  for (std::size_t device = 0; device < devices_.size(); ++device) {
    if (last_[device] && !alive(device, now)) {
      return device;
    }
  }
  return std::nullopt;
}

bool SilenceWatch::all_alive(Instant now) const {
  for (std::size_t device = 0; device < devices_.size(); ++device) {
    if (!alive(device, now)) {
      return false;
    }
  }
  return true;
}

std::string SilenceWatch::absent(Instant now) const {
  std::string names;
  for (std::size_t device = 0; device < devices_.size(); ++device) {
    if (!alive(device, now)) {
      names += names.empty() ? "" : ", ";
      names += devices_[device].name;
    }
  }
  return names;
}

}  // namespace rigwire::field

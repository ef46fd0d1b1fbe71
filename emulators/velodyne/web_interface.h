// The web interface of a Velodyne sensor: what it answers to HTTP requests.
//
//   GET   /                       this project's page with the sensor's settings as forms
//   GET   /cgi/settings.json, status.json, diag.json, info.json, snapshot.hdl
//   POST  /cgi/setting            laser=on|off, returns=Strongest|Last|Dual, rpm=0|300..1200
//   POST  /cgi/setting/fov        start=, end=: 0..359 degrees
//   POST  /cgi/setting/host       addr=, dport=, tport=: where the packets go
//   POST  /cgi/setting/net        addr=, mask=, gateway=, dhcp=on|off: kept and reported
//   POST  /cgi/setting/phaselock  enabled=on|off, offset=0..35999 hundredths of a degree
//   POST  /cgi/save               data=submit: the settings outlive a reset
//   POST  /cgi/reset              data=reset_system
//
// A POST takes several fields at once and answers 204, or 400 with the reason and changes nothing
// at all. Speeds are whole multiples of 60 rpm (the manual's own warning: with others motor control
// and phase lock misbehave).
//
// Sources: VLP-16 user's manual 63-9243 Rev. D, section 10.2; requests of clients and documents of
// sensors named in docs/devices/velodyne-web.md, which also lists what is not known of the real
// answers.
#pragma once

#include <functional>
#include <string>

#include "emulators/velodyne/velodyne_control.h"
#include "emulators/web_device.h"

namespace rigwire::emulators {

struct VelodyneWebSettings {
  /// Requests that are refused are answered 204 all the same, as one real sensor was seen to do.
  bool silent_refusals = false;
  /// Why these settings cannot hold here (a destination that the rig does not permit); empty: they
  /// can. Answered with 403. Without it, every valid setting is taken.
  std::function<std::string(const VelodyneLiveSettings&)> objection;
};

class VelodyneWebInterface final : public WebDevice {
 public:
  /// `control` must outlive it.
  explicit VelodyneWebInterface(VelodyneControl& control, VelodyneWebSettings settings = {});

  [[nodiscard]] WebResponse answer(SimTime now, const WebRequest& request) override;

 private:
  [[nodiscard]] WebResponse post(SimTime now, std::string_view path, std::string_view body);
  [[nodiscard]] WebResponse refuse(int status, const std::string& reason) const;

  VelodyneControl& control_;
  VelodyneWebSettings settings_;
};

}  // namespace rigwire::emulators

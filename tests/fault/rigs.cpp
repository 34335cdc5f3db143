// SPDX-License-Identifier: Apache-2.0
#include "fault/rigs.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "files/rig_file.h"

namespace dts::fault {
namespace {

const std::string kRigs = DTS_SOURCE_DIR "/config/rigs/";

pipeline::RigConfig checked(pipeline::RigConfig rig, const files::Problems& problems) {
  if (!problems.empty()) throw std::runtime_error("a shipped rig file is not in order: " + problems.front().text);
  rig.name = "floor";
  rig.device_uri = kDevice;
  return rig;
}

}  // namespace

std::string floor16_text() {
  std::ifstream file(kRigs + "floor16-sim.toml");
  std::string text(std::istreambuf_iterator<char>(file), {});
  const std::string slow = "rate_hz = 100.0";
  const std::size_t at = text.find(slow);
  if (at == std::string::npos) throw std::runtime_error("floor16-sim.toml has changed");
  return text.replace(at, slow.size(), "rate_hz = 1500.0");
}

pipeline::RigConfig floor16_rig() {
  files::Problems problems;
  pipeline::RigConfig rig = checked(files::read_rig_file(kRigs + "floor16-sim.toml", problems), problems);
  rig.rate = core::Rate::create(1500, 1).value();
  rig.block_scans = static_cast<std::size_t>(rig.rate.scans_in_ms(20.0));
  return rig;
}

pipeline::RigConfig floor4_rig() {
  files::Problems problems;
  return checked(files::read_rig_file(kRigs + "floor-sim.toml", problems), problems);
}

}  // namespace dts::fault

// SPDX-License-Identifier: Apache-2.0
// The daemon's own file, beside a rig, its sensors and a protocol that are shipped. One that is accepted holds checked values only.
#include <cmath>
#include <set>

#include "app/config.h"
#include "fuzz/fuzz_support.h"
#include "settings/endpoint.h"

namespace dts::fuzz::config {
namespace {

/// A folder with the files that the seeds name, but small ones, because every run reads them: rigs with four sensors, without calibration
/// and model, and one protocol. The targets rig, cop_calibration, trunk_model and protocol read the others.
class ConfigFolder {
 public:
  ConfigFolder() {
    std::filesystem::create_directory_symlink(DTS_SOURCE_DIR "/config/sensors", folder_.file("sensors"));
    std::filesystem::create_directory(folder_.file("rigs"));
    for (const char* name : {"rigs/floor-daq.toml", "rigs/floor-sim.toml", "rigs/chair-sim.toml"}) {
      std::filesystem::copy_file(DTS_SOURCE_DIR "/config/rigs/floor-daq.toml", folder_.file(name));
    }
    std::filesystem::create_directory(folder_.file("protocols"));
    std::filesystem::copy_file(DTS_SOURCE_DIR "/config/protocols/romberg.toml", folder_.file("protocols/romberg.toml"));
  }
  [[nodiscard]] std::string file() const { return folder_.file("dtsd.toml"); }

 private:
  fuzz::Folder folder_;
};

void check_config(const app::DaemonConfig& config) {
  for (const std::string& endpoint : {config.endpoints.control, config.endpoints.data}) {
    promise(settings::check_endpoint(endpoint).has_value(), "addresses of this machine");
  }
  promise(config.endpoints.control != config.endpoints.data, "two addresses");
  if (config.network) {
    promise(settings::check_remote_endpoint(config.network->control).has_value() &&
                settings::check_remote_endpoint(config.network->data).has_value(),
            "addresses for other machines");
  }
  promise(std::filesystem::path(config.storage.directory).is_absolute(), "recordings have a place");
  promise(std::isfinite(config.storage.stop_below_mib) && config.storage.warn_below_min >= config.storage.refuse_below_min,
          "room on the disk");
  const int priority = config.realtime.fifo_priority;
  promise(priority == 0 || (priority > 2 && priority <= 95), "all threads have a priority");
  std::set<std::string> names;
  for (const app::ConfiguredRig& rig : config.rigs) {
    promise(!rig.rig.name.empty() && rig.rig.name.size() <= 32 && names.insert(rig.rig.name).second, "rigs have names");
    promise(!rig.rig.device_uri.empty() && !rig.rig.definition.empty(), "rigs have devices and definitions");
  }
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  static const ConfigFolder folder;
  fuzz::put_file(folder.file(), fuzz::text_of(bytes, size));
  const app::LoadedConfig loaded = app::load_config(folder.file());
  for (const files::Problem& problem : loaded.problems)
    promise(!problem.text.empty() && !problem.file.empty(), "a problem says what it is and where");
  if (loaded.problems.empty()) check_config(loaded.config);
}

}  // namespace dts::fuzz::config

DTS_FUZZ_TARGET(config)

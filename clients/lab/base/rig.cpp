// SPDX-License-Identifier: Apache-2.0
#include "lab/base/rig.h"

#include "files/rig_file.h"
#include "files/rig_model_file.h"
#include "lab/base/thesis_setup.h"

namespace dts::lab {

physics::RigModel read_rig(const std::string& file, files::Problems& problems) {
  if (file.empty()) return thesis_setup::floor_platform();
  const auto table = files::parse_toml(file, problems);
  if (!table) return thesis_setup::floor_platform();
  files::TomlReader top(&*table, "", file, problems);
  physics::RigModel rig = files::read_rig_model(top, problems).model;
  if (rig.force_plate) top.report("force_plate", "this command needs a plate that bends, with sensors, not a force plate");
  return rig;
}

core::Result<pipeline::RigConfig> rig_of(const record::Recording& recording, const std::string& name) {
  const auto& session = recording.session();
  if (!session || session->rig_definition.empty()) {
    return core::fail(core::ErrorCode::InvalidArgument, name + " does not describe its rig: it is not a recording of dtsd",
                      "give a rig file with --rig");
  }
  files::Problems problems;
  pipeline::RigConfig config = files::read_rig_text(session->rig_definition, "rig definition in " + name, problems);
  if (!problems.empty()) return core::fail(core::ErrorCode::DataDamaged, files::to_string(problems.front()));
  config.name = session->rig;
  return config;
}

}  // namespace dts::lab

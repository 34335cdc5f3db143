// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/classify.h"

#include "pipeline/input_check.h"

namespace dts::pipeline {

Classify::Classify(const StageOptions& /*options*/, const StageContext& context) : model_(context.trunk_model) {}

const StageDescription& Classify::description() {
  static const StageDescription kDescription{.id = "classify",
                                             .sentence = "Classifies the trunk bending of every reach with the rig's model.",
                                             .output_stream = "",
                                             .options = {}};
  return kDescription;
}

core::Result<core::StreamFormat> Classify::prepare(const core::StreamFormat& input, std::size_t max_scans) {
  DTS_TRY(check_input("classify", input, max_scans, ""));
  if (model_ != nullptr) return input;
  return core::fail(core::ErrorCode::InvalidArgument, "stage 'classify' needs a model of trunk movement, but the rig has none",
                    "add model = \"FILE.toml\" to the rig file, see dtslab reach train; or remove the stage");
}

void Classify::process(const core::Block& /*in*/, core::Block& /*out*/) noexcept {}

void Classify::tell(core::FrameEvents& events) noexcept {
  for (const core::ReachEvent& reach : events.reaches.all_of()) {
    if (reach.step != core::ReachStep::Final) continue;
    events.classes.push({.number = reach.number,
                         .segment = reach.segment,
                         .scan = reach.scan,
                         .host_time_ns = reach.host_time_ns,
                         .movement = model_->classify(reach.features, reach.flags)});
  }
}

}  // namespace dts::pipeline

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "fhir/resources.h"

namespace dts::fhir {

/// The resources that every Observation of a part refers to.
struct About {
  std::string patient_id;
  std::string device_id;
};

/// The Observations of a part. Those of withdrawn trials are not results of the report.
struct PartObservations {
  std::vector<Resource> trials{};
  std::vector<Resource> results{};
  std::vector<Resource> withdrawn{};
};

/// Returns an Observation for each trial, whose components are its measures, and one for each group of results of the session. Fails with
/// DataDamaged if the result of a trial cannot be read.
[[nodiscard]] core::Result<PartObservations> observations_of(const RecordedPart& part, const About& about);

}  // namespace dts::fhir

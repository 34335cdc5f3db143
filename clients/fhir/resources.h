// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fhir/codes.h"
#include "fhir/recorded_session.h"

namespace dts::fhir {

/// A resource of the bundle with its UUID.
struct Resource {
  std::string id;
  Json json;
};

/// Returns a Reference to a resource of the same bundle.
[[nodiscard]] Json reference_to(const std::string& id);
/// Returns a FHIR Period; null if neither end is known.
[[nodiscard]] Json period_json(const Period& period);

/// Begins a resource: type, id, and for a simulated rig the security label of test data (HTEST).
[[nodiscard]] Resource begin_resource(const RecordedPart& part, std::string_view type, std::string_view what);
/// Adds the UUID as an identifier, so that a receiver finds the resource again whatever id it has given to it.
void add_identifier(Resource& resource);

/// Returns the Patient: the subject ID and nothing else.
[[nodiscard]] Resource patient(const RecordedPart& part);
/// Returns the rig of a part.
[[nodiscard]] Resource device(const RecordedPart& part);

/// Returns the DiagnosticReport; `results` are the ids of its Observations, `pdf` are the bytes of its PDF.
[[nodiscard]] Resource diagnostic_report(const RecordedSession& session, const std::string& patient_id,
                                         const std::vector<std::string>& results, const std::optional<std::string>& pdf);

}  // namespace dts::fhir

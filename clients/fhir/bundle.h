// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "fhir/recorded_session.h"
#include "fhir/resources.h"
#include "report/pdf.h"

namespace dts::fhir {

struct BundleSource {
  std::vector<std::string> files;    ///< The parts of one session, in order; or one recording. Parts of companions are left out.
  std::optional<std::string> pdf{};  ///< Bytes of the report as a PDF.
};

struct Bundle {
  std::string file;  ///< "20261121T144525Z-floor-1.fhir.json"
  std::string text;
  std::size_t resources = 0;
  std::vector<std::string> damage{};  ///< What was damaged.
  std::string without_pdf{};          ///< Why the report has no PDF; empty: it has one.
};

/// Makes a FHIR R4 Bundle of the type "collection" of a session: Patient, Device, Observations and a DiagnosticReport. The same recording
/// with the same corrections and the same PDF gives the same bytes on every machine. Fails like `read_recorded_session`. Thread: any.
[[nodiscard]] core::Result<Bundle> make_bundle(const BundleSource& source, const BundleProgress& progress);

/// Makes the bundle of a session with the PDF of its page. `software`: as for `dtsctl report`, "dtsctl 0.2.0". If the PDF cannot be made
/// within `pdf_limit`, the bundle has none: see `without_pdf`. Fails like `make_bundle`. Thread: any.
[[nodiscard]] core::Result<Bundle> make_session_bundle(const std::vector<std::string>& files, const std::string& software,
                                                       const BundleProgress& progress,
                                                       std::chrono::seconds pdf_limit = report::kLongestPdf);

}  // namespace dts::fhir

// SPDX-License-Identifier: Apache-2.0
#include "fhir/bundle.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "fhir/observations.h"
#include "fhir/resource_id.h"
#include "record/export/walk.h"
#include "report/report.h"

namespace dts::fhir {
namespace {

/// Adds the rig of a part, unless the part before has the same one. Returns its id.
std::string add_device(const RecordedPart& part, std::vector<Resource>& devices) {
  Resource one = device(part);
  if (!devices.empty()) {
    Json other = devices.back().json;
    other["id"] = one.id;
    if (other == one.json) return devices.back().id;
  }
  devices.push_back(std::move(one));
  return devices.back().id;
}

std::string text_of(const RecordedSession& session, std::vector<Resource> resources) {
  Resource bundle = begin_resource(session.parts.front(), "Bundle", "bundle");
  bundle.json["identifier"] = {{"system", "urn:ietf:rfc:3986"}, {"value", "urn:uuid:" + bundle.id}};
  bundle.json["type"] = "collection";
  for (Resource& one : resources) {
    bundle.json["entry"].push_back({{"fullUrl", "urn:uuid:" + one.id}, {"resource", std::move(one.json)}});
  }
  return bundle.json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

core::Result<Bundle> make_bundle(const BundleSource& source, const BundleProgress& progress) {
  DTS_TRY_ASSIGN(const auto session, read_recorded_session(source.files, progress));
  Bundle bundle;
  std::vector<Resource> resources{patient(session.parts.front())};
  const std::string patient_id = resources.front().id;
  std::vector<Resource> devices;
  std::vector<Resource> observations;
  std::vector<Resource> withdrawn;
  std::vector<std::string> results;
  for (const RecordedPart& part : session.parts) {
    if (!part.damage.empty()) bundle.damage.push_back(part.file + ": " + part.damage + "; only the undamaged part is exported");
    DTS_TRY_ASSIGN(auto of_part, observations_of(part, {.patient_id = patient_id, .device_id = add_device(part, devices)}));
    std::ranges::move(of_part.results, std::back_inserter(observations));
    std::ranges::move(of_part.trials, std::back_inserter(observations));
    std::ranges::move(of_part.withdrawn, std::back_inserter(withdrawn));
  }
  for (const Resource& one : observations) results.push_back(one.id);
  std::ranges::move(devices, std::back_inserter(resources));
  resources.push_back(diagnostic_report(session, patient_id, results, source.pdf));
  std::ranges::move(observations, std::back_inserter(resources));
  std::ranges::move(withdrawn, std::back_inserter(resources));
  bundle.resources = resources.size();
  bundle.file = record::fit_for_file_name(session.parts.front().facts.session_id) + ".fhir.json";
  bundle.text = text_of(session, std::move(resources));
  return bundle;
}

core::Result<Bundle> make_session_bundle(const std::vector<std::string>& files, const std::string& software, const BundleProgress& progress,
                                         std::chrono::seconds pdf_limit) {
  const auto page = report::make_session_pdf({.files = files, .software = software, .pdf_limit = pdf_limit, .for_record = true},
                                             [&](double done) { return progress(0.5 * done); });
  BundleSource source{.files = files};
  if (page) source.pdf = *page;
  DTS_TRY_ASSIGN(auto bundle, make_bundle(source, [&](double done) { return progress(0.5 + 0.5 * done); }));
  if (!page) bundle.without_pdf = page.error().what + (page.error().hint.empty() ? "" : ": " + page.error().hint);
  return bundle;
}

}  // namespace dts::fhir

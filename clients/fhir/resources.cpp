// SPDX-License-Identifier: Apache-2.0
#include "fhir/resources.h"

#include <sodium.h>

#include <algorithm>

#include "core/utc_text.h"
#include "core/utf8.h"
#include "fhir/resource_id.h"
#include "report/intended_use.h"

namespace dts::fhir {
namespace {

std::string base64(const std::string& bytes) {
  std::string text(sodium_base64_encoded_len(bytes.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                    sodium_base64_VARIANT_ORIGINAL);
  text.resize(text.size() - 1);  // without its final zero
  return text;
}

/// The newest correction, or the end of the recording: when the content became what it is. Not the time of the export.
std::optional<std::int64_t> issued_utc_ns(const RecordedSession& session) {
  std::optional<std::int64_t> newest = session.parts.back().period.ends_utc_ns;
  for (const record::Correction& one : session.corrections.all) newest = std::max(newest.value_or(one.utc_ns), one.utc_ns);
  return newest;
}

}  // namespace

Json reference_to(const std::string& id) { return {{"reference", "urn:uuid:" + id}}; }

Json period_json(const Period& period) {
  Json json;
  if (period.begins_utc_ns) json["start"] = core::utc_text(*period.begins_utc_ns);
  if (period.ends_utc_ns) json["end"] = core::utc_text(*period.ends_utc_ns);
  return json;
}

/// Returns why nobody was measured in this session; nullptr if somebody was.
static const char* note_of(const record::SessionFacts& facts) {
  if (facts.device_uri.starts_with("sim:")) return "Simulated rig: all values are synthetic.";
  if (facts.device_uri.starts_with("replay:")) return "A recording was played on this rig: nobody was measured in this session.";
  return nullptr;
}

Resource begin_resource(const RecordedPart& part, std::string_view type, std::string_view what) {
  Resource resource{.id = resource_id(part.facts, what), .json = {{"resourceType", type}}};
  resource.json["id"] = resource.id;
  if (note_of(part.facts) != nullptr) {
    resource.json["meta"]["security"] =
        list_of({{"system", "http://terminology.hl7.org/CodeSystem/v3-ActReason"}, {"code", "HTEST"}, {"display", "test health data"}});
  }
  return resource;
}

void add_identifier(Resource& resource) {
  resource.json["identifier"] = list_of({{"system", "urn:ietf:rfc:3986"}, {"value", "urn:uuid:" + resource.id}});
}

Resource patient(const RecordedPart& part) {
  // With the subject ID: after a correction of it, the resource is another person's, and must not replace the first person's.
  Resource resource = begin_resource(part, "Patient", "patient/" + part.facts.subject);
  const std::string& subject = part.facts.subject;
  if (subject.empty() || subject == record::kErasedText) return resource;
  // Without a system: the clinic has assigned the ID. The same ID of another clinic is another person.
  resource.json["identifier"] =
      list_of({{"use", "secondary"}, {"type", {{"text", "Subject ID, assigned by the clinic"}}}, {"value", core::printable(subject)}});
  return resource;
}

Resource device(const RecordedPart& part) {
  Resource resource = begin_resource(part, "Device", "device");
  Json& json = resource.json;
  const record::SessionFacts& facts = part.facts;
  const auto put = [](Json& at, const char* key, const std::string& text) {
    if (!text.empty()) at[key] = core::printable(text);
  };
  put(json, "serialNumber", facts.device_serial);
  if (!facts.rig.empty()) json["deviceName"] = list_of({{"name", "Rig " + core::printable(facts.rig)}, {"type", "user-friendly-name"}});
  put(json, "modelNumber", facts.device_model);
  const std::string what =
      facts.kind == "chair" ? "Instrumented chair for a reaching task" : "Platform that measures the centre of pressure";
  json["type"]["text"] = what;
  for (const auto& [type, value] :
       {std::pair{"software that measured", facts.software}, std::pair{"firmware", facts.firmware},
        std::pair{"calibration", facts.calibration_id}, std::pair{"SHA-256 of the model", facts.model_sha256}}) {
    if (!value.empty()) json["version"].push_back({{"type", {{"text", type}}}, {"value", core::printable(value)}});
  }
  if (const char* note = note_of(facts)) json["note"] = list_of({{"text", note}});
  return resource;
}

Resource diagnostic_report(const RecordedSession& session, const std::string& patient_id, const std::vector<std::string>& results,
                           const std::optional<std::string>& pdf) {
  const RecordedPart& first = session.parts.front();
  Resource resource = begin_resource(first, "DiagnosticReport", "report");
  add_identifier(resource);
  Json& json = resource.json;
  // "final" would say that an authorised person has verified the report. dtsd does not know that.
  json["status"] = "partial";
  json["code"] = concept_of("session-report");
  if (!first.facts.protocol.empty()) json["code"]["text"] = "Report of a session, protocol " + core::printable(first.facts.protocol);
  json["subject"] = reference_to(patient_id);
  const Json period = period_json({.begins_utc_ns = first.period.begins_utc_ns, .ends_utc_ns = session.parts.back().period.ends_utc_ns});
  if (!period.is_null()) json["effectivePeriod"] = period;
  if (const auto issued = issued_utc_ns(session)) json["issued"] = core::utc_text(*issued);
  // "additional": the sentence is not in the structured data. A conclusion it is not.
  json["text"] = {{"status", "additional"},
                  {"div", "<div xmlns=\"http://www.w3.org/1999/xhtml\">" + std::string(report::kIntendedUse) + "</div>"}};
  for (const std::string& id : results) json["result"].push_back(reference_to(id));
  if (pdf) {
    json["presentedForm"] = list_of({{"contentType", "application/pdf"},
                                     {"language", "en"},
                                     {"data", base64(*pdf)},
                                     {"size", pdf->size()},
                                     {"title", "Report of session " + core::printable(first.facts.session_id)}});
  }
  return resource;
}

}  // namespace dts::fhir

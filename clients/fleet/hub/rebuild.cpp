// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/rebuild.h"

#include <filesystem>
#include <system_error>

#include "fleet/hub/durable_file.h"
#include "record/recording.h"

namespace dts::fleet::hub {
namespace {

/// The offer with which the clinic sent this file. Fails with Unsupported or DataDamaged if the file is not one of our recordings.
core::Result<record::SessionFacts> facts_in(const RecordingName& name, const std::string& file) {
  DTS_TRY_ASSIGN(const std::string sum, sha256_from_disk(file, {}));
  if (sum != name.sha256) return core::fail(core::ErrorCode::DataDamaged, "the SHA-256 differs");
  return record::read_session_facts(file);
}

}  // namespace

core::Result<Rebuilt> rebuild(Store& store, Catalogue& catalogue, const std::string& hub, std::int64_t utc_ns) {
  Rebuilt rebuilt;
  DTS_TRY_ASSIGN(const auto names, store.list());
  for (const RecordingName& name : names) {
    DTS_TRY_ASSIGN(const auto receipt, catalogue.find_receipt(name));
    if (receipt) {
      ++rebuilt.known;
      continue;
    }
    const auto found = store.file(name);
    if (!found && found.error().code == core::ErrorCode::Unreachable) return tl::make_unexpected(found.error());
    if (!found) {  // for example without room for its copy
      rebuilt.left.push_back(key_of(name) + ": " + core::to_string(found.error()));
      continue;
    }
    if (!*found) continue;
    const std::string& file = (*found)->path();
    const auto facts = facts_in(name, file);
    std::error_code error;
    const auto bytes = std::filesystem::file_size(file, error);
    if (!facts || error) {
      rebuilt.left.push_back(key_of(name) + ": " + (facts ? error.message() : facts.error().what));
      continue;
    }
    v1::UploadOffer offer;
    offer.set_sha256(name.sha256);
    offer.set_bytes(bytes);
    offer.set_session_id(facts->session_id);
    offer.set_part(facts->part);
    const auto entered = catalogue.put_recording(name, offer, store, hub, utc_ns);
    if (!entered && entered.error().code == core::ErrorCode::NotFound) {
      DTS_TRY(catalogue.remove_recording(name, store));
      ++rebuilt.erased;
      continue;
    }
    if (!entered && entered.error().code == core::ErrorCode::WrongState) {
      rebuilt.left.push_back(key_of(name) + ": " + entered.error().what);
      continue;
    }
    DTS_TRY(entered);
    DTS_TRY(catalogue.put_header(name.clinic, *facts));
    ++rebuilt.entered;
    rebuilt.clinics.insert(name.clinic);
  }
  return rebuilt;
}

}  // namespace dts::fleet::hub

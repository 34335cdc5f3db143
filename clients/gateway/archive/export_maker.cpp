// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/export_maker.h"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "cli/try.h"
#include "dts/error.h"
#include "fhir/bundle.h"
#include "gateway/archive/work_folder.h"
#include "gateway/archive/zip_file.h"
#include "record/export/export.h"
#include "record/export/walk.h"
#include "record/xdf/recovery.h"

namespace dts::gateway {
namespace {

namespace fs = std::filesystem;

core::Status check_size(const ExportOrder& order, std::uint64_t bytes) {
  if (bytes <= order.most_bytes) return {};
  return core::fail(core::ErrorCode::LimitExceeded,
                    "this export is too large for the gateway: the limit is " + std::to_string(order.most_bytes >> 20U) + " MiB",
                    "on the daemon's host: dtsctl session export " + order.session_id + " --format " + name(order.format));
}

/// Exports into `folder`; adds to `damage` what the recording lacks.
core::Status export_part(const ExportOrder& order, const std::string& file, const fs::path& folder, const record::Progress& progress,
                         std::string& damage) {
  DTS_TRY_ASSIGN(const auto recording, record::Recording::open(file));
  if (!recording->damage().empty()) {
    damage += fs::path(file).filename().string() + ": " + recording->damage() + "; what is whole is exported\n";
  } else if (const auto verified = record::verify(file, progress); !verified) {
    // Wrong values look plausible; only the checksums reveal them. A table must not have values from a damaged file.
    return tl::make_unexpected(verified.error());
  }
  DTS_TRY_ASSIGN(const auto corrections, record::corrections_beside(file, recording->session().value_or(record::SessionFacts{})));
  const auto write = order.format == ExportFormat::Csv    ? record::export_csv
                     : order.format == ExportFormat::Bids ? record::export_bids
                                                          : record::export_c3d;
  const auto exported = write(*recording, folder.string(), progress, corrections);
  if (!exported) return tl::make_unexpected(exported.error());
  return {};
}

core::Status export_parts(const ExportOrder& order, const fs::path& data, const std::stop_token& stop) {
  const fs::path folder = data / (record::fit_for_file_name(order.session_id) + "-" + name(order.format));
  core::Status fits;
  const record::Progress progress = [&](std::uint64_t, std::uint64_t) {
    if (fits) fits = check_size(order, bytes_below(data));
    return fits && !stop.stop_requested();
  };
  std::string damage;
  for (const std::string& file : order.files) {
    const auto exported = export_part(order, file, folder, progress, damage);
    if (stop.stop_requested()) return core::fail(core::ErrorCode::Failed, "the gateway is stopping: nothing was exported");
    if (fits) fits = check_size(order, bytes_below(data));  // small recordings report no progress, so the size is checked here
    if (!fits) return fits;
    if (!exported) return exported;
  }
  if (damage.empty()) return {};
  if (std::ofstream(data / "DAMAGE.txt") << damage << std::flush) return {};
  return core::fail(core::ErrorCode::Failed, "cannot write into '" + data.string() + "'");
}

/// Writes one bundle with all parts, as `dtsctl session export --format fhir` does.
core::Status export_bundle(const ExportOrder& order, const fs::path& data, const std::stop_token& stop) {
  const auto bundle = fhir::make_session_bundle(
      order.files, "dtsctl " + std::string(client::version()), [&stop](double) { return !stop.stop_requested(); }, order.pdf_limit);
  if (!bundle) return tl::make_unexpected(bundle.error());
  DTS_TRY(check_size(order, bundle->text.size()));
  const fs::path folder = data / (record::fit_for_file_name(order.session_id) + "-" + name(order.format));
  std::error_code failed;
  fs::create_directories(folder, failed);
  const auto put = [](const fs::path& file, const std::string& text) -> core::Status {
    if (std::ofstream(file, std::ios::binary) << text << std::flush) return {};
    return core::fail(core::ErrorCode::Failed, "cannot write '" + file.string() + "'");
  };
  DTS_TRY(put(folder / bundle->file, bundle->text));
  if (!bundle->without_pdf.empty()) {
    DTS_TRY(put(data / "NOTES.txt", "The bundle has no PDF: " + bundle->without_pdf + "\n"));
  }
  std::string damage;
  for (const std::string& one : bundle->damage) damage += one + "\n";
  return damage.empty() ? core::Status{} : put(data / "DAMAGE.txt", damage);
}

}  // namespace

std::string name(ExportFormat format) {
  switch (format) {
    case ExportFormat::Csv: return "csv";
    case ExportFormat::Bids: return "bids";
    case ExportFormat::C3d: return "c3d";
    case ExportFormat::Fhir: break;
  }
  return "fhir";
}

core::Result<std::uint64_t> make_export(const ExportOrder& order, const fs::path& folder, const std::stop_token& stop) {
  const fs::path data = folder / "data";
  std::error_code failed;
  fs::create_directories(data, failed);
  if (failed) return core::fail_errno(failed.value(), "cannot make the folder '" + data.string() + "'");
  DTS_TRY(order.format == ExportFormat::Fhir ? export_bundle(order, data, stop) : export_parts(order, data, stop));
  const std::uint64_t rest = order.most_bytes - std::min(order.most_bytes, bytes_below(data));
  auto zip = write_zip(data, folder / "export.zip", rest, [&stop] { return !stop.stop_requested(); });
  fs::remove_all(data, failed);
  if (!zip && zip.error().code == core::ErrorCode::LimitExceeded) return tl::make_unexpected(check_size(order, ~0ULL).error());
  return zip;
}

}  // namespace dts::gateway

// SPDX-License-Identifier: Apache-2.0
#include "ctl/sessions/export_command.h"

#include <iterator>
#include <string>
#include <utility>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/try.h"
#include "ctl/recording_view.h"
#include "ctl/sessions/recorded_files.h"
#include "ctl/sessions/work_bar.h"
#include "fhir/bundle.h"
#include "record/export/export.h"
#include "record/export/output_files.h"
#include "record/xdf/recovery.h"

namespace dts::ctl {
namespace {

core::Result<record::Exported> export_one(const RecordedFile& file, const SessionArguments& wishes, cli::Console& console, WorkBar& work,
                                          cli::Json& damaged, cli::Json& losses) {
  DTS_TRY_ASSIGN(auto recording, record::Recording::open(file.path));
  if (recording->damage().empty()) {
    // Wrong values look plausible; only the checksums reveal them. A table must not have values from a damaged file.
    if (const auto verified = record::verify(file.path); !verified) {
      return core::fail(verified.error().code, verified.error().what, "copy the undamaged part: dtsctl session recover " + file.path);
    }
  } else {
    damaged.push_back({{"file", file.path}, {"damage", recording->damage()}});
    console.talk << console.program << ": " << cli::printable(file.path + ": " + recording->damage())
                 << "; only the undamaged part is exported" << std::endl;
  }
  if (const std::string lost = to_text(recording->losses()); !lost.empty()) {
    losses.push_back({{"file", file.path}, {"losses", lost}});
    console.talk << console.program << ": " << cli::printable(file.path) << ": " << lost << "; the events show where" << std::endl;
  }
  DTS_TRY_ASSIGN(const auto corrections, record::corrections_beside(file.path, recording->session().value_or(record::SessionFacts{})));
  const std::string folder = wishes.out.empty() ? "." : wishes.out;
  if (wishes.format == "csv") return record::export_csv(*recording, folder, work.progress(), corrections);
  if (wishes.format == "c3d") return record::export_c3d(*recording, folder, work.progress(), corrections);
  return record::export_bids(*recording, wishes.out.empty() ? "bids" : wishes.out, work.progress(), corrections);
}

/// Writes one bundle with all parts of the session.
int run_fhir_export(const std::vector<RecordedFile>& recorded, const Arguments& arguments, cli::Console& console) {
  std::vector<std::string> paths;
  for (const RecordedFile& file : recorded) paths.push_back(file.path);
  WorkBar work(console, "exporting");
  const auto progress = work.progress();
  constexpr std::uint64_t kSteps = 1000;
  const auto made = fhir::make_session_bundle(paths, "dtsctl " + std::string(client::version()), [&](double fraction) {
    return progress(static_cast<std::uint64_t>(fraction * static_cast<double>(kSteps)), kSteps);
  });
  const auto written = made.and_then([&](const fhir::Bundle& bundle) -> core::Result<record::OutputFiles::Written> {
    record::OutputFiles files(arguments.session.out);
    DTS_TRY(files.put(bundle.file, bundle.text));
    return files.commit();
  });
  if (!written) {
    const int status = cli::fail_with(console, written.error());
    return work.is_interrupted() ? cli::kInterrupted : status;
  }
  for (const std::string& damage : made->damage) console.talk << console.program << ": " << cli::printable(damage) << std::endl;
  if (!made->without_pdf.empty()) {
    console.talk << console.program << ": the bundle has no PDF: " << cli::printable(made->without_pdf) << std::endl;
  }
  if (arguments.is_json) {
    cli::Json json{
        {"files", written->files}, {"resources", made->resources}, {"bytes", written->bytes}, {"has_pdf", made->without_pdf.empty()}};
    if (!made->damage.empty()) json["damaged"] = made->damage;
    console.out << cli::document(json);
  } else {
    for (const std::string& name : written->files) console.out << cli::printable(name) << '\n';
    cli::print_hint(console, std::to_string(made->resources) + " resources, " + bytes_text(written->bytes));
  }
  console.out.flush();
  return cli::kOk;
}

}  // namespace

int run_session_export(const Arguments& arguments, cli::Console& console) {
  const auto files = find_recordings(arguments);
  if (!files) return cli::fail_with(console, files.error());
  if (arguments.session.format == "fhir") return run_fhir_export(*files, arguments, console);
  WorkBar work(console, "exporting");
  record::Exported all;
  cli::Json damaged = cli::Json::array();  // reported, so that a program does not mistake a partial export for a complete one
  cli::Json losses = cli::Json::array();
  for (const RecordedFile& file : *files) {
    auto exported = export_one(file, arguments.session, console, work, damaged, losses);
    if (!exported) {
      const int status = cli::fail_with(console, exported.error());
      for (const std::string& name : all.files) console.talk << "  already exported: " << cli::printable(name) << std::endl;
      return work.is_interrupted() ? cli::kInterrupted : status;
    }
    std::ranges::move(exported->files, std::back_inserter(all.files));
    all.rows += exported->rows;
    all.bytes += exported->bytes;
    if (exported->dropped_events > 0) {
      cli::print_hint(console, "the last " + std::to_string(exported->dropped_events) +
                                   " events are not in this file, C3D holds 255: --format csv writes all");
    }
  }
  if (arguments.is_json) {
    cli::Json json{{"files", all.files}, {"rows", all.rows}, {"bytes", all.bytes}};
    if (!damaged.empty()) json["damaged"] = std::move(damaged);
    if (!losses.empty()) json["losses"] = std::move(losses);
    console.out << cli::document(json);
  } else {
    for (const std::string& name : all.files) console.out << cli::printable(name) << '\n';
    cli::print_hint(console, std::to_string(all.rows) + " rows, " + bytes_text(all.bytes));
  }
  console.out.flush();
  return cli::kOk;
}

}  // namespace dts::ctl

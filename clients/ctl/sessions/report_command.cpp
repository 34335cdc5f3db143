// SPDX-License-Identifier: Apache-2.0
#include "ctl/sessions/report_command.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/try.h"
#include "ctl/recording_view.h"
#include "ctl/sessions/recorded_files.h"
#include "ctl/sessions/work_bar.h"
#include "record/export/output_files.h"
#include "record/export/walk.h"
#include "report/report.h"

namespace dts::ctl {
namespace {

/// Pages that are renamed to their final names together; each file is open until then.
constexpr std::size_t kPagesAtOnce = 100;

/// Checks for the mark that every page of this program has: near the beginning, or near the end of a PDF.
core::Status check_is_ours(const std::string& path) {
  std::error_code none;
  if (!std::filesystem::exists(std::filesystem::symlink_status(path, none))) return {};
  std::array<char, 1024> piece{};
  std::ifstream file(path, std::ios::binary);
  if (path.ends_with(".pdf")) {
    file.seekg(-static_cast<std::streamoff>(piece.size()), std::ios::end);
    if (!file) file.clear();  // shorter: read from the beginning
  }
  file.read(piece.data(), piece.size());
  const std::string_view text(piece.data(), static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  if (text.find(report::kPageMark) != std::string_view::npos) return {};
  return core::fail(core::ErrorCode::WrongState, "'" + path + "' exists and is not a report page: it is not replaced",
                    "move it away, or choose another folder with --out");
}

std::string folder_of(const Arguments& arguments, const std::vector<RecordedFile>& files, const report::Report& made) {
  if (!arguments.session.out.empty()) return arguments.session.out;
  const std::string stem = made.session_id.empty() ? std::filesystem::path(files.front().path).stem().string() : made.session_id;
  return record::fit_for_file_name(stem) + "-report";
}

core::Result<record::OutputFiles::Written> write_pages(const std::string& folder, const std::vector<report::Page>& pages,
                                                       const WorkBar& work) {
  record::OutputFiles::Written all;
  for (std::size_t first = 0; first < pages.size(); first += kPagesAtOnce) {
    record::OutputFiles files(folder);
    for (std::size_t index = first; index < std::min(pages.size(), first + kPagesAtOnce); ++index) {
      if (work.is_interrupted()) return core::fail(core::ErrorCode::Failed, "the report was interrupted");
      DTS_TRY(check_is_ours(files.path(pages[index].file)));
      DTS_TRY(files.replace(pages[index].file, pages[index].text));
    }
    DTS_TRY_ASSIGN(auto written, files.commit());
    std::ranges::move(written.files, std::back_inserter(all.files));
    all.bytes += written.bytes;
  }
  return all;
}

}  // namespace

int run_report(const Arguments& arguments, cli::Console& console) {
  const auto files = find_recordings(arguments);
  if (!files) return cli::fail_with(console, files.error());
  const std::string& format = arguments.session.format;
  report::ReportSource source{.files = {},
                              .software = "dtsctl " + std::string(client::version()),
                              .with_html = format == "html" || format == "all" || format.empty(),
                              .with_svg = format == "svg" || format == "all" || format.empty(),
                              .with_pdf = format == "pdf"};
  for (const RecordedFile& file : *files) source.files.push_back(file.path);
  WorkBar work(console, "reporting");
  const auto progress = work.progress();
  constexpr std::uint64_t kSteps = 1000;
  const auto made = report::make_report(
      source, [&](double fraction) { return progress(static_cast<std::uint64_t>(fraction * static_cast<double>(kSteps)), kSteps); });
  if (!made) {
    const int status = cli::fail_with(console, made.error());
    return work.is_interrupted() ? cli::kInterrupted : status;
  }
  const auto written = write_pages(folder_of(arguments, *files, *made), made->pages, work);
  if (!written) {
    const int status = cli::fail_with(console, written.error());
    return work.is_interrupted() ? cli::kInterrupted : status;
  }
  for (const std::string& damage : made->damage) console.talk << console.program << ": " << cli::printable(damage) << std::endl;
  if (arguments.is_json) {
    cli::Json json{{"session_id", made->session_id}, {"pages", written->files}, {"bytes", written->bytes}};
    if (!made->damage.empty()) json["damaged"] = made->damage;
    console.out << cli::document(json);
  } else {
    for (const std::string& name : written->files) console.out << cli::printable(name) << '\n';
    cli::print_hint(console, (written->files.size() == 1 ? "1 file" : std::to_string(written->files.size()) + " pages") + ", " +
                                 bytes_text(written->bytes));
  }
  console.out.flush();
  return cli::kOk;
}

}  // namespace dts::ctl

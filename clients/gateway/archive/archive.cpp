// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/archive.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "cli/try.h"
#include "gateway/archive/archive_path.h"
#include "gateway/archive/export_cache.h"
#include "gateway/archive/export_maker.h"
#include "gateway/archive/report_shelf.h"
#include "gateway/archive/session_files.h"
#include "gateway/archive/shared_work.h"
#include "gateway/archive/work_folder.h"
#include "gateway/http/json_answer.h"
#include "record/export/walk.h"

namespace dts::gateway {
namespace {

constexpr std::size_t kReportBytes = 64U << 20U;
constexpr std::size_t kPdfThreads = 2;  // one slow PDF does not delay the next one
// A page has no script and loads nothing. With "sandbox" alone, the page would have another origin: a click on a link to the next page
// would be cross-site, and the browser would omit the cookie (SameSite=Strict).
constexpr std::string_view kPagePolicy =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'self'; sandbox allow-same-origin";

HttpResponse busy() {
  HttpResponse answer = error_answer(503, "too many reports and exports are being prepared", "try again in a moment");
  answer.headers.emplace_back("Retry-After", "5");
  return answer;
}

/// An export that is too large stays too large: 429 would suggest that waiting helps.
HttpResponse not_made(const core::Error& error) {
  if (error.code == core::ErrorCode::LimitExceeded) return error_answer(507, error.what, error.hint);
  return error_answer(error);
}

HttpResponse not_found(std::string_view what) { return error_answer(404, what); }

/// Makes the browser save the file instead of showing it.
template <class Body>
HttpResponse download(Body body, const std::string& name, std::string content_type) {
  return {.content_type = std::move(content_type),
          .body = std::move(body),
          .headers = {{"Content-Disposition", "attachment; filename=\"" + record::fit_for_file_name(name) + "\""},
                      {"Cache-Control", "no-store"},
                      {"X-Content-Type-Options", "nosniff"}}};
}

HttpResponse list_pages(const report::Report& made) {
  cli::Json pages = cli::Json::array();
  for (const report::Page& page : made.pages) pages.push_back(page.file);
  return json_answer(200, {{"pages", pages}, {"damage", made.damage}});
}

HttpResponse show_page(const report::Report& made, const std::string& name) {
  const auto page = std::ranges::find(made.pages, name, &report::Page::file);
  if (page == made.pages.end()) return not_found("the report has no such page");
  if (name == report::kPdfName) return download(page->text, made.session_id + "-report.pdf", "application/pdf");
  return {.content_type = name.ends_with(".svg") ? "image/svg+xml" : "text/html; charset=utf-8",
          .body = page->text,
          .headers = {
              {"Content-Security-Policy", std::string(kPagePolicy)}, {"X-Content-Type-Options", "nosniff"}, {"Cache-Control", "no-store"}}};
}

/// Makes the pages, or the PDF alone: a browser that shows the pages does not need it.
core::Result<ReportPointer> make_pages(const std::vector<std::string>& files, bool is_pdf, report::Language language,
                                       std::chrono::seconds pdf_limit, const std::stop_token& stop) {
  // The pages show the program's name, and must have the same bytes as those of `dtsctl report`.
  const report::ReportSource source{.files = files,
                                    .software = "dtsctl " + std::string(client::version()),
                                    .with_html = !is_pdf,
                                    .with_svg = !is_pdf,
                                    .with_pdf = is_pdf,
                                    .pdf_limit = pdf_limit,
                                    .language = language};
  DTS_TRY_ASSIGN(auto made, report::make_report(source, [&stop](double) { return !stop.stop_requested(); }));
  return std::make_shared<const report::Report>(std::move(made));
}

struct MadeExport {
  std::shared_ptr<WorkFolder> folder;  ///< Removed when the zip file is in the cache, or cannot be kept.
  std::uint64_t bytes = 0;
};

class ArchiveImpl final : public Archive {
 public:
  ArchiveImpl(boost::asio::io_context& io, const ArchiveOptions& options, std::uint64_t work_bytes, std::unique_ptr<ExportCache> cache,
              FindSession find_session)
      : find_session_(std::move(find_session)),
        work_bytes_(work_bytes),
        pdf_limit_(options.pdf_limit),
        cache_(std::move(cache)),
        reports_([this](const std::string& key, const ReportPointer& made) {
          if (is_present(key)) shelf_.keep(key, made);
        }),
        exports_([this](const std::string& key, const MadeExport& made) {
          // If there is no room, `find` returns nothing for the waiting requests, and they are answered with "try again".
          if (is_present(key)) static_cast<void>(cache_->keep(key, made.folder->path() / "export.zip", made.bytes));
        }),
        pages_worker_(io),
        tables_worker_(io),
        pdf_worker_(io, kPdfThreads) {}

  void handle(HttpRequest request, Respond respond) override {
    if (request.method != "GET" && request.method != "HEAD") {
      return respond({.status = 405, .body = "this path accepts only GET and HEAD\n", .headers = {{"Allow", "GET, HEAD"}}});
    }
    auto path = read_archive_path(request.path);
    if (!path) return respond(not_found("nothing with that name"));
    const std::string session_id = path->session_id;
    find_session_(session_id, [this, is_alive = std::weak_ptr<bool>(is_alive_), path = std::move(*path),
                               respond = std::move(respond)](const client::Result<v1::SessionRecord>& session) {
      if (is_alive.expired()) return;
      if (!session) return respond(error_answer(session.error()));
      if (session->session_id() != path.session_id) return respond(error_answer(500, "the daemon answered with another session"));
      answer(path, *session, respond);
    });
  }

  void forget() override {
    ++generation_;
    shelf_.clear();
    cache_->clear();
  }

 private:
  /// Returns the key of a thing in the caches. After `forget`, keys of the same things differ.
  [[nodiscard]] std::string key_of(const std::string& what, const v1::SessionRecord& session) const {
    return std::to_string(generation_) + "\n" + what + "\n" + session.session_id() + "\n" + fingerprint_of(session);
  }
  [[nodiscard]] bool is_present(const std::string& key) const { return key.starts_with(std::to_string(generation_) + "\n"); }

  void answer(const ArchivePath& path, const v1::SessionRecord& session, const Respond& respond) {
    if (path.kind == ArchivePath::Kind::Recording) return send_recording(session, path.part, respond);
    auto files = files_of(session);
    if (!files) return respond(error_answer(files.error()));
    switch (path.kind) {
      case ArchivePath::Kind::Csv: return send_export(session, ExportFormat::Csv, std::move(*files), respond);
      case ArchivePath::Kind::Bids: return send_export(session, ExportFormat::Bids, std::move(*files), respond);
      case ArchivePath::Kind::C3d: return send_export(session, ExportFormat::C3d, std::move(*files), respond);
      case ArchivePath::Kind::Fhir: return send_export(session, ExportFormat::Fhir, std::move(*files), respond);
      default: return send_report(session, path, std::move(*files), respond);
    }
  }

  static void send_recording(const v1::SessionRecord& session, std::uint32_t part, const Respond& respond) {
    const auto file = file_of(session, part);
    if (!file) return respond(error_answer(file.error()));
    const std::filesystem::path path(*file);
    respond(download(FileBody{.path = path}, path.filename().string(), "application/octet-stream"));
  }

  /// A path without a page means the list of pages.
  void send_report(const v1::SessionRecord& session, const ArchivePath& path, std::vector<std::string> files, const Respond& respond) {
    const auto show = [page = path.page](const report::Report& made) { return page.empty() ? list_pages(made) : show_page(made, page); };
    const bool is_pdf = path.page == report::kPdfName;
    const std::string key = key_of((is_pdf ? "pdf-" : "report-") + std::string(report::code(path.language)), session);
    if (const ReportPointer made = shelf_.find(key)) return respond(show(*made));
    const bool is_accepted = reports_.ask(
        is_pdf ? pdf_worker_ : pages_worker_, key,
        [files = std::move(files), is_pdf, language = path.language, pdf_limit = pdf_limit_](const std::stop_token& stop) {
          return make_pages(files, is_pdf, language, pdf_limit, stop);
        },
        [show, respond](const core::Result<ReportPointer>& made) { respond(made ? show(**made) : not_made(made.error())); });
    if (!is_accepted) respond(busy());
  }

  void send_export(const v1::SessionRecord& session, ExportFormat format, std::vector<std::string> files, const Respond& respond) {
    const std::string key = key_of(name(format), session);
    const std::string file_name = session.session_id() + "-" + name(format) + ".zip";
    if (ExportCache::Held held = cache_->find(key)) return respond(zip_answer(std::move(held), file_name));
    // The exports under way at the same time, one table and a bundle on each PDF thread, must not need more than `work_bytes_` together.
    const bool is_bundle = format == ExportFormat::Fhir;
    const ExportOrder order{.session_id = session.session_id(),
                            .format = format,
                            .files = std::move(files),
                            .most_bytes = is_bundle ? work_bytes_ / (4 * kPdfThreads) : work_bytes_ / 4 * 3,
                            .pdf_limit = pdf_limit_};
    const auto folder = std::make_shared<WorkFolder>(cache_->new_folder());
    const bool is_accepted = exports_.ask(
        is_bundle ? pdf_worker_ : tables_worker_, key,
        [order, folder](const std::stop_token& stop) {
          return make_export(order, folder->path(), stop).map([&folder](std::uint64_t bytes) { return MadeExport{folder, bytes}; });
        },
        [this, key, file_name, respond](const core::Result<MadeExport>& made) {
          if (!made) return respond(not_made(made.error()));
          ExportCache::Held held = cache_->find(key);
          respond(held ? zip_answer(std::move(held), file_name) : busy());
        });
    if (!is_accepted) respond(busy());
  }

  /// Holds the export, so that the cache cannot remove the file before it is sent.
  static HttpResponse zip_answer(ExportCache::Held held, const std::string& file_name) {
    FileBody body{.path = held->file};
    body.when_done = [held = std::move(held)]() mutable { held.reset(); };
    return download(std::move(body), file_name, "application/zip");
  }

  FindSession find_session_;
  std::uint64_t work_bytes_;
  std::chrono::seconds pdf_limit_;
  std::uint64_t generation_ = 0;  ///< Counts the calls of `forget`.
  std::shared_ptr<bool> is_alive_ = std::make_shared<bool>(true);
  std::unique_ptr<ExportCache> cache_;
  ReportShelf shelf_{kReportBytes};
  SharedWork<ReportPointer> reports_;
  SharedWork<MadeExport> exports_;
  // Last: their threads end before the other members are destroyed. What waits for another program, which may hang, has its own threads.
  Worker pages_worker_;
  Worker tables_worker_;
  Worker pdf_worker_;
};

}  // namespace

client::Result<std::unique_ptr<Archive>> Archive::open(boost::asio::io_context& io, const ArchiveOptions& options,
                                                       FindSession find_session) {
  // Half of the bytes for the cache, half for the exports in progress, so that the limit for the disk always holds.
  const std::uint64_t work_bytes = options.cache_bytes / 2;
  // Uses a separate folder inside, so that the content of a directory given by mistake is not removed.
  DTS_TRY_ASSIGN(auto cache, ExportCache::open(options.cache_directory / "dts-gateway-exports", options.cache_bytes - work_bytes));
  return std::make_unique<ArchiveImpl>(io, options, work_bytes, std::move(cache), std::move(find_session));
}

}  // namespace dts::gateway

// SPDX-License-Identifier: Apache-2.0
#include "report/pdf.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "core/descriptor.h"

namespace dts::report {
namespace {

using core::ErrorCode;

constexpr const char* kProgram = "rsvg-convert";
constexpr rlim_t kMostMemory = rlim_t{1} << 30U;
constexpr rlim_t kMostCpuS = 300;  // 400 pages with much text need about 50 s
constexpr rlim_t kMostBytes = rlim_t{256} << 20U;
constexpr int kLookMs = 100;
constexpr std::size_t kMostMessage = 500;

core::Result<core::Descriptor> new_file(const char* name) {
  core::Descriptor file(::memfd_create(name, MFD_CLOEXEC));
  if (file.get() < 0) return core::fail_errno(errno, "no memory for the PDF");
  return file;
}

core::Status write_all(int file, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t written = ::write(file, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return core::fail_errno(errno, "no memory for the PDF");
    done += static_cast<std::size_t>(written);
  }
  return {};
}

std::string content_of(int file, std::size_t most) {
  std::string text;
  std::array<char, 65536> chunk{};
  while (text.size() < most) {
    const ssize_t count = ::pread(file, chunk.data(), std::min(chunk.size(), most - text.size()), static_cast<off_t>(text.size()));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    text.append(chunk.data(), static_cast<std::size_t>(count));
  }
  return text;
}

/// A running renderer. The destructor kills it.
class Renderer {
 public:
  explicit Renderer(pid_t process) : process_(process), exit_(static_cast<int>(::syscall(SYS_pidfd_open, process, 0))) {}
  ~Renderer() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    static_cast<void>(reaped());
  }
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Returns the wait status once the program has ended.
  [[nodiscard]] std::optional<int> wait() {
    pollfd waiter{.fd = exit_.get(), .events = POLLIN, .revents = 0};  // poll ignores a negative number and sleeps
    if (::poll(&waiter, 1, kLookMs) <= 0 && exit_.get() >= 0) return std::nullopt;
    const int status = reaped();
    process_ = -1;
    return status;
  }

 private:
  [[nodiscard]] int reaped() const {
    int status = -1;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  }

  pid_t process_;
  core::Descriptor exit_;
};

void limit(pid_t process, __rlimit_resource what, rlim_t most) {
  const rlimit both{.rlim_cur = most, .rlim_max = most};
  ::prlimit(process, what, &both, nullptr);
}

/// Starts the program: its only files are the pages, `out` and `talk`. Returns its process number, or an errno as error.
core::Result<pid_t> start(const std::vector<core::Descriptor>& pages, std::int64_t created_utc_s, int out, int talk) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, talk, STDERR_FILENO);
  std::vector<std::string> words{kProgram, "--format=pdf", "--"};
  for (const core::Descriptor& page : pages) {
    posix_spawn_file_actions_adddup2(&actions, page.get(), page.get());  // the child keeps this one
    words.push_back("/proc/self/fd/" + std::to_string(page.get()));
  }
  // Nothing of the caller's environment: its language, time zone and own fonts must not change the document.
  std::vector<std::string> settings{"LC_ALL=C.UTF-8", "TZ=UTC", "HOME=/nonexistent", "XDG_CACHE_HOME=/nonexistent",
                                    "SOURCE_DATE_EPOCH=" + std::to_string(std::max<std::int64_t>(created_utc_s, 0))};
  const auto pointers_to = [](std::vector<std::string>& texts) {
    std::vector<char*> pointers;
    for (std::string& text : texts) pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
  };
  const std::vector<char*> argv = pointers_to(words);
  const std::vector<char*> environment = pointers_to(settings);
  pid_t child = -1;
  const int problem = ::posix_spawnp(&child, kProgram, &actions, nullptr, argv.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (problem == ENOENT) {
    return core::fail(ErrorCode::Unsupported, "cannot make a PDF: the program rsvg-convert is not installed",
                      "install it on this computer: apt-get install librsvg2-bin. HTML pages need no further program");
  }
  if (problem != 0) return core::fail_errno(problem, "cannot make a PDF: rsvg-convert does not start");
  limit(child, RLIMIT_AS, kMostMemory);
  limit(child, RLIMIT_CPU, kMostCpuS);
  limit(child, RLIMIT_FSIZE, kMostBytes);
  return child;
}

core::Result<int> wait_for(Renderer& renderer, const std::function<bool()>& wants_more, std::chrono::seconds longest) {
  const auto end = std::chrono::steady_clock::now() + longest;
  while (true) {
    if (const auto status = renderer.wait()) return *status;
    if (!wants_more()) return core::fail(ErrorCode::Failed, "the report was interrupted: no page was written");
    if (std::chrono::steady_clock::now() > end) {
      return core::fail(ErrorCode::Failed,
                        "cannot make a PDF: rsvg-convert did not finish within " + std::to_string(longest.count()) + " s",
                        "open the HTML page and print it");
    }
  }
}

}  // namespace

core::Result<std::string> pdf_of(std::span<const std::string> svg_pages, std::int64_t created_utc_s,
                                 const std::function<bool()>& wants_more, std::chrono::seconds longest) {
  if (svg_pages.empty() || svg_pages.size() > kMostPdfPages) {
    return core::fail(ErrorCode::LimitExceeded,
                      "a PDF can have 1 to " + std::to_string(kMostPdfPages) + " pages, not " + std::to_string(svg_pages.size()),
                      "open the HTML pages instead");
  }
  std::vector<core::Descriptor> pages;
  for (const std::string& page : svg_pages) {
    DTS_TRY_ASSIGN(auto file, new_file("page.svg"));
    DTS_TRY(write_all(file.get(), page));
    pages.push_back(std::move(file));
  }
  DTS_TRY_ASSIGN(const auto out, new_file("report.pdf"));
  DTS_TRY_ASSIGN(const auto talk, new_file("messages"));
  DTS_TRY_ASSIGN(const auto child, start(pages, created_utc_s, out.get(), talk.get()));
  Renderer renderer(child);
  DTS_TRY_ASSIGN(const auto status, wait_for(renderer, wants_more, longest));
  std::string document = content_of(out.get(), kMostBytes);
  if (status != 0 || !document.starts_with("%PDF-")) {
    return core::fail(ErrorCode::Failed, "cannot make a PDF: rsvg-convert failed: " + content_of(talk.get(), kMostMessage),
                      "check the program: rsvg-convert --version; it must be 2.54 or later");
  }
  return document;
}

}  // namespace dts::report

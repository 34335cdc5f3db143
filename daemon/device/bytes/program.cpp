// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/program.h"

#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include "device/bytes/child_process.h"
#include "device/bytes/descriptor_link.h"
#include "device/bytes/error_lines.h"

namespace dts::device::bytes {
namespace {

constexpr int kEndTextMs = 100;  // a program closes its stdout some time before it has ended
constexpr std::chrono::milliseconds kLastWords{50};

class Program final : public DescriptorLink {
 public:
  Program(std::vector<std::string> argv, core::Clock& clock, core::Log log)
      : DescriptorLink("program " + (argv.empty() ? std::string{} : argv.front()), clock), argv_(std::move(argv)), log_(std::move(log)) {}
  ~Program() override { Program::close(); }

  core::Status open() override {
    if (is_open()) return {};
    const std::lock_guard lock(mutex_);
    end_child();
    if (child_) return core::fail(core::ErrorCode::WrongState, name() + " has not ended yet: the kernel does not let it end");
    DTS_TRY_ASSIGN(auto started, ChildProcess::start(argv_));
    child_.emplace(std::move(started));
    why_lost_.clear();
    try {
      errors_.emplace(child_->take_errors(), name(), log_);
    } catch (const std::system_error& error) {  // no thread or descriptor left
      end_child();
      return core::fail(core::ErrorCode::Failed, "cannot read the error lines of " + name() + ": " + error.what());
    }
    core::Descriptor end = child_->watch();
    if (end.get() < 0) {
      const int error = errno;
      end_child();
      return core::fail_errno(error, "cannot watch the " + name());
    }
    attach({.in = child_->take_output(), .out = child_->take_input(), .end = std::move(end), .out_is_socket = true});
    return {};
  }

  void close() noexcept override {
    const std::lock_guard lock(mutex_);
    keep_why_lost();
    detach();  // first: a program that reads its stdin ends by itself
    end_child();
  }

  bool has_arrived() noexcept override { return false; }
  Facts facts() const override { return {}; }

  std::string why_lost() const override {
    const std::lock_guard lock(mutex_);
    if (lost() && child_ && why_lost_.empty()) why_lost_ = explain();
    return why_lost_;
  }

  bool restarts_the_board() const noexcept override { return true; }

 private:
  [[nodiscard]] std::string explain() const {
    const bool has_ended = child_->wait(kEndTextMs);
    std::string text = "the " + name() + " " + (has_ended ? child_->end_text() : std::string("closed its standard output"));
    const std::string words = errors_ ? errors_->last_lines(kLastWords) : std::string{};
    return words.empty() ? text : text + "; its last words: " + words;
  }

  void keep_why_lost() noexcept {
    try {
      if (lost() && child_ && why_lost_.empty()) why_lost_ = explain();
    } catch (const std::exception&) {  // no memory for a message: the link closes without one
    }
  }

  void end_child() noexcept {
    if (child_ && child_->end()) child_.reset();
    errors_.reset();
  }

  std::vector<std::string> argv_;
  core::Log log_;
  mutable std::mutex mutex_;  ///< Protects what follows; `read` and `write` do not use it.
  std::optional<ChildProcess> child_;
  mutable std::optional<ErrorLines> errors_;
  mutable std::string why_lost_;  ///< Made once: it waits for the last words.
};

}  // namespace

std::unique_ptr<ByteLink> run_program(std::vector<std::string> argv, core::Clock& clock, core::Log log) {
  return std::make_unique<Program>(std::move(argv), clock, std::move(log));
}

}  // namespace dts::device::bytes

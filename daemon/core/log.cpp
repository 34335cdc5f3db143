// SPDX-License-Identifier: Apache-2.0
#include "core/log.h"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "core/utf8.h"

namespace dts::core {
namespace {

spdlog::level::level_enum to_spdlog(LogLevel level) {
  switch (level) {
    case LogLevel::Debug: return spdlog::level::debug;
    case LogLevel::Info: return spdlog::level::info;
    case LogLevel::Warning: return spdlog::level::warn;
    case LogLevel::Error: return spdlog::level::err;
  }
  return spdlog::level::info;
}

/// sd-daemon(3) prefixes: the journal turns "<4>" into a priority.
class JournalPriority final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    const std::string_view prefix = message.level >= spdlog::level::err    ? "<3>"
                                    : message.level >= spdlog::level::warn ? "<4>"
                                    : message.level >= spdlog::level::info ? "<6>"
                                                                           : "<7>";
    out.append(prefix.data(), prefix.data() + prefix.size());
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<JournalPriority>(); }
};

/// JOURNAL_STREAM contains device and inode of the journal's stream (systemd.exec(5)). A shell that a service started inherits the
/// variable but not the stream, so stderr must be the same stream.
bool is_stderr_the_journal() {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat actual {};
  if (stream == nullptr || fstat(STDERR_FILENO, &actual) != 0) return false;
  return stream == std::to_string(actual.st_dev) + ":" + std::to_string(actual.st_ino);
}

}  // namespace

Log::Log() : Log(std::make_shared<spdlog::logger>("dts", std::make_shared<spdlog::sinks::null_sink_mt>())) {}

Log::Log(std::shared_ptr<spdlog::logger> logger) : logger_(std::move(logger)) {}

Log Log::to_stderr(LogLevel minimum) {
  std::shared_ptr<spdlog::logger> logger;
  if (is_stderr_the_journal()) {
    logger = std::make_shared<spdlog::logger>("dts", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    formatter->add_flag<JournalPriority>('*').set_pattern("%*%v");
    logger->set_formatter(std::move(formatter));
  } else {
    logger = std::make_shared<spdlog::logger>("dts", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
    logger->set_pattern("%H:%M:%S.%e %^%l%$ %v");
  }
  logger->set_level(to_spdlog(minimum));
  logger->flush_on(spdlog::level::debug);
  return Log{logger};
}

void Log::debug(std::string_view text) const { logger_->debug("{}", printable(text)); }
void Log::info(std::string_view text) const { logger_->info("{}", printable(text)); }
void Log::warning(std::string_view text) const { logger_->warn("{}", printable(text)); }
void Log::error(std::string_view text) const { logger_->error("{}", printable(text)); }

}  // namespace dts::core

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace spdlog {
class logger;
}

namespace dts::core {

enum class LogLevel : std::uint8_t { Debug, Info, Warning, Error };

/// Where log lines go. Passed in, never global, so that a test can listen and two daemons in one process do not mix.
/// Copies share the sink. Thread: any but the sample threads. Realtime-safe: no (that is why sample threads count and
/// let the control thread log).
class Log {
 public:
  Log();  ///< Swallows everything.
  explicit Log(std::shared_ptr<spdlog::logger> logger);

  /// To the terminal with colours, or, when stderr is connected to the journal, with syslog priorities ("<4>text").
  [[nodiscard]] static Log to_stderr(LogLevel minimum);

  /// One line each: `text`, which may quote a peer, is made printable and cannot forge a second line.
  void debug(std::string_view text) const;
  void info(std::string_view text) const;
  void warning(std::string_view text) const;
  void error(std::string_view text) const;

 private:
  std::shared_ptr<spdlog::logger> logger_;
};

}  // namespace dts::core

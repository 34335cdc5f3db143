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

/// Writes log lines. Never global: the owner passes it to each user, so a test can read the lines, and two daemons in one process do
/// not mix them. Copies share the sink.
/// Thread: any but the rigs' threads. Realtime-safe: no (so these only count, and the control thread logs).
class Log {
 public:
  Log();  ///< Discards all lines.
  explicit Log(std::shared_ptr<spdlog::logger> logger);

  /// Logs to stderr: with syslog priorities ("<4>text") if stderr is connected to the journal, otherwise with colours for a terminal.
  [[nodiscard]] static Log to_stderr(LogLevel minimum);

  /// Each call logs one line. `text` may quote a peer: it is made printable, so it cannot fake a second line.
  void debug(std::string_view text) const;
  void info(std::string_view text) const;
  void warning(std::string_view text) const;
  void error(std::string_view text) const;

 private:
  std::shared_ptr<spdlog::logger> logger_;
};

}  // namespace dts::core

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "core/log.h"
#include "core/result.h"
#include "fleet/database/database.h"

namespace dts::fleet::desk {

/// Executes statements on a few threads, each with a connection of its own, so that the io thread never waits for PostgreSQL.
class QueryPool {
 public:
  static constexpr std::size_t kThreads = 3;
  static constexpr std::size_t kMostWaiting = 64;
  static constexpr std::chrono::milliseconds kStatementTimeout{5000};  ///< Also the longest time that the destructor waits.

  using Work = std::function<core::Result<std::string>(database::Database&)>;
  using Done = std::function<void(core::Result<std::string>)>;

  /// Logs once why the database cannot be read, and when it can be read again.
  QueryPool(boost::asio::io_context& io, const std::string& connection, core::Log log);
  /// Drops what waits, and waits for the statements that run.
  ~QueryPool();
  QueryPool(const QueryPool&) = delete;
  QueryPool& operator=(const QueryPool&) = delete;

  /// Calls `done` on the io thread; at once with LimitExceeded if too many wait. Thread: io.
  void submit(Work work, Done done);

 private:
  struct Query {
    Work work;
    Done done;
  };
  void run(const std::stop_token& stop, const std::string& connection);
  [[nodiscard]] core::Result<std::string> result_of(const Work& work, database::Database& database) noexcept;
  void note(const std::string& problem);

  const core::Log log_;
  boost::asio::io_context& io_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Query> waiting_;  ///< Guarded by `mutex_`, as the next.
  std::string problem_;        ///< Of the database; empty: none.
  std::vector<std::jthread> threads_;
};

}  // namespace dts::fleet::desk

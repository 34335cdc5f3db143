// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/query_pool.h"

#include <pthread.h>

#include <boost/asio/post.hpp>
#include <exception>
#include <memory>
#include <utility>

namespace dts::fleet::desk {
namespace {

constexpr const char* kNoRights =
    "as the owner of the database: CREATE ROLE \"dts-fleet-gateway\" LOGIN IN ROLE dashboard, and name this role in --database";

}  // namespace

/// libpq and the standard library may throw if memory runs out.
core::Result<std::string> QueryPool::result_of(const Work& work, database::Database& database) noexcept {
  try {
    auto result = work(database);
    if (result) {
      note({});
      return result;
    }
    core::Error& error = result.error();
    if (error.code == core::ErrorCode::Unreachable || error.code == core::ErrorCode::NotAllowed) {
      note(core::to_string(error));
      const bool is_rejected = !error.hint.empty();  // see DatabaseOptions
      error = {.code = core::ErrorCode::Unreachable,
               .what = is_rejected ? "the database of the centre rejects the dashboard" : "the database of the centre does not answer",
               .hint = is_rejected ? "the log of dts-fleet-gateway has the reason" : "check PostgreSQL on the computer of the centre"};
    } else if (error.code == core::ErrorCode::Timeout) {
      error.what = "the database of the centre needed too long";
      error.hint = "choose a shorter time or one clinic";
    }
    return result;
  } catch (const std::exception& failure) {
    return core::fail(core::ErrorCode::Failed, failure.what());
  }
}

void QueryPool::note(const std::string& problem) {
  const std::lock_guard lock(mutex_);
  if (problem == problem_) return;
  problem_ = problem;
  if (problem.empty()) log_.info("the database answers again");
  if (!problem.empty()) log_.error("the database: " + problem);
}

QueryPool::QueryPool(boost::asio::io_context& io, const std::string& connection, core::Log log) : log_(std::move(log)), io_(io) {
  for (std::size_t number = 0; number < kThreads; ++number) {
    threads_.emplace_back([this, connection](const std::stop_token& stop) { run(stop, connection); });
  }
}

QueryPool::~QueryPool() {
  for (std::jthread& thread : threads_) thread.request_stop();
}

void QueryPool::submit(Work work, Done done) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < kMostWaiting) {
      waiting_.push_back({std::move(work), std::move(done)});
      changed_.notify_one();
      return;
    }
  }
  done(core::fail(core::ErrorCode::LimitExceeded, "too many pages are requested at once", "try again"));
}

void QueryPool::run(const std::stop_token& stop, const std::string& connection) {
  ::pthread_setname_np(::pthread_self(), "query");
  database::Database database(
      {.connection = connection, .name = "dts-fleet-gateway", .statement_timeout = kStatementTimeout, .rejection_hint = kNoRights});
  while (true) {
    Query query;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [this] { return !waiting_.empty(); }) || stop.stop_requested()) return;
      query = std::move(waiting_.front());
      waiting_.pop_front();
    }
    boost::asio::post(io_, [done = std::move(query.done), result = result_of(query.work, database)]() mutable { done(std::move(result)); });
  }
}

}  // namespace dts::fleet::desk

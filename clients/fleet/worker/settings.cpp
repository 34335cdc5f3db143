// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/settings.h"

#include <filesystem>

namespace dts::fleet::worker {
namespace {

/// A path of the configuration is relative to its file.
std::string beside(const std::string& file, const std::string& path) {
  return path.empty() ? path : (std::filesystem::absolute(file).parent_path() / path).lexically_normal().string();
}

std::string required_text(files::TomlReader& reader, std::string_view key) {
  reader.require(key);
  return reader.text(key, "");
}

}  // namespace

WorkerOptions read_settings(const std::string& file, files::Problems& problems) {
  WorkerOptions options;
  const auto table = files::parse_toml(file, problems);
  if (!table) return options;
  files::TomlReader top(&*table, "", file, problems);
  options.dtslab = beside(file, top.text("dtslab", options.dtslab));
  files::TomlReader database = top.table("database");
  options.connection = required_text(database, "connection");
  database.finish();
  files::TomlReader store = top.table("store");
  if (store.has("s3")) options.s3 = s3::read_settings(store.table("s3"));
  options.store = beside(file, options.s3 ? store.text("directory", "") : required_text(store, "directory"));
  store.finish();
  files::TomlReader limits = top.table("limits");
  options.limits.time = std::chrono::seconds(limits.integer("time_s", options.limits.time.count(), 1, 86'400));
  constexpr std::int64_t kMib = 1 << 20;
  const auto memory_mib = static_cast<std::int64_t>(options.limits.memory_bytes) / kMib;
  options.limits.memory_bytes = static_cast<std::uint64_t>(limits.integer("memory_mib", memory_mib, 64, 1'048'576) * kMib);
  limits.finish();
  files::TomlReader jobs = top.table("jobs");
  options.lease = std::chrono::seconds(jobs.integer("lease_s", options.lease.count(), 2, 3600));
  options.retry_pause = std::chrono::seconds(jobs.integer("retry_pause_s", options.retry_pause.count(), 0, 86'400));
  jobs.finish();
  top.finish();
  return options;
}

}  // namespace dts::fleet::worker

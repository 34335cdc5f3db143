// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <stdlib.h>

#include <filesystem>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include "record/catalogue/catalogue.h"
#include "record/losses.h"

/// For the tests of the catalogue: a folder of their own, an open catalogue, and a way past it to the database.
namespace dts::record::catalogue_test {

inline SessionFacts facts(const std::string& id = "s1", std::uint32_t part = 1, std::int64_t started_utc_ns = 1000) {
  SessionFacts session{.session_id = id, .part = part, .rig = "floor", .kind = "floor", .protocol = "free", .subject = "P017"};
  session.started_utc_ns = started_utc_ns;
  return session;
}

class CatalogueFixture : public testing::Test {
 protected:
  CatalogueFixture() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-catalogue-XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) folder_ = name;
  }
  ~CatalogueFixture() override {
    std::error_code ignored;
    catalogue_.reset();
    std::filesystem::remove_all(folder_, ignored);
  }
  [[nodiscard]] std::string path(const std::string& name = "catalogue.sqlite") const { return (folder_ / name).string(); }

  /// The open catalogue; opens it first when it is not.
  Catalogue& catalogue() {
    if (!catalogue_) {
      auto opened = Catalogue::open(path());
      if (!opened) throw std::runtime_error(core::to_string(opened.error()));
      catalogue_ = std::move(*opened);
    }
    return *catalogue_;
  }
  void close() { catalogue_.reset(); }

  /// All sessions with their parts and trials, one a line, newest session first; files as seen from the test's folder.
  std::string sessions_text() {
    std::ostringstream text;
    const auto sessions = catalogue().sessions({}).value();
    for (const SessionRow& listed : sessions) {
      const SessionRow session = catalogue().session(listed.id).value();
      text << session.id << ' ' << session.rig << ' ' << session.protocol << ' ' << session.subject << ' ' << session.state << " from "
           << session.started_utc_ns << " to " << session.ended_utc_ns << (session.message.empty() ? "" : ": ") << session.message << '\n';
      for (const PartRow& part : session.parts) {
        text << "  part " << part.part << ' ' << std::filesystem::path(part.file).lexically_proximate(folder_).string() << ' '
             << name(part.state) << ' ' << part.scans << " scans " << part.duration_s << " s, " << part.valid_trials << " valid, lost "
             << (part.losses ? to_json(*part.losses) : "unknown") << ' ' << part.lost_s_at_most << " s" << (part.reason.empty() ? "" : ": ")
             << part.reason << '\n';
      }
      for (const TrialRow& trial : session.trials) {
        text << "  trial " << trial.part << '.' << trial.trial << '.' << trial.attempt << ' ' << trial.condition << ' ' << trial.outcome
             << ' ' << trial.segment << ':' << trial.first_scan << " to " << trial.last_segment << ':' << trial.last_scan << trial.result
             << '\n';
      }
    }
    std::string all = text.str();
    for (std::size_t at = all.find(folder_); at != std::string::npos; at = all.find(folder_)) all.erase(at, folder_.string().size());
    return all;
  }

  /// What somebody with another program does to the file. False: refused.
  [[nodiscard]] bool meddle(const std::string& sql) const {
    sqlite3* handle = nullptr;
    bool is_done = sqlite3_open(path().c_str(), &handle) == SQLITE_OK;
    is_done = is_done && sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
    sqlite3_close(handle);
    return is_done;
  }

  std::filesystem::path folder_;
  std::unique_ptr<Catalogue> catalogue_;
};

template <class Value>
core::ErrorCode code(const core::Result<Value>& result) {
  return result ? core::ErrorCode{} : result.error().code;
}
template <class Value>
std::string what(const core::Result<Value>& result) {
  return result ? "" : core::to_string(result.error());
}

}  // namespace dts::record::catalogue_test

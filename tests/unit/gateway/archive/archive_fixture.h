// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <vector>

#include "gateway/archive/archive.h"
#include "unit/ctl/sessions/made_recording.h"
#include "unit/gateway/answered_test.h"
#include "unit/gateway/read_response.h"
#include "unit/report/made_standing.h"

namespace dts::gateway {

inline const std::string kId = "20261121T144525Z-floor-1";

/// An archive on some sessions that a daemon is said to have.
class ArchiveTest : public AnsweredTest {
 protected:
  ArchiveTest() { open(); }
  void open() {
    archive_.reset();
    auto opened = Archive::open(io_, options_, [this](const std::string& id, const auto& found) {
      ++asked_;
      const auto session = sessions_.find(id);
      if (session != sessions_.end()) return found(session->second);
      found(client::fail(client::ErrorCode::NotFound, "no session '" + id + "'"));
    });
    ASSERT_TRUE(opened.has_value()) << opened.error().what;
    archive_ = std::move(*opened);
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (directory_.path() / name).string(); }
  v1::SessionRecord& add_session(const std::vector<std::string>& files, const std::string& id = kId) {
    v1::SessionRecord& session = sessions_[id];
    session.set_session_id(id);
    session.set_rig("floor");
    session.set_state("complete");
    for (const std::string& file : files) {
      v1::SessionPart& part = *session.add_parts();
      part.set_part(static_cast<std::uint32_t>(session.parts_size()));
      part.set_state(v1::PART_STATE_COMPLETE);
      part.set_file(file);
    }
    return session;
  }
  v1::SessionRecord& add_standing() {
    report::MadeStanding made{.length_s = 25.0};
    report::add_trial(made, 1, 2.0, 20.0, "eyes-open", {{"eyes", "open"}});
    return add_session({report::write_standing(path("standing.xdf"), made)});
  }
  v1::SessionRecord& add_two_parts() {
    return add_session({ctl::make_recording(path("a.xdf")), ctl::make_recording(path("b.xdf"), ctl::Ending::Closed, 2)});
  }
  void begin(const std::string& what, const std::string& method = "GET", const std::string& id = kId) {
    HttpRequest request{.method = method, .path = "/api/sessions/" + id + "/" + what};
    archive_->handle(std::move(request), keep());
  }
  HttpResponse get(const std::string& what, const std::string& method = "GET", const std::string& id = kId) {
    begin(what, method, id);
    return std::move(wait_for(1).front());
  }
  [[nodiscard]] std::vector<std::string> cached() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(options_.cache_directory / "dts-gateway-exports"))
      names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
  }

  testing::TemporaryDirectory directory_;
  ArchiveOptions options_{.cache_directory = directory_.path() / "cache", .cache_bytes = 64U << 20U};
  std::map<std::string, v1::SessionRecord> sessions_;
  int asked_ = 0;
  std::unique_ptr<Archive> archive_;
};

}  // namespace dts::gateway

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "gateway/access/access_control.h"
#include "gateway/archive/archive.h"
#include "gateway/http/static_files.h"
#include "gateway/subjects/subjects.h"

namespace dts::gateway {

/// Maps paths to handlers. Thread: io.
///
///     /api/me /api/login /api/logout    AccessControl
///     /api/sessions/...                 Archive, for users who may view
///     /api/subjects/ID                  Subjects, for users who may operate: only they see subject IDs
///     /metrics                          for users who may view, and for a monitor on this machine (cannot log in; sees no names)
///     everything else                   the dashboard's files: they hold no secrets, and the login page must load before a login
class Routes {
 public:
  /// `metrics` returns the text of /metrics; empty: the page does not exist.
  Routes(AccessControl& access, Archive& archive, Subjects& subjects, const StaticFiles& files, std::function<std::string()> metrics)
      : access_(access), archive_(archive), subjects_(subjects), files_(files), metrics_(std::move(metrics)) {}
  void handle(HttpRequest request, Respond respond) const;

 private:
  void serve_metrics(const HttpRequest& request, const Respond& respond) const;
  void serve_subject(const HttpRequest& request, const Respond& respond) const;
  [[nodiscard]] bool may_view(const HttpRequest& request) const;

  AccessControl& access_;
  Archive& archive_;
  Subjects& subjects_;
  const StaticFiles& files_;
  std::function<std::string()> metrics_;
};

}  // namespace dts::gateway

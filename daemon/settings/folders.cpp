// SPDX-License-Identifier: Apache-2.0
#include "settings/folders.h"

#include <unistd.h>

#include <cstdlib>

namespace dts::settings {
namespace {

const char* environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0' ? value : nullptr;
}

}  // namespace

std::string runtime_directory() {
  if (const char* given = environment("DTSD_RUNTIME_DIR")) return given;
  if (const char* systemd = environment("RUNTIME_DIRECTORY")) return systemd;
  if (const char* user = environment("XDG_RUNTIME_DIR")) return std::string(user) + "/dtsd";
  return "/tmp/dtsd-" + std::to_string(::getuid());
}

std::string state_directory() {
  if (const char* given = environment("DTSD_STATE_DIR")) return given;
  if (const char* systemd = environment("STATE_DIRECTORY")) return systemd;
  if (const char* user = environment("XDG_STATE_HOME")) return std::string(user) + "/dtsd";
  if (const char* home = environment("HOME")) return std::string(home) + "/.local/state/dtsd";
  return runtime_directory() + "/state";
}

}  // namespace dts::settings

// SPDX-License-Identifier: Apache-2.0
#include "lsl/liblsl.h"

#include <dlfcn.h>

namespace dts::lsl {
namespace {

using core::ErrorCode;

constexpr std::int32_t kOldestVersion = 110;
constexpr std::int32_t kNextMajorVersion = 200;
constexpr const char* kHowToGetIt =
    "install liblsl from https://github.com/sccn/liblsl/releases (its Debian package), or name the file in lsl.toml: [lsl] library = "
    "\"/path/liblsl.so\"";

std::string loader_text() {
  const char* const text = dlerror();
  return text != nullptr ? text : "no reason given";
}

// Never unloaded: the library starts threads, which would lose their code.
void* open_library(const std::string& file) { return dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE); }

/// Finds functions of a library and keeps the first name that is missing.
class Functions {
 public:
  explicit Functions(void* library) : library_(library) {}

  template <class Function>
  void find(const char* name, Function& function) {
    function = reinterpret_cast<Function>(dlsym(library_, name));
    if (function == nullptr && missing_.empty()) missing_ = name;
  }
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }

 private:
  void* library_;
  std::string missing_;
};

/// Returns the name of the first function that the library lacks; empty: it has all.
std::string find_all(void* library, Liblsl& lsl) {
  Functions functions(library);
  functions.find("lsl_library_version", lsl.library_version);
  functions.find("lsl_local_clock", lsl.local_clock);
  functions.find("lsl_create_streaminfo", lsl.create_streaminfo);
  functions.find("lsl_destroy_streaminfo", lsl.destroy_streaminfo);
  functions.find("lsl_get_channel_count", lsl.get_channel_count);
  functions.find("lsl_get_nominal_srate", lsl.get_nominal_srate);
  functions.find("lsl_get_name", lsl.get_name);
  functions.find("lsl_get_source_id", lsl.get_source_id);
  functions.find("lsl_get_uid", lsl.get_uid);
  functions.find("lsl_get_desc", lsl.get_desc);
  functions.find("lsl_append_child", lsl.append_child);
  functions.find("lsl_append_child_value", lsl.append_child_value);
  functions.find("lsl_create_outlet", lsl.create_outlet);
  functions.find("lsl_destroy_outlet", lsl.destroy_outlet);
  functions.find("lsl_have_consumers", lsl.have_consumers);
  functions.find("lsl_push_chunk_ftnp", lsl.push_chunk_ftnp);
  functions.find("lsl_push_sample_strtp", lsl.push_sample_strtp);
  functions.find("lsl_create_continuous_resolver_bypred", lsl.create_continuous_resolver_bypred);
  functions.find("lsl_resolver_results", lsl.resolver_results);
  functions.find("lsl_destroy_continuous_resolver", lsl.destroy_continuous_resolver);
  functions.find("lsl_create_inlet", lsl.create_inlet);
  functions.find("lsl_destroy_inlet", lsl.destroy_inlet);
  functions.find("lsl_pull_sample_str", lsl.pull_sample_str);
  functions.find("lsl_destroy_string", lsl.destroy_string);
  functions.find("lsl_time_correction", lsl.time_correction);
  return functions.missing();
}

}  // namespace

const std::vector<std::string>& Liblsl::default_files() {
  static const std::vector<std::string> files{"liblsl.so.2", "liblsl.so", "liblsl64.so"};
  return files;
}

core::Result<std::unique_ptr<const Liblsl>> Liblsl::load(const std::string& file) {
  const std::vector<std::string> files = file.empty() ? default_files() : std::vector<std::string>{file};
  void* library = nullptr;
  std::string reason;
  std::string loaded_file;
  for (const std::string& candidate : files) {
    library = open_library(candidate);
    if (library != nullptr) {
      loaded_file = candidate;
      break;
    }
    reason = loader_text();
  }
  if (library == nullptr) return core::fail(ErrorCode::NotFound, "liblsl cannot be loaded: " + reason, kHowToGetIt);
  auto loaded = std::make_unique<Liblsl>();
  if (const std::string missing = find_all(library, *loaded); !missing.empty()) {
    return core::fail(ErrorCode::InvalidArgument, loaded_file + " has no function " + missing + ": it is not liblsl, or too old",
                      kHowToGetIt);
  }
  if (const std::int32_t version = loaded->library_version(); version < kOldestVersion || version >= kNextMajorVersion) {
    return core::fail(ErrorCode::InvalidArgument,
                      loaded_file + " has version " + std::to_string(version / 100) + "." + std::to_string(version % 100) +
                          ", and dts-lsl knows 1.10 to 1.99",
                      kHowToGetIt);
  }
  return loaded;
}

}  // namespace dts::lsl

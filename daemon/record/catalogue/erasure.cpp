// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/erasure.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "core/utf8.h"
#include "record/recording.h"
#include "record/replace_file.h"

namespace dts::record {
namespace {

using core::ErrorCode;
using Json = nlohmann::ordered_json;

constexpr const char* kErasureHint =
    "check the permissions of the state folder and whether its disk is full or read-only, then restart dtsd";
constexpr int kDeepest = 32;

std::string journal_of(const std::string& state_folder) { return state_folder + "/erasure.json"; }

/// A descriptor that is closed at the end.
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const noexcept { return value_; }
  [[nodiscard]] int release() noexcept { return std::exchange(value_, -1); }

 private:
  int value_;
};

bool is_letter(char letter) { return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_'; }
bool joins(char letter) { return letter == '-' || letter == '.'; }

/// Returns whether an ID that begins at `at` is only the end of a longer one, as P01 in X-P01.
bool continues_before(std::string_view text, std::size_t at) {
  if (at == 0) return false;
  return is_letter(text[at - 1]) || (at > 1 && joins(text[at - 1]) && is_letter(text[at - 2]));
}
/// Returns whether an ID that ends before `end` is only the begin of a longer one, as P01 in P01-2.
bool continues_after(std::string_view text, std::size_t end) {
  if (end >= text.size()) return false;
  return is_letter(text[end]) || (end + 1 < text.size() && joins(text[end]) && is_letter(text[end + 1]));
}

/// Removes files in one folder after the other. Each folder is opened relative to the folder above it, and never through a link.
class Remover {
 public:
  Remover(const std::vector<std::string>& sessions, const std::function<bool()>& is_wanted) : sessions_(sessions), is_wanted_(is_wanted) {}

  core::Status remove_in(int folder, const std::string& path, int depth);
  [[nodiscard]] Erased take_result() { return std::move(erased_); }

 private:
  core::Status remove_entry(int folder, const std::string& path, const std::string& name, int depth);
  core::Status unlink(int folder, const std::string& path, const std::string& name, std::uint64_t bytes);
  [[nodiscard]] bool is_named(const std::string& name) const {
    return std::ranges::any_of(sessions_, [&name](const std::string& id) { return name.starts_with(id + "."); });
  }
  [[nodiscard]] bool is_recording_of(int folder, const std::string& name) const;

  const std::vector<std::string>& sessions_;
  const std::function<bool()>& is_wanted_;
  Erased erased_;
};

core::Status Remover::remove_in(int folder, const std::string& path, int depth) {
  DIR* const stream = ::fdopendir(folder);
  if (stream == nullptr) {
    ::close(folder);
    return core::fail_errno(errno, "cannot look for recordings in '" + path + "'", kErasureHint);
  }
  const std::unique_ptr<DIR, int (*)(DIR*)> closes(stream, ::closedir);
  std::vector<std::string> names;  // read first: removing entries while reading may skip others
  for (errno = 0; const dirent* entry = ::readdir(stream);) names.emplace_back(entry->d_name);
  if (errno != 0) return core::fail_errno(errno, "cannot look for recordings in '" + path + "'", kErasureHint);
  std::ranges::sort(names);
  for (const std::string& name : names) {
    if (name == "." || name == "..") continue;
    if (!is_wanted_()) return core::fail(ErrorCode::Failed, "dtsd is stopping: it continues the erasure when it starts again");
    DTS_TRY(remove_entry(folder, path, name, depth));
  }
  if (erased_.files > 0) static_cast<void>(::fsync(folder));
  return {};
}

core::Status Remover::remove_entry(int folder, const std::string& path, const std::string& name, int depth) {
  struct stat facts {};
  struct stat index_facts {};
  if (::fstatat(folder, name.c_str(), &facts, AT_SYMLINK_NOFOLLOW) != 0) return {};  // it is gone
  if (S_ISDIR(facts.st_mode)) {
    Descriptor inner(::openat(folder, name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (depth == kDeepest || inner.get() < 0) {
      erased_.left.push_back("folder '" + path + "/" + name + "' could not be searched");
      return {};
    }
    return remove_in(inner.release(), path + "/" + name, depth + 1);
  }
  if (S_ISREG(facts.st_mode) && (is_named(name) || is_recording_of(folder, name))) {
    if (facts.st_nlink > 1) erased_.left.push_back("'" + path + "/" + name + "' has another name (a hard link), which may be elsewhere");
    if (!is_named(name)) {  // its index has the same other name
      const std::string index = name.substr(0, name.size() - (name.ends_with(".part") ? 5 : 0)) + ".idx";
      if (::fstatat(folder, index.c_str(), &index_facts, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(index_facts.st_mode)) {
        DTS_TRY(unlink(folder, path, index, static_cast<std::uint64_t>(index_facts.st_size)));
      }
    }
    return unlink(folder, path, name, static_cast<std::uint64_t>(facts.st_size));
  }
  if (S_ISLNK(facts.st_mode) && is_named(name)) {
    erased_.left.push_back("'" + path + "/" + name + "' was a link; the file that it named is not removed");
    return unlink(folder, path, name, 0);
  }
  return {};
}

core::Status Remover::unlink(int folder, const std::string& path, const std::string& name, std::uint64_t bytes) {
  if (::unlinkat(folder, name.c_str(), 0) != 0 && errno != ENOENT) {
    return core::fail_errno(errno, "cannot remove '" + path + "/" + name + "'", kErasureHint);
  }
  ++erased_.files;
  erased_.bytes += bytes;
  return {};
}

/// Reads the header of a recording with any name.
bool Remover::is_recording_of(int folder, const std::string& name) const {
  if (!name.ends_with(".xdf") && !name.ends_with(".part")) return false;
  const Descriptor file(::openat(folder, name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.get() < 0) return false;
  const auto facts = read_session_facts("/proc/self/fd/" + std::to_string(file.get()));  // this file, whatever its name is now
  return facts && std::ranges::find(sessions_, facts->session_id) != sessions_.end();
}

}  // namespace

core::Result<std::optional<Erasure>> read_erasure(const std::string& state_folder) {
  const std::string file = journal_of(state_folder);
  if (struct stat facts{}; ::stat(file.c_str(), &facts) != 0) {
    if (errno == ENOENT) return std::optional<Erasure>();
    return core::fail_errno(errno, "cannot read '" + file + "'", kErasureHint);
  }
  std::ifstream stream(file, std::ios::binary);
  const Json json = Json::parse(std::istreambuf_iterator<char>(stream), {}, nullptr, false);
  const auto is_text = [&json](const char* key) { return json.contains(key) && json[key].is_string(); };
  const bool is_good = json.is_object() && is_text("subject") && is_text("who") && json.contains("utc_ns") &&
                       json["utc_ns"].is_number_integer() && json.contains("sessions") && json["sessions"].is_array() &&
                       std::ranges::all_of(json["sessions"], [](const Json& id) { return id.is_string(); });
  if (!is_good || json["subject"].get<std::string>().empty()) {
    return core::fail(ErrorCode::DataDamaged, "'" + file + "', which describes an erasure that was interrupted, is damaged",
                      "remove this file, then erase the subject again: dtsctl subject erase ID");
  }
  Erasure erasure{.subject = json["subject"], .who = json["who"], .utc_ns = json["utc_ns"], .sessions = json["sessions"]};
  return std::optional(std::move(erasure));
}

core::Status write_erasure(const std::string& state_folder, const Erasure& erasure) {
  const Json json{{"subject", erasure.subject}, {"who", erasure.who}, {"utc_ns", erasure.utc_ns}, {"sessions", erasure.sessions}};
  return replace_file(journal_of(state_folder), json.dump(1) + "\n", 0600);
}

core::Status remove_erasure(const std::string& state_folder) {
  const std::string file = journal_of(state_folder);
  if (::unlink(file.c_str()) != 0 && errno != ENOENT) return core::fail_errno(errno, "cannot remove '" + file + "'", kErasureHint);
  synchronise_folder(state_folder);
  return {};
}

core::Result<Erased> remove_session_files(const std::string& folder, const std::vector<std::string>& sessions,
                                          const std::function<bool()>& is_wanted) {
  const int root = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (root < 0) return core::fail_errno(errno, "cannot look for recordings in '" + folder + "'", kErasureHint);
  Remover remover(sessions, is_wanted);
  DTS_TRY(remover.remove_in(root, folder, 0));
  return remover.take_result();
}

std::optional<std::string> without_mention(const std::string& text, const std::string& subject) {
  std::string changed = text;
  bool is_found = false;
  for (std::size_t at = changed.find(subject); !subject.empty() && at != std::string::npos; at = changed.find(subject, at)) {
    const bool stands_alone = !continues_before(changed, at) && !continues_after(changed, at + subject.size());
    if (stands_alone) changed.replace(at, subject.size(), kErasedText);
    is_found = is_found || stands_alone;
    at += stands_alone ? kErasedText.size() : 1;
  }
  if (!is_found) return std::nullopt;
  if (changed.size() > kLongestCorrectionText) {
    std::size_t end = kLongestCorrectionText;
    while (end > 0 && !core::starts_character(changed[end])) --end;
    changed.resize(end);
  }
  return changed;
}

}  // namespace dts::record

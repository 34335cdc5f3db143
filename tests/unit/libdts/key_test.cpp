// SPDX-License-Identifier: Apache-2.0
#include "dts/key.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "unit/libdts/fake_daemon.h"

namespace dts::client {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class KeyFile : public ::testing::Test {
 protected:
  KeyFile() {
    key_.server_public_key = new_key("dtsd")->public_key;
    key_.control = "tcp://ward:5555";
    key_.data = "tcp://ward:5556";
  }
  void write(const std::string& text, fs::perms mode = fs::perms(0600)) const {
    std::ofstream(file_) << text;
    fs::permissions(file_, mode);
  }

  testing::TemporaryDirectory directory_;
  std::string file_ = (directory_.path() / "ward.key").string();
  Key key_ = new_key("ward-3").value();
};

TEST_F(KeyFile, Written_ReadsBackAndIsForItsOwnerOnlyAndNeverReplaced) {
  ASSERT_TRUE(write_new_key(file_, key_));

  const auto read = read_key(file_);

  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(std::tie(read->name, read->public_key, read->secret_key, read->server_public_key, read->control, read->data),
            std::tie(key_.name, key_.public_key, key_.secret_key, key_.server_public_key, key_.control, key_.data));
  EXPECT_NE(key_.public_key, new_key("ward-3")->public_key);
  EXPECT_EQ(fs::status(file_).permissions(), fs::perms(0600));
  EXPECT_EQ(write_new_key(file_, *new_key("other")).error(),
            (Error{ErrorCode::WrongState, file_ + " already exists", "give another name: --out FILE"}));
  EXPECT_EQ(read_key(file_)->secret_key, key_.secret_key);
  const auto nowhere = write_new_key("/nonexistent/a.key", key_);
  EXPECT_EQ(nowhere.error().code, ErrorCode::Failed);
  EXPECT_THAT(nowhere.error().what, HasSubstr("/nonexistent/a.key: No such file or directory"));
}

TEST_F(KeyFile, OpenToOthers_IsRefused) {
  for (const unsigned mode : {0610U, 0604U, 0640U, 0620U, 0601U}) {
    write(key_text(key_), fs::perms(mode));
    EXPECT_EQ(read_key(file_).error(),
              (Error{ErrorCode::NotAllowed, "key file " + file_ + " is readable or writable by other users: its secret is not protected",
                     "chmod 0600 " + file_}))
        << mode;
  }
}

TEST_F(KeyFile, ThatIsNone_IsRefusedWithTheReason) {
  std::string longest = key_text(key_) + "# ";
  longest.append(4096 - longest.size(), 'x');
  write(longest);
  EXPECT_TRUE(read_key(file_)) << "4096 bytes";
  Key no_z85 = key_;
  no_z85.secret_key[7] = '~';
  Key short_key = key_;
  short_key.server_public_key.pop_back();
  const std::string hint = "use an unchanged file from dtsctl key new";
  for (const auto& [text, what, try_this] : {std::tuple(longest + "x", "key file " + file_ + " is too large for a key file", std::string()),
                                             {"", "key file " + file_ + " is empty or cannot be read", ""},
                                             {"name = \"a\"\nb = = 1\n", file_ + ":2:5: not a key file", hint},
                                             {"name = 1\n", file_ + ": public_key is not a key of 40 characters", hint},
                                             {key_text(no_z85), file_ + ": secret_key is not a key of 40 characters", hint},
                                             {key_text(short_key), file_ + ": server_public_key is not a key of 40 characters", hint}}) {
    write(text);
    EXPECT_EQ(read_key(file_).error(), (Error{ErrorCode::InvalidArgument, what, try_this}));
  }
  fs::remove(file_);
  EXPECT_EQ(read_key(file_).error(), (Error{ErrorCode::InvalidArgument, "key file " + file_ + ": No such file or directory",
                                            "make a key on the daemon's machine: dtsctl key new"}));
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  EXPECT_EQ(read_key(file_).error().what, "key file " + file_ + " is not a regular file") << "a pipe would be waited for";
}

}  // namespace
}  // namespace dts::client

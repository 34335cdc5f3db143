// SPDX-License-Identifier: Apache-2.0
#include "access/key_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "key_fixture.h"

namespace dts::access {
namespace {

using core::ErrorCode;
using ::testing::HasSubstr;
using ::testing::Not;

using KeyStoreTest = KeyFixture;

TEST_F(KeyStoreTest, FirstOpening_MakesAPairForTheOwnerOnly) {
  EXPECT_EQ(mode_of(directory()), 0700U);
  EXPECT_EQ(mode_of(directory() + "/server.toml"), 0600U);
  EXPECT_TRUE(is_public_key(store_->server().public_key));
  EXPECT_TRUE(store_->keys().empty());
}

TEST_F(KeyStoreTest, AnotherOpening_HasTheSamePairAndKeys) {
  ASSERT_TRUE(store_->add(key_for("anna", v1::ROLE_OPERATOR)));
  const auto again = KeyStore::open(directory());

  ASSERT_TRUE(again.has_value());
  EXPECT_EQ((*again)->server().secret_key, store_->server().secret_key);
  EXPECT_EQ((*again)->keys(), store_->keys());
  EXPECT_EQ(mode_of(client_file()), 0600U);
}

TEST_F(KeyStoreTest, AKeyIsFoundByItsBytesAndItsName) {
  const ClientKey anna = key_for("anna", v1::ROLE_VIEWER);
  ASSERT_TRUE(store_->add(anna));

  EXPECT_EQ(store_->find_by_key(bytes_of(anna.public_key)), anna);
  EXPECT_EQ(store_->find_by_public_key(anna.public_key), anna);
  EXPECT_FALSE(store_->find_by_key(bytes_of(new_pair().public_key)));
  EXPECT_FALSE(store_->find_by_key(std::array<std::uint8_t, 3>{}));
}

TEST_F(KeyStoreTest, NamesAndKeysAreUnique) {
  const ClientKey anna = key_for("anna", v1::ROLE_VIEWER);
  ASSERT_TRUE(store_->add(anna));
  ClientKey same_key = anna;
  same_key.name = "bert";

  EXPECT_EQ(store_->add(key_for("anna", v1::ROLE_ENGINEER)).error().code, ErrorCode::WrongState);
  EXPECT_EQ(store_->add(same_key).error().code, ErrorCode::WrongState);
  EXPECT_EQ(store_->keys().size(), 1U);
}

TEST_F(KeyStoreTest, WhatCannotBeAKeyIsRefused) {
  for (const std::string& name :
       {std::string(), std::string("local"), std::string("Anna"), std::string("a b"), std::string("a/b"), std::string(33, 'a')}) {
    EXPECT_EQ(store_->add(key_for(name, v1::ROLE_VIEWER)).error().code, ErrorCode::InvalidArgument) << name;
  }
  EXPECT_EQ(store_->add(key_for("anna", v1::ROLE_UNSPECIFIED)).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(store_->add(key_for("anna", static_cast<v1::Role>(17))).error().code, ErrorCode::InvalidArgument);
  for (const std::string& key :
       {std::string(), std::string(39, 'a'), std::string(40, '"'), std::string(40, '\0'), std::string(1000, 'a')}) {
    EXPECT_EQ(core::to_string(store_->add(key_for("anna", v1::ROLE_VIEWER, {key, ""})).error()),
              "the public key is not valid (make a new pair: dtsctl key new)");
  }
  EXPECT_TRUE(store_->keys().empty());
  EXPECT_TRUE(store_->add(key_for("0123456789abcdefghijklmnopqrst.-", v1::ROLE_VIEWER)));
}

TEST_F(KeyStoreTest, RevokedIsGone_AlsoFromTheFile) {
  const ClientKey anna = key_for("anna", v1::ROLE_VIEWER);
  ASSERT_TRUE(store_->add(anna));
  ASSERT_TRUE(store_->revoke("anna"));

  EXPECT_FALSE(store_->find_by_key(bytes_of(anna.public_key)));
  EXPECT_THAT(text_of(client_file()), Not(HasSubstr(anna.public_key)));
  EXPECT_EQ(store_->revoke("anna").error().code, ErrorCode::NotFound);
}

TEST_F(KeyStoreTest, Reload_TellsWhetherSomebodyLostSomething) {
  const ClientKey anna = key_for("anna", v1::ROLE_OPERATOR);
  const ClientKey bert = key_for("bert", v1::ROLE_VIEWER);
  ClientKey less = anna;
  less.role = v1::ROLE_VIEWER;

  const auto has_losses_with = [&](const std::vector<ClientKey>& keys) {
    write(client_file(), client_keys_text(keys));
    EXPECT_TRUE(store_->reload());
    return store_->take_losses();
  };

  EXPECT_FALSE(has_losses_with({anna}));
  EXPECT_FALSE(has_losses_with({anna, bert}));
  EXPECT_TRUE(has_losses_with({less, bert}));
  EXPECT_TRUE(has_losses_with({less}));
  EXPECT_FALSE(store_->take_losses()) << "told once";
  EXPECT_EQ(store_->keys(), std::vector<ClientKey>{less});
}

TEST_F(KeyStoreTest, AChange_StartsFromTheFile_NotFromWhatWasKnown) {
  const ClientKey anna = key_for("anna", v1::ROLE_OPERATOR);
  ASSERT_TRUE(store_->add(anna));
  write(client_file(), "# taken out by hand\n");

  ASSERT_TRUE(store_->add(key_for("bert", v1::ROLE_VIEWER)));

  EXPECT_FALSE(store_->find_by_public_key(anna.public_key));
  EXPECT_TRUE(store_->take_losses());
}

TEST_F(KeyStoreTest, AThousandKeysAreTheMost) {
  std::vector<ClientKey> keys;
  while (keys.size() < 999) {
    std::string name = std::to_string(keys.size());
    keys.push_back(key_for(name, v1::ROLE_VIEWER, {std::string(40 - name.size(), 'a') + name, ""}));
  }
  write(client_file(), client_keys_text(keys));
  EXPECT_TRUE(store_->add(key_for("last", v1::ROLE_VIEWER)));
  EXPECT_EQ(store_->add(key_for("more", v1::ROLE_VIEWER)).error().code, ErrorCode::LimitExceeded);
  EXPECT_EQ(store_->keys().size(), 1000U);

  keys = store_->keys();
  keys.push_back(key_for("more", v1::ROLE_VIEWER));
  write(client_file(), client_keys_text(keys));
  EXPECT_THAT(store_->reload().error().what, HasSubstr("at most 1000 clients"));
}

TEST_F(KeyStoreTest, AFileThatIsWrong_SaysWhereAndWhat) {
  const std::string key = "public_key = \"" + std::string(40, 'a') + "\"\n";
  const std::string anna = "[[client]]\nname = \"anna\"\nrole = \"viewer\"\n" + key;
  const struct {
    std::string text, where, what;
  } rows[]{
      {"[[client]]\n", ":1:", "name"},
      {"[[client]]\nname = \"Anna\"\nrole = \"viewer\"\n" + key, ":2:", "a key's name has 1..32"},
      {"[[client]]\nname = \"anna\"\nrole = \"viewer\"\npublic_key = \"x\"\n", ":4:", "a public key has 40 characters"},
      {anna + "colour = 1\n", ":5:", "colour"},
      {"colour = 1\n" + anna, ":1:", "colour"},
      {anna + "[[client]]\nname = \"bert\"\nrole = \"viewer\"\n" + key, ":8:", "another client has the same public key"},
      {anna + "[[client]]\nname = \"anna\"\nrole = \"viewer\"\npublic_key = \"" + std::string(40, 'b') + "\"\n",
       ":6:", "another client is named 'anna'"},
  };
  for (const auto& row : rows) {
    write(client_file(), row.text);
    const auto reloaded = store_->reload();
    ASSERT_FALSE(reloaded) << row.text;
    EXPECT_THAT(reloaded.error().what, HasSubstr("clients.toml" + row.where));
    EXPECT_THAT(reloaded.error().what, HasSubstr(row.what));
  }
}

TEST_F(KeyStoreTest, ReloadOfADamagedFile_KeepsWhatItKnewAndSaysWhere) {
  const ClientKey anna = key_for("anna", v1::ROLE_OPERATOR);
  ASSERT_TRUE(store_->add(anna));
  write(client_file(), "[[client]]\nname = \"anna\"\nrole = \"king\"\npublic_key = \"x\"\n");

  const auto reloaded = store_->reload();

  ASSERT_FALSE(reloaded.has_value());
  EXPECT_THAT(reloaded.error().what, HasSubstr("clients.toml:3:"));
  EXPECT_EQ(store_->find_by_public_key(anna.public_key), anna);
}

TEST_F(KeyStoreTest, ADamagedServerKeyIsNotReplaced) {
  const std::string damaged = "public_key = \"" + store_->server().public_key + "\"\nsecret_key = \"" + new_pair().secret_key + "\"\n";
  write(directory() + "/server.toml", damaged);

  const auto opened = KeyStore::open(directory());

  ASSERT_FALSE(opened.has_value());
  EXPECT_THAT(opened.error().what, HasSubstr("server.toml"));
  EXPECT_THAT(opened.error().what, Not(HasSubstr("secret_key =")));
  EXPECT_EQ(text_of(directory() + "/server.toml"), damaged);
}

TEST_F(KeyStoreTest, AFolderOfOthersOrOpenToThemIsRefused) {
  ASSERT_EQ(::chmod(directory().c_str(), 0750), 0);

  EXPECT_EQ(core::to_string(KeyStore::open(directory()).error()),
            "key folder " + directory() + " is accessible to other users (chmod 0700 " + directory() + ")");
  if (::geteuid() != 0 || ::chown(directory().c_str(), 65534, 65534) != 0) return;
  EXPECT_EQ(core::to_string(KeyStore::open(directory()).error()),
            "key folder " + directory() + " belongs to another user (change its owner with chown to the user that runs dtsd)");
}

}  // namespace
}  // namespace dts::access

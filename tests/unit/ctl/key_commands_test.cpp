// SPDX-License-Identifier: Apache-2.0
#include "ctl/key_commands.h"

#include <filesystem>

#include "dts/key.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

class KeyNewTest : public RunTest {
 protected:
  KeyNewTest() { console_.is_talk_terminal = true; }
  int make_key(const std::string& role, const std::vector<std::string>& further = {}) {
    std::vector<std::string> words{"key", "new", "ward-3", "--role", role, "--out", file_};
    words.insert(words.end(), further.begin(), further.end());
    return run_with(words);
  }
  std::vector<std::string> answer(const v1::Request& request) {
    return {testing::reply(request, [&](v1::Response& response) {
      if (request.has_add_key()) added_ = request.add_key();
      if (request.has_add_key() && refusal_ != v1::ERROR_CODE_UNSPECIFIED) {
        response.mutable_error()->set_code(refusal_);
        response.mutable_error()->set_what("no");
        return;
      }
      response.mutable_keys()->set_server_public_key(std::string(40, 'x'));
      response.mutable_keys()->set_control_endpoint("tcp://*:5555");
      response.mutable_keys()->set_data_endpoint("tcp://192.0.2.7:5556");
    })};
  }

  std::string file_ = directory_.path() / "ward-3.key";
  v1::AddKeyRequest added_;
  v1::ErrorCode refusal_ = v1::ERROR_CODE_UNSPECIFIED;
  testing::FakeController daemon_{control_, [this](const v1::Request& request, int) { return answer(request); }};
};

TEST_F(KeyNewTest, File_HasWhatTheOtherMachineNeeds) {
  for (const auto& [word, role] :
       {std::pair("viewer", v1::ROLE_VIEWER), {"operator", v1::ROLE_OPERATOR}, {"engineer", v1::ROLE_ENGINEER}}) {
    std::filesystem::remove(file_);
    EXPECT_EQ(make_key(word, {"--host", "dts.clinic"}), cli::kOk);
    EXPECT_EQ(out(), file_ + "\n");
    EXPECT_EQ(talk(), "copy it to the other machine, delete it here, then run on the other machine: dtsctl --key " + file_ + " status\n");
    const auto key = client::read_key(file_);
    ASSERT_TRUE(key) << key.error().what;
    EXPECT_EQ(key->name, "ward-3");
    EXPECT_EQ(key->control, "tcp://dts.clinic:5555");
    EXPECT_EQ(key->data, "tcp://192.0.2.7:5556");
    EXPECT_EQ(key->server_public_key, std::string(40, 'x'));
    EXPECT_EQ(added_.name(), "ward-3");
    EXPECT_EQ(added_.role(), role);
    EXPECT_EQ(added_.public_key(), key->public_key);
  }
  EXPECT_EQ(make_key("viewer"), 6) << "never over another: " << out() << talk();
  std::filesystem::remove(file_);
  EXPECT_EQ(make_key("viewer", {"--json"}), cli::kOk);
  EXPECT_EQ(json(), (nlohmann::json{{"name", "ward-3"}, {"role", "viewer"}, {"file", file_}, {"public_key", added_.public_key()}}));
  EXPECT_EQ(talk(), "");
}

TEST_F(KeyNewTest, RefusedKey_LeavesAFileOnlyIfTheAnswerWasLost) {
  for (const auto& [code, stays] : {std::pair(v1::ERROR_CODE_WRONG_STATE, false), {v1::ERROR_CODE_UNREACHABLE, true}}) {
    refusal_ = code;
    EXPECT_EQ(make_key("viewer"), static_cast<int>(code));
    EXPECT_EQ(talk(), "dtsctl: no\n");
    EXPECT_EQ(std::filesystem::exists(file_), stays);
  }
}

TEST(Dialled, EveryAddressOfTheDaemon_BecomesItsHost) {
  EXPECT_EQ(dialled("tcp://*:5555", "host"), "tcp://host:5555");
  EXPECT_EQ(dialled("tcp://0.0.0.0:5555", "host"), "tcp://host:5555");
  EXPECT_EQ(dialled("tcp://[::]:5555", "host"), "tcp://host:5555");
  EXPECT_EQ(dialled("tcp://192.0.2.7:5555", "host"), "tcp://192.0.2.7:5555");
}

}  // namespace
}  // namespace dts::ctl

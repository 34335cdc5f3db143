// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/audit_trail.h"

#include <gmock/gmock.h>
#include <sodium.h>

#include <array>
#include <fstream>

#include "unit/record/catalogue/catalogue_fixture.h"

namespace dts::record {
namespace {

using catalogue_test::code;
using catalogue_test::what;
using testing::HasSubstr;

class Audit : public catalogue_test::CatalogueFixture {
 protected:
  void append(int count) {
    for (int index = 0; index < count; ++index) {
      ASSERT_TRUE(catalogue().append_audit({.utc_ns = 1000 + index, .who = "local", .what = "mark", .target = "floor", .result = "ok"}));
    }
  }
  /// Past the triggers, as somebody with the file can.
  [[nodiscard]] bool tamper(const std::string& sql) const {
    return meddle("DROP TRIGGER audit_is_not_changed; DROP TRIGGER audit_is_not_deleted; DROP TRIGGER audit_is_only_continued;" + sql);
  }
  [[nodiscard]] std::string second() const { return path("catalogue.sqlite.audit"); }
  [[nodiscard]] std::string second_text() const {
    std::ifstream file(second());
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
};

std::string sha256(const std::string& bytes) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
  crypto_hash_sha256(digest.data(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  std::array<char, 65> letters{};
  sodium_bin2hex(letters.data(), letters.size(), digest.data(), digest.size());
  return letters.data();
}

TEST_F(Audit, Hash_IsOverTheDocumentedBytes) {
  const auto field = [](const std::string& text) { return std::string(1, static_cast<char>(text.size())) + std::string(7, '\0') + text; };
  const AuditEntry entry{.number = 12, .utc_ns = -3, .who = "local", .what = "start_session", .target = "", .result = "ok"};
  const std::string before(64, 'a');
  EXPECT_EQ(audit_hash(before, entry),
            sha256(before + field("12") + field("-3") + field("local") + field("start_session") + field("") + field("ok")));
}

TEST_F(Audit, TextMovedToTheNextField_HasAnotherHash) {
  EXPECT_NE(audit_hash("", {.who = "a", .what = "bc"}), audit_hash("", {.who = "ab", .what = "c"}));
}

TEST_F(Audit, Empty_IsSound) {
  EXPECT_EQ(catalogue().verify_audit().value_or(99), 0U);
  EXPECT_TRUE(catalogue().audit(10).value().empty());
}

TEST_F(Audit, Entries_AreNumberedChainedAndComeOldestFirst) {
  RecordProperty("requirement", "REC-11");
  append(5);
  const auto entries = catalogue().audit(3);
  ASSERT_TRUE(entries);
  ASSERT_EQ(entries->size(), 3U);
  EXPECT_EQ(entries->at(0).number, 3U);
  EXPECT_EQ(entries->at(2).number, 5U);
  EXPECT_EQ(entries->at(2).hash, audit_hash(entries->at(1).hash, entries->at(2)));
  EXPECT_EQ(catalogue().verify_audit().value_or(0), 5U);
}

TEST_F(Audit, OpenedAgain_GoesOnWithTheChain) {
  append(2);
  close();
  append(2);
  EXPECT_EQ(catalogue().verify_audit().value_or(0), 4U);
}

TEST_F(Audit, Callers_DoNotChooseNumberOrHash) {
  ASSERT_TRUE(catalogue().append_audit({.number = 77, .who = "x", .hash = "mine"}));
  EXPECT_EQ(catalogue().audit(1)->front().number, 1U);
  EXPECT_EQ(catalogue().verify_audit().value_or(0), 1U);
}

TEST_F(Audit, LongText_IsCutAndStillFits) {
  ASSERT_TRUE(catalogue().append_audit({.who = std::string(5000, 'w'), .what = "it's; --", .target = std::string("a\0b", 3)}));
  EXPECT_EQ(catalogue().audit(1)->front().who.size(), 1024U);
  EXPECT_EQ(catalogue().audit(1)->front().target.size(), 3U);
  EXPECT_EQ(catalogue().verify_audit().value_or(0), 1U);
}

TEST_F(Audit, Table_RefusesChangesByMistake) {
  append(3);
  EXPECT_FALSE(meddle("UPDATE audit SET who = 'x'"));
  EXPECT_FALSE(meddle("DELETE FROM audit"));
  EXPECT_FALSE(meddle("DELETE FROM audit WHERE number = 3"));
  EXPECT_FALSE(meddle("INSERT OR REPLACE INTO audit VALUES (2, 0, '', '', '', '', '')"));
  EXPECT_FALSE(meddle("INSERT INTO audit VALUES (9, 0, '', '', '', '', '')"));
  EXPECT_EQ(catalogue().verify_audit().value_or(0), 3U);
}

struct Tampering {
  const char* name;
  const char* sql;
  const char* told;
};
class AuditTampered : public Audit, public testing::WithParamInterface<Tampering> {};

TEST_P(AuditTampered, Verify_NamesTheFirstEntryThatDoesNotFit) {
  RecordProperty("requirement", "REC-11");
  append(5);
  close();
  ASSERT_TRUE(tamper(GetParam().sql));
  const auto verified = catalogue().verify_audit();
  EXPECT_EQ(code(verified), core::ErrorCode::DataDamaged);
  EXPECT_THAT(what(verified), HasSubstr(GetParam().told));
}

INSTANTIATE_TEST_SUITE_P(
    Each, AuditTampered,
    testing::Values(Tampering{"who", "UPDATE audit SET who = 'other' WHERE number = 3", "entry 3 does not fit"},
                    Tampering{"time", "UPDATE audit SET utc_ns = 1 WHERE number = 1", "entry 1 does not fit"},
                    Tampering{"result", "UPDATE audit SET result = 'failed' WHERE number = 5", "entry 5 does not fit"},
                    Tampering{"hash", "UPDATE audit SET hash = '' WHERE number = 4", "entry 4 does not fit"},
                    Tampering{"removed", "DELETE FROM audit WHERE number = 2", "entry 2 is missing"},
                    Tampering{"removed_first", "DELETE FROM audit WHERE number = 1", "entry 1 is missing"},
                    Tampering{"renumbered", "DELETE FROM audit WHERE number = 2; UPDATE audit SET number = number - 1 WHERE number > 2",
                              "entry 2 does not fit"},
                    Tampering{"swapped",
                              "UPDATE audit SET number = 9 WHERE number = 2; UPDATE audit SET number = 2 WHERE number = 3;"
                              "UPDATE audit SET number = 3 WHERE number = 9",
                              "entry 2 does not fit"},
                    Tampering{"put_in", "INSERT INTO audit VALUES (6, 1, 'a', 'b', 'c', 'd', 'e')", "entry 6 does not fit"},
                    Tampering{"put_before", "INSERT INTO audit VALUES (0, 1, 'a', 'b', 'c', 'd', 'e')", "entry 1 is missing"},
                    Tampering{"newest_cut_off", "DELETE FROM audit WHERE number = 5", "entry 5 was cut off"},
                    Tampering{"all_cut_off", "DELETE FROM audit", "entry 1 was cut off"}),
    [](const auto& tampering) { return tampering.param.name; });

TEST_F(Audit, OlderCatalogueThatGoesOn_ShowsByTheSecondTrail) {
  append(3);
  close();
  std::filesystem::copy_file(path(), path("backup"));
  append(2);
  close();
  std::filesystem::rename(path("backup"), path());
  EXPECT_THAT(what(catalogue().verify_audit()), HasSubstr("entry 4 was cut off"));
  ASSERT_TRUE(catalogue().append_audit({.who = "somebody"}));
  EXPECT_THAT(what(catalogue().verify_audit()), HasSubstr("entry 4 is another"));
}

TEST_F(Audit, SecondTrail_MayLackLinesAndHoldTornOnes) {
  append(3);
  const std::string text = second_text();
  std::ofstream(second()) << text.substr(67, 40) << "\n\nnoise " << std::string(500, 'x') << "\n99999999999999999999 "
                          << std::string(64, 'a') << "\n"
                          << text.substr(134) << "3 abc";
  EXPECT_EQ(catalogue().verify_audit().value_or(0), 3U);
}

TEST_F(Audit, SecondTrailChanged_Shows) {
  append(3);
  std::string text = second_text();
  ASSERT_EQ(text.size(), 3U * 67U);
  text[67 + 10] = text[67 + 10] == 'a' ? 'b' : 'a';
  std::ofstream(second()) << text;
  EXPECT_THAT(what(catalogue().verify_audit()), HasSubstr("entry 2 is another"));
}

TEST_F(Audit, SecondTrailGone_Shows) {
  append(2);
  std::filesystem::remove(second());
  EXPECT_THAT(what(catalogue().verify_audit()), HasSubstr("is gone"));
}

TEST_F(Audit, SecondTrailCannotBeWritten_IsToldAndTheEntryStands) {
  std::filesystem::create_directory(second());
  const auto appended = catalogue().append_audit({.who = "local"});
  EXPECT_THAT(what(appended), HasSubstr("audit entry 1 is in the catalogue, but was not written to"));
  EXPECT_EQ(catalogue().audit(10)->size(), 1U);
}

}  // namespace
}  // namespace dts::record

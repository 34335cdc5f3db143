// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/report_shelf.h"

#include <gtest/gtest.h>

namespace dts::gateway {
namespace {

ReportPointer report_of(std::size_t bytes) {
  return std::make_shared<const report::Report>(report::Report{
      .session_id = {},
      .pages = {{.file = "a", .text = std::string(bytes / 2, 'x')}, {.file = "b", .text = std::string(bytes - bytes / 2, 'x')}}});
}

TEST(ReportShelf, OfTooManyTheOneNotAskedForLongestGoes) {
  ReportShelf shelf(1000);
  shelf.keep("a", report_of(400));
  shelf.keep("b", report_of(400));
  EXPECT_NE(shelf.find("a"), nullptr);

  shelf.keep("c", report_of(400));

  EXPECT_NE(shelf.find("a"), nullptr);
  EXPECT_EQ(shelf.find("b"), nullptr);
  EXPECT_NE(shelf.find("c"), nullptr);
}

TEST(ReportShelf, FitsToTheByteAndWhatNeverFitsPushesNothingOut) {
  ReportShelf shelf(1000);

  shelf.keep("a", report_of(500));
  shelf.keep("b", report_of(500));
  shelf.keep("c", report_of(1001));

  EXPECT_NE(shelf.find("a"), nullptr);
  EXPECT_NE(shelf.find("b"), nullptr);
  EXPECT_EQ(shelf.find("c"), nullptr);
  const ReportPointer largest = report_of(1000);
  shelf.keep("d", largest);
  EXPECT_EQ(shelf.find("d"), largest);
  EXPECT_EQ(shelf.find("a"), nullptr);
}

}  // namespace
}  // namespace dts::gateway

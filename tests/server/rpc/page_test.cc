#include "server/rpc/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/violation_lines.h"

namespace gelenk::server {
namespace {

TEST(PageTest, HasASizeWithinBounds) {
  EXPECT_EQ(PageSize(0).value(), 50);
  EXPECT_EQ(PageSize(1).value(), 1);
  EXPECT_EQ(PageSize(1000).value(), 1000);
  EXPECT_EQ(PageSize(1001).value(), 1000);
  EXPECT_THAT(gelenk::testing::ViolationLines(PageSize(-1).status()),
              ::testing::ElementsAre("page_size: want 0 or more, got -1"));
}

}  // namespace
}  // namespace gelenk::server

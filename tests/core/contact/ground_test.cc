#include "gelenk/contact/ground.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

TEST(HeightFieldTest, IsBilinearBetweenNodesAndFlatBeyond) {
  Eigen::MatrixXd heights(2, 3);
  heights << 0, 1, 2,  //
      10, 11, 12;
  const auto field = HeightField::Create(heights, 1, -1, 0.5);
  ASSERT_TRUE(field.ok()) << field.status();
  const Ground& ground = **field;
  EXPECT_DOUBLE_EQ(ground.HeightAt(1, -1), 0);
  EXPECT_DOUBLE_EQ(ground.HeightAt(1.5, 0), 12);
  EXPECT_DOUBLE_EQ(ground.HeightAt(1.25, -0.75), 5.5);
  EXPECT_DOUBLE_EQ(ground.HeightAt(-100, 100), 2);
  EXPECT_DOUBLE_EQ(ground.HeightAt(100, -100), 10);
}

TEST(HeightFieldTest, NamesWhatIsWrong) {
  using testing::Fails;
  const double infinity = std::numeric_limits<double>::infinity();
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  const Eigen::MatrixXd flat = Eigen::MatrixXd::Zero(2, 2);
  EXPECT_THAT(HeightField::Create(flat, 0, 0, 0).status(),
              Fails(kInvalid, "spacing_m"));
  EXPECT_THAT(HeightField::Create(flat, infinity, 0, 1).status(),
              Fails(kInvalid, "origin"));
  EXPECT_THAT(
      HeightField::Create(Eigen::MatrixXd::Zero(1, 2), 0, 0, 1).status(),
      Fails(kInvalid, "heights_m"));
  EXPECT_THAT(
      HeightField::Create(Eigen::MatrixXd::Constant(2, 2, infinity), 0, 0, 1)
          .status(),
      Fails(kInvalid, "heights_m"));
}

}  // namespace
}  // namespace gelenk

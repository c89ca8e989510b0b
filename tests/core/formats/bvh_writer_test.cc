#include "gelenk/formats/bvh_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include "absl/strings/str_cat.h"
#include "gelenk/formats/bvh_reader.h"

namespace gelenk {
namespace {

// As the writer writes it.
constexpr char kTree[] =
    "HIERARCHY\n"
    "ROOT Hips\n"
    "{\n"
    "\tOFFSET 0 -0 1e-05\n"
    "\tCHANNELS 4 Yposition Zrotation Xrotation Zrotation\n"
    "\tJOINT L Foot\n"
    "\t{\n"
    "\t\tOFFSET 0.1 0 0\n"
    "\t\tCHANNELS 0\n"
    "\t\tEnd Site\n"
    "\t\t{\n"
    "\t\t\tOFFSET 0 0 3\n"
    "\t\t}\n"
    "\t\tEnd Site heel\n"
    "\t\t{\n"
    "\t\t\tOFFSET 0 0 -1\n"
    "\t\t}\n"
    "\t}\n"
    "\tJOINT R Foot\n"
    "\t{\n"
    "\t\tOFFSET -0.1 0 0\n"
    "\t\tCHANNELS 1 Yrotation\n"
    "\t}\n"
    "}\n"
    "MOTION\n"
    "Frames: 2\n"
    "Frame Time: .00833330\n"
    "0.1 -0 359.99999999999994 1 2\n"
    "-123456789.125 5e-324 0.30000000000000004 0 0\n";

TEST(BvhWriterTest, WritesWhatItReads) {
  const absl::StatusOr<BvhDocument> document = ReadBvh(kTree);
  ASSERT_TRUE(document.ok()) << document.status();
  EXPECT_EQ(WriteBvh(*document), kTree);
}

TEST(BvhWriterTest, ADifferentFrameTimeReplacesTheText) {
  absl::StatusOr<BvhDocument> document = ReadBvh(kTree);
  ASSERT_TRUE(document.ok()) << document.status();
  document->frame_time_s = 1.0 / 30;
  EXPECT_NE(WriteBvh(*document).find("Frame Time: 0.03333333333333333\n"),
            std::string::npos);
  document->frame_time_s = .0083333;
  document->frame_time_text = ".0083333 2";
  EXPECT_NE(WriteBvh(*document).find("Frame Time: 0.0083333\n"),
            std::string::npos);
}

// A random tree, depth first, with random channels and numbers of any size
// that the reader takes.
BvhDocument RandomDocument(std::mt19937& random) {
  const auto below = [&random](int end) {
    return std::uniform_int_distribution<int>(0, end - 1)(random);
  };
  const auto number = [&] {
    const double mantissa = std::uniform_real_distribution<>(-1, 1)(random);
    return std::ldexp(mantissa, below(90) - 60);
  };
  BvhDocument document;
  const int joints = 1 + below(20);
  for (int i = 0; i < joints; ++i) {
    BvhJoint joint;
    joint.name = absl::StrCat("joint ", i);
    // Depth first: the parent is the joint before or one of its ancestors.
    joint.parent = i - 1;
    while (joint.parent > 0 && below(3) == 0) {
      joint.parent = document.joints[joint.parent].parent;
    }
    joint.offset = {number(), number(), number()};
    for (int axis = 0; axis < 3; ++axis) {
      if (below(2)) joint.channels.push_back(static_cast<BvhChannel>(axis));
      if (below(2)) {
        joint.channels.push_back(static_cast<BvhChannel>(3 + below(3)));
      }
    }
    for (int site = below(3); site > 0; --site) {
      joint.end_sites.push_back({below(2) ? "" : absl::StrCat("tip", site),
                                 {number(), number(), number()}});
    }
    document.joints.push_back(joint);
  }
  document.frame_time_s = 1.0 / (1 + below(240));
  document.motion.resize(document.channel_count(), below(5));
  for (double& value : document.motion.reshaped()) value = number();
  return document;
}

bool SameBits(const Eigen::Ref<const Eigen::MatrixXd>& a,
              const Eigen::Ref<const Eigen::MatrixXd>& b) {
  // memcmp may not be given the null pointers of empty matrices.
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         (a.size() == 0 ||
          std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

TEST(BvhWriterTest, RandomDocumentsComeBackBitByBit) {
  std::mt19937 random(7);
  for (int round = 0; round < 500; ++round) {
    const BvhDocument written = RandomDocument(random);
    const absl::StatusOr<BvhDocument> read = ReadBvh(WriteBvh(written));
    ASSERT_TRUE(read.ok()) << read.status();
    ASSERT_EQ(read->joints.size(), written.joints.size());
    for (size_t i = 0; i < read->joints.size(); ++i) {
      const BvhJoint& a = read->joints[i];
      const BvhJoint& b = written.joints[i];
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.parent, b.parent);
      EXPECT_TRUE(SameBits(a.offset, b.offset));
      EXPECT_EQ(a.channels, b.channels);
      ASSERT_EQ(a.end_sites.size(), b.end_sites.size());
      for (size_t k = 0; k < a.end_sites.size(); ++k) {
        EXPECT_EQ(a.end_sites[k].name, b.end_sites[k].name);
        EXPECT_TRUE(SameBits(a.end_sites[k].offset, b.end_sites[k].offset));
      }
    }
    EXPECT_EQ(read->frame_time_s, written.frame_time_s);
    EXPECT_TRUE(SameBits(read->motion, written.motion));
  }
}

}  // namespace
}  // namespace gelenk

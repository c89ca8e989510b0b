#include "gelenk/formats/bvh_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace gelenk {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr char kArm[] = R"(HIERARCHY
ROOT upper
{
  OFFSET 0 1 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT lower
  {
    OFFSET 0.5 0 -2.25
    CHANNELS 1 Yrotation
    End Site
    {
      OFFSET 0 0 3
    }
  }
}
MOTION
Frames: 2
Frame Time: .0083333
1 2 3 4 5 6 7
-1 -2 -3 -4 -5 -6 -7
)";

// A file of one joint, with `body` in its braces and `motion` below.
std::string OneJoint(absl::string_view body, absl::string_view motion = "") {
  return absl::StrCat("HIERARCHY\nROOT a\n{\n", body, "\n}\n", motion);
}

BvhDocument Read(absl::string_view text) {
  absl::StatusOr<BvhDocument> document = ReadBvh(text);
  EXPECT_TRUE(document.ok()) << document.status();
  return document.value_or(BvhDocument());
}

std::string ErrorOf(absl::string_view text, const BvhBounds& bounds = {}) {
  const absl::StatusOr<BvhDocument> document = ReadBvh(text, bounds);
  EXPECT_EQ(document.status().code(), absl::StatusCode::kInvalidArgument);
  return std::string(document.status().message());
}

std::vector<double> Numbers(const BvhDocument& document) {
  const Eigen::MatrixXd& motion = document.motion;
  return {motion.data(), motion.data() + motion.size()};
}

// The same structure and numbers as kArm, whatever the spelling.
void ExpectArm(const BvhDocument& document) {
  ASSERT_THAT(document.joints, SizeIs(2));
  const BvhJoint& upper = document.joints[0];
  const BvhJoint& lower = document.joints[1];
  EXPECT_EQ(upper.name, "upper");
  EXPECT_EQ(upper.parent, -1);
  EXPECT_EQ(upper.offset, Eigen::Vector3d(0, 1, 0));
  EXPECT_THAT(upper.channels,
              ElementsAre(BvhChannel::kXposition, BvhChannel::kYposition,
                          BvhChannel::kZposition, BvhChannel::kZrotation,
                          BvhChannel::kXrotation, BvhChannel::kYrotation));
  EXPECT_THAT(upper.end_sites, IsEmpty());
  EXPECT_EQ(lower.name, "lower");
  EXPECT_EQ(lower.parent, 0);
  EXPECT_EQ(lower.offset, Eigen::Vector3d(0.5, 0, -2.25));
  EXPECT_THAT(lower.channels, ElementsAre(BvhChannel::kYrotation));
  ASSERT_THAT(lower.end_sites, SizeIs(1));
  EXPECT_EQ(lower.end_sites[0].offset, Eigen::Vector3d(0, 0, 3));
  EXPECT_EQ(document.channel_count(), 7);
  EXPECT_EQ(document.frame_count(), 2);
  EXPECT_EQ(document.frame_time_s, .0083333);
  EXPECT_THAT(Numbers(document),
              ElementsAre(1, 2, 3, 4, 5, 6, 7, -1, -2, -3, -4, -5, -6, -7));
}

TEST(BvhReaderTest, ReadsHierarchyAndMotion) {
  const BvhDocument document = Read(kArm);
  ExpectArm(document);
  EXPECT_EQ(document.frame_time_text, ".0083333");
  EXPECT_THAT(document.warnings, IsEmpty());
}

TEST(BvhReaderTest, TakesAnyLineEndAndAByteOrderMark) {
  const std::string lf(kArm);
  const std::string cr_lf = absl::StrReplaceAll(lf, {{"\n", "\r\n"}});
  const std::string cr = absl::StrReplaceAll(lf, {{"\n", "\r"}});
  const std::string mixed =
      absl::StrReplaceAll(lf, {{"{\n", "{\r"}, {"}\n", "}\r\n"}});
  const std::string marked = absl::StrCat("\xEF\xBB\xBF", lf);
  const std::string padded =
      absl::StrCat(lf, "\n \t\r\n", std::string(3, '\0'), "\x1a");
  for (const std::string& text : {cr_lf, cr, mixed, marked, padded}) {
    const BvhDocument document = Read(text);
    ExpectArm(document);
    EXPECT_THAT(document.warnings, IsEmpty());
  }
}

TEST(BvhReaderTest, TakesAnyCaseAndBracesOnAnyLine) {
  const std::string lower =
      absl::StrReplaceAll(kArm, {{"HIERARCHY", "hierarchy"},
                                 {"ROOT", "root"},
                                 {"OFFSET", "Offset"},
                                 {"CHANNELS", "channels"},
                                 {"Xrotation", "XROTATION"},
                                 {"Yrotation", "yrotation"},
                                 {"End Site", "end site"},
                                 {"MOTION", "motion"},
                                 {"Frames", "FRAMES"},
                                 {"Frame Time", "frame time"}});
  ExpectArm(Read(lower));
  ExpectArm(
      Read(absl::StrReplaceAll(kArm, {{"JOINT lower", "JOINT\n lower"}})));
  const std::string glued =
      absl::StrReplaceAll(kArm, {{"upper\n{\n", "upper{"},
                                 {"lower\n  {", "lower {"},
                                 {"Site\n    {\n", "Site{"},
                                 {"3\n    }\n  }\n}\n", "3}}}"}});
  ExpectArm(Read(glued));
}

TEST(BvhReaderTest, TakesMotionHeadersWithAndWithoutBlanks) {
  for (const char* header :
       {"Frames:2\nFrame Time:.0083333\n", "Frames :2\nFrame Time : .0083333\n",
        "Frames 2 Frame Time .0083333\n", "Frames:\t2\nFrameTime:.0083333\n"}) {
    const std::string text = absl::StrReplaceAll(
        kArm, {{"Frames: 2\nFrame Time: .0083333\n", header}});
    ExpectArm(Read(text));
  }
}

TEST(BvhReaderTest, TakesNamesAsTheyAre) {
  for (const char* name : {"Bip01 L Hand", "mixamorig:LeftHand", "Hüfte",
                           "右手", "a.b-c_d|e", "ROOT", "End"}) {
    const BvhDocument document = Read(absl::StrReplaceAll(
        kArm, {{"JOINT lower", absl::StrCat("JOINT \t", name, "  ")}}));
    ASSERT_THAT(document.joints, SizeIs(2));
    EXPECT_EQ(document.joints[1].name, name);
  }
}

TEST(BvhReaderTest, TakesNamesOfEndSitesAndSeveralOfThem) {
  const BvhDocument document =
      Read(OneJoint("OFFSET 0 0 0\nEnd Site tip of a\n{ OFFSET 1 2 3 }\n"
                    "EndSite { offset 4 5 6 channels 0 }"));
  ASSERT_THAT(document.joints, SizeIs(1));
  ASSERT_THAT(document.joints[0].end_sites, SizeIs(2));
  EXPECT_EQ(document.joints[0].end_sites[0].name, "tip of a");
  EXPECT_EQ(document.joints[0].end_sites[1].name, "");
  EXPECT_EQ(document.joints[0].end_sites[1].offset, Eigen::Vector3d(4, 5, 6));
}

TEST(BvhReaderTest, TakesAnyChannels) {
  const BvhDocument document =
      Read(OneJoint("OFFSET 0 0 0\n"
                    "CHANNELS 4 Zrotation Xrotation Zrotation Yposition\n"
                    "JOINT b { OFFSET 0 0 0 CHANNELS 0 }\n"
                    "JOINT c { OFFSET 0 0 0 }\n"
                    "JOINT d { CHANNELS 2 Xposition Xrotation OFFSET 0 0 0 }"));
  ASSERT_THAT(document.joints, SizeIs(4));
  EXPECT_THAT(document.joints[0].channels,
              ElementsAre(BvhChannel::kZrotation, BvhChannel::kXrotation,
                          BvhChannel::kZrotation, BvhChannel::kYposition));
  EXPECT_EQ(document.channel_count(), 6);
}

TEST(BvhReaderTest, ReadsEverySpellingOfANumber) {
  const BvhDocument document =
      Read(OneJoint("OFFSET +.5 -.5 5.\nCHANNELS 3 Xrotation Yrotation "
                    "Zrotation",
                    "MOTION\nFrames: 2\nFrame Time: 1e-3\n"
                    "1e-3 +1E2 -0\n0.1 -123456.7890625 000012\n"));
  EXPECT_EQ(document.joints[0].offset, Eigen::Vector3d(.5, -.5, 5));
  EXPECT_THAT(Numbers(document),
              ElementsAre(1e-3, 100, 0, 0.1, -123456.7890625, 12));
  EXPECT_EQ(document.frame_time_s, 1e-3);
}

TEST(BvhReaderTest, DropsRowsBeyondTheHeader) {
  const BvhDocument document = Read(absl::StrCat(kArm, "9 9 9 9 9 9 9\n"));
  ExpectArm(document);
  EXPECT_THAT(document.warnings,
              ElementsAre("the header says 2 frames, the file has 3: the last "
                          "1 dropped"));
}

TEST(BvhReaderTest, ReadsMotionNumberByNumber) {
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"1 2 3 4", "1 2 3\n4"},
                                                        {"7\n-1", "7 -1"}}) {
    const BvhDocument document = Read(absl::StrReplaceAll(kArm, {{from, to}}));
    ExpectArm(document);
    ASSERT_THAT(document.warnings, SizeIs(1));
    EXPECT_THAT(document.warnings[0], HasSubstr("one frame a line"));
  }
}

TEST(BvhReaderTest, TakesAHierarchyWithoutMotion) {
  const BvhDocument document =
      Read(OneJoint("OFFSET 0 0 0\nCHANNELS 1 "
                    "Xrotation"));
  EXPECT_EQ(document.frame_count(), 0);
  EXPECT_EQ(document.motion.rows(), 1);
  EXPECT_THAT(document.warnings, ElementsAre(HasSubstr("no MOTION")));
}

TEST(BvhReaderTest, TakesFramesWithoutChannels) {
  const BvhDocument document = Read(
      OneJoint("OFFSET 0 0 0", "MOTION\nFrames: 5\nFrame Time: 0.1\n\n\n"));
  EXPECT_EQ(document.frame_count(), 5);
  EXPECT_EQ(document.motion.rows(), 0);
}

TEST(BvhReaderTest, TakesAFrameTimeOfZeroForAStillPose) {
  for (const char* motion : {"MOTION\nFrames: 0\nFrame Time: 0\n",
                             "MOTION\nFrames: 1\nFrame Time: -1\n7\n"}) {
    const BvhDocument document =
        Read(OneJoint("OFFSET 0 0 0\nCHANNELS 1 Xrotation", motion));
    EXPECT_EQ(document.frame_time_s, 1.0 / 30);
    EXPECT_THAT(document.warnings, ElementsAre(HasSubstr("1/30 s")));
  }
}

TEST(BvhReaderTest, RenamesJointsOfTheSameName) {
  const BvhDocument document =
      Read(OneJoint("OFFSET 0 0 0\nJOINT a { OFFSET 0 0 0\nJOINT a\n{\n"
                    "OFFSET 0 0 0 } }"));
  ASSERT_THAT(document.joints, SizeIs(3));
  EXPECT_EQ(document.joints[1].name, "a#2");
  EXPECT_EQ(document.joints[2].name, "a#3");
  EXPECT_THAT(
      document.warnings,
      ElementsAre("line 5, column 7: a second joint \"a\" is renamed \"a#2\"",
                  "line 6, column 7: a second joint \"a\" is renamed \"a#3\"",
                  HasSubstr("no MOTION")));
}

std::string WithMotion(absl::string_view motion) {
  return OneJoint("OFFSET 0 0 0\nCHANNELS 2 Xrotation Yrotation", motion);
}

struct Malformed {
  std::string text;
  std::string error;
};

void ExpectErrors(const std::vector<Malformed>& cases) {
  for (const Malformed& malformed : cases) {
    EXPECT_EQ(ErrorOf(malformed.text), malformed.error) << malformed.text;
  }
}

TEST(BvhReaderTest, SaysWhereAHierarchyIsMalformed) {
  ExpectErrors({
      {"", "line 1, column 1: expected HIERARCHY, got end of file"},
      {" \n\n", "line 1, column 1: expected HIERARCHY, got end of file"},
      {"\n  solid cube", "line 2, column 3: expected HIERARCHY, got \"solid\""},
      {"HIERARCHY\nJOINT a", "line 2, column 1: expected ROOT, got \"JOINT\""},
      {"HIERARCHY\nROOT\n{", "line 3, column 1: expected a name, got \"{\""},
      {"HIERARCHY\nROOT a\nOFFSET",
       "line 3, column 1: expected \"{\", got \"OFFSET\""},
      {OneJoint("CHANNELS 0"),
       "line 5, column 1: expected an OFFSET in \"a\", got \"}\""},
      {OneJoint("OFFSET 0 0 0\nOFFSET 0 0 0"),
       "line 5, column 1: expected one OFFSET a joint, got \"OFFSET\""},
      {OneJoint("OFFSET 0 0 0\nJOINT b { OFFSET 0 0 0 }\nCHANNELS 0"),
       "line 6, column 1: expected one CHANNELS a joint, before its children, "
       "got \"CHANNELS\""},
      {OneJoint("OFFSET 0 0 0 0"),
       "line 4, column 14: expected OFFSET, CHANNELS, JOINT, End Site or "
       "\"}\", got \"0\""},
      {"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n",
       "line 4, column 13: expected OFFSET, CHANNELS, JOINT, End Site or "
       "\"}\", got end of file"},
      {OneJoint("OFFSET 0 0 0", "ROOT b\n{"),
       "line 6, column 1: expected MOTION (a file has one ROOT), got \"ROOT\""},
  });
}

TEST(BvhReaderTest, SaysWhereANumberIsMalformed) {
  const std::string not_finite =
      "expected a finite number of at most 1e9, got ";
  ExpectErrors({
      {OneJoint("OFFSET 0 0\n"),
       "line 6, column 1: expected a number, got \"}\""},
      {OneJoint("OFFSET 0 1,5 0"),
       "line 4, column 10: expected a number, got \"1,5\""},
      {OneJoint("OFFSET 0 0 0x10"),
       "line 4, column 12: expected a number, got \"0x10\""},
      {OneJoint("OFFSET 0 +-1 0"),
       "line 4, column 10: expected a number, got \"+-1\""},
      {OneJoint("OFFSET 0 + 0"),
       "line 4, column 10: expected a number, got \"+\""},
      {OneJoint("OFFSET 0 nan 0"),
       "line 4, column 10: " + not_finite + "\"nan\""},
      {OneJoint("OFFSET 0 0 -inf"),
       "line 4, column 12: " + not_finite + "\"-inf\""},
      {OneJoint("OFFSET 0 0 1e999"),
       "line 4, column 12: " + not_finite + "\"1e999\""},
      {OneJoint("OFFSET 0 0 1.1e9"),
       "line 4, column 12: " + not_finite + "\"1.1e9\""},
  });
}

TEST(BvhReaderTest, SaysWhereChannelsAreMalformed) {
  ExpectErrors({
      {OneJoint("CHANNELS 7"),
       "line 4, column 10: expected 0 to 6 channels, got \"7\""},
      {OneJoint("CHANNELS -1"),
       "line 4, column 10: expected a whole number >= 0, got \"-1\""},
      {OneJoint("CHANNELS 2 Xrotation Xscale"),
       "line 4, column 22: expected a channel (Xposition ... Zposition, "
       "Xrotation ... Zrotation), got \"Xscale\""},
      {OneJoint("CHANNELS 2 Xposition xposition"),
       "line 4, column 22: expected each position channel once, got "
       "\"xposition\""},
      {OneJoint("CHANNELS 1 Xrotation Yrotation"),
       "line 4, column 22: expected OFFSET, CHANNELS, JOINT, End Site or "
       "\"}\", got \"Yrotation\""},
  });
}

TEST(BvhReaderTest, SaysWhereAnEndSiteIsMalformed) {
  ExpectErrors({
      {OneJoint("End Sight"), "line 4, column 5: expected Site, got \"Sight\""},
      {OneJoint("End Site\n{\n}"),
       "line 6, column 1: expected OFFSET, got \"}\""},
      {OneJoint("End Site { OFFSET 0 0 0 CHANNELS 3 Xrotation }"),
       "line 4, column 34: expected 0 channels in an End Site, got \"3\""},
      {OneJoint("End Site { OFFSET 0 0 0 JOINT b"),
       "line 4, column 25: expected \"}\", got \"JOINT\""},
  });
}

TEST(BvhReaderTest, SaysWhereAMotionHeaderIsMalformed) {
  const std::string bad_time = "expected a frame time of 1e-6 to 3600 s, got ";
  ExpectErrors({
      {WithMotion("MOTION\n0 0"),
       "line 8, column 1: expected Frames:, got \"0\""},
      {WithMotion("MOTION\nFrames: two"),
       "line 8, column 9: expected a whole number >= 0, got \"two\""},
      {WithMotion("MOTION\nFrames: -2"),
       "line 8, column 9: expected a whole number >= 0, got \"-2\""},
      {WithMotion("MOTION\nFrames: 1.5"),
       "line 8, column 9: expected a whole number >= 0, got \"1.5\""},
      {WithMotion("MOTION\nFrames: 99999999999999999999"),
       "line 8, column 9: expected a whole number >= 0, got "
       "\"99999999999999999999\""},
      {WithMotion("MOTION\nFrames: 10000001"),
       "line 8, column 9: expected at most 10000000 frames, got \"10000001\""},
      {WithMotion("MOTION\nFrames: 2\n1 2"),
       "line 9, column 1: expected Frame Time:, got \"1\""},
      {WithMotion("MOTION\nFrames: 2\nFrame Time: 0\n1 2\n3 4"),
       "line 9, column 13: " + bad_time + "\"0\""},
      {WithMotion("MOTION\nFrames: 2\nFrame Time: -0.1\n1 2\n3 4"),
       "line 9, column 13: " + bad_time + "\"-0.1\""},
      {WithMotion("MOTION\nFrames: 1\nFrame Time: 1e8\n1 2"),
       "line 9, column 13: " + bad_time + "\"1e8\""},
  });
}

TEST(BvhReaderTest, SaysWhereRowsAreMalformed) {
  const std::string header = "MOTION\nFrames: 2\nFrame Time: 0.1\n";
  ExpectErrors({
      {WithMotion(header + "1 2\n3 NaN\n"),
       "line 11, column 3: expected a finite number of at most 1e9, got "
       "\"NaN\""},
      {WithMotion(header + "1 2\n3 4 }"),
       "line 11, column 5: expected a number, got \"}\""},
      {WithMotion(header + "1 2"),
       "line 10, column 4: expected 2 frames of 2 numbers, got 1"},
      {WithMotion(header + "1 2\n3"),
       "line 11, column 2: expected 2 frames of 2 numbers, got 1 and 1 "
       "numbers"},
      {WithMotion(header + "1 2\n3 4\n5"),
       "line 12, column 2: expected 2 frames of 2 numbers, got 2 and 1 "
       "numbers"},
      {OneJoint("OFFSET 0 0 0", header + "1"),
       "line 9, column 1: expected no numbers without channels, got \"1\""},
  });
}

TEST(BvhReaderTest, CountsLinesOfEveryKind) {
  EXPECT_THAT(ErrorOf("HIERARCHY\r\nROOT a\r\n{\r\nx"),
              HasSubstr("line 4, column 1: "));
  EXPECT_THAT(ErrorOf("HIERARCHY\rROOT a\r{\rx"),
              HasSubstr("line 4, column 1: "));
  EXPECT_THAT(ErrorOf("HIERARCHY\n\rROOT a\r\n{\n x"),
              HasSubstr("line 5, column 2: "));
}

TEST(BvhReaderTest, QuotesNeitherControlCharactersNorWholeFiles) {
  EXPECT_EQ(ErrorOf("\x1b[31m\x07"),
            "line 1, column 1: expected HIERARCHY, got \"\\x1b[31m\\x07\"");
  EXPECT_EQ(ErrorOf(std::string(1000, 'x')),
            absl::StrCat("line 1, column 1: expected HIERARCHY, got \"",
                         std::string(40, 'x'), "...\""));
  EXPECT_THAT(ErrorOf("HIERARCHY\nROOT a\x01z\n{"),
              HasSubstr("line 2, column 6: expected a name, got \"a\\x01"));
  EXPECT_THAT(ErrorOf("\xFF\xFEHI"), HasSubstr("got UTF-16"));
}

TEST(BvhReaderTest, TakesNoMemoryForFramesThatAreNotThere) {
  // Would be 480 MB if it were believed.
  const std::string text = OneJoint(
      "OFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition "
      "Zrotation Xrotation Yrotation",
      "MOTION\nFrames: 10000000\nFrame Time: 1\n1 2 3 4 5 6\n");
  EXPECT_EQ(ErrorOf(text),
            "line 10, column 12: expected 10000000 frames of 6 numbers, got 1");
}

TEST(BvhReaderTest, HoldsEveryBoundFromBothSides) {
  const std::string arm(kArm);
  BvhBounds bounds;
  bounds.max_bytes = arm.size();
  bounds.max_joints = 2;
  bounds.max_depth = 2;
  bounds.max_end_sites = 1;
  bounds.max_frames = 2;
  bounds.max_numbers = 14;
  bounds.max_name_bytes = 5;
  EXPECT_TRUE(ReadBvh(arm, bounds).ok());

  const auto error_with = [&](auto change) {
    BvhBounds tighter = bounds;
    change(tighter);
    return ErrorOf(arm, tighter);
  };
  EXPECT_THAT(error_with([](BvhBounds& b) { --b.max_bytes; }),
              HasSubstr("expected at most 299 bytes of BVH, got 300"));
  EXPECT_THAT(error_with([](BvhBounds& b) { --b.max_joints; }),
              HasSubstr("line 6, column 9: expected at most 1 joints"));
  EXPECT_THAT(error_with([](BvhBounds& b) { --b.max_depth; }),
              HasSubstr("line 6, column 9: expected at most 1 joints in each "
                        "other"));
  EXPECT_THAT(error_with([](BvhBounds& b) { --b.max_end_sites; }),
              HasSubstr("line 10, column 5: expected at most 0 End Sites"));
  EXPECT_THAT(error_with([](BvhBounds& b) { --b.max_frames; }),
              HasSubstr("line 17, column 9: expected at most 1 frames"));
  EXPECT_THAT(error_with([](BvhBounds& b) { --b.max_numbers; }),
              HasSubstr("line 17, column 9: expected at most 13 numbers"));
  EXPECT_THAT(error_with([](BvhBounds& b) { --b.max_name_bytes; }),
              HasSubstr("line 2, column 6: expected a name of at most 4 bytes, "
                        "got 5"));
}

TEST(BvhReaderTest, DeepFilesCostNoStack) {
  std::string text = "HIERARCHY\nROOT a\n{ OFFSET 0 0 0\n";
  for (int i = 0; i < 300000; ++i) text += "JOINT a\n{ OFFSET 0 0 0\n";
  EXPECT_THAT(ErrorOf(text), HasSubstr("at most 256 joints in each other"));
}

}  // namespace
}  // namespace gelenk

#include "gelenk/import/urdf_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/substitute.h"
#include "gelenk/math/rotation.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr double kHalfPi = std::numbers::pi / 2;
// Rounding of a few products.
constexpr double kRounding = 1e-14;

UrdfDocument Read(absl::string_view text) {
  absl::StatusOr<UrdfDocument> document = ReadUrdf(text);
  EXPECT_TRUE(document.ok()) << document.status();
  return document.ok() ? *std::move(document) : UrdfDocument();
}

std::string Message(absl::string_view text, const UrdfBounds& bounds = {}) {
  const absl::Status status = ReadUrdf(text, bounds).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  return std::string(status.message());
}

std::string Robot(absl::string_view parts) {
  return absl::StrCat("<robot name=\"arm\">\n", parts, "\n</robot>\n");
}

// A joint "j" of `type` on line 2, with more in it.
std::string JointText(absl::string_view type, absl::string_view more) {
  return Robot(absl::Substitute(
      R"(<joint name="j" type="$0"><parent link="a"/><child link="b"/>$1</joint>)",
      type, more));
}

UrdfJoint ReadOne(absl::string_view type, absl::string_view more) {
  const UrdfDocument document = Read(JointText(type, more));
  EXPECT_THAT(document.joints, SizeIs(1));
  return document.joints.empty() ? UrdfJoint() : document.joints[0];
}

std::vector<std::string> Warnings(absl::string_view type,
                                  absl::string_view more) {
  return Read(JointText(type, more)).warnings;
}

std::vector<std::string> Lines(absl::string_view type, absl::string_view more) {
  return ViolationLines(ReadUrdf(JointText(type, more)).status());
}

TEST(UrdfReaderTest, ReadsLinksWithTheirMass) {
  const UrdfDocument document = Read(
      "<?xml version=\"1.0\"?>\n<!-- made by hand -->\n"
      "<robot name=\"arm\">\n"
      "  <link name=\"base\"/>\n"
      "  <link name=\"tool\">\n"
      "    <inertial>\n"
      "      <mass value=\"2.5\"/>\n"
      "      <origin xyz=\"0.1 -0.2 3e-1\" rpy=\"1 2 3\"/>\n"
      "      <inertia ixx=\"1\" ixy=\"x\"/>\n"
      "    </inertial>\n"
      "    <visual><geometry><mesh filename=\"${nowhere}\"/></geometry>"
      "</visual>\n"
      "  </link>\n"
      "</robot>\n");
  EXPECT_EQ(document.name, "arm");
  ASSERT_THAT(document.links, SizeIs(2));
  EXPECT_EQ(document.links[0].name, "base");
  EXPECT_EQ(document.links[0].line, 4);
  EXPECT_EQ(document.links[0].mass_kg, 0);
  EXPECT_EQ(document.links[1].line, 5);
  EXPECT_EQ(document.links[1].mass_kg, 2.5);
  EXPECT_EQ(document.links[1].center_of_mass, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_THAT(document.warnings, IsEmpty());
}

TEST(UrdfReaderTest, ReadsAJointWhole) {
  const UrdfDocument document = Read(
      "<robot>\n"
      "<joint name=\"elbow\" type=\"revolute\">\n"
      "  <origin xyz=\"1 2 3\" rpy=\"0 0 0\"/>\n"
      "  <parent\n    link=\"upper\"/>\n"
      "  <child link=\"lower\"/>\n"
      "  <axis xyz=\"0 0 -1\"/>\n"
      "  <limit lower=\"-0.5\" upper=\"+.75\" effort=\"9\" velocity=\"2\"/>\n"
      "  <mimic joint=\"other\" multiplier=\"-2\" offset=\"0.25\"/>\n"
      "  <dynamics damping=\"NaN\"/>\n"
      "</joint></robot>");
  ASSERT_THAT(document.joints, SizeIs(1));
  const UrdfJoint& joint = document.joints[0];
  EXPECT_EQ(joint.name, "elbow");
  EXPECT_EQ(joint.line, 2);
  EXPECT_EQ(joint.type, JointType::kRevolute);
  EXPECT_EQ(joint.parent_link.name, "upper");
  EXPECT_EQ(joint.parent_link.line, 4);
  EXPECT_EQ(joint.child_link.name, "lower");
  EXPECT_EQ(joint.parent_from_joint.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(joint.axis, -Eigen::Vector3d::UnitZ());
  EXPECT_THAT(joint.limits.lower, ElementsAre(-0.5));
  EXPECT_THAT(joint.limits.upper, ElementsAre(0.75));
  EXPECT_THAT(joint.limits.max_velocity, ElementsAre(2));
  ASSERT_TRUE(joint.mimic.has_value());
  EXPECT_EQ(joint.mimic->joint.name, "other");
  EXPECT_EQ(joint.mimic->joint.line, 9);
  EXPECT_EQ(joint.mimic->multiplier, -2);
  EXPECT_EQ(joint.mimic->offset, 0.25);
  EXPECT_THAT(document.warnings, IsEmpty());
}

TEST(UrdfReaderTest, KnowsTheSixTypes) {
  const struct {
    const char* name;
    JointType type;
  } cases[] = {{"fixed", JointType::kFixed},
               {"revolute", JointType::kRevolute},
               {"continuous", JointType::kRevolute},
               {"prismatic", JointType::kPrismatic},
               {"planar", JointType::kPlanar},
               {"floating", JointType::kFree}};
  for (const auto& c : cases) EXPECT_EQ(ReadOne(c.name, "").type, c.type);
  EXPECT_THAT(Lines("ball", ""),
              ElementsAre("line 2: <joint type=\"ball\"> of joint \"j\": want "
                          "fixed, revolute, continuous, prismatic, planar or "
                          "floating"));
}

TEST(UrdfReaderTest, RollPitchYawTurnAboutFixedAxes) {
  const RigidTransform turned =
      ReadOne("fixed", R"(<origin rpy="0.3 -0.5 1.1"/>)").parent_from_joint;
  const Eigen::Matrix3d expected =
      (Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(-0.5, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_LT((turned.rotation.matrix() - expected).norm(), kRounding);
  EXPECT_TRUE(turned.translation.isZero(0));
  // Roll comes first: it leaves x where it is, and yaw then moves it to y.
  const RigidTransform quarter =
      ReadOne("fixed",
              absl::StrCat("<origin rpy=\"", kHalfPi, " 0 ", kHalfPi, "\"/>"))
          .parent_from_joint;
  EXPECT_LT(
      (quarter.rotation * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY())
          .norm(),
      1e-5);
}

TEST(UrdfReaderTest, AnAxisThatIsMissingIsX) {
  EXPECT_EQ(ReadOne("continuous", "").axis, Eigen::Vector3d::UnitX());
  EXPECT_EQ(ReadOne("continuous", "<axis/>").axis, Eigen::Vector3d::UnitX());
  EXPECT_THAT(Warnings("continuous", "<axis/>"), IsEmpty());
}

TEST(UrdfReaderTest, AnySkewAxisIsNormalised) {
  constexpr char kSkew[] = R"(<axis xyz="0.57735 0.57735 -0.57735"/>)";
  EXPECT_LT((ReadOne("continuous", kSkew).axis -
             Eigen::Vector3d(1, 1, -1).normalized())
                .norm(),
            kRounding);
  EXPECT_THAT(Warnings("continuous", kSkew), IsEmpty());

  constexpr char kLong[] = R"(<axis xyz="0 3 4"/>)";
  EXPECT_LT(
      (ReadOne("planar", kLong).axis - Eigen::Vector3d(0, 0.6, 0.8)).norm(),
      kRounding);
  EXPECT_THAT(Warnings("planar", kLong),
              ElementsAre("line 2: <axis> of joint \"j\": 5 long, taken as a "
                          "unit vector"));
}

TEST(UrdfReaderTest, AnAxisWithoutDirectionIsRefusedWhereItCounts) {
  constexpr char kZero[] = R"(<axis xyz="0 0 0"/>)";
  EXPECT_THAT(Lines("continuous", kZero),
              ElementsAre("line 2: <axis xyz=\"0 0 0\"> of joint \"j\": no "
                          "direction"));
  // Exporters write it for joints that do not turn.
  EXPECT_THAT(Lines("fixed", kZero), IsEmpty());
  EXPECT_THAT(Lines("floating", kZero), IsEmpty());
  // From both sides.
  EXPECT_THAT(Lines("continuous", R"(<axis xyz="0 0 1.1e-6"/>)"), IsEmpty());
  EXPECT_THAT(Lines("continuous", R"(<axis xyz="0 0 0.9e-6"/>)"), SizeIs(1));
}

TEST(UrdfReaderTest, AMissingLimitIsNone) {
  for (const char* type : {"revolute", "prismatic"}) {
    EXPECT_THAT(ReadOne(type, "").limits.lower, IsEmpty());
    EXPECT_THAT(Warnings(type, ""),
                ElementsAre("line 2: joint \"j\": no <limit>: unlimited"));
  }
  for (const char* type : {"fixed", "continuous", "planar", "floating"}) {
    EXPECT_THAT(Warnings(type, ""), IsEmpty());
  }
  constexpr char kEffort[] = R"(<limit effort="3" velocity="2"/>)";
  EXPECT_THAT(ReadOne("revolute", kEffort).limits.lower, IsEmpty());
  EXPECT_THAT(ReadOne("revolute", kEffort).limits.max_velocity, ElementsAre(2));
  EXPECT_THAT(Warnings("revolute", kEffort),
              ElementsAre("line 2: <limit> of joint \"j\": neither lower nor "
                          "upper: unlimited"));
}

TEST(UrdfReaderTest, ALimitThatIsHalfMissingIsZero) {
  constexpr char kUpper[] = R"(<limit upper="1.5"/>)";
  EXPECT_THAT(ReadOne("revolute", kUpper).limits.lower, ElementsAre(0));
  EXPECT_THAT(ReadOne("revolute", kUpper).limits.upper, ElementsAre(1.5));
  EXPECT_THAT(Warnings("revolute", kUpper),
              ElementsAre(HasSubstr("no lower: taken as 0")));
  EXPECT_THAT(Lines("revolute", R"(<limit lower="1.5"/>)"),
              ElementsAre("line 2: <limit lower=\"1.5\"> of joint \"j\": above "
                          "upper, 0"));
}

TEST(UrdfReaderTest, LimitsMayMeetButNotCross) {
  EXPECT_THAT(
      Warnings("prismatic", R"(<limit lower="0.25" upper="0.25"/>)"),
      ElementsAre(HasSubstr("lower and upper are equal: it cannot move")));
  EXPECT_THAT(Lines("prismatic", R"(<limit lower="0.25" upper="0.2499"/>)"),
              ElementsAre(HasSubstr("lower=\"0.25\"")));
}

TEST(UrdfReaderTest, HugeLimitsAreNone) {
  const JointLimits limits =
      ReadOne("revolute", R"(<limit lower="-1e16" upper="1e9"/>)").limits;
  EXPECT_THAT(limits.lower, ElementsAre(-INFINITY));
  EXPECT_THAT(limits.upper, ElementsAre(INFINITY));
  EXPECT_THAT(
      ReadOne("revolute", R"(<limit lower="-1" upper="9.9e8"/>)").limits.upper,
      ElementsAre(9.9e8));
}

TEST(UrdfReaderTest, ContinuousJointsKeepTheirVelocityOnly) {
  const JointLimits limits =
      ReadOne("continuous", R"(<limit lower="1" upper="-1" velocity="3"/>)")
          .limits;
  EXPECT_THAT(limits.lower, IsEmpty());
  EXPECT_THAT(limits.max_velocity, ElementsAre(3));
}

TEST(UrdfReaderTest, AVelocityOfZeroIsNoLimit) {
  constexpr char kZero[] = R"(<limit lower="-1" upper="1" velocity="0"/>)";
  EXPECT_THAT(ReadOne("revolute", kZero).limits.max_velocity, IsEmpty());
  EXPECT_THAT(Warnings("revolute", kZero),
              ElementsAre(HasSubstr("velocity of 0 is taken as no limit")));
  EXPECT_THAT(
      Lines("revolute", R"(<limit lower="-1" upper="1" velocity="-1"/>)"),
      ElementsAre(HasSubstr("velocity=\"-1\"> of joint \"j\": below 0")));
}

TEST(UrdfReaderTest, OnlyHingesAndSlidersFollow) {
  constexpr char kMimic[] = R"(<mimic joint="other"/>)";
  const UrdfJoint joint = ReadOne("continuous", kMimic);
  ASSERT_TRUE(joint.mimic.has_value());
  EXPECT_EQ(joint.mimic->multiplier, 1);
  EXPECT_EQ(joint.mimic->offset, 0);
  for (const char* type : {"fixed", "planar", "floating"}) {
    EXPECT_FALSE(ReadOne(type, kMimic).mimic.has_value());
    EXPECT_THAT(Warnings(type, kMimic), ElementsAre(HasSubstr("ignored")));
  }
  EXPECT_THAT(
      Lines("continuous", "<mimic multiplier=\"2\"/>"),
      ElementsAre("line 2: <mimic> of joint \"j\": no attribute joint"));
}

TEST(UrdfReaderTest, OnlyDecimalNumbersAreNumbers) {
  for (const char* text : {"abc", "", "nan", "NaN", "inf", "-Infinity", "0x10",
                           "1,5", "1.0.0", "1 2", "1e", "--1"}) {
    EXPECT_THAT(
        Lines("revolute", absl::StrCat("<limit lower=\"", text, "\"/>")),
        ElementsAre(absl::StrCat("line 2: <limit lower=\"", text,
                                 "\"> of joint \"j\": not a number")));
  }
  for (const char* text : {"0x1 0 0", "inf 0 0", "1 nan 0"}) {
    EXPECT_THAT(Lines("fixed", absl::StrCat("<origin xyz=\"", text, "\"/>")),
                ElementsAre(HasSubstr("not a number")));
  }
}

TEST(UrdfReaderTest, NumbersThatDoNotFitAreRefused) {
  for (const char* text : {"1e999", "-1e999", "1e-999"}) {
    EXPECT_THAT(
        Lines("revolute", absl::StrCat("<limit upper=\"", text, "\"/>")),
        ElementsAre(HasSubstr("out of the range of numbers")));
  }
  EXPECT_THAT(Lines("fixed", R"(<origin xyz="0 1 1e400"/>)"),
              ElementsAre(HasSubstr("out of the range of numbers")));
}

TEST(UrdfReaderTest, VectorsHaveThreeNumbers) {
  EXPECT_EQ(ReadOne("fixed", "<origin xyz=\" 1\t2\n 3 \"/>")
                .parent_from_joint.translation,
            Eigen::Vector3d(1, 2, 3));
  for (const auto& [text, count] :
       {std::make_pair("", 0), std::make_pair("1 2", 2),
        std::make_pair("1 2 3 4", 4)}) {
    EXPECT_THAT(Lines("fixed", absl::StrCat("<origin xyz=\"", text, "\"/>")),
                ElementsAre(absl::StrCat(
                    "line 2: <origin xyz=\"", text,
                    "\"> of joint \"j\": want 3 numbers, got ", count)));
  }
  EXPECT_THAT(Lines("fixed", R"(<origin xyz="0 0 1e9"/>)"), IsEmpty());
  EXPECT_THAT(Lines("fixed", R"(<origin xyz="0 0 1.1e9"/>)"),
              ElementsAre(HasSubstr("at most 1e9")));
}

TEST(UrdfReaderTest, TheLocaleDoesNotCount) {
  // Where the locale is not installed this proves nothing, and fails nothing.
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  EXPECT_EQ(ReadOne("fixed", R"(<origin xyz="0.5 0 0"/>)")
                .parent_from_joint.translation.x(),
            0.5);
  EXPECT_THAT(Lines("fixed", R"(<origin xyz="0,5 0 0"/>)"), SizeIs(1));
  std::setlocale(LC_ALL, "C");
}

TEST(UrdfReaderTest, ListsEveryFaultByItsLine) {
  const absl::Status status =
      ReadUrdf(
          "<robot name=\"r\">\n"
          "<link/>\n"
          "<link name=\"a\"><inertial>\n<mass "
          "value=\"-1\"/></inertial></link>\n"
          "<joint name=\"j\" type=\"revolute\">\n"
          "  <parent/>\n"
          "  <limit lower=\"abc\"\n"
          "         upper=\"x\"/>\n"
          "</joint>\n"
          "<joint type=\"fixed\"><parent link=\"a\"/><child link=\"\"/></joint>"
          "</robot>")
          .status();
  EXPECT_THAT(
      ViolationLines(status),
      ElementsAre("line 2: <link>: no attribute name",
                  "line 4: <mass value=\"-1\"> of link \"a\": want 0 to 1e9 kg",
                  "line 6: <parent> of joint \"j\": no attribute link",
                  "line 5: joint \"j\": no <child>",
                  "line 7: <limit lower=\"abc\"> of joint \"j\": not a number",
                  "line 8: <limit upper=\"x\"> of joint \"j\": not a number",
                  "line 10: <joint>: no attribute name",
                  "line 10: <child link=\"\"> of joint \"\": empty"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("line 7"));
}

TEST(UrdfReaderTest, TheFirstOfSeveralChildrenCounts) {
  constexpr char kTwo[] =
      "<limit lower=\"-1\" upper=\"1\"/>\n<limit lower=\"-2\" upper=\"2\"/>";
  EXPECT_THAT(ReadOne("revolute", kTwo).limits.lower, ElementsAre(-1));
  EXPECT_THAT(Warnings("revolute", kTwo),
              ElementsAre("line 3: <limit> of joint \"j\": ignored: the one on "
                          "line 2 counts"));
}

TEST(UrdfReaderTest, JointsInsideOtherElementsAreNone) {
  const UrdfDocument document = Read(
      Robot("<link name=\"a\"/><transmission name=\"t\"><joint name=\"j\">"
            "<hardwareInterface>x</hardwareInterface></joint></transmission>"
            "<gazebo reference=\"a\"><joint name=\"k\"/><link/></gazebo>"
            "<material name=\"m\"><color rgba=\"1 0 0 x\"/></material>"));
  EXPECT_THAT(document.joints, IsEmpty());
  EXPECT_THAT(document.links, SizeIs(1));
}

TEST(UrdfReaderTest, XacroIsRefusedWithAHint) {
  EXPECT_THAT(Message("<robot xmlns:xacro=\"http://x\">\n"
                      "<xacro:macro name=\"leg\"/></robot>"),
              AllOf(StartsWith("line 2: "), HasSubstr("xacro FILE")));
  EXPECT_THAT(Message("<robot><gazebo>\n\n<a/><b><xacro:if value=\"1\"/></b>"
                      "</gazebo></robot>"),
              StartsWith("line 3: "));
  EXPECT_THAT(Lines("fixed", R"(<origin xyz="0 0 ${length / 2}"/>)"),
              ElementsAre(HasSubstr("not expanded: run `xacro")));
  EXPECT_THAT(Lines("revolute", "<limit lower=\"$(arg low)\"/>"),
              ElementsAre(HasSubstr("not expanded: run `xacro")));
  // The namespace alone is what xacro leaves behind.
  EXPECT_THAT(
      Read("<robot xmlns:xacro=\"http://x\"><link name=\"a\"/></robot>").links,
      SizeIs(1));
}

TEST(UrdfReaderTest, OtherFilesAreNamed) {
  EXPECT_EQ(Message(""), "line 0: no well-formed XML: the file is empty");
  EXPECT_EQ(Message("<sdf version=\"1.7\"><model/></sdf>"),
            "line 1: want <robot>, got an element \"sdf\"");
  EXPECT_EQ(Message("<!-- nothing -->"), "no <robot>");
  EXPECT_THAT(Message("HIERARCHY\nROOT a\n"), HasSubstr("no well-formed XML"));
  EXPECT_THAT(Message("<robot>\n<link name=\"a\">\n</robot>"),
              AllOf(StartsWith("line 2: "), HasSubstr("is not closed")));
  EXPECT_THAT(Message("<robot>\n<link name=a/></robot>"),
              HasSubstr("malformed attribute"));
  EXPECT_THAT(Message(absl::string_view("<\0r\0", 4)), HasSubstr("byte 0"));
}

TEST(UrdfReaderTest, ByteOrderMarksAndLineEndsAreFine) {
  const UrdfDocument document = Read(
      "\xEF\xBB\xBF<robot name=\"r\">\r\n<link name=\"a&amp;&#65;\"/>\r\n"
      "<link name=\"M\xC3\xBC\"/></robot>");
  ASSERT_THAT(document.links, SizeIs(2));
  EXPECT_EQ(document.links[0].name, "a&A");
  EXPECT_EQ(document.links[0].line, 2);
  EXPECT_EQ(document.links[1].name, "M\xC3\xBC");
}

TEST(UrdfReaderTest, EntitiesOfTheFilesOwnStayText) {
  // Expanded, they would be a billion of these.
  const UrdfDocument document = Read(
      "<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;\">\n"
      "<!ENTITY c SYSTEM \"file:///etc/passwd\">]>\n"
      "<robot name=\"r\"><link name=\"&b;&c;\"/></robot>");
  ASSERT_THAT(document.links, SizeIs(1));
  EXPECT_EQ(document.links[0].name, "&b;&c;");
}

TEST(UrdfReaderTest, NestingIsBounded) {
  const auto nested = [](int depth) {
    std::string text = "<robot><link name=\"a\"/>";
    for (int i = 0; i < depth; ++i) text += "<gazebo>";
    for (int i = 0; i < depth; ++i) text += "</gazebo>";
    return text + "</robot>";
  };
  EXPECT_THAT(Read(nested(50)).links, SizeIs(1));
  EXPECT_THAT(Message(nested(150)), HasSubstr("nested too deep"));
  EXPECT_THAT(Message(nested(99'000)), HasSubstr("nested too deep"));
}

TEST(UrdfReaderTest, SizesAreBoundedOnBothSides) {
  const std::string text = JointText("fixed", "");
  UrdfBounds bounds;
  bounds.max_bytes = text.size();
  bounds.max_elements = 6;  // Four open, two close.
  bounds.max_attributes = 5;
  bounds.max_joints = 1;
  EXPECT_TRUE(ReadUrdf(text, bounds).ok());
  const auto message = [&text, &bounds](auto UrdfBounds::*member) {
    UrdfBounds tighter = bounds;
    --(tighter.*member);
    return Message(text, tighter);
  };
  EXPECT_EQ(message(&UrdfBounds::max_bytes),
            absl::StrCat("want at most ", text.size() - 1, " bytes, got ",
                         text.size()));
  EXPECT_EQ(message(&UrdfBounds::max_elements),
            "want at most 5 elements, got 6");
  EXPECT_EQ(message(&UrdfBounds::max_attributes),
            "want at most 4 attributes, got 5");
  EXPECT_EQ(message(&UrdfBounds::max_joints), "line 2: want at most 0 joints");
}

TEST(UrdfReaderTest, LongValuesAreCutInMessages) {
  const std::string line =
      Lines("fixed",
            absl::StrCat("<origin xyz=\"", std::string(5000, 'x'), "\"/>"))[0];
  EXPECT_LT(line.size(), 150);
  EXPECT_THAT(line, HasSubstr("xxx...\""));
}

}  // namespace
}  // namespace gelenk

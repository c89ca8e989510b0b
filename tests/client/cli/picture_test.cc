#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/cli/examples/leg_example.h"
#include "client/cli/picture/camera.h"
#include "client/cli/picture/contact_sheet.h"
#include "client/cli/picture/figure_row.h"
#include "client/cli/picture/leg_picture.h"
#include "client/cli/picture/play_picture.h"
#include "client/cli/picture/pose_picture.h"
#include "client/cli/picture/stick_figure.h"
#include "client/cli/picture/svg.h"
#include "client/cli/picture/two_link_picture.h"
#include "client/cli/picture/workspace_picture.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/skeleton/planar_chain.h"
#include "tests/client/cli/sample_playback.h"
#include "tests/client/cli/well_formed_xml.h"
#include "tests/testing/body_clips.h"

namespace gelenk::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Counts the elements of the picture of `playback`, which is well formed.
std::map<std::string, int> Drawn(const Playback& playback) {
  const auto counts =
      CountElements(PlayPictureSvg(playback, MeasureResiduals(playback)));
  EXPECT_TRUE(counts.ok()) << counts.status();
  return counts.ok() ? *counts : std::map<std::string, int>();
}

TEST(WellFormedXmlTest, TellsGoodFromBad) {
  const auto counts = CountElements("<a><b class=\"x y\"/>t &amp; t</a>");
  ASSERT_TRUE(counts.ok()) << counts.status();
  EXPECT_EQ(counts->at("b.y"), 1);
  for (const char* bad : {"<a>", "<a></b>", "<a b=c/>", "<a>x & y</a>",
                          "<a b=\"1\" b=\"2\"/>", "<a b=\"&\"/>", "</a>"}) {
    EXPECT_FALSE(CountElements(bad).ok()) << bad;
  }
}

TEST(SvgTest, EscapesTextAndRoundsNumbers) {
  Svg svg(10, 20, "a < b", "");
  svg.Text({1.23456, -0.001}, "\"R&D\" <x>", "end");
  const std::string text = std::move(svg).Finish();
  EXPECT_THAT(text, HasSubstr("<title>a &lt; b</title>"));
  EXPECT_THAT(text, HasSubstr("x=\"1.23\" y=\"0\">&quot;R&amp;D&quot; &lt;x&gt;"
                              "</text>"));
  EXPECT_TRUE(CountElements(text).ok());
}

TEST(CameraTest, RightAndDownAreAsOnThePicture) {
  const Camera front(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(front.Project({1, 0, 0}).isApprox(Point(1, 0)));
  EXPECT_TRUE(front.Project({0, 2, 0}).isApprox(Point(0, -2)));
  const Camera map = MapCamera(Eigen::Vector3d::UnitY());
  EXPECT_TRUE(map.Project({0, 5, 1}).isApprox(Point(0, -1)));
}

TEST(StickFigureTest, KnowsLeftFromRight) {
  const Playback playback = SamplePlayback(1);
  const Skeleton& skeleton = *playback.skeleton;
  const std::vector<BodyHalf> halves = HalvesOf(skeleton, playback.body);
  const auto half_of = [&](const char* id) {
    return halves[skeleton.FindJoint(id)];
  };
  EXPECT_EQ(half_of("Hips"), BodyHalf::kTrunk);
  EXPECT_EQ(half_of("Spine"), BodyHalf::kTrunk);
  EXPECT_EQ(half_of("Head"), BodyHalf::kTrunk);
  EXPECT_EQ(half_of("LeftUpLeg"), BodyHalf::kLeft);
  EXPECT_EQ(half_of("LeftToes"), BodyHalf::kLeft);
  EXPECT_EQ(half_of("RightForeArm"), BodyHalf::kRight);
}

TEST(PlayPictureTest, ShowsADozenFiguresWithTheirTargets) {
  const Playback playback = SamplePlayback(100);
  auto drawn = Drawn(playback);
  EXPECT_EQ(drawn["g.figure"], kMostFigures);
  // One more of each is in the key.
  const int goals = static_cast<int>(playback.goals.size());
  EXPECT_EQ(drawn["circle.target"], kMostFigures * goals + 1);
  EXPECT_EQ(drawn["circle.effector"], kMostFigures * goals + 1);
  const int bones = playback.skeleton->joint_count() - 1 +
                    static_cast<int>(playback.skeleton->end_effectors().size());
  EXPECT_EQ(drawn["line.ghost"], kMostFigures * bones + 1);
  EXPECT_EQ(drawn["line.bone"], kMostFigures * bones + 2);
  EXPECT_EQ(drawn["g.chart"], 2);
  EXPECT_EQ(drawn["polyline.path"], 1);
  EXPECT_EQ(drawn["line.residual"], 0);
  // The strip is one stretch of converged frames; the key has a sample.
  EXPECT_EQ(drawn["rect.converged"], 2);
}

TEST(PlayPictureTest, ShowsWhatWentWrong) {
  Playback playback = SamplePlayback(100);
  playback.answered_poses.row(0).array() += 0.3;
  playback.answers[20].outcome = SolveOutcome::kUnreachable;
  playback.answers[40].outcome = SolveOutcome::kStalledAtLimits;
  playback.answers[60].answered = false;
  auto drawn = Drawn(playback);
  EXPECT_EQ(drawn["line.residual"],
            kMostFigures * static_cast<int>(playback.goals.size()));
  EXPECT_EQ(drawn["rect.unreachable"], 2);
  EXPECT_EQ(drawn["rect.stalled"], 2);
  EXPECT_EQ(drawn["rect.unanswered"], 2);
  EXPECT_EQ(drawn["rect.converged"], 5);
}

TEST(PlayPictureTest, OneFrameIsEnough) {
  EXPECT_EQ(Drawn(SamplePlayback(1))["g.figure"], 1);
}

TEST(PlayPictureTest, NothingAnsweredIsDrawn) {
  Playback playback = SamplePlayback(3);
  for (Answer& answer : playback.answers) answer.answered = false;
  EXPECT_EQ(Drawn(playback)["g.figure"], 0);
}

TEST(PlayPictureTest, NeedsNothingButItself) {
  const Playback playback = SamplePlayback(4);
  const Residuals residuals = MeasureResiduals(playback);
  std::string svg = PlayPictureSvg(playback, residuals);
  const std::string name_space = "http://www.w3.org/2000/svg";
  svg.erase(svg.find(name_space), name_space.size());
  EXPECT_THAT(svg, Not(HasSubstr("http")));
  EXPECT_THAT(svg, Not(HasSubstr("href")));
  EXPECT_THAT(svg, HasSubstr("prefers-color-scheme: dark"));
  for (const char* no_number : {"\"nan", " nan", ",nan", "\"inf", ",inf"}) {
    EXPECT_THAT(svg, Not(HasSubstr(no_number)));
  }
}

TEST(PlayPictureTest, NamesOfFilesAreEscaped) {
  Playback playback = SamplePlayback(2);
  playback.clip_name = "<script>&.bvh";
  Drawn(playback);
  EXPECT_THAT(PlayPictureHtml(playback, MeasureResiduals(playback)),
              Not(HasSubstr("<script>")));
}

// Counts the elements of any picture, which is well formed.
std::map<std::string, int> ElementsOf(const std::string& svg) {
  const auto counts = CountElements(svg);
  EXPECT_TRUE(counts.ok()) << counts.status();
  return counts.ok() ? *counts : std::map<std::string, int>();
}

TEST(PosePictureTest, LinksAreWedgesAlongTheirAxes) {
  PlanarChain chain;
  chain.link_lengths_m = {1, 2};
  const auto skeleton = BuilderOf(chain)->Build().value();
  const Eigen::Vector3d target(1, 1, 0);
  auto drawn = ElementsOf(PosePictureSvg(*skeleton, Eigen::Vector2d(0.3, 0.4),
                                         {&target, 1}, "a & b"));
  EXPECT_EQ(drawn["polygon.shade4"], 2);
  EXPECT_EQ(drawn["circle.target"], 1);
  // Seen along Z only.
  EXPECT_EQ(drawn["rect.panel"], 1);
}

TEST(PosePictureTest, BodiesAreSeenTwice) {
  const Playback playback = SamplePlayback(1);
  auto drawn = ElementsOf(PosePictureSvg(
      *playback.skeleton, playback.clip_poses.col(0), {}, "body"));
  EXPECT_EQ(drawn["rect.panel"], 2);
  EXPECT_GT(drawn["polygon.shade4"], 2 * 10);
}

TEST(WorkspacePictureTest, AMapIsSeenAlongEachAxis) {
  WorkspaceMap map;
  map.voxel_size_m = 0.1;
  map.size = {3, 2, 2};
  map.sample_count = 7;
  map.voxels = {{0, 1, 0.1}, {1, 2, 0.1}, {11, 4, 1}};
  auto drawn = ElementsOf(WorkspacePictureSvg(map, "tip"));
  EXPECT_EQ(drawn["rect.panel"], 3);
  // The best one is dark in each view, and once in the key; voxels 0 and 1 are
  // one stretch where both are seen.
  EXPECT_EQ(drawn["rect.shade6"], 3 + 1);
  EXPECT_EQ(drawn["rect.shade1"], 3 + 1);
  map.size = {3, 2, 1};
  map.voxels.pop_back();
  EXPECT_EQ(ElementsOf(WorkspacePictureSvg(map, "tip"))["rect.panel"], 1);
}

TEST(WorkspacePictureTest, ARingHasTwoCircles) {
  PlanarAnnulus annulus;
  annulus.inner_radius_m = 1;
  annulus.outer_radius_m = 3;
  auto drawn = ElementsOf(WorkspacePictureSvg(annulus, "tip"));
  EXPECT_EQ(drawn["circle.shade3"], 1);
  EXPECT_EQ(drawn["circle.panel"], 1);
}

TEST(TwoLinkPictureTest, TheOtherSolutionIsPale) {
  v1::PlanarTwoLink limb;
  limb.mutable_target()->set_x(1);
  v1::SolveTwoLinkResponse response;
  response.set_max_reach_m(2);
  response.set_best(1);
  for (double y : {-1, 1}) {
    v1::TwoLinkSolution& solution = *response.add_solutions();
    solution.mutable_world_mid()->set_y(y);
    solution.mutable_world_tip()->set_x(1);
  }
  auto drawn = ElementsOf(TwoLinkPictureSvg(limb, response));
  EXPECT_EQ(drawn["line.ghost"], 2);
  EXPECT_EQ(drawn["line.bone"], 2);
  EXPECT_EQ(drawn["circle.target"], 1);
}

constexpr double kFrameTime_s = 1.0 / 60;

TEST(ContactSheetTest, ShowsEveryMotionAndWhereFeetStand) {
  const auto skeleton = MakeHumanoid();
  const auto model =
      MakeBodyModel(skeleton, *ProposeJointMap(*skeleton)).value();
  const Eigen::MatrixXd standing = skeleton->rest_positions().replicate(1, 30);
  const auto poses = testing::BodyPosesOf(*model, standing);
  const ContactLabels labels =
      LabelContacts(FootPointsOf(poses), kFrameTime_s, FeetOf(*model));
  const SheetMotion row = {"a < b", *model, standing, poses, labels.floor_m};
  const auto one =
      CountElements(ContactSheetSvg("one", {row}, labels, kFrameTime_s));
  ASSERT_TRUE(one.ok()) << one.status();
  EXPECT_EQ(one->at("g.figure"), kMostSheetFigures);
  EXPECT_GT(one->at("circle.contact"), 0);
  EXPECT_GT(one->at("rect.left-fill"), 0);
  const SheetMotion rows[] = {row, row};
  const auto two =
      CountElements(ContactSheetSvg("two", rows, labels, kFrameTime_s));
  ASSERT_TRUE(two.ok()) << two.status();
  EXPECT_EQ(two->at("g.figure"), 2 * kMostSheetFigures);
  EXPECT_EQ(two->at("line.bone"), 2 * one->at("line.bone"));
}

TEST(LegExampleTest, KeysAloneSlideAndSinkAndContactsDoNot) {
  const auto example = MakeLegExample();
  ASSERT_TRUE(example.ok()) << example.status();
  EXPECT_GT(example->keyed.quality.skate.label_cm_s, 5);
  EXPECT_GT(example->keyed.quality.penetration.max_m, 0.01);
  EXPECT_LT(example->planted.quality.skate.label_cm_s, 0.1);
  EXPECT_LT(example->planted.quality.penetration.max_m, 1e-4);
  EXPECT_EQ(example->planted.quality.hyper_extended_frames, 0);
  for (const LegMotion* motion : {&example->keyed, &example->planted}) {
    const auto drawn = CountElements(LegPictureSvg(*example, *motion, "leg"));
    ASSERT_TRUE(drawn.ok()) << drawn.status();
    EXPECT_GT(drawn->at("polyline.slide"), 4);
  }
}

}  // namespace
}  // namespace gelenk::cli

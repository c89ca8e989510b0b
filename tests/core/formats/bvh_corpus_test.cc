// Real clips of many exporters, none of them part of the project: the folder
// that GELENK_CORPUS names, or shared/data beside the source tree, and the
// clips of Debian's package assimp-testmodels.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/formats/bvh_motion.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/formats/bvh_writer.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/body_parts.h"
#include "tests/core/formats/bvh_oracle.h"

namespace gelenk {
namespace {

namespace fs = std::filesystem;

constexpr double kTolerance = 1e-9;
// Less than this is a test of the format, not a person.
constexpr int kMinBodyJoints = 15;

fs::path CorpusFolder() {
  const char* named = std::getenv("GELENK_CORPUS");
  const fs::path data =
      named != nullptr
          ? fs::path(named)
          : fs::path(GELENK_SOURCE_DIR).parent_path() / "shared" / "data";
  return data / "bvh";
}

const fs::path kAssimpFolder = "/usr/share/assimp/models/BVH";

std::vector<fs::path> Clips(const fs::path& folder) {
  std::vector<fs::path> clips;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".bvh") clips.push_back(entry.path());
  }
  std::sort(clips.begin(), clips.end());
  return clips;
}

std::string ReadFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void ExpectPosesStandWhereTheFileSays(const BvhDocument& document,
                                      const BvhImport& import,
                                      const Eigen::MatrixXd& poses) {
  WorldTransforms world_from_joints;
  const int step = std::max(1, document.frame_count() / 40);
  for (int frame = 0; frame < document.frame_count(); frame += step) {
    ForwardKinematics(*import.skeleton, poses.col(frame), world_from_joints);
    const auto expected = OracleWorldFromJoints(document, frame);
    for (size_t i = 0; i < expected.size(); ++i) {
      const RigidTransform& actual = world_from_joints[import.joints[i]];
      ASSERT_LT((actual.translation - import.unit_m * expected[i].translation())
                    .norm(),
                kTolerance);
      ASSERT_LT((actual.rotation.matrix() - expected[i].linear()).norm(),
                kTolerance);
    }
  }
}

void ExpectContinuousRotations(const BvhMapping& mapping,
                               const Eigen::MatrixXd& poses) {
  for (const BvhRotation& rotation : mapping.rotations) {
    const auto rows = poses.middleRows<4>(rotation.position);
    for (int frame = 1; frame < poses.cols(); ++frame) {
      ASSERT_GE(rows.col(frame).dot(rows.col(frame - 1)), 0);
    }
  }
}

void ExpectRoundTrip(const BvhDocument& document, const BvhImport& import,
                     const Eigen::MatrixXd& poses) {
  const absl::StatusOr<BvhDocument> back =
      BvhFromPoses(document, import, poses);
  ASSERT_TRUE(back.ok()) << back.status();
  const absl::StatusOr<BvhDocument> read = ReadBvh(WriteBvh(*back));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->frame_time_text, document.frame_time_text);
  const BvhDifference worst = CompareMotion(document, *read);
  EXPECT_LT(worst.rotation, kTolerance);
  EXPECT_LT(worst.position, kTolerance);
}

// The parts that names and shape find must be the same ones; which is left
// cannot be seen in every rest pose.
void ExpectBody(const BvhDocument& document, const Skeleton& skeleton) {
  const BodyParts parts = FindBodyParts(skeleton);
  EXPECT_TRUE(parts.IsComplete());
  EXPECT_EQ(parts.evidence, BodyParts::Evidence::kNames);

  BvhDocument nameless = document;
  for (size_t i = 0; i < nameless.joints.size(); ++i) {
    nameless.joints[i].name = absl::StrCat("j", i);
  }
  const absl::StatusOr<BvhImport> import = ImportBvh(nameless);
  ASSERT_TRUE(import.ok()) << import.status();
  const BodyParts shape = FindBodyParts(*import->skeleton);
  EXPECT_EQ(shape.evidence, BodyParts::Evidence::kShape);
  EXPECT_EQ(std::minmax(shape.left_foot, shape.right_foot),
            std::minmax(parts.left_foot, parts.right_foot));
  EXPECT_EQ(shape.head, parts.head);
}

void CheckClip(const fs::path& path) {
  SCOPED_TRACE(path);
  const absl::StatusOr<BvhDocument> document = ReadBvh(ReadFile(path));
  ASSERT_TRUE(document.ok()) << document.status();
  const absl::StatusOr<BvhImport> import = ImportBvh(*document);
  ASSERT_TRUE(import.ok()) << import.status();
  const absl::StatusOr<Eigen::MatrixXd> poses =
      PosesFromBvh(*document, *import);
  ASSERT_TRUE(poses.ok()) << poses.status();
  ExpectPosesStandWhereTheFileSays(*document, *import, *poses);
  ExpectContinuousRotations(import->mapping, *poses);
  ExpectRoundTrip(*document, *import, *poses);
  if (document->joints.size() >= kMinBodyJoints) {
    ExpectBody(*document, *import->skeleton);
  }
}

TEST(BvhCorpusTest, EveryClipOfTheCorpusComesRound) {
  const std::vector<fs::path> clips = Clips(CorpusFolder());
  if (clips.empty()) GTEST_SKIP() << "SKIPPED: no clips in " << CorpusFolder();
  for (const fs::path& clip : clips) CheckClip(clip);
}

TEST(BvhCorpusTest, EveryClipOfAssimpComesRound) {
  const std::vector<fs::path> clips = Clips(kAssimpFolder);
  if (clips.empty()) GTEST_SKIP() << "SKIPPED: no clips in " << kAssimpFolder;
  for (const fs::path& clip : clips) CheckClip(clip);
}

struct Known {
  const char* name;
  double unit_m;
  Eigen::Vector3d up;
};

void CheckKnown(const fs::path& folder, const std::vector<Known>& clips) {
  for (const Known& known : clips) {
    const fs::path path = folder / known.name;
    if (!fs::exists(path)) continue;
    SCOPED_TRACE(path);
    const absl::StatusOr<BvhDocument> document = ReadBvh(ReadFile(path));
    ASSERT_TRUE(document.ok()) << document.status();
    const absl::StatusOr<BvhImport> import = ImportBvh(*document);
    ASSERT_TRUE(import.ok()) << import.status();
    EXPECT_EQ(import->unit_m, known.unit_m);
    EXPECT_EQ(import->skeleton->up(), known.up);
  }
}

TEST(BvhCorpusTest, UnitAndUpAreThoseOfTheStudio) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  CheckKnown(CorpusFolder(), {{"ad_fair1_dab.bvh", 0.0254, z},
                              {"ad_fair1_zombie.bvh", 0.0254, z},
                              {"ad_rokoko_jesse_dance.bvh", 0.01, y},
                              {"bvhpy_mocapbank.bvh", 0.01, y},
                              {"cmu_114_16.bvh", 0.01, y},
                              {"pybvh_bvh_test1.bvh", 0.0254, z},
                              {"pybvh_bvh_test2.bvh", 0.01, y},
                              {"pybvh_bvh_test3.bvh", 0.0254, z},
                              {"pybvh_cmu_12_01_walk.bvh", 0.056444, y},
                              {"pybvh_full_precision_frame_time.bvh", 0.01, y},
                              {"pybvh_rotation_first_root.bvh", 0.01, y},
                              {"pybvh_standard_skeleton.bvh", 0.0254, z},
                              {"pymo_AV_8Walk_Meredith.bvh", 0.0254, y}});
  CheckKnown(kAssimpFolder, {{"01_01.bvh", 0.056444, y},
                             {"01_03.bvh", 0.056444, y},
                             {"Boxing_Toes.bvh", 0.01, y}});
}

TEST(BvhCorpusTest, PositionsReplaceTheRootsOffset) {
  // Added, they would lift this actor by 94 cm.
  const fs::path path = CorpusFolder() / "ad_rokoko_jesse_dance.bvh";
  if (!fs::exists(path)) GTEST_SKIP() << "SKIPPED: no " << path;
  const absl::StatusOr<BvhDocument> document = ReadBvh(ReadFile(path));
  ASSERT_TRUE(document.ok());
  const absl::StatusOr<BvhImport> import = ImportBvh(*document);
  ASSERT_TRUE(import.ok());
  const absl::StatusOr<Eigen::MatrixXd> poses =
      PosesFromBvh(*document, *import);
  ASSERT_TRUE(poses.ok());
  WorldTransforms world_from_joints;
  ForwardKinematics(*import->skeleton, poses->col(0), world_from_joints);
  EXPECT_NEAR(world_from_joints[0].translation.y(), 0.877332, 1e-12);
}

TEST(BvhCorpusTest, TheRowBeyondTheHeaderIsDropped) {
  const fs::path path = kAssimpFolder / "Boxing_Toes.bvh";
  if (!fs::exists(path)) GTEST_SKIP() << "SKIPPED: no " << path;
  const absl::StatusOr<BvhDocument> document = ReadBvh(ReadFile(path));
  ASSERT_TRUE(document.ok());
  EXPECT_EQ(document->frame_count(), 3069);
  EXPECT_THAT(document->warnings,
              testing::ElementsAre(testing::HasSubstr("3070")));
}

}  // namespace
}  // namespace gelenk

// Real models, none of them part of the project: the folder that GELENK_CORPUS
// names, or shared/data beside the source tree, and the models of Debian's
// package assimp-testmodels.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/import/gltf_animation.h"
#include "gelenk/import/gltf_clip.h"
#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/import/gltf_skin.h"
#include "gelenk/import/gltf_writer.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/clip_frames.h"
#include "tests/core/import/gltf_oracle.h"
#include "tests/core/import/gltf_skin_oracle.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_pose.h"

namespace gelenk {
namespace {

namespace fs = std::filesystem;
using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::GltfOracle;
using ::gelenk::testing::GltfSkinOracle;
using ::gelenk::testing::LargestError;
using ::gelenk::testing::OraclePositionError;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomTurns;
using ::gelenk::testing::StartNear;
using ::gelenk::testing::TurnedPose;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Quaternions in single precision are unit to about 1e-7, and are made so.
constexpr double kSinglePrecision = 1e-5;

fs::path CorpusFolder() {
  const char* named = std::getenv("GELENK_CORPUS");
  const fs::path data =
      named != nullptr
          ? fs::path(named)
          : fs::path(GELENK_SOURCE_DIR).parent_path() / "shared" / "data";
  return data / "gltf";
}

const fs::path kAssimpFolder = "/usr/share/assimp/models/glTF2";

// In any folder below, version 2 only.
std::vector<fs::path> Models(const fs::path& folder) {
  std::vector<fs::path> models;
  std::error_code none;
  for (const auto& entry : fs::recursive_directory_iterator(folder, none)) {
    const fs::path extension = entry.path().extension();
    if (extension == ".gltf" || extension == ".glb") {
      models.push_back(entry.path());
    }
  }
  std::sort(models.begin(), models.end());
  return models;
}

std::string ReadFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void ExpectRestWhereTheFileSays(const GltfOracle& oracle,
                                const GltfImport& import) {
  const Skeleton& skeleton = *import.skeleton;
  WorldTransforms frames;
  ForwardKinematics(skeleton, skeleton.rest_positions(), frames);
  double size = 1;
  for (const RigidTransform& frame : frames) {
    size = std::max(size, frame.translation.norm());
  }
  for (size_t node = 0; node < import.joint_of_node.size(); ++node) {
    const int joint = import.joint_of_node[node];
    if (joint < 0) continue;
    EXPECT_LT(
        (frames[joint].translation -
         oracle.SceneFromNode(static_cast<int>(node)).topRightCorner<3, 1>())
            .norm(),
        kSinglePrecision * size)
        << node;
  }
}

// All leaves at once, warm, from near by.
void ExpectLeavesAreReached(const std::shared_ptr<const Skeleton>& skeleton) {
  std::vector<bool> is_parent(skeleton->joint_count(), false);
  for (int i = 1; i < skeleton->joint_count(); ++i) {
    is_parent[skeleton->span(i).parent] = true;
  }
  Random random(1);
  const Eigen::VectorXd pose =
      StartNear(random, *skeleton, skeleton->rest_positions(), 0.3);
  std::vector<Goal> goals;
  for (int i = 0; i < skeleton->joint_count(); ++i) {
    if (is_parent[i]) continue;
    const std::string& id = skeleton->joint(i).id;
    goals.push_back(
        PositionGoalFor(id, EffectorPose(*skeleton, pose, id).translation));
  }
  const absl::StatusOr<IkProblem> problem = IkProblem::Create(skeleton, goals);
  ASSERT_TRUE(problem.ok()) << problem.status();
  LevenbergMarquardtSolver solver;
  SolveReport report;
  Eigen::VectorXd solved = skeleton->rest_positions();
  solver.Solve(*problem, SolverOptions(), SolveStart::kCold, solved, report);
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
  for (const Goal& goal : goals) {
    EXPECT_LT(OraclePositionError(*skeleton, goal, solved), 1e-4);
  }
}

TEST(GltfCorpusTest, EveryModelStandsAndReaches) {
  const std::vector<fs::path> models = Models(CorpusFolder());
  if (models.empty()) {
    GTEST_SKIP() << "SKIPPED: no models in " << CorpusFolder();
  }
  for (const fs::path& path : models) {
    SCOPED_TRACE(path);
    const std::string bytes = ReadFile(path);
    const absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
    ASSERT_TRUE(document.ok()) << document.status();
    const absl::StatusOr<GltfImport> import = ImportGltf(*document);
    ASSERT_TRUE(import.ok()) << import.status();
    ExpectRestWhereTheFileSays(GltfOracle(bytes), *import);
    ExpectLeavesAreReached(import->skeleton);
  }
}

// Animations become clips, those of every sampler.
TEST(GltfCorpusTest, EveryAnimationPlays) {
  const std::vector<fs::path> models = Models(CorpusFolder());
  if (models.empty()) {
    GTEST_SKIP() << "SKIPPED: no models in " << CorpusFolder();
  }
  for (const fs::path& path : models) {
    SCOPED_TRACE(path);
    const std::string bytes = ReadFile(path);
    const absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
    ASSERT_TRUE(document.ok()) << document.status();
    const absl::StatusOr<GltfImport> import = ImportGltf(*document);
    ASSERT_TRUE(import.ok()) << import.status();
    const auto animations =
        ReadGltfAnimations(bytes, *document, [&](absl::string_view uri) {
          return absl::StatusOr<std::string>(
              ReadFile(path.parent_path() / std::string(uri)));
        });
    ASSERT_TRUE(animations.ok()) << animations.status();
    for (const GltfAnimation& animation : *animations) {
      const absl::StatusOr<GltfClip> clip =
          ClipFromGltf(animation, *document, *import);
      ASSERT_TRUE(clip.ok()) << clip.status();
      // Scales move no joint; the clip says so.
      EXPECT_TRUE(clip->clip.duration_s() > 0 || !clip->warnings.empty());
      EXPECT_TRUE(FramesFromClip(clip->clip).ok());
      const absl::StatusOr<std::string> out =
          WriteGltf(clip->clip, GltfForm::kBinary);
      ASSERT_TRUE(out.ok()) << out.status();
      EXPECT_TRUE(ReadGltf(*out).ok());
    }
  }
}

// Every vertex where the format's formula has it, in any pose.
TEST(GltfCorpusTest, EverySkinDeformsAsTheFormulaSays) {
  const std::vector<fs::path> models = Models(CorpusFolder());
  if (models.empty()) {
    GTEST_SKIP() << "SKIPPED: no models in " << CorpusFolder();
  }
  Random random(1);
  int skins = 0;
  for (const fs::path& path : models) {
    SCOPED_TRACE(path);
    const std::string bytes = ReadFile(path);
    const absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
    ASSERT_TRUE(document.ok()) << document.status();
    if (document->skins.empty()) continue;
    ++skins;
    const absl::StatusOr<GltfImport> import = ImportGltf(*document);
    ASSERT_TRUE(import.ok()) << import.status();
    const absl::StatusOr<GltfSkinnedMesh> read =
        ReadGltfSkin(bytes, *document, *import);
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_THAT(read->warnings, IsEmpty());
    const auto skin = WeightedSkin::Create(import->skeleton, read->mesh,
                                           read->weights, BindOptions(*read));
    ASSERT_TRUE(skin.ok()) << skin.status();
    const GltfSkinOracle oracle(bytes);
    SkinWorkspace workspace;
    VertexBlocks blocks;
    for (double most_rad : {0.0, 0.5, 2.0}) {
      const TurnedPose pose = RandomTurns(random, *import, most_rad);
      (*skin)->Deform(pose.positions, {}, workspace, blocks);
      EXPECT_LT(LargestError(oracle.Positions(pose.turns), **skin, blocks),
                kSinglePrecision)
          << most_rad;
    }
  }
  EXPECT_GT(skins, 0);
}

// These hold all sorts of faults; what is no fault must import.
TEST(GltfCorpusTest, ModelsOfAssimpImportOrSayWhyNot) {
  const std::vector<fs::path> models = Models(kAssimpFolder);
  if (models.empty()) {
    GTEST_SKIP() << "SKIPPED: no models in " << kAssimpFolder;
  }
  for (const fs::path& path : models) {
    SCOPED_TRACE(path);
    const std::string bytes = ReadFile(path);
    const absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
    if (!document.ok()) {
      EXPECT_EQ(document.status().code(), absl::StatusCode::kInvalidArgument);
      continue;
    }
    const absl::StatusOr<GltfImport> import = ImportGltf(*document);
    if (import.ok()) ExpectRestWhereTheFileSays(GltfOracle(bytes), *import);
  }
}

TEST(GltfCorpusTest, ModelsInCentimetresAreTold) {
  const fs::path path = CorpusFolder() / "Fox.glb";
  if (!fs::exists(path)) GTEST_SKIP() << "SKIPPED: no " << path;
  const absl::StatusOr<GltfDocument> document = ReadGltf(ReadFile(path));
  ASSERT_TRUE(document.ok());
  const absl::StatusOr<GltfImport> import = ImportGltf(*document);
  ASSERT_TRUE(import.ok());
  EXPECT_THAT(import->warnings, Contains(HasSubstr("m large")));
  EXPECT_EQ(import->skeleton->joint_count(), 24);
}

}  // namespace
}  // namespace gelenk

// Where joints are, beside another reader of the same files: Assimp. Only built
// where libassimp-dev is found.

#include <gtest/gtest.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/formats/bvh_motion.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "tests/testing/body_clips.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

namespace fs = std::filesystem;

// Of the body's size; Assimp reads floats.
constexpr double kTolerance = 1e-5;
constexpr int kComparedFrames = 40;

// A scene of one clip: its joints in the order of the file.
class AssimpClip {
 public:
  explicit AssimpClip(const std::string& text) {
    scene_ = importer_.ReadFileFromMemory(text.data(), text.size(), 0, "bvh");
    if (scene_ == nullptr || scene_->mNumAnimations == 0) return;
    const aiAnimation& animation = *scene_->mAnimations[0];
    for (unsigned i = 0; i < animation.mNumChannels; ++i) {
      channels_[animation.mChannels[i]->mNodeName.C_Str()] =
          animation.mChannels[i];
    }
  }

  bool ok() const { return scene_ != nullptr && !channels_.empty(); }

  std::vector<Eigen::Vector3d> JointsAt(int frame) const {
    std::vector<Eigen::Vector3d> places;
    Visit(*scene_->mRootNode, aiMatrix4x4(), frame, places);
    return places;
  }

 private:
  static bool IsEndSite(const aiNode& node) {
    return std::strncmp(node.mName.C_Str(), "EndSite", 7) == 0;
  }

  void Visit(const aiNode& node, const aiMatrix4x4& world_from_parent,
             int frame, std::vector<Eigen::Vector3d>& places) const {
    if (IsEndSite(node)) return;
    const aiMatrix4x4 world_from_node =
        world_from_parent * LocalAt(node, frame);
    places.emplace_back(world_from_node.a4, world_from_node.b4,
                        world_from_node.c4);
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
      Visit(*node.mChildren[i], world_from_node, frame, places);
    }
  }

  aiMatrix4x4 LocalAt(const aiNode& node, int frame) const {
    const auto found = channels_.find(node.mName.C_Str());
    if (found == channels_.end()) return node.mTransformation;
    const aiNodeAnim& channel = *found->second;
    const auto key = [frame](unsigned count) {
      return std::min(static_cast<unsigned>(frame), count - 1);
    };
    return aiMatrix4x4(
        aiVector3D(1, 1, 1),
        channel.mRotationKeys[key(channel.mNumRotationKeys)].mValue,
        channel.mPositionKeys[key(channel.mNumPositionKeys)].mValue);
  }

  Assimp::Importer importer_;
  const aiScene* scene_ = nullptr;
  std::map<std::string, const aiNodeAnim*> channels_;
};

double SizeOf(const BvhDocument& document) {
  std::vector<double> reach;
  double longest = 0;
  for (const BvhJoint& joint : document.joints) {
    reach.push_back(
        joint.parent < 0 ? 0 : reach[joint.parent] + joint.offset.norm());
    longest = std::max(longest, reach.back());
  }
  return longest;
}

void ExpectTheSame(const std::string& text) {
  const auto document = ReadBvh(text);
  ASSERT_TRUE(document.ok()) << document.status();
  const auto import = ImportBvh(*document);
  ASSERT_TRUE(import.ok()) << import.status();
  const auto poses = PosesFromBvh(*document, *import);
  ASSERT_TRUE(poses.ok()) << poses.status();
  const AssimpClip other(text);
  ASSERT_TRUE(other.ok());
  const double tolerance = kTolerance * SizeOf(*document);
  WorldTransforms world_from_joints;
  const int step = std::max(1, document->frame_count() / kComparedFrames);
  for (int frame = 0; frame < document->frame_count(); frame += step) {
    ForwardKinematics(*import->skeleton, poses->col(frame), world_from_joints);
    const std::vector<Eigen::Vector3d> expected = other.JointsAt(frame);
    ASSERT_EQ(expected.size(), document->joints.size());
    for (size_t i = 0; i < expected.size(); ++i) {
      const Eigen::Vector3d actual =
          world_from_joints[import->joints[i]].translation / import->unit_m;
      ASSERT_LT((actual - expected[i]).norm(), tolerance)
          << document->joints[i].name << " in frame " << frame;
    }
  }
}

TEST(BvhAssimpTest, AWalkStandsWhereAssimpHasIt) {
  ExpectTheSame(testing::WalkingBvh(60));
}

// The root's offset is replaced; another order at every joint.
TEST(BvhAssimpTest, EveryOrderOfRotationStandsWhereAssimpHasIt) {
  std::string joints;
  std::string ends;
  std::string frames;
  const char* const orders[] = {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"};
  int depth = 0;
  for (const char* order : orders) {
    absl::StrAppend(&joints, depth == 0 ? "ROOT" : "JOINT", " j", depth,
                    " { OFFSET 1 ", 2 + depth, " 3 CHANNELS ",
                    depth == 0 ? "6 Xposition Yposition Zposition " : "3 ");
    for (const char* axis = order; *axis != 0; ++axis) {
      absl::StrAppend(&joints, std::string(1, *axis), "rotation ");
    }
    joints += "\n";
    ends += "}\n";
    ++depth;
  }
  joints += "End Site { OFFSET 0 1 0 }\n";
  for (int frame = 0; frame < 5; ++frame) {
    absl::StrAppend(&frames, frame, " 20 -3");
    for (int i = 0; i < 3 * depth; ++i) {
      absl::StrAppend(&frames, " ", (37 * (frame + 1) * (i + 2)) % 359 - 180);
    }
    frames += "\n";
  }
  ExpectTheSame(absl::StrCat("HIERARCHY\n", joints, ends,
                             "MOTION\nFrames: 5\nFrame Time: 0.01\n", frames));
}

// Those of the corpus and of Debian's assimp-testmodels, where they are.
TEST(BvhAssimpTest, RealClipsStandWhereAssimpHasThem) {
  std::vector<fs::path> clips = testing::FilesWith(
      testing::CorpusFolder(GELENK_SOURCE_DIR) / "bvh", ".bvh");
  for (const fs::path& clip :
       testing::FilesWith("/usr/share/assimp/models/BVH", ".bvh")) {
    clips.push_back(clip);
  }
  if (clips.empty()) GTEST_SKIP() << "no clips";
  for (const fs::path& clip : clips) {
    SCOPED_TRACE(clip);
    ExpectTheSame(testing::FileText(clip));
  }
}

}  // namespace
}  // namespace gelenk

#include "gelenk/import/gltf_clip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/import/gltf_writer.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/sampler.h"
#include "tests/core/import/gltf_buffer.h"
#include "tests/testing/gltf_files.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Bytes;
using ::gelenk::testing::Fails;
using ::gelenk::testing::Glb;
using ::gelenk::testing::GltfBuffer;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr absl::StatusCode kBad = absl::StatusCode::kInvalidArgument;
// Numbers in the files have 24 bits.
constexpr double kSinglePrecision = 1e-6;

// Two joints: "hip", moved and turned by an armature above it, and "knee" with
// a rest rotation; its buffer, accessors and channels are put together below.
struct File : GltfBuffer {
  std::string samplers;
  std::string channels;

  void AddChannel(int node, const char* path, int input, int output,
                  const char* interpolation) {
    absl::StrAppend(
        &channels, channels.empty() ? "" : ",", "{\"sampler\":", sampler_count,
        ",\"target\":{\"node\":", node, ",\"path\":\"", path, "\"}}");
    absl::StrAppend(&samplers, samplers.empty() ? "" : ",",
                    "{\"input\":", input, ",\"output\":", output,
                    ",\"interpolation\":\"", interpolation, "\"}");
    ++sampler_count;
  }
  int sampler_count = 0;

  std::string Json(const std::string& members) const {
    return absl::StrCat(
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)",
        R"("skins":[{"joints":[1,2]}],"nodes":[)",
        R"({"name":"armature","children":[1],"rotation":[0.6,0,0,0.8],)",
        R"("scale":[2,2,2],"translation":[1,2,3]},)",
        R"({"name":"hip","children":[2],"translation":[0,1,0]},)",
        R"({"name":"knee","translation":[0,1,0],"rotation":[0,0.6,0,0.8]}],)",
        R"("animations":[{"name":"move","channels":[)", channels,
        "],\"samplers\":[", samplers, "]}],", members, "}");
  }
  std::string Gltf() const { return Json(Members()); }
};

File MovingFile() {
  File file;
  file.AddView(Bytes<float>({0, 2}));
  file.AddView(Bytes<float>({0, 0, 0, 1, 0, 0, 0.6F, 0.8F}));
  file.AddView(Bytes<float>({0, 1, 0, 0, 1, 5}));
  file.AddAccessor(
      R"("bufferView":0,"componentType":5126,"count":2,"type":"SCALAR")");
  file.AddAccessor(
      R"("bufferView":1,"componentType":5126,"count":2,"type":"VEC4")");
  file.AddAccessor(
      R"("bufferView":2,"componentType":5126,"count":2,"type":"VEC3")");
  file.AddChannel(1, "rotation", 0, 1, "LINEAR");
  file.AddChannel(1, "translation", 0, 2, "STEP");
  file.AddChannel(2, "rotation", 0, 1, "LINEAR");
  return file;
}

absl::StatusOr<std::vector<GltfAnimation>> Animations(
    const std::string& bytes, const OpenUri& open = {}) {
  const absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
  if (!document.ok()) return document.status();
  return ReadGltfAnimations(bytes, *document, open);
}

absl::StatusOr<GltfClip> ClipOf(const std::string& bytes, size_t index = 0) {
  const absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
  if (!document.ok()) return document.status();
  const auto animations = ReadGltfAnimations(bytes, *document);
  if (!animations.ok()) return animations.status();
  const absl::StatusOr<GltfImport> import = ImportGltf(*document);
  if (!import.ok()) return import.status();
  return ClipFromGltf(animations->at(index), *document, *import);
}

Eigen::VectorXd At(const MotionClip& clip, double time_s) {
  Eigen::VectorXd positions(clip.skeleton()->position_count());
  Sampler(clip).Sample(time_s, positions);
  return positions;
}

TEST(GltfClipTest, JointsAreWhereTheSceneShowsThem) {
  const absl::StatusOr<GltfClip> read = ClipOf(MovingFile().Gltf());
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_THAT(read->warnings, IsEmpty());
  EXPECT_EQ(read->clip.name(), "move");
  EXPECT_EQ(read->clip.duration_s(), 2);
  // By hand, as the format composes nodes: a quarter of the way.
  const Eigen::Quaterniond half = Eigen::Quaterniond::Identity().slerp(
      0.25, Eigen::Quaterniond(0.8, 0, 0, 0.6));
  const Eigen::Affine3d armature = Eigen::Translation3d(1, 2, 3) *
                                   Eigen::Quaterniond(0.8, 0.6, 0, 0) *
                                   Eigen::Scaling(2.0);
  const Eigen::Affine3d hip = armature * Eigen::Translation3d(0, 1, 0) * half;
  const Eigen::Affine3d knee = hip * Eigen::Translation3d(0, 1, 0) * half;
  WorldTransforms frames;
  ForwardKinematics(*read->clip.skeleton(), At(read->clip, 0.5), frames);
  EXPECT_LT((frames[0].translation - hip.translation()).norm(),
            kSinglePrecision);
  EXPECT_LT((frames[1].translation - knee.translation()).norm(),
            kSinglePrecision);
  EXPECT_LT(
      AngleBetween(frames[1].rotation, Eigen::Quaterniond(knee.rotation())),
      kSinglePrecision);
  // STEP until the last key.
  ForwardKinematics(*read->clip.skeleton(), At(read->clip, 2), frames);
  EXPECT_LT(
      (frames[0].translation - armature * Eigen::Vector3d(0, 1, 5)).norm(),
      kSinglePrecision);
}

TEST(GltfClipTest, ChannelsBindByIndexWhateverNodesAreCalled) {
  const std::string bytes = MovingFile().Gltf();
  const absl::StatusOr<GltfClip> named = ClipOf(bytes);
  const absl::StatusOr<GltfClip> alike = ClipOf(absl::StrReplaceAll(
      bytes, {{"\"armature\"", "\"knee\""}, {"\"hip\"", "\"knee\""}}));
  ASSERT_TRUE(named.ok() && alike.ok()) << alike.status();
  for (double time_s : {0.0, 0.5, 1.9, 2.0}) {
    EXPECT_EQ(At(alike->clip, time_s), At(named->clip, time_s)) << time_s;
  }
}

double FrameTimeOfKeysAt(const std::vector<double>& times_s) {
  const GltfDocument document = ReadGltf(MovingFile().Gltf()).value();
  const GltfImport import = ImportGltf(document).value();
  GltfChannel channel = {.node = 2, .times_s = times_s};
  channel.values.setZero(4, static_cast<Eigen::Index>(times_s.size()));
  channel.values.row(3).setOnes();
  const absl::StatusOr<GltfClip> read =
      ClipFromGltf({.channels = {channel}}, document, import);
  EXPECT_TRUE(read.ok()) << read.status();
  return read.ok() ? read->clip.properties().frame_time_s : -1;
}

TEST(GltfClipTest, EvenKeysAreFrames) {
  std::vector<double> times_s;
  for (int i = 0; i < 50; ++i) {
    times_s.push_back(static_cast<double>(static_cast<float>(i) / 30.0F));
  }
  EXPECT_EQ(FrameTimeOfKeysAt(times_s), 1.0 / 30);
  times_s[20] += 0.01;
  EXPECT_EQ(FrameTimeOfKeysAt(times_s), 0);
  // What an animator sets, and what is too little to tell.
  EXPECT_EQ(FrameTimeOfKeysAt({0, 0.5, 1, 1.5}), 0);
  EXPECT_EQ(FrameTimeOfKeysAt({0, 0.02}), 0);
}

// By appendix C of the format, a quarter of the way through two seconds: the
// weights of value, out tangent, value, in tangent are 0.84375, 2 * 0.140625,
// 0.15625 and 2 * -0.046875.
TEST(GltfClipTest, CubicSplineIsExact) {
  File file;
  file.AddView(Bytes<float>({0, 2}));
  file.AddView(Bytes<float>({9, 9, 9, 9, 0, 0, 0,    1,    0, 0, 1, 0,  //
                             0, 0, 0, 1, 0, 0, 0.6F, 0.8F, 9, 9, 9, 9}));
  file.AddAccessor(
      R"("bufferView":0,"componentType":5126,"count":2,"type":"SCALAR")");
  file.AddAccessor(
      R"("bufferView":1,"componentType":5126,"count":6,"type":"VEC4")");
  file.AddChannel(1, "rotation", 0, 1, "CUBICSPLINE");
  const absl::StatusOr<GltfClip> read = ClipOf(file.Gltf());
  ASSERT_TRUE(read.ok()) << read.status();
  const Eigen::VectorXd pose = At(read->clip, 0.5);
  // The armature's rotation stands before it.
  const Eigen::Vector4d sum(0, 0, 0.15625 * 0.6 + 0.28125,
                            0.84375 + 0.15625 * 0.8 - 0.09375);
  Eigen::Quaterniond local;
  local.coeffs() = sum.normalized();
  EXPECT_LT(AngleBetween(QuaternionXyzw(pose.data() + 3),
                         Eigen::Quaterniond(0.8, 0.6, 0, 0) * local),
            kSinglePrecision);
}

TEST(GltfClipTest, NormalizedIntegersStridesAndSparseValues) {
  File file;
  file.AddView(Bytes<float>({0, 1, 2}));
  // As shorts, 12 bytes apart.
  file.AddView(Bytes<int16_t>({0, 0, 0, 32767, 7, 7,  //
                               32767, 0, 0, 0, 7, 7,  //
                               0, -32768, 0, 0}));
  file.view_list.insert(file.view_list.size() - 1, ",\"byteStride\":12");
  file.AddView(Bytes<uint8_t>({1}));
  file.AddView(Bytes<float>({0.6F, 0, 0, 0.8F}));
  file.AddAccessor(
      R"("bufferView":0,"componentType":5126,"count":3,"type":"SCALAR")");
  file.AddAccessor(R"("bufferView":1,"componentType":5122,"normalized":true,)"
                   R"("count":3,"type":"VEC4")");
  file.AddAccessor(
      R"("componentType":5126,"count":3,"type":"VEC3",)"
      R"("sparse":{"count":1,"indices":{"bufferView":2,"componentType":5121},)"
      R"("values":{"bufferView":3}})");
  file.AddChannel(2, "rotation", 0, 1, "LINEAR");
  file.AddChannel(1, "translation", 0, 2, "LINEAR");
  const auto animations = Animations(file.Gltf());
  ASSERT_TRUE(animations.ok()) << animations.status();
  Eigen::MatrixXd rotations(4, 3);
  rotations << 0, 1, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0;
  EXPECT_EQ((*animations)[0].channels[0].values, rotations);
  Eigen::MatrixXd translations = Eigen::MatrixXd::Zero(3, 3);
  translations(0, 1) = 0.6F;
  EXPECT_EQ((*animations)[0].channels[1].values, translations);
}

TEST(GltfClipTest, BuffersInAGlbAndInOtherFiles) {
  const File file = MovingFile();
  const std::string plain =
      file.Members(absl::StrCat("{\"byteLength\":", file.buffer.size(), "}"));
  EXPECT_TRUE(ClipOf(Glb(file.Json(plain), file.buffer)).ok());
  EXPECT_THAT(ClipOf(file.Json(plain)).status(), Fails(kBad, "neither a uri"));
  const std::string other =
      file.Json(file.Members("{\"byteLength\":9,\"uri\":\"walk.bin\"}"));
  EXPECT_THAT(Animations(other).status(), Fails(kBad, "another file, \"walk"));
  const auto opened = Animations(other, [&](absl::string_view uri) {
    EXPECT_EQ(uri, "walk.bin");
    return absl::StatusOr<std::string>(file.buffer);
  });
  EXPECT_TRUE(opened.ok()) << opened.status();
  EXPECT_THAT(Animations(other,
                         [](absl::string_view) -> absl::StatusOr<std::string> {
                           return absl::NotFoundError("gone");
                         })
                  .status(),
              Fails(kBad, "buffers[0].uri: gone"));
}

struct Mistake {
  const char* from;
  const char* to;
  const char* words;
};

TEST(GltfClipTest, RefusesWhatIsMalformedByPath) {
  const Mistake mistakes[] = {
      {"\"count\":2,\"type\":\"SCALAR\"", "\"count\":3,\"type\":\"SCALAR\"",
       "accessors[0]: 3 elements end at byte 12 of bufferViews[0]"},
      {"\"count\":2,\"type\":\"SCALAR\"",
       "\"count\":99999999999999,\"type\":\"SCALAR\"", "accessors[0].count"},
      {"\"count\":2,\"type\":\"SCALAR\"", "\"count\":0,\"type\":\"SCALAR\"",
       "want 1 to"},
      {"\"count\":2,\"type\":\"SCALAR\"", "\"count\":-2,\"type\":\"SCALAR\"",
       "whole number"},
      {"\"type\":\"VEC4\"", "\"type\":\"VEC3\"",
       "accessors[1].type: want VEC4"},
      {"\"componentType\":5126", "\"componentType\":5125", "componentType"},
      {"\"byteOffset\":8,\"byteLength\":32",
       "\"byteOffset\":8,\"byteLength\":9999", "bufferViews[1]: bytes 8 to"},
      {"\"bufferView\":1", "\"bufferView\":7", "bufferViews[7]: there are 3"},
      {"\"input\":0", "\"input\":8", "accessors[8]: there are 3"},
      {"\"sampler\":1", "\"sampler\":9", "samplers[9]: there are 3"},
      {"LINEAR", "CUBIC", "want STEP, LINEAR or CUBICSPLINE, got \"CUBIC\""},
      {"\"STEP\"", "\"CUBICSPLINE\"", "accessors[2].count: want 6 for 2 keys"},
      {"\"input\":0,\"output\":1", "\"input\":0", "output: missing"},
      {"base64,", "base64,!", "no data in base64"},
      {"\"node\":2,\"path\":\"rotation\"", "\"node\":1,\"path\":\"rotation\"",
       "has such a channel already"},
      {"\"path\":\"translation\"", "\"path\":\"colour\"", "target.path"},
  };
  for (const Mistake& mistake : mistakes) {
    const std::string right = MovingFile().Gltf();
    const std::string wrong =
        absl::StrReplaceAll(right, {{mistake.from, mistake.to}});
    ASSERT_NE(right, wrong) << mistake.from;
    EXPECT_THAT(Animations(wrong).status(), Fails(kBad, mistake.words));
  }
  File file = MovingFile();
  const float same[] = {2, 2};
  std::memcpy(file.buffer.data(), same, sizeof(same));
  EXPECT_THAT(Animations(file.Gltf()).status(),
              Fails(kBad, "animations[0].channels[0]: input[1]"));
}

TEST(GltfClipTest, TellsWhatARigidSkeletonCannotDo) {
  File file = MovingFile();
  file.AddChannel(2, "translation", 0, 2, "LINEAR");
  file.AddChannel(2, "scale", 0, 2, "LINEAR");
  file.AddChannel(0, "rotation", 0, 1, "LINEAR");
  const absl::StatusOr<GltfClip> read = ClipOf(file.Gltf());
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->clip.track_count(), 3);
  EXPECT_THAT(read->warnings, Contains(HasSubstr("translations of 1 joints")));
  EXPECT_THAT(read->warnings, Contains(HasSubstr("scales of 1 nodes")));
  EXPECT_THAT(read->warnings, Contains(HasSubstr("nodes[0] (\"armature\")")));
}

// Everything of a clip comes round through a file, whatever its joints are.
TEST(GltfWriterTest, WritesWhatReadsBackAsTheSameMotion) {
  Random random(1);
  for (Interpolation interpolation :
       {Interpolation::kStep, Interpolation::kLinear,
        Interpolation::kCubicSpline, Interpolation::kCatmullRom}) {
    for (GltfForm form : {GltfForm::kJson, GltfForm::kBinary}) {
      const auto skeleton = RandomSkeleton(random);
      std::vector<JointTrack> tracks;
      for (const PosePart& part : PosePartsOf(*skeleton)) {
        JointTrack track{.joint = part.joint,
                         .kind = part.kind,
                         .interpolation = interpolation,
                         .times_s = {0, 0.25, 0.5}};
        track.values.resize(part.position_count, 3);
        for (int key = 0; key < 3; ++key) {
          track.values.col(key) =
              RandomPose(random, *skeleton)
                  .segment(part.position_offset, part.position_count);
        }
        if (interpolation == Interpolation::kCubicSpline) {
          track.in_tangents = track.out_tangents =
              Eigen::MatrixXd::Random(part.position_count, 3);
        }
        tracks.push_back(std::move(track));
      }
      const MotionClip clip =
          MotionClip::Create(skeleton, tracks,
                             {.name = "all", .frame_time_s = 0.25 / 16})
              .value();
      const absl::StatusOr<std::string> bytes = WriteGltf(clip, form);
      ASSERT_TRUE(bytes.ok()) << bytes.status();
      const absl::StatusOr<GltfClip> back = ClipOf(*bytes);
      ASSERT_TRUE(back.ok()) << back.status();
      EXPECT_EQ(back->clip.name(), "all");
      WorldTransforms expected, actual;
      for (int i = 0; i <= 32; ++i) {  // Sampled frames are among these.
        const double time_s = 0.25 / 16 * i;
        ForwardKinematics(*skeleton, At(clip, time_s), expected);
        ForwardKinematics(*back->clip.skeleton(), At(back->clip, time_s),
                          actual);
        for (int joint = 0; joint < skeleton->joint_count(); ++joint) {
          const std::string& id = skeleton->joint(joint).id;
          const int there = back->clip.skeleton()->FindJoint(id);
          ASSERT_GE(there, 0) << id;
          // Translations below the root are not read back.
          ASSERT_LT(
              AngleBetween(expected[joint].rotation, actual[there].rotation),
              // Of single precision, along a chain of 12 joints; near
              // the zero of a cubic it grows.
              2e-4)
              << id << " at " << time_s;
        }
      }
    }
  }
}

}  // namespace
}  // namespace gelenk

#include "server/rpc/file_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/testing/gltf_files.h"
#include "tests/testing/gripper_arm_urdf.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::BodyGltf;
using ::gelenk::testing::Glb;
using ::gelenk::testing::GripperArmUrdf;
using ::gelenk::testing::kBodyGltfJointCount;
using ::gelenk::testing::kGripperArmJointCount;
using ::gelenk::testing::kWalkingJointCount;
using ::gelenk::testing::WalkingBvh;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

v1::ImportHeader Header(v1::ImportFormat format) {
  v1::ImportHeader header;
  header.set_format(format);
  return header;
}

FileImport Import(const v1::ImportHeader& header, const std::string& bytes) {
  absl::StatusOr<FileImport> import = ImportFile(header, bytes, Limits());
  EXPECT_TRUE(import.ok()) << import.status();
  return *std::move(import);
}

TEST(FileImportTest, ReadsEveryFormat) {
  const FileImport bvh = Import(Header(v1::IMPORT_FORMAT_BVH), WalkingBvh(2));
  EXPECT_EQ(bvh.skeleton.skeleton->joint_count(), kWalkingJointCount);
  EXPECT_EQ(bvh.unit_m, 0.01);
  EXPECT_THAT(bvh.skeleton.warnings, Not(IsEmpty()));

  const FileImport urdf =
      Import(Header(v1::IMPORT_FORMAT_URDF), GripperArmUrdf());
  EXPECT_EQ(urdf.skeleton.skeleton->joint_count(), kGripperArmJointCount);
  EXPECT_EQ(urdf.unit_m, 1);
  EXPECT_THAT(urdf.skeleton.warnings, Not(IsEmpty()));

  for (const std::string& bytes : {BodyGltf(), Glb(BodyGltf())}) {
    const FileImport gltf = Import(Header(v1::IMPORT_FORMAT_GLTF), bytes);
    EXPECT_EQ(gltf.skeleton.skeleton->joint_count(), kBodyGltfJointCount);
    EXPECT_EQ(gltf.unit_m, 1);
  }
}

TEST(FileImportTest, TakesTheUnitOfFilesThatHaveNone) {
  v1::ImportHeader header = Header(v1::IMPORT_FORMAT_GLTF);
  header.set_unit_m(0.5);
  const FileImport gltf = Import(header, BodyGltf());
  EXPECT_EQ(gltf.unit_m, 0.5);
  EXPECT_NEAR(gltf.skeleton.skeleton->rest_positions()[1], 0.475, 1e-12);
  header.set_format(v1::IMPORT_FORMAT_BVH);
  EXPECT_EQ(Import(header, WalkingBvh(2)).unit_m, 0.5);
}

TEST(FileImportTest, KeepsTheServersLimitOfJoints) {
  Limits limits;
  const auto joints_allowed = [&limits](v1::ImportFormat format,
                                        const std::string& bytes, int most) {
    limits.max_joints = most;
    return ImportFile(Header(format), bytes, limits).ok();
  };
  EXPECT_TRUE(joints_allowed(v1::IMPORT_FORMAT_URDF, GripperArmUrdf(),
                             kGripperArmJointCount));
  EXPECT_FALSE(joints_allowed(v1::IMPORT_FORMAT_URDF, GripperArmUrdf(),
                              kGripperArmJointCount - 1));
  EXPECT_TRUE(
      joints_allowed(v1::IMPORT_FORMAT_GLTF, BodyGltf(), kBodyGltfJointCount));
  EXPECT_FALSE(joints_allowed(v1::IMPORT_FORMAT_GLTF, BodyGltf(),
                              kBodyGltfJointCount - 1));
}

TEST(FileImportTest, MalformedFilesAreTheCallersMistake) {
  for (v1::ImportFormat format : {v1::IMPORT_FORMAT_BVH, v1::IMPORT_FORMAT_URDF,
                                  v1::IMPORT_FORMAT_GLTF}) {
    EXPECT_EQ(ImportFile(Header(format), "<x", Limits()).status().code(),
              absl::StatusCode::kInvalidArgument);
  }
}

TEST(FileImportTest, FormatsAndTheirUnitsAreChecked) {
  for (v1::ImportFormat format : {v1::IMPORT_FORMAT_BVH, v1::IMPORT_FORMAT_URDF,
                                  v1::IMPORT_FORMAT_GLTF}) {
    EXPECT_TRUE(CheckImportFormat(Header(format)).ok());
  }
  for (int format : {0, 99}) {
    EXPECT_THAT(std::string(CheckImportFormat(
                                Header(static_cast<v1::ImportFormat>(format)))
                                .message()),
                HasSubstr("header.format: no such format: "));
  }
  v1::ImportHeader header = Header(v1::IMPORT_FORMAT_URDF);
  header.set_unit_m(1);
  EXPECT_TRUE(CheckImportFormat(header).ok());
  header.set_unit_m(0.01);
  EXPECT_EQ(std::string(CheckImportFormat(header).message()),
            "header.unit_m: a URDF is in metres, got 0.01");
}

}  // namespace
}  // namespace gelenk::server

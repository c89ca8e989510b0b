// Files go to a real gelenkd piece by piece, skeletons that solve come back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "gelenk/client/connection.h"
#include "tests/testing/gltf_files.h"
#include "tests/testing/gripper_arm_urdf.h"
#include "tests/testing/server_process.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// Small, so that every file comes in several.
constexpr size_t kPieceBytes = 200;

class ImportSkeletonTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(gelenkd_.Start(), absl::OkStatus());
    connection_ = std::make_unique<client::Connection>(gelenkd_.target());
  }

  grpc::Status Import(const v1::ImportHeader& header, const std::string& bytes,
                      v1::ImportSkeletonResponse* response) {
    grpc::ClientContext context;
    connection_->Prepare({}, context);
    const auto writer =
        connection_->kinematics().ImportSkeleton(&context, response);
    v1::ImportSkeletonRequest request;
    *request.mutable_header() = header;
    for (size_t at = 0; at < bytes.size(); at += kPieceBytes) {
      request.set_data(bytes.substr(at, kPieceBytes));
      // A server that has heard enough ends the call.
      if (!writer->Write(request)) break;
      request.clear_header();
    }
    writer->WritesDone();
    return writer->Finish();
  }

  v1::ImportSkeletonResponse Import(v1::ImportFormat format,
                                    const std::string& bytes) {
    v1::ImportHeader header;
    header.set_format(format);
    v1::ImportSkeletonResponse response;
    const grpc::Status status = Import(header, bytes, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }

  std::string Message(v1::ImportFormat format, const std::string& bytes) {
    v1::ImportHeader header;
    header.set_format(format);
    v1::ImportSkeletonResponse response;
    const grpc::Status status = Import(header, bytes, &response);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    return status.error_message();
  }

  // The server solves on what it stored.
  void ExpectReaches(const std::string& skeleton, const std::string& effector,
                     double x, double y, double z) {
    v1::SolveInverseKinematicsRequest request;
    request.set_skeleton(skeleton);
    v1::Goal* goal = request.add_goals();
    goal->set_goal_id("reach");
    goal->mutable_position()->set_end_effector_id(effector);
    v1::Vector3* position = goal->mutable_position()->mutable_world_position();
    position->set_x(x);
    position->set_y(y);
    position->set_z(z);
    const auto response = connection_->Call(
        &v1::KinematicsService::Stub::SolveInverseKinematics, request);
    ASSERT_TRUE(response.ok()) << response.status();
    EXPECT_EQ(response->report().outcome(), v1::SolveReport::OUTCOME_CONVERGED);
  }

  gelenk::testing::ServerProcess gelenkd_{GELENKD};
  std::unique_ptr<client::Connection> connection_;
};

TEST_F(ImportSkeletonTest, ARobotReachesWithALink) {
  const v1::ImportSkeletonResponse response =
      Import(v1::IMPORT_FORMAT_URDF, gelenk::testing::GripperArmUrdf());
  EXPECT_EQ(response.unit_m(), 1);
  EXPECT_EQ(response.skeleton().joints_size(),
            gelenk::testing::kGripperArmJointCount);
  EXPECT_EQ(response.skeleton().up().z(), 1);
  EXPECT_EQ(response.skeleton().warnings_size(), 2);
  ExpectReaches(response.skeleton().name(), "palm", 0.4, 0.3, 0.5);
}

TEST_F(ImportSkeletonTest, AModelReachesWithItsHand) {
  for (const std::string& bytes :
       {gelenk::testing::BodyGltf(),
        gelenk::testing::Glb(gelenk::testing::BodyGltf(), "mesh")}) {
    const v1::ImportSkeletonResponse response =
        Import(v1::IMPORT_FORMAT_GLTF, bytes);
    EXPECT_EQ(response.skeleton().joints_size(),
              gelenk::testing::kBodyGltfJointCount);
    EXPECT_EQ(response.skeleton().up().y(), 1);
    ExpectReaches(response.skeleton().name(), "LeftHand", 0.8, 1.2, 0.3);
  }
}

TEST_F(ImportSkeletonTest, AClipIsABody) {
  const v1::ImportSkeletonResponse response =
      Import(v1::IMPORT_FORMAT_BVH, gelenk::testing::WalkingBvh(3));
  EXPECT_EQ(response.unit_m(), 0.01);
  EXPECT_EQ(response.skeleton().joints_size(),
            gelenk::testing::kWalkingJointCount);
}

TEST_F(ImportSkeletonTest, FaultsAreToldByPlace) {
  std::string urdf = gelenk::testing::GripperArmUrdf();
  urdf.replace(urdf.find("lower=\"0.1\""), 11, "lower=\"abc\"");
  EXPECT_THAT(Message(v1::IMPORT_FORMAT_URDF, urdf),
              StartsWith("line 37: <limit lower=\"abc\"> of joint \"elbow\""));
  std::string gltf = gelenk::testing::BodyGltf();
  gltf.replace(gltf.find("[1, 7]"), 6, "[1, 9]");
  EXPECT_THAT(Message(v1::IMPORT_FORMAT_GLTF, gltf),
              HasSubstr("nodes[0].children[1]: want a node, 0 to 7, got 9"));
  const std::string glb = gelenk::testing::Glb(gelenk::testing::BodyGltf());
  EXPECT_THAT(Message(v1::IMPORT_FORMAT_GLTF, glb.substr(0, glb.size() - 9)),
              HasSubstr("cut off"));
  EXPECT_THAT(Message(v1::IMPORT_FORMAT_UNSPECIFIED, "x"),
              HasSubstr("header.format"));
}

}  // namespace
}  // namespace gelenk

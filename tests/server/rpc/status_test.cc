#include "server/rpc/status.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "gelenk/base/violations.h"
#include "gelenk/internal/v1/error_details.pb.h"

namespace gelenk::server {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

TEST(StatusTest, EveryCodeKeepsItsNumberAndMessage) {
  for (int code = 1; code <= 16; ++code) {
    const absl::Status status(static_cast<absl::StatusCode>(code), "why");
    const grpc::Status told = ToGrpc(status);
    EXPECT_EQ(static_cast<int>(told.error_code()), code);
    EXPECT_EQ(told.error_message(), "why");
    EXPECT_EQ(told.error_details(), "") << "there is no more to say";
    v1::FrameStatus frame_status;
    ToProto(status, &frame_status);
    EXPECT_EQ(frame_status.code(), code);
    EXPECT_EQ(frame_status.message(), "why");
  }
}

TEST(StatusTest, OkIsOk) {
  EXPECT_TRUE(ToGrpc(absl::OkStatus()).ok());
  v1::FrameStatus frame_status;
  ToProto(absl::OkStatus(), &frame_status);
  EXPECT_EQ(frame_status.code(), 0);
  EXPECT_EQ(frame_status.message(), "");
}

TEST(StatusTest, ViolationsTravelAsBadRequest) {
  Violations violations;
  violations.Add("skeleton.joints[3].axis", "want a unit vector");
  violations.Add("request_id", "want at most 64 bytes, got 70");
  const grpc::Status told = ToGrpc(violations.ToStatus());
  EXPECT_EQ(told.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(told.error_message(),
            "skeleton.joints[3].axis: want a unit vector; request_id: want at "
            "most 64 bytes, got 70");

  internal::v1::RpcStatus details;
  ASSERT_TRUE(details.ParseFromString(told.error_details()));
  EXPECT_EQ(details.code(), 3);
  EXPECT_EQ(details.message(), told.error_message());
  ASSERT_EQ(details.details_size(), 1);
  EXPECT_EQ(details.details(0).type_url(),
            "type.googleapis.com/google.rpc.BadRequest");
  internal::v1::BadRequest bad_request;
  ASSERT_TRUE(bad_request.ParseFromString(details.details(0).value()));
  ASSERT_EQ(bad_request.field_violations_size(), 2);
  EXPECT_EQ(bad_request.field_violations(0).field(), "skeleton.joints[3].axis");
  EXPECT_EQ(bad_request.field_violations(0).description(),
            "want a unit vector");
  EXPECT_EQ(bad_request.field_violations(1).field(), "request_id");
}

// As google/rpc/error_details.proto and status.proto have them.
TEST(StatusTest, DetailsHaveTheFieldNumbersOfTheGuidelines) {
  const auto* bad_request = internal::v1::BadRequest::descriptor();
  EXPECT_EQ(bad_request->FindFieldByName("field_violations")->number(), 1);
  const auto* violation =
      internal::v1::BadRequest::FieldViolation::descriptor();
  EXPECT_EQ(violation->FindFieldByName("field")->number(), 1);
  EXPECT_EQ(violation->FindFieldByName("description")->number(), 2);
  const auto* status = internal::v1::RpcStatus::descriptor();
  EXPECT_EQ(status->FindFieldByName("code")->number(), 1);
  EXPECT_EQ(status->FindFieldByName("message")->number(), 2);
  EXPECT_EQ(status->FindFieldByName("details")->number(), 3);
}

// Bytes on the wire: the message percent-encoded at worst, the details in
// base64.
size_t TrailerBytes(const grpc::Status& status) {
  return 3 * status.error_message().size() +
         (status.error_details().size() + 2) / 3 * 4;
}

// Clients refuse trailers of more than 8 KB; some room is for other headers.
constexpr size_t kMaxTrailerBytes = 7500;

TEST(StatusTest, ManyViolationsFitTheTrailers) {
  Violations violations;
  for (int i = 0; i < 100000; ++i) {
    violations.Add("skeleton.joints[12345].parent_from_joint.rotation",
                   "want a unit quaternion, got (0.25, 0.25, 0.25, 0.25)");
  }
  const grpc::Status told = ToGrpc(violations.ToStatus());
  EXPECT_LT(TrailerBytes(told), kMaxTrailerBytes);
  internal::v1::RpcStatus details;
  ASSERT_TRUE(details.ParseFromString(told.error_details()));
  internal::v1::BadRequest bad_request;
  ASSERT_TRUE(bad_request.ParseFromString(details.details(0).value()));
  EXPECT_GE(bad_request.field_violations_size(), 15);
}

TEST(StatusTest, ALongViolationFitsTheTrailers) {
  Violations violations;
  violations.Add(std::string(100000, 'f'), std::string(100000, 'd'));
  violations.Add("second", "is left out");
  const grpc::Status told = ToGrpc(violations.ToStatus());
  EXPECT_LT(TrailerBytes(told), kMaxTrailerBytes);
  internal::v1::RpcStatus details;
  ASSERT_TRUE(details.ParseFromString(told.error_details()));
  internal::v1::BadRequest bad_request;
  ASSERT_TRUE(bad_request.ParseFromString(details.details(0).value()));
  ASSERT_EQ(bad_request.field_violations_size(), 1);
  EXPECT_THAT(bad_request.field_violations(0).field(), StartsWith("fff"));
  EXPECT_THAT(bad_request.field_violations(0).description(), EndsWith(" ..."));
}

TEST(StatusTest, ShorteningCutsNoCharacterInTwo) {
  std::string umlauts;
  for (int i = 0; i < 5000; ++i) umlauts += "\xc3\xa4";
  for (const std::string& text : {umlauts, "a" + umlauts}) {
    std::string message = ToGrpc(absl::InternalError(text)).error_message();
    ASSERT_THAT(message, EndsWith(" ..."));
    message.resize(message.size() - 4);
    EXPECT_EQ(message.back(), '\xa4');
  }
}

}  // namespace
}  // namespace gelenk::server

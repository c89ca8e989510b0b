// Files in pieces over the wire: what is imported, what is refused, and that
// nothing stays of what was not finished.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "absl/time/clock.h"
#include "gelenk/client/status.h"
#include "tests/integration/service_test.h"
#include "tests/testing/status_matchers.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

using testing::Fails;
using testing::kPatience;
using testing::kWalkingJointCount;
using ::testing::SizeIs;
using testing::WalkingBvh;

using Stub = v1::KinematicsService::Stub;

constexpr int64_t kMaxImportBytes = 1 << 20;

v1::ImportHeader Header(const std::string& id = "") {
  v1::ImportHeader header;
  header.set_skeleton_id(id);
  header.set_format(v1::IMPORT_FORMAT_BVH);
  return header;
}

// One ImportSkeleton, message by message.
class Upload {
 public:
  explicit Upload(Stub& stub) {
    context_.set_deadline(std::chrono::system_clock::now() +
                          absl::ToChronoMicroseconds(kPatience));
    writer_ = stub.ImportSkeleton(&context_, &response_);
  }

  // False when the server takes no more.
  bool Send(const v1::ImportHeader& header, const std::string& data = "") {
    v1::ImportSkeletonRequest request;
    *request.mutable_header() = header;
    request.set_data(data);
    return writer_->Write(request);
  }
  bool Send(const std::string& data) {
    v1::ImportSkeletonRequest request;
    request.set_data(data);
    return writer_->Write(request);
  }
  // In pieces of at most `piece` bytes.
  void SendAll(const std::string& data, size_t piece) {
    for (size_t i = 0; i < data.size(); i += piece) {
      if (!Send(data.substr(i, piece))) return;
    }
  }
  void Cancel() { context_.TryCancel(); }

  absl::StatusOr<v1::ImportSkeletonResponse> Finish() {
    writer_->WritesDone();
    const absl::Status status = client::FromGrpc(writer_->Finish());
    if (!status.ok()) return status;
    return response_;
  }

 private:
  grpc::ClientContext context_;
  v1::ImportSkeletonResponse response_;
  std::unique_ptr<grpc::ClientWriter<v1::ImportSkeletonRequest>> writer_;
};

class ImportTest : public ServiceTest {
 protected:
  static void SetUpTestSuite() {
    StartServer({"--max-import-bytes", absl::StrCat(kMaxImportBytes),
                 "--max-imports", "2", "--max-joints", "20"});
  }

  static Stub& stub() { return connection().kinematics(); }

  static absl::StatusOr<v1::ImportSkeletonResponse> Import(
      const v1::ImportHeader& header, const std::string& data) {
    Upload upload(stub());
    upload.Send(header);
    upload.SendAll(data, 1 << 16);
    return upload.Finish();
  }

  static int SkeletonCount() {
    v1::ListSkeletonsRequest request;
    request.set_page_size(1000);
    const auto list = Call(&Stub::ListSkeletons, request);
    EXPECT_TRUE(list.ok()) << list.status();
    return list.ok() ? list->skeletons_size() : -1;
  }

  // Fails as told, and stores nothing.
  static void ExpectRefused(
      const absl::StatusOr<v1::ImportSkeletonResponse>& answer, int count,
      const std::string& words) {
    EXPECT_THAT(answer.status(),
                Fails(absl::StatusCode::kInvalidArgument, words));
    EXPECT_EQ(SkeletonCount(), count);
  }
};

TEST_F(ImportTest, PiecesOfAnySizeGiveTheSameSkeleton) {
  const std::string file = WalkingBvh(20);
  std::vector<std::string> skeletons;
  for (size_t piece : {size_t{1}, size_t{7}, size_t{4096}, file.size()}) {
    Upload upload(stub());
    // The header alone, or with the first piece.
    const size_t first = piece == 4096 ? 100 : 0;
    ASSERT_TRUE(upload.Send(Header(), file.substr(0, first)));
    upload.SendAll(file.substr(first), piece);
    auto answer = upload.Finish();
    ASSERT_TRUE(answer.ok()) << answer.status();
    EXPECT_EQ(answer->unit_m(), 0.01);
    EXPECT_THAT(answer->skeleton().joints(), SizeIs(kWalkingJointCount));
    answer->mutable_skeleton()->clear_name();
    answer->mutable_skeleton()->clear_create_time();
    skeletons.push_back(answer->skeleton().DebugString());
  }
  for (const std::string& skeleton : skeletons) {
    EXPECT_EQ(skeleton, skeletons[0]);
  }
}

TEST_F(ImportTest, TheSkeletonIsStoredUnderItsId) {
  const auto answer = Import(Header("walker"), WalkingBvh(2));
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(answer->skeleton().name(), "skeletons/walker");
  v1::GetSkeletonRequest get;
  get.set_name("skeletons/walker");
  EXPECT_EQ(Call(&Stub::GetSkeleton, get)->DebugString(),
            answer->skeleton().DebugString());
  const int count = SkeletonCount();
  EXPECT_THAT(Import(Header("walker"), WalkingBvh(2)).status(),
              Fails(absl::StatusCode::kAlreadyExists, "skeletons/walker"));
  EXPECT_EQ(SkeletonCount(), count);
}

TEST_F(ImportTest, ARepeatedRequestAnswersTheFirstResult) {
  v1::ImportHeader header = Header();
  header.set_request_id("once");
  const auto first = Import(header, WalkingBvh(2));
  ASSERT_TRUE(first.ok()) << first.status();
  const int count = SkeletonCount();
  EXPECT_EQ(Import(header, WalkingBvh(2))->DebugString(), first->DebugString());
  EXPECT_EQ(SkeletonCount(), count);
}

TEST_F(ImportTest, NothingIsNoFile) {
  const int count = SkeletonCount();
  ExpectRefused(Import(Header(), ""), count, "line 1");
  Upload upload(stub());
  ASSERT_TRUE(upload.Send(Header()));
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(upload.Send(""));
  ExpectRefused(upload.Finish(), count, "line 1");
}

TEST_F(ImportTest, TheFirstMessageHoldsTheHeaderAndNoOther) {
  const int count = SkeletonCount();
  Upload nothing(stub());
  ExpectRefused(nothing.Finish(), count, "header: ");
  Upload headless(stub());
  headless.SendAll(WalkingBvh(2), 1000);
  ExpectRefused(headless.Finish(), count, "header: ");
  Upload twice(stub());
  twice.Send(Header());
  twice.Send(Header(), WalkingBvh(2));
  ExpectRefused(twice.Finish(), count, "header: ");
}

TEST_F(ImportTest, BadHeadersAreRefusedByName) {
  const int count = SkeletonCount();
  v1::ImportHeader header = Header("X");
  header.clear_format();
  header.set_request_id(std::string(65, 'r'));
  const auto answer = Import(header, WalkingBvh(2));
  ExpectRefused(answer, count, "header.skeleton_id: ");
  ExpectRefused(answer, count, "header.request_id: ");
  ExpectRefused(answer, count, "header.format: ");
  header = Header();
  header.set_format(static_cast<v1::ImportFormat>(77));
  ExpectRefused(Import(header, WalkingBvh(2)), count, "77");
  header = Header();
  header.set_unit_m(-1);
  ExpectRefused(Import(header, WalkingBvh(2)), count, "unit_m");
}

TEST_F(ImportTest, OtherFilesThanTheHeaderSays) {
  const int count = SkeletonCount();
  ExpectRefused(Import(Header(), "<robot name=\"r\"/>"), count,
                "line 1, column 1");
  ExpectRefused(Import(Header(), std::string(1000, '\0')), count,
                "line 1, column 1");
}

TEST_F(ImportTest, BrokenFilesAreToldByLineAndColumn) {
  const int count = SkeletonCount();
  std::string file = WalkingBvh(2);
  file.replace(file.find("OFFSET 0 0 0"), 12, "OFFSET 0 x 0");
  ExpectRefused(Import(Header(), file), count, "line 4, column 10");
  file = WalkingBvh(50);
  ExpectRefused(Import(Header(), file.substr(0, file.size() / 2)), count,
                "line ");
}

TEST_F(ImportTest, SizesAreBoundedWhileTheyCome) {
  // Spaces at the end, up to the last byte that is taken.
  std::string file = WalkingBvh(2);
  file.resize(kMaxImportBytes, ' ');
  EXPECT_TRUE(Import(Header(), file).ok());
  const int count = SkeletonCount();
  ExpectRefused(Import(Header(), file + " "), count,
                absl::StrCat("data: want at most ", kMaxImportBytes));
  // Not only at the end.
  Upload upload(stub());
  upload.Send(Header());
  int pieces = 0;
  while (upload.Send(std::string(1 << 16, ' '))) ASSERT_LT(++pieces, 10000);
  ExpectRefused(upload.Finish(), count, "data: want at most");
}

TEST_F(ImportTest, JointsAreBounded) {
  std::string file = "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 0\n";
  for (int i = 0; i < 20; ++i) {
    file += "JOINT j" + absl::StrCat(i) + "\n{\nOFFSET 0 1 0\nCHANNELS 0\n";
  }
  file += "End Site\n{\nOFFSET 0 1 0\n}\n";
  for (int i = 0; i < 21; ++i) file += "}\n";
  file += "MOTION\nFrames: 0\nFrame Time: 0.02\n";
  ExpectRefused(Import(Header(), file), SkeletonCount(), "20");
}

TEST_F(ImportTest, CancelledOnesLeaveNothing) {
  const int count = SkeletonCount();
  // Whole but for the half-close, and large enough to be at it for a while.
  const std::string file = WalkingBvh(1000);
  ASSERT_LT(file.size(), kMaxImportBytes);
  // More than may be under way: each gives its place back.
  for (int i = 0; i < 6; ++i) {
    for (int attempt = 0;; ++attempt) {
      Upload upload(stub());
      ASSERT_TRUE(upload.Send(Header("cancelled")));
      upload.SendAll(file, 1 << 16);
      absl::SleepFor(absl::Milliseconds(20));
      upload.Cancel();
      const absl::Status status = upload.Finish().status();
      ASSERT_FALSE(status.ok());
      if (status.code() == absl::StatusCode::kCancelled) break;
      ASSERT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
      ASSERT_LT(attempt, 100) << "the places do not come back";
      absl::SleepFor(absl::Milliseconds(20));
    }
  }
  // Time for whoever would store it all the same.
  absl::SleepFor(absl::Milliseconds(200));
  EXPECT_EQ(SkeletonCount(), count);
}

TEST_F(ImportTest, OnlySoManyAreUnderWay) {
  Upload first(stub());
  Upload second(stub());
  ASSERT_TRUE(first.Send(Header()));
  ASSERT_TRUE(second.Send(Header()));
  // The two may still be on their way, or one before not yet gone.
  absl::Status status;
  for (int i = 0; i < 100 && status.ok(); ++i) {
    status = Import(Header(), WalkingBvh(2)).status();
  }
  EXPECT_THAT(status, Fails(absl::StatusCode::kResourceExhausted, "imports"));
  for (Upload* upload : {&first, &second}) {
    upload->SendAll(WalkingBvh(2), 1000);
    EXPECT_TRUE(upload->Finish().ok());
  }
  EXPECT_TRUE(Import(Header(), WalkingBvh(2)).ok());
}

}  // namespace
}  // namespace gelenk

#include "tests/architecture/include_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace gelenk::architecture {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// What can be included, by the name used in the architecture.
const std::string kStd = "<";
const std::string kCore = "gelenk/";
const std::string kImport = "gelenk/import/";  // A library of its own.
const std::string kGenerated = "gelenk/v1/";
const std::string kInternal = "gelenk/internal/";  // Messages of our own.
const std::string kClient = "gelenk/client/";
const std::string kConvert = "convert/";
const std::string kGrpc = "grpcpp/";
const std::string kHealth = "grpc/health/v1/";  // Generated, gRPC's own.
// What every room of the server may know about the server as a whole.
const std::string kOptions = "server/options.h";
const std::string kVersion = "server/version.h";
const std::string kClock = "server/clock.h";

using Includes = std::vector<std::string>;

Includes operator+(Includes left, const Includes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

const Includes kPosix = {"unistd.h", "fcntl.h",   "signal.h",
                         "poll.h",   "pthread.h", "sys/",
                         "netdb.h",  "arpa/",     "netinet/"};

// clang-format off

// core has no input and output, no clock and no thread.
const Includes kNotInCore = {
    kGenerated, kInternal, kClient,
    "<iostream>", "<fstream>", "<cstdio>", "<filesystem>",
    "<chrono>", "<ctime>", "absl/time/clock.h",
    "<thread>", "<stop_token>", "<mutex>", "<shared_mutex>", "<future>",
    "<semaphore>", "<latch>", "<barrier>", "<condition_variable>", "<csignal>",
    "absl/synchronization/"};

// The arrows, and no others. The longest fitting prefix decides.
const std::vector<Room>& House() {
  static const std::vector<Room> kHouse = {
    // core: the kinematics library, usable without the service.
    {"core/",           {kStd, "Eigen/", "absl/", kCore},
                        kNotInCore + Includes{kImport}},

    // import: what core reads by way of an XML or JSON parser.
    {"core/gelenk/import/",
                        {kStd, "Eigen/", "absl/", kCore, "tinyxml2.h",
                         "nlohmann/"}, kNotInCore},

    // convert: the only code that knows both messages and core types.
    {"proto/convert/",  {kStd, "Eigen/", "absl/", kCore, kGenerated,
                         kInternal, kConvert, "google/protobuf/"},
                        {kClient, kImport}},

    // session, store: the server's domain, without gRPC and messages. Stores
    // may use what sessions are made of, not the other way round.
    {"server/session/", {kStd, "Eigen/", "absl/", kCore, kClock,
                         "server/session/"},
                        {kGenerated, kInternal, kClient, kImport}},
    {"server/store/",   {kStd, "absl/", kCore, "server/session/",
                         "server/store/"},
                        {kGenerated, kInternal, kClient, kImport}},

    // rpc: convert, call, convert, return.
    {"server/rpc/",     {kStd, "Eigen/", "absl/", kCore, kGenerated,
                         kInternal, kConvert, kGrpc, kHealth,
                         "google/protobuf/", "sanitizer/", kOptions, kVersion,
                         kClock, "server/rpc/",
                         "server/session/", "server/store/"}, {kClient}},

    // ops: what a running server needs around the calls.
    {"server/ops/",     Includes{kStd, "absl/", kCore, kGenerated, kGrpc,
                         kHealth, "CLI/", "spdlog/", "nlohmann/", kOptions, kVersion,
                         "server/ops/", "server/session/",
                         "server/store/"} + kPosix,
                        {kInternal, kClient}},

    // main, options, server: put the rooms together.
    {"server/",         Includes{kStd, "absl/", kCore, kGenerated, kGrpc,
                         "CLI/", "spdlog/", "nlohmann/", "server/"} + kPosix,
                        {kInternal, kClient}},

    // client: talks to the server over the wire only.
    {"client/",         Includes{kStd, "Eigen/", "absl/", kCore, kGenerated,
                         kClient, kConvert, kGrpc, kHealth,
                         "google/protobuf/", "CLI/", "spdlog/",
                         "nlohmann/", "sanitizer/", "zlib.h", "lo/",
                         "client/"} + kPosix, {kInternal}},

    // Without --server the CLI hosts the same service in its own process; this
    // is the one file that may know how.
    {"client/cli/local_server.cc",
                        {kStd, "absl/", kGrpc, "client/cli/", "server/"}, {}},
  };
  return kHouse;
}
// clang-format on

std::vector<std::string> Printed(const std::vector<Violation>& violations) {
  std::vector<std::string> lines;
  for (const Violation& violation : violations) {
    std::ostringstream line;
    line << violation;
    lines.push_back(line.str());
  }
  return lines;
}

TEST(HouseTest, EveryIncludeFollowsAnArrow) {
  EXPECT_THAT(Printed(CheckIncludes(GELENK_SOURCE_DIR, House())), IsEmpty());
}

TEST(HouseTest, ThereIsSomethingToCheck) {
  EXPECT_FALSE(SourceFiles(GELENK_SOURCE_DIR, "core/").empty());
}

// A small tree of our own, with faults planted in it.
class PlantedTreeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(::testing::TempDir()) /
            ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  void Plant(const std::string& file, const std::string& text) {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }

  std::vector<std::string> Violations() {
    return Printed(CheckIncludes(root_, House()));
  }

  fs::path root_;
};

TEST_F(PlantedTreeTest, CleanTreeHasNoViolation) {
  Plant("core/gelenk/ik/goal.cc",
        "#include \"gelenk/ik/goal.h\"\n"
        "#include <vector>\n"
        "#include <Eigen/Core>\n"
        "#include \"absl/status/status.h\"\n");
  EXPECT_THAT(Violations(), IsEmpty());
}

TEST_F(PlantedTreeTest, GrpcInCoreIsReportedWithItsLine) {
  Plant("core/gelenk/ik/goal.h", "// A goal.\n\n#include <grpcpp/grpcpp.h>\n");
  EXPECT_THAT(Violations(),
              ElementsAre("core/gelenk/ik/goal.h:3: core/ must not include "
                          "grpcpp/grpcpp.h"));
}

TEST_F(PlantedTreeTest, CoreHasNoMessageNoThreadNoClock) {
  Plant("core/gelenk/ik/goal.cc",
        "#include \"gelenk/v1/ik.pb.h\"\n"
        "  #  include <thread>\n"
        "#include <chrono>  // to measure\n"
        "#include <functional>\n"
        "#include \"absl/time/clock.h\"\n"
        "#include \"absl/time/time.h\"\n");
  EXPECT_THAT(
      Violations(),
      ElementsAre(
          "core/gelenk/ik/goal.cc:1: core/ must not include gelenk/v1/ik.pb.h",
          "core/gelenk/ik/goal.cc:2: core/ must not include <thread>",
          "core/gelenk/ik/goal.cc:3: core/ must not include <chrono>",
          "core/gelenk/ik/goal.cc:5: core/ must not include "
          "absl/time/clock.h"));
}

TEST_F(PlantedTreeTest, OnlyTheImportKnowsParsers) {
  Plant("core/gelenk/import/urdf.cc",
        "#include <tinyxml2.h>\n#include <nlohmann/json.hpp>\n"
        "#include \"gelenk/import/urdf.h\"\n"
        "#include <fstream>\n");
  Plant("core/gelenk/formats/urdf.cc",
        "#include <tinyxml2.h>\n#include \"gelenk/import/urdf.h\"\n");
  Plant("server/session/session.h", "#include \"gelenk/import/urdf.h\"\n");
  EXPECT_THAT(
      Violations(),
      ElementsAre(
          "core/gelenk/formats/urdf.cc:1: core/ must not include tinyxml2.h",
          "core/gelenk/formats/urdf.cc:2: core/ must not include "
          "gelenk/import/urdf.h",
          "core/gelenk/import/urdf.cc:4: core/gelenk/import/ must not include "
          "<fstream>",
          "server/session/session.h:1: server/session/ must not include "
          "gelenk/import/urdf.h"));
}

TEST_F(PlantedTreeTest, CommentedIncludeIsNone) {
  Plant("core/gelenk/ik/goal.cc", "// #include <thread>\n");
  EXPECT_THAT(Violations(), IsEmpty());
}

TEST_F(PlantedTreeTest, SessionsKnowNeitherMessagesNorConversions) {
  Plant("server/session/session.h",
        "#include \"gelenk/ik/goal.h\"\n"
        "#include \"gelenk/v1/session.pb.h\"\n"
        "#include \"convert/pose.h\"\n");
  EXPECT_THAT(Violations(),
              ElementsAre("server/session/session.h:2: server/session/ must "
                          "not include gelenk/v1/session.pb.h",
                          "server/session/session.h:3: server/session/ must "
                          "not include convert/pose.h"));
}

TEST_F(PlantedTreeTest, ServerAndClientDoNotKnowEachOther) {
  Plant("server/rpc/stream.cc", "#include \"gelenk/client/session.h\"\n");
  Plant("client/cli/play.cc", "#include \"server/server.h\"\n");
  EXPECT_THAT(Violations(),
              ElementsAre("client/cli/play.cc:1: client/ must not include "
                          "server/server.h",
                          "server/rpc/stream.cc:1: server/rpc/ must not "
                          "include gelenk/client/session.h"));
}

TEST_F(PlantedTreeTest, OneFileOfTheCliMayHostTheServer) {
  Plant("client/cli/local_server.cc", "#include \"server/server.h\"\n");
  EXPECT_THAT(Violations(), IsEmpty());
}

}  // namespace
}  // namespace gelenk::architecture

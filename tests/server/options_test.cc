#include "server/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "tests/testing/violation_lines.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::vector<std::string> Lines(
    const std::function<void(ServerOptions&)>& change) {
  ServerOptions options;
  change(options);
  return ViolationLines(CheckOptions(options));
}

std::vector<std::string> LinesOfListen(const std::string& listen,
                                       bool insecure = false) {
  return Lines([&](ServerOptions& options) {
    options.listen = listen;
    options.insecure = insecure;
  });
}

TEST(OptionsTest, DefaultsAreFine) {
  EXPECT_THAT(Lines([](ServerOptions&) {}), IsEmpty());
}

TEST(OptionsTest, PlainTextOnLoopbackIsFine) {
  for (const char* listen : {"127.0.0.1:0", "127.0.0.1:50051", "127.8.8.8:1",
                             "[::1]:50051", "localhost:50051", "unix:/tmp/g"}) {
    EXPECT_THAT(LinesOfListen(listen), IsEmpty()) << listen;
    EXPECT_TRUE(IsLoopback(listen)) << listen;
  }
}

TEST(OptionsTest, PlainTextElsewhereIsRefused) {
  for (const char* listen :
       {"0.0.0.0:50051", "[::]:50051", "192.168.1.2:50051", "example.org:1",
        ":50051", "localhost.example.org:1", "[::1%eth0]:1"}) {
    EXPECT_THAT(LinesOfListen(listen),
                ElementsAre(AllOf(StartsWith("listen: "), HasSubstr(listen),
                                  HasSubstr("--insecure"))))
        << listen;
    EXPECT_FALSE(IsLoopback(listen)) << listen;
  }
}

TEST(OptionsTest, PlainTextElsewhereIsFineWhenToldSo) {
  EXPECT_THAT(LinesOfListen("0.0.0.0:50051", true), IsEmpty());
  EXPECT_THAT(LinesOfListen("[::]:50051", true), IsEmpty());
}

TEST(OptionsTest, ListenNeedsAPort) {
  EXPECT_THAT(LinesOfListen("localhost"),
              ElementsAre("listen: want host:port, got \"localhost\""));
  EXPECT_THAT(LinesOfListen(""), ElementsAre(HasSubstr("want host:port")));
}

TEST(OptionsTest, NamesEveryBadOptionAtOnce) {
  EXPECT_THAT(
      Lines([](ServerOptions& options) {
        options.listen = "somewhere";
        options.io_threads = -1;
        options.limits.max_sessions = 0;
        options.heartbeat = absl::ZeroDuration();
      }),
      ElementsAre(StartsWith("listen: "), "io_threads: want at least 0, got -1",
                  "max_sessions: want at least 1, got 0",
                  "heartbeat: want more than 0, got 0"));
}

// A number, the least that is taken and the line for one less.
struct Bound {
  std::string name;
  std::function<void(ServerOptions&, int64_t)> set;
  int64_t least;
};

class OptionBoundTest : public ::testing::TestWithParam<Bound> {};

TEST_P(OptionBoundTest, HoldsFromBothSides) {
  const Bound& bound = GetParam();
  EXPECT_THAT(
      Lines([&](ServerOptions& options) { bound.set(options, bound.least); }),
      IsEmpty());
  EXPECT_THAT(Lines([&](ServerOptions& options) {
                bound.set(options, bound.least - 1);
              }),
              ElementsAre(StartsWith(bound.name + ": want ")));
}

template <class Number>
Bound OfLimit(const std::string& name, Number Limits::*member,
              int64_t least = 1) {
  return {name,
          [member](ServerOptions& options, int64_t value) {
            options.limits.*member = static_cast<Number>(value);
          },
          least};
}

Bound OfDuration(const std::string& name, absl::Duration Limits::*member) {
  return {name,
          [member](ServerOptions& options, int64_t value) {
            options.limits.*member = absl::Nanoseconds(value);
          },
          1};
}

INSTANTIATE_TEST_SUITE_P(
    All, OptionBoundTest,
    ::testing::Values(
        Bound{"io_threads",
              [](ServerOptions& o, int64_t v) {
                o.io_threads = static_cast<int>(v);
              },
              0},
        Bound{"worker_threads",
              [](ServerOptions& o, int64_t v) {
                o.worker_threads = static_cast<int>(v);
              },
              0},
        Bound{"heartbeat",
              [](ServerOptions& o, int64_t v) {
                o.heartbeat = absl::Nanoseconds(v);
              },
              1},
        Bound{"keepalive",
              [](ServerOptions& o, int64_t v) {
                o.keepalive = absl::Nanoseconds(v);
              },
              1},
        OfLimit("max_sessions", &Limits::max_sessions),
        OfLimit("max_skeletons", &Limits::max_skeletons),
        OfLimit("max_joints", &Limits::max_joints),
        OfLimit("max_skins", &Limits::max_skins),
        OfLimit("max_skin_vertices", &Limits::max_skin_vertices),
        OfLimit("max_skin_triangles", &Limits::max_skin_triangles),
        OfLimit("max_skin_revisions", &Limits::max_skin_revisions, 2),
        OfLimit("max_message_bytes", &Limits::max_message_bytes, 1024),
        OfLimit("max_import_bytes", &Limits::max_import_bytes),
        OfLimit("max_imports", &Limits::max_imports),
        OfLimit("max_streams", &Limits::max_streams),
        OfLimit("max_slots", &Limits::max_slots),
        OfLimit("max_unsent_answers", &Limits::max_unsent_answers),
        OfDuration("import_stall", &Limits::import_stall),
        OfDuration("write_stall", &Limits::write_stall),
        OfDuration("max_idle_ttl", &Limits::max_idle_ttl),
        OfDuration("default_idle_ttl", &Limits::default_idle_ttl)),
    [](const auto& info) { return info.param.name; });

TEST(OptionsTest, RefusesAnInstructionSetThatTheProcessorHasNot) {
  const auto supported = SupportedInstructionSets();
  for (InstructionSet level : {InstructionSet::kBaseline, InstructionSet::kAvx2,
                               InstructionSet::kAvx512}) {
    const bool runs =
        std::find(supported.begin(), supported.end(), level) != supported.end();
    EXPECT_EQ(Lines([level](ServerOptions& options) {
                options.instruction_set = level;
              }).empty(),
              runs)
        << std::string(InstructionSetName(level));
  }
}

}  // namespace
}  // namespace gelenk::server

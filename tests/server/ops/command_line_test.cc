#include "server/ops/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"

namespace gelenk::server {
namespace {

using ::testing::HasSubstr;
using ::testing::internal::CaptureStderr;
using ::testing::internal::CaptureStdout;
using ::testing::internal::GetCapturedStderr;
using ::testing::internal::GetCapturedStdout;

struct Parsed {
  std::optional<int> exit_code;
  CommandLine command_line;
  std::string out;
  std::string err;
};

Parsed Parse(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "gelenkd");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  Parsed parsed;
  CaptureStdout();
  CaptureStderr();
  parsed.exit_code = ParseCommandLine(static_cast<int>(argv.size()),
                                      argv.data(), parsed.command_line);
  parsed.out = GetCapturedStdout();
  parsed.err = GetCapturedStderr();
  return parsed;
}

TEST(CommandLineTest, WithoutFlagsMeansDefaults) {
  const Parsed parsed = Parse({});
  EXPECT_EQ(parsed.exit_code, std::nullopt);
  EXPECT_EQ(parsed.command_line.server.listen, ServerOptions().listen);
  EXPECT_FALSE(parsed.command_line.server.insecure);
  EXPECT_EQ(parsed.command_line.drain, absl::Seconds(20));
  EXPECT_EQ(parsed.command_line.log_level, "info");
}

// What a flag with a value gives, printed.
struct Flag {
  std::string name;
  std::string value;
  std::function<std::string(const CommandLine&)> read;
  std::string bad_value;
};

template <class Number>
Flag Of(const std::string& name, Number Limits::*member) {
  return {name, "2345",
          [member](const CommandLine& line) {
            return std::to_string(line.server.limits.*member);
          },
          "many"};
}
Flag Of(const std::string& name, absl::Duration Limits::*member) {
  return {name, "1m30s",
          [member](const CommandLine& line) {
            return absl::FormatDuration(line.server.limits.*member);
          },
          "90"};
}

std::vector<Flag> Flags() {
  const auto listen = [](const CommandLine& l) { return l.server.listen; };
  const auto port_file = [](const CommandLine& l) { return l.port_file; };
  const auto log_level = [](const CommandLine& l) { return l.log_level; };
  const auto drain = [](const CommandLine& l) {
    return absl::FormatDuration(l.drain);
  };
  const auto heartbeat = [](const CommandLine& l) {
    return absl::FormatDuration(l.server.heartbeat);
  };
  const auto keepalive = [](const CommandLine& l) {
    return absl::FormatDuration(l.server.keepalive);
  };
  const auto isa = [](const CommandLine& l) {
    return std::string(InstructionSetName(l.server.instruction_set));
  };
  const auto io_threads = [](const CommandLine& l) {
    return std::to_string(l.server.io_threads);
  };
  const auto worker_threads = [](const CommandLine& l) {
    return std::to_string(l.server.worker_threads);
  };
  return {
      {"listen", "127.0.0.1:0", listen, ""},
      {"port-file", "/tmp/port", port_file, ""},
      {"log-level", "warn", log_level, "loud"},
      {"drain", "500ms", drain, "soon"},
      {"heartbeat", "200ms", heartbeat, "5"},
      {"keepalive", "45s", keepalive, "5"},
      {"isa", "baseline", isa, "mmx"},
      {"io-threads", "3", io_threads, "three"},
      {"worker-threads", "4", worker_threads, "4.5"},
      Of("max-sessions", &Limits::max_sessions),
      Of("max-skeletons", &Limits::max_skeletons),
      Of("max-skeleton-bytes", &Limits::max_skeleton_bytes),
      Of("max-clips", &Limits::max_clips),
      Of("max-clip-bytes", &Limits::max_clip_bytes),
      Of("max-clip-numbers", &Limits::max_clip_numbers),
      Of("max-clip-revisions", &Limits::max_clip_revisions),
      Of("max-recording-bytes", &Limits::max_recording_bytes),
      Of("max-joints", &Limits::max_joints),
      Of("max-skins", &Limits::max_skins),
      Of("max-skin-bytes", &Limits::max_skin_bytes),
      Of("max-skin-vertices", &Limits::max_skin_vertices),
      Of("max-skin-triangles", &Limits::max_skin_triangles),
      Of("max-skin-revisions", &Limits::max_skin_revisions),
      Of("max-message-bytes", &Limits::max_message_bytes),
      Of("max-import-bytes", &Limits::max_import_bytes),
      Of("max-imports", &Limits::max_imports),
      Of("max-streams", &Limits::max_streams),
      Of("max-slots", &Limits::max_slots),
      Of("max-unsent-answers", &Limits::max_unsent_answers),
      Of("import-stall", &Limits::import_stall),
      Of("write-stall", &Limits::write_stall),
      Of("max-idle-ttl", &Limits::max_idle_ttl),
      Of("default-idle-ttl", &Limits::default_idle_ttl),
  };
}

class FlagTest : public ::testing::TestWithParam<Flag> {};

INSTANTIATE_TEST_SUITE_P(All, FlagTest, ::testing::ValuesIn(Flags()),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(FlagTest, GivesItsValue) {
  const Flag& flag = GetParam();
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--" + flag.name, flag.value},
        std::vector<std::string>{"--" + flag.name + "=" + flag.value}}) {
    const Parsed parsed = Parse(arguments);
    EXPECT_EQ(parsed.exit_code, std::nullopt) << parsed.err;
    EXPECT_EQ(flag.read(parsed.command_line), flag.value);
  }
}

// A variable of the environment, for as long as this object lives.
class Variable {
 public:
  Variable(std::string name, const std::string& value)
      : name_(std::move(name)) {
    setenv(name_.c_str(), value.c_str(), /*overwrite=*/1);
  }
  ~Variable() { unsetenv(name_.c_str()); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const std::string name_;
};

// max-sessions: GELENKD_MAX_SESSIONS
std::string VariableName(const Flag& flag) {
  std::string name = absl::AsciiStrToUpper("gelenkd_" + flag.name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

TEST_P(FlagTest, IsReadFromTheEnvironment) {
  const Flag& flag = GetParam();
  const Variable variable(VariableName(flag), flag.value);
  const Parsed parsed = Parse({});
  EXPECT_EQ(parsed.exit_code, std::nullopt) << parsed.err;
  EXPECT_EQ(flag.read(parsed.command_line), flag.value);
}

TEST_P(FlagTest, IsStrongerThanTheEnvironment) {
  const Flag& flag = GetParam();
  const Variable variable(VariableName(flag), "0");
  const Parsed parsed = Parse({"--" + flag.name, flag.value});
  EXPECT_EQ(parsed.exit_code, std::nullopt) << parsed.err;
  EXPECT_EQ(flag.read(parsed.command_line), flag.value);
}

TEST_P(FlagTest, RefusesABadValueOfTheEnvironment) {
  const Flag& flag = GetParam();
  if (flag.bad_value.empty()) return;  // any text will do
  const Variable variable(VariableName(flag), flag.bad_value);
  const Parsed parsed = Parse({});
  EXPECT_EQ(parsed.exit_code, 2);
  EXPECT_THAT(parsed.err, HasSubstr("--" + flag.name));
}

TEST_P(FlagTest, RefusesABadValue) {
  const Flag& flag = GetParam();
  if (flag.bad_value.empty()) return;  // any text will do
  const Parsed parsed = Parse({"--" + flag.name, flag.bad_value});
  EXPECT_EQ(parsed.exit_code, 2);
  EXPECT_THAT(parsed.err, HasSubstr("--" + flag.name));
}

TEST_P(FlagTest, RefusesNoValue) {
  EXPECT_EQ(Parse({"--" + GetParam().name}).exit_code, 2);
}

TEST(CommandLineTest, SwitchesAreOffUnlessNamed) {
  EXPECT_TRUE(Parse({"--insecure"}).command_line.server.insecure);
  EXPECT_TRUE(Parse({"--reflection"}).command_line.server.reflection);
  EXPECT_FALSE(Parse({}).command_line.server.reflection);
}

TEST(CommandLineTest, TheEnvironmentThrowsSwitches) {
  const Variable insecure("GELENKD_INSECURE", "true");
  const Variable reflection("GELENKD_REFLECTION", "false");
  const Parsed parsed = Parse({});
  EXPECT_TRUE(parsed.command_line.server.insecure);
  EXPECT_FALSE(parsed.command_line.server.reflection);
}

// Else a variable meant for a container would keep its server from starting.
TEST(CommandLineTest, OnlyTheCommandLineAsksForAHealthCheck) {
  const Variable variable("GELENKD_HEALTH_CHECK", "true");
  EXPECT_FALSE(Parse({}).command_line.health_check);
  EXPECT_TRUE(Parse({"--health-check"}).command_line.health_check);
}

TEST(CommandLineTest, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(Parse({"--max-session", "3"}).exit_code, 2);
  EXPECT_EQ(Parse({"serve"}).exit_code, 2);
  EXPECT_THAT(Parse({"--frobnicate"}).err, HasSubstr("--frobnicate"));
}

TEST(CommandLineTest, SaysWhatABadDurationShouldBe) {
  EXPECT_THAT(Parse({"--drain", "soon"}).err,
              HasSubstr("want a duration such as 20s, got \"soon\""));
}

TEST(CommandLineTest, HelpAndVersionEndWell) {
  const Parsed help = Parse({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("--listen"));
  EXPECT_THAT(help.out, HasSubstr("127.0.0.1:50051"));
  const Parsed version = Parse({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, HasSubstr("."));
}

TEST(PortFileTest, HoldsThePort) {
  const std::string path = ::testing::TempDir() + "gelenk_port_file_test";
  ASSERT_TRUE(WritePortFile(path, "127.0.0.1:1234"));
  std::string line;
  std::ifstream file(path);
  std::getline(file, line);
  EXPECT_EQ(line, "1234");
  EXPECT_FALSE(std::filesystem::exists(path + ".draft"));
  std::filesystem::remove(path);
}

TEST(PortFileTest, SaysWhenItCannotBeWritten) {
  EXPECT_FALSE(WritePortFile("/nowhere/at/all", "127.0.0.1:1234"));
}

}  // namespace
}  // namespace gelenk::server

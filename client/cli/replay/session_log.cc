#include "client/cli/replay/session_log.h"

#include <cerrno>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "convert/duration.h"

namespace gelenk::cli {
namespace {

using google::protobuf::MessageLite;

// A length of 32 bits takes five bytes of seven.
constexpr int kMaxLengthShift = 28;

// A length of 0 in place of a frame's.
constexpr absl::string_view kEnd("\0", 1);

// Takes message after message.
class MessageReader {
 public:
  explicit MessageReader(absl::string_view bytes) : bytes_(bytes) {}

  bool at_end() const { return offset_ == bytes_.size(); }

  // The length that comes next, of `what`.
  absl::StatusOr<uint32_t> Length(absl::string_view what) {
    start_ = offset_;
    uint64_t length = 0;
    for (int shift = 0; shift <= kMaxLengthShift; shift += 7) {
      if (at_end()) return Error(what, "the file ends here: it was cut off");
      const auto byte = static_cast<uint8_t>(bytes_[offset_++]);
      length |= uint64_t{byte & 0x7fu} << shift;
      if (byte >= 0x80) continue;
      if (length > kMaxLoggedMessageBytes) break;
      return static_cast<uint32_t>(length);
    }
    return Error(what, absl::StrCat("want a length of at most ",
                                    kMaxLoggedMessageBytes, " bytes"));
  }

  absl::Status Message(absl::string_view what, uint32_t length,
                       MessageLite* message) {
    if (length > bytes_.size() - offset_) {
      return Error(
          what, absl::StrCat("want ", length, " bytes, the file has ",
                             bytes_.size() - offset_, " more: it was cut off"));
    }
    if (!message->ParseFromArray(bytes_.data() + offset_,
                                 static_cast<int>(length))) {
      return Error(what, absl::StrCat("is no ", message->GetTypeName()));
    }
    offset_ += length;
    return absl::OkStatus();
  }

  absl::Status Message(absl::string_view what, MessageLite* message) {
    const absl::StatusOr<uint32_t> length = Length(what);
    if (!length.ok()) return length.status();
    return Message(what, *length, message);
  }

  // About what begins with the last length.
  absl::Status Error(absl::string_view what, absl::string_view fault) const {
    return absl::InvalidArgumentError(absl::StrCat(
        "byte ", kSessionLogMagic.size() + start_, ": ", what, ": ", fault));
  }

 private:
  const absl::string_view bytes_;
  size_t offset_ = 0;
  size_t start_ = 0;
};

absl::Status ReadHead(MessageReader& reader, SessionLog& log) {
  for (const auto& [what, message] :
       {std::pair<absl::string_view, MessageLite*>{"server", &log.server},
        {"skeleton", &log.spec.skeleton},
        {"source_skeleton", &log.spec.source_skeleton},
        {"session", &log.spec.session}}) {
    absl::Status status = reader.Message(what, message);
    if (!status.ok()) return status;
  }
  if (!log.spec.skeleton.has_skeleton() || !log.spec.session.has_session()) {
    return reader.Error("session", "want a skeleton and a session");
  }
  return absl::OkStatus();
}

absl::Status ReadFrame(MessageReader& reader, uint32_t length,
                       SessionLog& log) {
  const std::string what = absl::StrCat("frame ", log.frames.frames().size());
  LoggedFrame<v1::TargetFrame> frame;
  absl::Status status = reader.Message(what, length, &frame.input);
  if (!status.ok()) return status;
  v1::PoseFrame answer;
  status = reader.Message(absl::StrCat("answer of ", what), &answer);
  if (!status.ok()) return status;
  if (answer.sequence_number() != frame.input.sequence_number()) {
    return reader.Error(what,
                        absl::StrCat("the answer is that of sequence_number ",
                                     answer.sequence_number(), ", not of ",
                                     frame.input.sequence_number()));
  }
  frame.sequence_number = answer.sequence_number();
  frame.time_s =
      absl::ToDoubleSeconds(convert::FromProto(frame.input.capture_time()));
  frame.positions = Eigen::Map<const Eigen::VectorXd>(
      answer.pose().positions().data(), answer.pose().positions_size());
  status = log.frames.Append(std::move(frame));
  if (absl::IsInvalidArgument(status)) {
    return reader.Error(what, status.message());
  }
  return status;
}

}  // namespace

absl::StatusOr<SessionLog> ParseSessionLog(absl::string_view bytes,
                                           const SessionLogLimits& limits) {
  if (bytes.size() > limits.max_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("want a log of at most ", limits.max_bytes, " bytes, got ",
                     bytes.size()));
  }
  if (!absl::StartsWith(bytes, kSessionLogMagic)) {
    return absl::InvalidArgumentError(
        "is no log of gelenk play --record, or one of another version");
  }
  SessionLog log;
  log.frames = FrameLog<v1::TargetFrame>(limits.max_frames);
  MessageReader reader(bytes.substr(kSessionLogMagic.size()));
  absl::Status status = ReadHead(reader, log);
  if (!status.ok()) return status;
  for (;;) {
    const absl::StatusOr<uint32_t> length =
        reader.Length(absl::StrCat("frame ", log.frames.frames().size()));
    if (!length.ok()) return length.status();
    if (*length == 0) break;
    status = ReadFrame(reader, *length, log);
    if (!status.ok()) return status;
  }
  if (!reader.at_end()) return reader.Error("end", "more bytes behind it");
  return log;
}

absl::StatusOr<SessionLog> ReadSessionLog(const std::string& path) {
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<SessionLog> log = ParseSessionLog(*bytes);
  if (!log.ok()) return InFile(path, log.status());
  return log;
}

SessionLogWriter::SessionLogWriter(std::string path, FILE* file,
                                   const SessionLogLimits& limits)
    : path_(std::move(path)), limits_(limits), file_(file) {}

absl::StatusOr<std::unique_ptr<SessionLogWriter>> SessionLogWriter::Open(
    const std::string& path, const v1::ServerInfo& server,
    const client::SessionSpec& spec, const SessionLogLimits& limits) {
  FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) {
    return absl::ErrnoToStatus(errno, absl::StrCat("\"", path, "\""));
  }
  std::unique_ptr<SessionLogWriter> writer(
      new SessionLogWriter(path, file, limits));
  absl::Status status = writer->Write(kSessionLogMagic);
  if (status.ok()) {
    status = writer->WriteMessages(
        {&server, &spec.skeleton, &spec.source_skeleton, &spec.session});
  }
  if (!status.ok()) return status;
  return writer;
}

absl::Status SessionLogWriter::Append(const v1::TargetFrame& effective_frame,
                                      const v1::PoseFrame& answer) {
  if (frame_count_ == limits_.max_frames) {
    return Full(absl::StrCat(limits_.max_frames, " frames"));
  }
  // What a replay needs.
  v1::PoseFrame kept;
  kept.set_sequence_number(answer.sequence_number());
  *kept.mutable_pose() = answer.pose();
  absl::Status status = WriteMessages({&effective_frame, &kept});
  if (status.ok()) ++frame_count_;
  return status;
}

absl::Status SessionLogWriter::Close() {
  absl::Status status = Write(kEnd);
  if (status.ok() && std::fflush(file_.get()) != 0) {
    return absl::ErrnoToStatus(errno, absl::StrCat("\"", path_, "\""));
  }
  return status;
}

absl::Status SessionLogWriter::WriteMessages(
    absl::Span<const MessageLite* const> messages) {
  std::string bytes;
  for (const MessageLite* message : messages) {
    const size_t size = message->ByteSizeLong();
    if (size > kMaxLoggedMessageBytes) {
      return absl::ResourceExhaustedError(
          absl::StrCat("\"", path_, "\": a message of ", size,
                       " bytes, want at most ", kMaxLoggedMessageBytes));
    }
    for (size_t rest = size;; rest >>= 7) {
      bytes.push_back(static_cast<char>(rest < 0x80 ? rest : rest | 0x80));
      if (rest < 0x80) break;
    }
    message->AppendToString(&bytes);
  }
  if (byte_count_ + bytes.size() + kEnd.size() > limits_.max_bytes) {
    return Full(absl::StrCat(limits_.max_bytes, " bytes"));
  }
  return Write(bytes);
}

absl::Status SessionLogWriter::Write(absl::string_view bytes) {
  byte_count_ += bytes.size();
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size()) {
    return absl::OkStatus();
  }
  return absl::ErrnoToStatus(errno, absl::StrCat("\"", path_, "\""));
}

absl::Status SessionLogWriter::Full(absl::string_view limit) const {
  return absl::ResourceExhaustedError(
      absl::StrCat("\"", path_, "\": want at most ", limit, " in a log"));
}

}  // namespace gelenk::cli

// A skin on the service: one that is there, or one for as long as a command
// needs it.
#ifndef CLIENT_CLI_SKIN_SERVED_SKIN_H_
#define CLIENT_CLI_SKIN_SERVED_SKIN_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/cli/skin/skin_source.h"
#include "gelenk/client/connection.h"
#include "gelenk/v1/skin_service.grpc.pb.h"

namespace gelenk::cli {

using SkinStub = v1::SkinService::Stub;

class ServedSkin {
 public:
  // `source.path` may also name a skin: skins/{skin}, with a revision or
  // without. `keep_id` is that of a new skin that stays, with its skeleton;
  // without it both go when this goes.
  static absl::StatusOr<std::unique_ptr<ServedSkin>> Open(
      std::shared_ptr<client::Connection> connection,
      const SkinSourceOptions& source, const std::string& keep_id,
      const v1::LayeredVolumes& volumes);

  ~ServedSkin();
  ServedSkin(const ServedSkin&) = delete;
  ServedSkin& operator=(const ServedSkin&) = delete;

  const v1::Skin& skin() const { return skin_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  // The skeleton that it is on.
  absl::StatusOr<v1::Skeleton> ReadSkeleton() const;

 private:
  explicit ServedSkin(std::shared_ptr<client::Connection> connection);

  absl::Status Find(const std::string& name);
  absl::Status Create(const SkinSourceOptions& options,
                      const std::string& keep_id,
                      const v1::LayeredVolumes& volumes);

  const std::shared_ptr<client::Connection> connection_;
  v1::Skin skin_;
  std::vector<std::string> warnings_;
  // What goes with this; empty for what stays.
  std::string temporary_skin_;
  std::string temporary_skeleton_;
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_SERVED_SKIN_H_

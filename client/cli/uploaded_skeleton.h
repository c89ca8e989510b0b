// A skeleton on the service for as long as a command needs it.
#ifndef CLIENT_CLI_UPLOADED_SKELETON_H_
#define CLIENT_CLI_UPLOADED_SKELETON_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "gelenk/client/connection.h"
#include "gelenk/v1/skeleton.pb.h"

namespace gelenk::cli {

class UploadedSkeleton {
 public:
  static absl::StatusOr<std::unique_ptr<UploadedSkeleton>> Create(
      std::shared_ptr<client::Connection> connection,
      const v1::Skeleton& skeleton);

  // Deletes it.
  ~UploadedSkeleton();
  UploadedSkeleton(const UploadedSkeleton&) = delete;
  UploadedSkeleton& operator=(const UploadedSkeleton&) = delete;

  // skeletons/{skeleton}
  const std::string& name() const { return name_; }

 private:
  UploadedSkeleton(std::shared_ptr<client::Connection> connection,
                   std::string name);

  const std::shared_ptr<client::Connection> connection_;
  const std::string name_;
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_UPLOADED_SKELETON_H_

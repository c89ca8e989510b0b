// Motion files as clips on a service, for as long as a command needs them.
#ifndef CLIENT_CLI_MOTION_SERVED_CLIPS_H_
#define CLIENT_CLI_MOTION_SERVED_CLIPS_H_

#include <Eigen/Core>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cli/motion/motion_file.h"
#include "client/cli/service.h"
#include "gelenk/client/connection.h"
#include "gelenk/retarget/moving_body.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/motion_service.pb.h"

namespace gelenk::cli {

class ServedClips {
 public:
  // Errors as Service::Open.
  static absl::StatusOr<std::unique_ptr<ServedClips>> Open(
      const std::string& server);

  // Deletes all that was made.
  ~ServedClips();
  ServedClips(const ServedClips&) = delete;
  ServedClips& operator=(const ServedClips&) = delete;

  // Errors name the file; INVALID_ARGUMENT for one that holds no clip.
  absl::StatusOr<v1::Clip> Upload(const std::string& path,
                                  const MotionFileOptions& options = {});
  // skeletons/{skeleton}
  absl::StatusOr<std::string> Upload(const Skeleton& skeleton);

  absl::StatusOr<v1::Clip> Process(const std::string& clip,
                                   std::vector<v1::ClipStep> steps);
  absl::StatusOr<v1::Clip> Retarget(const v1::RetargetClipRequest& request);
  // `reference` may be empty.
  absl::StatusOr<MeasuredMotion> Measure(const std::string& clip,
                                         const std::string& reference);

  // The frames of a clip of `skeleton` at its frame time, a column a frame.
  absl::StatusOr<Eigen::MatrixXd> Frames(
      const std::string& clip, std::shared_ptr<const Skeleton> skeleton);

  // Writes a clip in the format that the end of `path` says.
  absl::Status Write(const std::string& clip, const std::string& path);

 private:
  explicit ServedClips(std::unique_ptr<Service> service);
  absl::StatusOr<v1::Clip> Keep(absl::StatusOr<v1::Clip> made);
  // All that ExportClip sends.
  struct Exported {
    v1::Clip clip;
    std::string data;
  };
  absl::StatusOr<Exported> Export(const std::string& clip,
                                  v1::ClipFormat format);

  const std::unique_ptr<Service> service_;
  std::set<std::string> clips_;
  std::set<std::string> skeletons_;
};

// What the end of `path` says: .bvh, .gltf or .glb. INVALID_ARGUMENT otherwise.
absl::StatusOr<v1::ClipFormat> ClipFormatOf(const std::string& path);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_SERVED_CLIPS_H_

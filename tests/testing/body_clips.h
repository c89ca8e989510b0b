// Recorded clips as bodies in motion, for tests and tables of retargeting.
#ifndef GELENK_TESTS_TESTING_BODY_CLIPS_H_
#define GELENK_TESTS_TESTING_BODY_CLIPS_H_

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/body_pose.h"

namespace gelenk::testing {

struct BodyClip {
  std::string name;
  std::shared_ptr<const BodyModel> model;
  // position_count rows, one column a frame of the motion: a first frame that
  // is none is left out.
  Eigen::MatrixXd positions;
  double frame_time_s = 1.0 / 30;

  int frame_count() const { return static_cast<int>(positions.cols()); }
};

// The text of a BVH file: imported, mapped and modelled with its own motion.
absl::StatusOr<BodyClip> BodyClipFromBvh(absl::string_view text,
                                         std::string name);
// Empty where there is no file.
std::string FileText(const std::filesystem::path& path);
absl::StatusOr<BodyClip> ReadBodyClip(const std::filesystem::path& bvh);

// The poses of the clip, canonical.
std::vector<BodyPose> BodyPosesOf(const BodyModel& model,
                                  const Eigen::MatrixXd& positions);

// The folder of real files that are not part of the project: GELENK_CORPUS, or
// shared/data beside the source tree.
std::filesystem::path CorpusFolder(const std::filesystem::path& source_dir);

std::vector<std::filesystem::path> FilesWith(
    const std::filesystem::path& folder, absl::string_view extension);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_BODY_CLIPS_H_

// A BVH file as a skeleton and its poses.
#ifndef CLIENT_CLI_BVH_CLIP_H_
#define CLIENT_CLI_BVH_CLIP_H_

#include <Eigen/Core>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gelenk/formats/bvh_document.h"
#include "gelenk/formats/bvh_import.h"

namespace gelenk::cli {

struct BvhClip {
  // As the file has it: what answers are written back into.
  BvhDocument document;
  BvhImport import;
  // position_count rows, one column a frame.
  Eigen::MatrixXd poses;

  int frame_count() const { return static_cast<int>(poses.cols()); }
  absl::Duration frame_time() const {
    return absl::Seconds(document.frame_time_s);
  }
};

// Errors name the file, and the line and column where it is malformed.
// `unit_m` is the length of the file's unit; unset means guessed.
absl::StatusOr<BvhClip> ReadBvhClip(const std::string& path,
                                    std::optional<double> unit_m);

// The same of an Acclaim skeleton and its motion, as the form of a BVH file;
// `amc_path` may be empty.
absl::StatusOr<BvhClip> ReadAsfClip(const std::string& asf_path,
                                    const std::string& amc_path,
                                    std::optional<double> unit_m);

// The clip's file with other poses in it.
absl::Status WriteBvhClip(const BvhClip& clip, const Eigen::MatrixXd& poses,
                          const std::string& path);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_BVH_CLIP_H_

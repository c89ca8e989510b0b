// The motion of a BVH file as poses of its skeleton, and back.
//
//   ReadBvh -> ImportBvh -> PosesFromBvh -> ... -> BvhFromPoses -> WriteBvh
#ifndef GELENK_FORMATS_BVH_MOTION_H_
#define GELENK_FORMATS_BVH_MOTION_H_

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "gelenk/formats/bvh_document.h"
#include "gelenk/formats/bvh_import.h"

namespace gelenk {

// position_count rows, one column a frame. Quaternions lie in the hemisphere of
// the frame before. Errors: INVALID_ARGUMENT when the document has other
// channels than the one imported.
absl::StatusOr<Eigen::MatrixXd> PosesFromBvh(const BvhDocument& document,
                                             const BvhImport& import);

// `form` with the motion `poses` (position_count rows): its hierarchy,
// channels, orders of rotation and frame time. Angles run on from frame to
// frame without jumps of a turn, the first near those of form's first frame;
// in gimbal lock the angle that is lost keeps its value. Errors:
// INVALID_ARGUMENT when sizes do not fit or a number is not finite.
absl::StatusOr<BvhDocument> BvhFromPoses(const BvhDocument& form,
                                         const BvhImport& import,
                                         const Eigen::MatrixXd& poses);

}  // namespace gelenk

#endif  // GELENK_FORMATS_BVH_MOTION_H_

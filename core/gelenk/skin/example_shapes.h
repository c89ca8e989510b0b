// Skeletons with skins, to try things on: nothing to load, the same for
// everybody.
#ifndef GELENK_SKIN_EXAMPLE_SHAPES_H_
#define GELENK_SKIN_EXAMPLE_SHAPES_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skin/muscle.h"
#include "gelenk/skin/skin_link.h"
#include "gelenk/skin/triangle_mesh.h"

namespace gelenk {

struct SkinShape {
  std::shared_ptr<const Skeleton> skeleton;
  SkinLinkOptions links;
  SkinMuscles muscles;
  TriangleMesh mesh;
  // For each vertex the joint whose limb it is part of, by construction: what
  // a binding can be judged by.
  std::vector<std::string> joint_ids;
};

// "cylinder": two links of 1 m and a round tube about them.
// "arm": upper arm, forearm, hand, with a biceps and a triceps.
// "leg": thigh, shank, foot.
// "humanoid": a body of 1.75 m in one piece, arms a little away from its
// sides; it stands on the ground, up is +Y, it looks along +Z.
absl::Span<const absl::string_view> SkinShapeNames();

// `vertex_count` is what the mesh has about, 100 to 100,000. NOT_FOUND lists
// the names, INVALID_ARGUMENT the range.
absl::StatusOr<SkinShape> MakeSkinShape(absl::string_view name,
                                        int vertex_count = 10000);

}  // namespace gelenk

#endif  // GELENK_SKIN_EXAMPLE_SHAPES_H_

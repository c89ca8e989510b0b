// A person's decision about vertices whose binding is not clear.
//
// Bindings are values: Rebind makes a new one and leaves the old as it is, so a
// dry run is a result that is not kept, and undoing is going back to an older
// one (BindingHistory).
#ifndef GELENK_SKIN_REBIND_H_
#define GELENK_SKIN_REBIND_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/skin/skin_binding.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {

// All in the frame of the mesh, m.
struct SelectIds {
  std::vector<int> vertices;
};
struct SelectSphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius_m = 0;
};
struct SelectBox {
  Eigen::Vector3d lowest = Eigen::Vector3d::Zero();
  Eigen::Vector3d highest = Eigen::Vector3d::Zero();
};
// All that hangs together with a vertex.
struct SelectComponent {
  int vertex = -1;
};
// What a ray from the eye meets first, and what is near that along the surface.
struct SelectRay {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // any length but zero
  double geodesic_radius_m = 0;
};
using VertexSelector = std::variant<SelectIds, SelectSphere, SelectBox,
                                    SelectComponent, SelectRay>;

// Rising, each once; may be none. INVALID_ARGUMENT that lists what is wrong
// with the selector. `mesh` is a good one. Cost: linear.
absl::StatusOr<std::vector<int>> SelectVertices(const TriangleMesh& mesh,
                                                const VertexSelector& selector);

struct RebindResult {
  SkinBinding binding;
  std::vector<int> selected;
  // Of those, which moved to another link.
  std::vector<int> moved;
};

// Binds `selected` to `link_id`, as an assignment, and everything that was not
// assigned afresh. An empty `link_id` takes assignments back.
absl::StatusOr<RebindResult> Rebind(
    const VolumeRig& rig, const TriangleMesh& mesh, const SkinBinding& binding,
    const VertexSelector& selector, const std::string& link_id,
    AssignmentScope scope = AssignmentScope::kChain);

// Revisions of a binding, from 1.
class BindingHistory {
 public:
  explicit BindingHistory(SkinBinding first);

  int revision() const { return current_ + 1; }
  int revision_count() const { return static_cast<int>(revisions_.size()); }
  const std::shared_ptr<const SkinBinding>& current() const {
    return revisions_[current_];
  }
  // NOT_FOUND when there is none.
  absl::StatusOr<std::shared_ptr<const SkinBinding>> At(int revision) const;

  // A new revision behind the current one; those that were undone are
  // forgotten. RESOURCE_EXHAUSTED at kMaxBindingRevisions.
  absl::Status Add(SkinBinding binding);
  // FAILED_PRECONDITION at the first revision, or at the last.
  absl::Status Undo();
  absl::Status Redo();

 private:
  std::vector<std::shared_ptr<const SkinBinding>> revisions_;
  int current_ = 0;
};

// A session of somebody who decides by hand.
inline constexpr int kMaxBindingRevisions = 1000;

}  // namespace gelenk

#endif  // GELENK_SKIN_REBIND_H_

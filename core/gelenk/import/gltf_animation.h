// Reads the animations of a glTF file, as it says them: channels of keys, each
// bound to a node by its index.
//
// All samplers of the format: STEP, LINEAR, CUBICSPLINE; floats and normalised
// integers; sparse accessors, strides; buffers in the GLB, as data URI, or in
// other files, which the caller's `open_uri` reads (nothing is opened here).
//
// Errors: INVALID_ARGUMENT that lists every channel that is malformed and says
// by path what of it is (`animations[0].channels[2]: accessors[7]: ...`):
// indices out of range, accessors beyond their view and views beyond their
// buffer, wrong types and counts, times that do not grow. Cost: linear.
#ifndef GELENK_IMPORT_GLTF_ANIMATION_H_
#define GELENK_IMPORT_GLTF_ANIMATION_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/import/gltf_document.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/motion/joint_track.h"

namespace gelenk {

enum class GltfPath { kTranslation, kRotation, kScale };

struct GltfChannel {
  int node = -1;
  GltfPath path = GltfPath::kRotation;
  // Any but kCatmullRom.
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<double> times_s = {};
  // One column a key, three numbers or x y z w, as in the file.
  Eigen::MatrixXd values = {};
  // kCubicSpline only.
  Eigen::MatrixXd in_tangents = {};
  Eigen::MatrixXd out_tangents = {};
};

struct GltfAnimation {
  // Empty where the file gives none.
  std::string name;
  std::vector<GltfChannel> channels;
  // Channels left out: of mesh weights, or without a node.
  int skipped_channels = 0;
};

// The bytes behind a relative URI.
using OpenUri =
    std::function<absl::StatusOr<std::string>(absl::string_view uri)>;

// `document` is what ReadGltf makes of the same bytes. Without `open_uri` an
// animation in another file is an error.
absl::StatusOr<std::vector<GltfAnimation>> ReadGltfAnimations(
    absl::string_view bytes, const GltfDocument& document,
    const OpenUri& open_uri = nullptr, const GltfBounds& bounds = {});

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_ANIMATION_H_

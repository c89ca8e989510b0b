// Makes a Skeleton of a BVH hierarchy.
//
// Position channels replace the joint's OFFSET. A joint of the file becomes
//   - free: the root with three positions and a full rotation; another joint
//     whose three positions move during the clip;
//   - spherical: a full rotation, that is three angles in one of the twelve
//     orders that reach every rotation;
//   - fixed: nothing that moves;
//   - else a chain of prismatic, then revolute joints, one a channel, that ends
//     in the joint of the file's name; those before it are called like
//     "Chest.Xrotation". A full rotation ends the chain as one spherical joint.
// Position channels of a joint other than the root that stay constant are its
// offset. End Sites become end effectors: by their own name when they have one
// that is free, else "<joint>.end". Rest positions are the file's: all
// angles zero, OFFSETs as written.
//
// Lengths become metres by `unit_m`; axes stay as they are: Skeleton::up says
// which way is up.
#ifndef GELENK_FORMATS_BVH_IMPORT_H_
#define GELENK_FORMATS_BVH_IMPORT_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/formats/bvh_document.h"
#include "gelenk/formats/bvh_mapping.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct BvhImportOptions {
  // Length of the file's unit, m. When unset, the one of m, cm, mm, inch, foot
  // and the CMU database's unit that makes the body nearest to 1.7 m tall.
  std::optional<double> unit_m;
};

struct BvhImport {
  std::shared_ptr<const Skeleton> skeleton;
  double unit_m = 0;
  // Index in the skeleton of each joint of the document.
  std::vector<int> joints;
  BvhMapping mapping;
  // The document's, and what was inferred or changed: unit, up, names.
  std::vector<std::string> warnings;
};

// Errors: INVALID_ARGUMENT naming `unit_m`, or what SkeletonBuilder refuses.
// Cost: linear in the document.
absl::StatusOr<BvhImport> ImportBvh(const BvhDocument& document,
                                    const BvhImportOptions& options = {});

}  // namespace gelenk

#endif  // GELENK_FORMATS_BVH_IMPORT_H_

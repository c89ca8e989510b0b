// Makes a Skeleton of a URDF.
//
// A joint of the file is a joint of the skeleton by the same name; its frame is
// that of the link it moves, which gives it mass and centre of mass. The root
// link is a fixed joint called like the link. Every link is an end effector by
// its name, at the frame of its joint, so that goals can name links; a link
// whose name another joint has is called "<link>.link". Up is +Z.
//
// Joints that mimic one that mimics in turn follow the last one directly. The
// rest pose is all zeros, or the nearest that the limits allow.
#ifndef GELENK_IMPORT_URDF_IMPORT_H_
#define GELENK_IMPORT_URDF_IMPORT_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/import/urdf_document.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {

struct UrdfImport {
  std::shared_ptr<const Skeleton> skeleton;
  // The document's, and what was changed: names, the rest pose.
  std::vector<std::string> warnings;
};

// Errors: INVALID_ARGUMENT that lists, by line, names that come twice or that
// nobody has, links that two joints move, several roots, cycles, mimics that
// follow each other; else what SkeletonBuilder refuses. Cost: linear.
absl::StatusOr<UrdfImport> ImportUrdf(const UrdfDocument& document,
                                      const SkeletonBounds& bounds = {});

}  // namespace gelenk

#endif  // GELENK_IMPORT_URDF_IMPORT_H_

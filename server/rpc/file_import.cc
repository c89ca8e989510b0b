#include "server/rpc/file_import.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/formats/bvh_import.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/import/gltf_import.h"
#include "gelenk/import/gltf_reader.h"
#include "gelenk/import/urdf_import.h"
#include "gelenk/import/urdf_reader.h"

namespace gelenk::server {
namespace {

SkeletonBounds BoundsFor(const Limits& limits) {
  SkeletonBounds bounds;
  bounds.max_joints = limits.max_joints;
  return bounds;
}

// What the importers have in common.
template <class Import>
FileImport Imported(Import&& import, double unit_m) {
  FileImport file;
  file.skeleton.skeleton = std::move(import.skeleton);
  file.skeleton.warnings = std::move(import.warnings);
  file.unit_m = unit_m;
  return file;
}

absl::StatusOr<FileImport> ImportBvhFile(const v1::ImportHeader& header,
                                         std::string bytes,
                                         const Limits& limits) {
  BvhBounds bounds;
  bounds.max_joints = limits.max_joints;
  const absl::StatusOr<BvhDocument> document = ReadBvh(bytes, bounds);
  if (!document.ok()) return document.status();
  // Clips are large, and so is what comes of them.
  std::string().swap(bytes);
  BvhImportOptions options;
  if (header.has_unit_m()) options.unit_m = header.unit_m();
  absl::StatusOr<BvhImport> import = ImportBvh(*document, options);
  if (!import.ok()) return import.status();
  const double unit_m = import->unit_m;
  return Imported(*std::move(import), unit_m);
}

absl::StatusOr<FileImport> ImportUrdfFile(absl::string_view bytes,
                                          const Limits& limits) {
  UrdfBounds bounds;
  bounds.max_joints = limits.max_joints;
  const absl::StatusOr<UrdfDocument> document = ReadUrdf(bytes, bounds);
  if (!document.ok()) return document.status();
  absl::StatusOr<UrdfImport> import = ImportUrdf(*document, BoundsFor(limits));
  if (!import.ok()) return import.status();
  return Imported(*std::move(import), 1);
}

absl::StatusOr<FileImport> ImportGltfFile(const v1::ImportHeader& header,
                                          absl::string_view bytes,
                                          const Limits& limits) {
  const absl::StatusOr<GltfDocument> document = ReadGltf(bytes);
  if (!document.ok()) return document.status();
  GltfImportOptions options;
  options.bounds = BoundsFor(limits);
  if (header.has_unit_m()) options.unit_m = header.unit_m();
  absl::StatusOr<GltfImport> import = ImportGltf(*document, options);
  if (!import.ok()) return import.status();
  return Imported(*std::move(import), options.unit_m);
}

}  // namespace

absl::Status CheckImportFormat(const v1::ImportHeader& header) {
  Violations violations;
  switch (header.format()) {
    case v1::IMPORT_FORMAT_BVH:
    case v1::IMPORT_FORMAT_GLTF:
      break;
    case v1::IMPORT_FORMAT_URDF:
      if (!header.has_unit_m() || header.unit_m() == 1) break;
      violations.Add("header.unit_m", absl::StrCat("a URDF is in metres, got ",
                                                   header.unit_m()));
      break;
    default:
      violations.Add(
          "header.format",
          absl::StrCat("no such format: ", static_cast<int>(header.format())));
  }
  return violations.ToStatus();
}

absl::StatusOr<FileImport> ImportFile(const v1::ImportHeader& header,
                                      std::string bytes, const Limits& limits) {
  switch (header.format()) {
    case v1::IMPORT_FORMAT_URDF:
      return ImportUrdfFile(bytes, limits);
    case v1::IMPORT_FORMAT_GLTF:
      return ImportGltfFile(header, bytes, limits);
    default:
      return ImportBvhFile(header, std::move(bytes), limits);
  }
}

}  // namespace gelenk::server

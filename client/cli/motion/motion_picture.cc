#include "client/cli/motion/motion_picture.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "client/cli/picture/contact_sheet.h"

namespace gelenk::cli {

absl::Status WriteMotionPicture(const BodyFile& body, const BodyFile* reference,
                                const std::string& path) {
  const std::vector<BodyPose> poses = BodyPosesOf(*body.model, body.positions);
  if (reference == nullptr) {
    const ContactLabels labels = ContactsOf(body, poses);
    const SheetMotion row = {body.name, *body.model, body.positions, poses,
                             labels.floor_m};
    return WriteFile(
        path, ContactSheetSvg(body.name, {row}, labels, body.frame_time_s));
  }
  const std::vector<BodyPose> reference_poses =
      BodyPosesOf(*reference->model, reference->positions);
  const ContactLabels labels = ContactsOf(*reference, reference_poses);
  const SheetMotion rows[] = {
      {reference->name, *reference->model, reference->positions,
       reference_poses, labels.floor_m},
      {body.name, *body.model, body.positions, poses, 0}};
  return WriteFile(
      path, ContactSheetSvg(absl::StrCat(reference->name, " on ", body.name),
                            rows, labels, body.frame_time_s));
}

}  // namespace gelenk::cli

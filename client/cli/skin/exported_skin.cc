#include "client/cli/skin/exported_skin.h"

#include "client/cli/patient_call.h"
#include "client/cli/skin/served_skin.h"
#include "convert/duration.h"

namespace gelenk::cli {

absl::StatusOr<ExportedSkin> ExportSkin(client::Connection& connection,
                                        const std::string& skin,
                                        const std::vector<v1::SkinPose>& poses,
                                        absl::Duration frame_time) {
  v1::ExportSkinRequest request;
  request.set_name(skin);
  request.mutable_poses()->Add(poses.begin(), poses.end());
  convert::ToProto(frame_time, request.mutable_frame_time());
  grpc::ClientContext context;
  connection.Prepare(PatientCall(), context);
  const auto stream = connection.stub<SkinStub>().ExportSkin(&context, request);
  ExportedSkin exported;
  v1::ExportSkinResponse piece;
  while (stream->Read(&piece)) {
    exported.glb += piece.data();
    exported.inexact_vertex_count += piece.inexact_vertex_count();
  }
  const absl::Status end = client::FromGrpc(stream->Finish());
  if (!end.ok()) return end;
  return exported;
}

}  // namespace gelenk::cli

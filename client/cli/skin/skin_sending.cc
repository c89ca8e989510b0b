#include "client/cli/skin/skin_sending.h"

#include <algorithm>
#include <utility>

#include "client/cli/patient_call.h"
#include "gelenk/client/status.h"

namespace gelenk::cli {
namespace {

using Stub = v1::SkinService::Stub;

template <class Number>
using Numbers = google::protobuf::RepeatedField<Number>;

// A varint is longer, where indices are large; five bytes at most.
constexpr size_t kBytesPerNumber = 4;

// Writes pieces until one is not taken.
class PieceWriter {
 public:
  PieceWriter(grpc::ClientWriter<v1::UploadSkinRequest>& writer,
              size_t piece_bytes)
      : writer_(writer),
        piece_numbers_(static_cast<int>(
            std::max<size_t>(1, piece_bytes / kBytesPerNumber))) {}

  void Write(const v1::UploadSkinRequest& piece) {
    if (is_taken_) is_taken_ = writer_.Write(piece);
  }

  // `numbers` in pieces; `field(piece)` is where they belong.
  template <class Number, class Field>
  void WriteNumbers(const Numbers<Number>& numbers, Field field) {
    for (int at = 0; is_taken_ && at < numbers.size(); at += piece_numbers_) {
      v1::UploadSkinRequest piece;
      const int count = std::min(piece_numbers_, numbers.size() - at);
      field(piece)->Add(numbers.begin() + at, numbers.begin() + at + count);
      Write(piece);
    }
  }

 private:
  grpc::ClientWriter<v1::UploadSkinRequest>& writer_;
  const int piece_numbers_;
  bool is_taken_ = true;
};

void WriteMesh(const v1::TriangleMesh& mesh, PieceWriter& writer) {
  writer.WriteNumbers(mesh.positions(), [](v1::UploadSkinRequest& piece) {
    return piece.mutable_mesh()->mutable_positions();
  });
  writer.WriteNumbers(mesh.triangles(), [](v1::UploadSkinRequest& piece) {
    return piece.mutable_mesh()->mutable_triangles();
  });
  writer.WriteNumbers(mesh.normals(), [](v1::UploadSkinRequest& piece) {
    return piece.mutable_mesh()->mutable_normals();
  });
}

void WriteWeights(const v1::VertexWeights& weights, PieceWriter& writer) {
  writer.WriteNumbers(weights.joints(), [](v1::UploadSkinRequest& piece) {
    return piece.mutable_weights()->mutable_joints();
  });
  writer.WriteNumbers(weights.weights(), [](v1::UploadSkinRequest& piece) {
    return piece.mutable_weights()->mutable_weights();
  });
}

// Takes the numbers of vertices out of `weights`; the rest stays.
v1::VertexWeights TakeNumbers(v1::VertexWeights* weights) {
  v1::VertexWeights taken;
  taken.mutable_joints()->Swap(weights->mutable_joints());
  taken.mutable_weights()->Swap(weights->mutable_weights());
  return taken;
}

}  // namespace

absl::StatusOr<v1::Skin> SendSkin(client::Connection& connection,
                                  v1::CreateSkinRequest request,
                                  size_t piece_bytes) {
  if (request.ByteSizeLong() <= piece_bytes) {
    return connection.Call(&Stub::CreateSkin, request, PatientCall());
  }
  // What is long, apart from the header.
  v1::Skin& skin = *request.mutable_skin();
  v1::TriangleMesh mesh;
  if (skin.has_mesh()) mesh.Swap(skin.mutable_mesh());
  v1::VertexWeights weights;
  if (skin.has_linear_blend()) {
    weights = TakeNumbers(skin.mutable_linear_blend());
  } else if (skin.has_dual_quaternion()) {
    weights = TakeNumbers(skin.mutable_dual_quaternion());
  }
  google::protobuf::RepeatedPtrField<v1::VertexAssignment> assignments;
  if (skin.has_layered_volumes()) {
    assignments.Swap(skin.mutable_layered_volumes()->mutable_assignments());
  }

  grpc::ClientContext context;
  connection.Prepare(PatientCall(), context);
  v1::Skin created;
  const auto stream = connection.stub<Stub>().UploadSkin(&context, &created);
  PieceWriter writer(*stream, piece_bytes);
  v1::UploadSkinRequest piece;
  *piece.mutable_header() = std::move(request);
  writer.Write(piece);
  WriteMesh(mesh, writer);
  WriteWeights(weights, writer);
  for (v1::VertexAssignment& assignment : assignments) {
    piece.Clear();
    piece.add_assignments()->Swap(&assignment);
    writer.Write(piece);
  }
  stream->WritesDone();
  // Says why where a piece was not taken.
  const grpc::Status status = stream->Finish();
  if (!status.ok()) return client::FromGrpc(status);
  return created;
}

}  // namespace gelenk::cli

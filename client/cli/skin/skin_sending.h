// A new skin on its way to a server: in one message, or in pieces.
#ifndef CLIENT_CLI_SKIN_SKIN_SENDING_H_
#define CLIENT_CLI_SKIN_SKIN_SENDING_H_

#include <cstddef>

#include "absl/status/statusor.h"
#include "gelenk/client/connection.h"
#include "gelenk/v1/skin_service.grpc.pb.h"

namespace gelenk::cli {

// A quarter of what a message may hold.
inline constexpr size_t kSkinPieceBytes = size_t{1} << 20;

// Requests of more than `piece_bytes` by UploadSkin, in pieces of about as
// much. Errors are those of the server.
absl::StatusOr<v1::Skin> SendSkin(client::Connection& connection,
                                  v1::CreateSkinRequest request,
                                  size_t piece_bytes = kSkinPieceBytes);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_SKIN_SENDING_H_

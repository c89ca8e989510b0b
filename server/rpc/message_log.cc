#include "server/rpc/message_log.h"

#include <google/protobuf/stubs/logging.h>

namespace gelenk::server {

void DropMessageLog() { google::protobuf::SetLogHandler(nullptr); }

}  // namespace gelenk::server

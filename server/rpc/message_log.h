// protobuf writes a line to standard error about each message with a fault. The
// fault is the sender's and told to it; clients shall not write into the log.
#ifndef GELENK_SERVER_RPC_MESSAGE_LOG_H_
#define GELENK_SERVER_RPC_MESSAGE_LOG_H_

namespace gelenk::server {

// For the whole process.
void DropMessageLog();

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_MESSAGE_LOG_H_

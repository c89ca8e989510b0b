// A message that is made anew again and again without asking the heap.
#ifndef GELENK_SERVER_RPC_MESSAGE_ARENA_H_
#define GELENK_SERVER_RPC_MESSAGE_ARENA_H_

#include <google/protobuf/arena.h>

#include <memory>

namespace gelenk::server {

// Holds one `Message` in memory of its own, taken at the first use and kept.
template <class Message>
class MessageArena {
 public:
  // An empty message; the one before is gone.
  Message* Renew() {
    if (arena_ == nullptr) {
      block_ = std::make_unique<char[]>(kBlockBytes);
      google::protobuf::ArenaOptions options;
      options.initial_block = block_.get();
      options.initial_block_size = kBlockBytes;
      options.max_block_size = kMaxBlockBytes;
      arena_ = std::make_unique<google::protobuf::Arena>(options);
    } else {
      arena_->Reset();
    }
    message_ = google::protobuf::Arena::CreateMessage<Message>(arena_.get());
    return message_;
  }

  // The message of the last Renew, which must have been.
  Message* get() { return message_; }
  const Message* get() const { return message_; }

 private:
  // Holds a frame or an answer of a 64-joint body with a few goals.
  static constexpr size_t kBlockBytes = 4096;
  static constexpr size_t kMaxBlockBytes = 65536;

  std::unique_ptr<char[]> block_;
  std::unique_ptr<google::protobuf::Arena> arena_;
  Message* message_ = nullptr;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_MESSAGE_ARENA_H_

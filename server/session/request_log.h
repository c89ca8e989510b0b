// Remembers which request made which resource, so that a retried create answers
// the first result (AIP-155).
#ifndef GELENK_SERVER_SESSION_REQUEST_LOG_H_
#define GELENK_SERVER_SESSION_REQUEST_LOG_H_

#include <deque>
#include <map>
#include <string>

#include "absl/strings/string_view.h"
#include "server/session/resource_name.h"

namespace gelenk::server {

// The newest kCapacity requests; older ones are forgotten, which is long after
// any client has stopped retrying. Not thread-safe: lives under the lock of its
// registry.
class RequestLog {
 public:
  static constexpr size_t kCapacity = 4096;

  // The name of the resource that the request made; empty when it is new.
  std::string Find(absl::string_view tenant,
                   absl::string_view request_id) const {
    if (request_id.empty()) return "";
    const auto found =
        names_.find({std::string(tenant), std::string(request_id)});
    return found == names_.end() ? "" : found->second;
  }

  void Add(absl::string_view tenant, absl::string_view request_id,
           absl::string_view name) {
    if (request_id.empty()) return;
    const ResourceKey key(tenant, request_id);
    // A request whose resource is gone may have made another one.
    if (names_.insert_or_assign(key, std::string(name)).second) {
      order_.push_back(key);
    }
    if (order_.size() <= kCapacity) return;
    names_.erase(order_.front());
    order_.pop_front();
  }

 private:
  std::map<ResourceKey, std::string> names_;
  std::deque<ResourceKey> order_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_REQUEST_LOG_H_

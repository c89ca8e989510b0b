// Paging of lists: a token is the name of the last resource of the page before.
#ifndef GELENK_SERVER_RPC_PAGE_H_
#define GELENK_SERVER_RPC_PAGE_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk::server {

inline constexpr int kDefaultPageSize = 50;
inline constexpr int kMaxPageSize = 1000;

// INVALID_ARGUMENT for a negative size; larger ones than the most give the
// most.
inline absl::StatusOr<size_t> PageSize(int requested) {
  if (requested < 0) {
    Violations violations;
    violations.Add("page_size",
                   absl::StrCat("want 0 or more, got ", requested));
    return violations.ToStatus();
  }
  if (requested == 0) return kDefaultPageSize;
  return requested < kMaxPageSize ? requested : kMaxPageSize;
}

// The token of the page after `page`, which was asked for with one item more
// than its `size`: that one is taken away, and there is another page. Empty on
// the last page. `name` gives the name of an item.
template <class Item, class Name>
std::string TakeNextPageToken(size_t size, std::vector<Item>& page, Name name) {
  if (page.size() <= size) return "";
  page.erase(page.begin() + size, page.end());
  return name(page.back());
}

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_PAGE_H_

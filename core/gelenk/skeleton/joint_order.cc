#include "gelenk/skeleton/joint_order.h"

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

std::string ParentField(int index) {
  return absl::StrCat("joints[", index, "].parent_joint_id");
}

// The index of each joint's parent; -1 for roots and where there is none.
std::vector<int> FindParents(absl::Span<const Joint> joints,
                             Violations& violations) {
  absl::flat_hash_map<absl::string_view, int> index_of;
  for (size_t i = 0; i < joints.size(); ++i) {
    if (index_of.emplace(joints[i].id, i).second) continue;
    violations.Add(absl::StrCat("joints[", i, "].joint_id"),
                   absl::StrCat("duplicate ", QuotedId(joints[i].id)));
  }
  std::vector<int> parents(joints.size(), -1);
  int roots = 0;
  for (size_t i = 0; i < joints.size(); ++i) {
    const std::string& parent_id = joints[i].parent_id;
    const auto found = index_of.find(parent_id);
    if (parent_id.empty()) {
      ++roots;
    } else if (found == index_of.end()) {
      violations.Add(ParentField(i),
                     absl::StrCat("no joint ", QuotedId(parent_id)));
    } else {
      parents[i] = found->second;
    }
  }
  if (roots != 1) {
    violations.Add("joints", absl::StrFormat("want one root, got %d", roots));
  }
  return parents;
}

}  // namespace

std::vector<int> OrderParentsFirst(absl::Span<const Joint> joints,
                                   int max_depth, Violations& violations) {
  const std::vector<int> parents = FindParents(joints, violations);
  // Each joint is placed behind its ancestors; a walk that meets itself is a
  // cycle.
  enum class Mark : char { kNew, kOpen, kDone };
  std::vector<Mark> marks(joints.size(), Mark::kNew);
  std::vector<int> depths(joints.size(), 0);
  std::vector<int> order;
  std::vector<int> walk;
  for (size_t start = 0; start < joints.size(); ++start) {
    walk.clear();
    int at = static_cast<int>(start);
    while (at >= 0 && marks[at] == Mark::kNew) {
      marks[at] = Mark::kOpen;
      walk.push_back(at);
      at = parents[at];
    }
    if (at >= 0 && marks[at] == Mark::kOpen) {
      violations.Add(ParentField(at),
                     absl::StrCat("joint ", QuotedId(joints[at].id),
                                  " is its own ancestor"));
    }
    for (auto it = walk.rbegin(); it != walk.rend(); ++it) {
      marks[*it] = Mark::kDone;
      depths[*it] = parents[*it] < 0 ? 1 : depths[parents[*it]] + 1;
      if (depths[*it] == max_depth + 1) {
        violations.Add(ParentField(*it),
                       absl::StrFormat("deeper than %d joints", max_depth));
      }
      order.push_back(*it);
    }
  }
  return order;
}

}  // namespace gelenk

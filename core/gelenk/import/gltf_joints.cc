#include "gelenk/import/gltf_joints.h"

#include <algorithm>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/formats/unique_names.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

// Skins that an error or warning lists.
constexpr size_t kMaxListedSkins = 8;

std::string SkinName(const GltfDocument& document, size_t index) {
  const std::string& name = document.skins[index].name;
  return name.empty()
             ? absl::StrCat("skin ", index)
             : absl::StrCat("skin \"",
                            TruncateUtf8(PrintableUtf8(name), kMaxIdBytes),
                            "\"");
}

std::string SkinNames(const GltfDocument& document) {
  std::string names;
  for (size_t i = 0; i < document.skins.size() && i < kMaxListedSkins; ++i) {
    absl::StrAppend(&names, i == 0 ? "" : ", ", SkinName(document, i));
  }
  if (document.skins.size() > kMaxListedSkins) absl::StrAppend(&names, ", ...");
  return names;
}

size_t LargestSkin(const GltfDocument& document) {
  const auto largest =
      std::max_element(document.skins.begin(), document.skins.end(),
                       [](const GltfSkin& a, const GltfSkin& b) {
                         return a.joints.size() < b.joints.size();
                       });
  return largest - document.skins.begin();
}

absl::StatusOr<size_t> FindSkin(const GltfDocument& document,
                                const std::string& name) {
  for (size_t i = 0; i < document.skins.size(); ++i) {
    if (document.skins[i].name == name) return i;
  }
  size_t index = 0;
  if (absl::SimpleAtoi(name, &index) && index < document.skins.size()) {
    return index;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("skin: there is none called ", QuotedId(name),
                   document.skins.empty()
                       ? ""
                       : absl::StrCat("; there are ", SkinNames(document))));
}

class JointFinder {
 public:
  explicit JointFinder(const GltfDocument& document)
      : document_(document), is_joint_(document.nodes.size(), false) {}

  absl::StatusOr<GltfJoints> Find(const std::optional<std::string>& skin);

 private:
  absl::Status MarkSkin(const std::optional<std::string>& skin);
  // Marks the joints of skins that share one with those marked, until there is
  // none left; returns how many skins that are.
  size_t MarkSharers(size_t first);
  void MarkScene();
  void MarkTurnedBetween();
  // A common root, where joints have none and there is one.
  void MarkRoot();

  // The nodes below `roots` and these themselves, parents first, children in
  // the file's order.
  std::vector<int> Below(const std::vector<int>& roots) const;
  std::vector<int> AllRoots() const;
  // The marked ones that hang from no marked one.
  std::vector<int> Tops() const;
  void Order();

  const GltfDocument& document_;
  std::vector<bool> is_joint_;
  GltfJoints joints_;
};

absl::StatusOr<GltfJoints> JointFinder::Find(
    const std::optional<std::string>& skin) {
  if (document_.nodes.empty()) {
    return absl::InvalidArgumentError("nodes: there is none");
  }
  if (document_.skins.empty() && !skin) {
    MarkScene();
  } else if (absl::Status status = MarkSkin(skin); !status.ok()) {
    return status;
  }
  MarkTurnedBetween();
  MarkRoot();
  Order();
  if (joints_.nodes.empty()) {
    return absl::InvalidArgumentError("scenes: the scene shows no node");
  }
  return std::move(joints_);
}

absl::Status JointFinder::MarkSkin(const std::optional<std::string>& skin) {
  const absl::StatusOr<size_t> chosen =
      skin ? FindSkin(document_, *skin) : LargestSkin(document_);
  if (!chosen.ok()) return chosen.status();
  const size_t taken = MarkSharers(*chosen);
  joints_.name = document_.skins[*chosen].name;
  if (taken < document_.skins.size() && !skin) {
    joints_.warnings.push_back(absl::StrFormat(
        "%s is taken, with the most joints, %d; there are %s",
        SkinName(document_, *chosen), document_.skins[*chosen].joints.size(),
        SkinNames(document_)));
  }
  return absl::OkStatus();
}

size_t JointFinder::MarkSharers(size_t first) {
  // Skins by joint, so that each skin is looked at once.
  std::vector<std::vector<size_t>> skins_of_node(document_.nodes.size());
  for (size_t i = 0; i < document_.skins.size(); ++i) {
    for (int node : document_.skins[i].joints) skins_of_node[node].push_back(i);
  }
  std::vector<bool> is_taken(document_.skins.size(), false);
  std::vector<size_t> taken = {first};
  is_taken[first] = true;
  for (size_t i = 0; i < taken.size(); ++i) {
    for (int node : document_.skins[taken[i]].joints) {
      if (is_joint_[node]) continue;
      is_joint_[node] = true;
      for (size_t skin : skins_of_node[node]) {
        if (is_taken[skin]) continue;
        is_taken[skin] = true;
        taken.push_back(skin);
      }
    }
  }
  return taken.size();
}

void JointFinder::MarkScene() {
  const bool has_scene = document_.scene >= 0;
  for (int node : Below(has_scene ? document_.scenes[document_.scene].roots
                                  : AllRoots())) {
    is_joint_[node] = true;
  }
  if (has_scene) joints_.name = document_.scenes[document_.scene].name;
  joints_.warnings.emplace_back(
      "there is no skin: every node of the scene is a joint");
}

void JointFinder::MarkTurnedBetween() {
  // Leaves first: a node is between when it is below a joint and has one below.
  const std::vector<int> order = Below(AllRoots());
  std::vector<bool> has_above(document_.nodes.size(), false);
  for (int node : order) {
    const int parent = document_.nodes[node].parent;
    if (parent >= 0) has_above[node] = has_above[parent] || is_joint_[parent];
  }
  std::vector<bool> has_below(document_.nodes.size(), false);
  int folded = 0;
  for (size_t i = order.size(); i-- > 0;) {
    const int node = order[i];
    const bool is_between =
        !is_joint_[node] && has_above[node] && has_below[node];
    if (is_between && document_.nodes[node].is_turned) {
      is_joint_[node] = true;
    } else if (is_between) {
      ++folded;
    }
    const int parent = document_.nodes[node].parent;
    if (parent >= 0 && (is_joint_[node] || has_below[node])) {
      has_below[parent] = true;
    }
  }
  if (folded > 0) {
    joints_.warnings.push_back(absl::StrFormat(
        "%d nodes between joints are part of the joints below them", folded));
  }
}

std::vector<int> JointFinder::Tops() const {
  std::vector<int> tops;
  std::vector<bool> has_above(document_.nodes.size(), false);
  for (int node : Below(AllRoots())) {
    const int parent = document_.nodes[node].parent;
    if (parent >= 0) has_above[node] = has_above[parent] || is_joint_[parent];
    if (is_joint_[node] && !has_above[node]) tops.push_back(node);
  }
  return tops;
}

void JointFinder::MarkRoot() {
  const std::vector<int> tops = Tops();
  if (tops.size() < 2) return;
  // How many of them are at or below each node; the lowest that has all.
  std::vector<size_t> counts(document_.nodes.size(), 0);
  for (int top : tops) counts[top] = 1;
  const std::vector<int> order = Below(AllRoots());
  for (size_t i = order.size(); i-- > 0;) {
    const int node = order[i];
    if (counts[node] == tops.size()) {
      is_joint_[node] = true;
      return;
    }
    const int parent = document_.nodes[node].parent;
    if (parent >= 0) counts[parent] += counts[node];
  }
}

std::vector<int> JointFinder::AllRoots() const {
  std::vector<int> roots;
  for (size_t i = 0; i < document_.nodes.size(); ++i) {
    if (document_.nodes[i].parent < 0) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

std::vector<int> JointFinder::Below(const std::vector<int>& roots) const {
  std::vector<int> order;
  std::vector<int> waiting(roots.rbegin(), roots.rend());
  while (!waiting.empty()) {
    const int node = waiting.back();
    waiting.pop_back();
    order.push_back(node);
    const std::vector<int>& children = document_.nodes[node].children;
    waiting.insert(waiting.end(), children.rbegin(), children.rend());
  }
  return order;
}

void JointFinder::Order() {
  std::vector<int>& place = joints_.place_above;
  place.assign(document_.nodes.size(), -1);
  for (int node : Below(AllRoots())) {
    const int parent = document_.nodes[node].parent;
    if (parent >= 0) place[node] = place[parent];
    if (!is_joint_[node]) continue;
    joints_.parents.push_back(place[node]);
    place[node] = static_cast<int>(joints_.nodes.size());
    joints_.nodes.push_back(node);
  }
}

}  // namespace

absl::StatusOr<GltfJoints> FindGltfJoints(
    const GltfDocument& document, const std::optional<std::string>& skin) {
  return JointFinder(document).Find(skin);
}

}  // namespace gelenk

#include "gelenk/motion/body_part_name.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/strip.h"

namespace gelenk {
namespace {

template <size_t kSize>
using Words = std::array<absl::string_view, kSize>;

constexpr Words<4> kLeftWords = {"left", "l", "lft", "lt"};
constexpr Words<4> kRightWords = {"right", "r", "rgt", "rt"};
constexpr Words<2> kHandWords = {"hand", "wrist"};
constexpr Words<2> kFootWords = {"foot", "ankle"};
constexpr Words<3> kHipsWords = {"hips", "hip", "pelvis"};
constexpr Words<1> kRootWords = {"root"};
constexpr Words<1> kHeadWords = {"head"};

// Limbs that have no part here, but whose side may be glued to them.
constexpr Words<12> kLimbWords = {"arm",   "forearm", "elbow", "shoulder",
                                  "shldr", "collar",  "leg",   "thigh",
                                  "shin",  "knee",    "toe",   "uparm"};

// A name with one of these is another thing near the part.
constexpr Words<47> kOtherWords = {
    "thumb",     "index",      "middle",     "mid",       "ring",
    "pinky",     "pinkie",     "little",     "finger",    "fingers",
    "digit",     "metacarpal", "fingerbase", "toe",       "toes",
    "toebase",   "ball",       "fore",       "forefoot",  "heel",
    "end",       "nub",        "tip",        "top",       "site",
    "effector",  "ik",         "pole",       "target",    "goal",
    "prop",      "weapon",     "item",       "attach",    "socket",
    "twist",     "roll",       "ctrl",       "control",   "hair",
    "jaw",       "xposition",  "yposition",  "zposition", "xrotation",
    "yrotation", "zrotation"};

template <typename List>
bool Contains(const List& words, absl::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// "LHandProp_01" is l, hand, prop, 01: a word ends where letters end, where a
// capital follows a small letter, and before the last of several capitals.
std::vector<std::string> SplitWords(absl::string_view name) {
  const auto at = [&name](size_t i) { return i < name.size() ? name[i] : ' '; };
  std::vector<std::string> words;
  bool open = false;
  for (size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (!absl::ascii_isalnum(c)) {
      open = false;
      continue;
    }
    const char before = i > 0 ? name[i - 1] : ' ';
    const bool capital_starts =
        absl::ascii_isupper(c) &&
        (absl::ascii_islower(before) || absl::ascii_islower(at(i + 1)));
    const bool kind_changes =
        absl::ascii_isdigit(c) != absl::ascii_isdigit(before);
    if (!open || capital_starts || kind_changes) words.emplace_back();
    words.back() += absl::ascii_tolower(c);
    open = true;
  }
  return words;
}

BodyPart PartOf(absl::string_view word) {
  if (Contains(kHandWords, word)) return BodyPart::kHand;
  if (Contains(kFootWords, word)) return BodyPart::kFoot;
  if (Contains(kHeadWords, word)) return BodyPart::kHead;
  if (Contains(kHipsWords, word)) return BodyPart::kHips;
  if (Contains(kRootWords, word)) return BodyPart::kRoot;
  return BodyPart::kOther;
}

// Splits "lefthand" and "rfoot", in which nothing shows where the side ends.
BodyPartName ReadGlued(absl::string_view word) {
  for (BodySide side : {BodySide::kLeft, BodySide::kRight}) {
    const auto& prefixes = side == BodySide::kLeft ? kLeftWords : kRightWords;
    for (absl::string_view prefix : prefixes) {
      if (!absl::StartsWith(word, prefix)) continue;
      const absl::string_view rest = absl::StripPrefix(word, prefix);
      const BodyPart part = PartOf(rest);
      if (part != BodyPart::kOther || Contains(kLimbWords, rest)) {
        return {side, part};
      }
    }
  }
  return {};
}

BodySide SideOf(absl::string_view word) {
  if (Contains(kLeftWords, word)) return BodySide::kLeft;
  return Contains(kRightWords, word) ? BodySide::kRight : BodySide::kNone;
}

}  // namespace

BodyPartName ReadBodyPartName(absl::string_view name) {
  const size_t scope = name.find_last_of(":|");
  if (scope != absl::string_view::npos) name.remove_prefix(scope + 1);
  BodyPartName result;
  if (absl::StrContains(name, "左")) result.side = BodySide::kLeft;
  if (absl::StrContains(name, "右")) result.side = BodySide::kRight;
  bool is_other = false;
  for (const std::string& word : SplitWords(name)) {
    is_other |= Contains(kOtherWords, word);
    const BodyPartName glued = ReadGlued(word);
    const BodyPart part =
        glued.part == BodyPart::kOther ? PartOf(word) : glued.part;
    const BodySide side =
        glued.side == BodySide::kNone ? SideOf(word) : glued.side;
    if (part != BodyPart::kOther) result.part = part;
    if (side != BodySide::kNone) result.side = side;
  }
  const bool is_paired =
      result.part == BodyPart::kHand || result.part == BodyPart::kFoot;
  const bool has_side = result.side != BodySide::kNone;
  if (is_other || is_paired != has_side) result.part = BodyPart::kOther;
  return result;
}

}  // namespace gelenk

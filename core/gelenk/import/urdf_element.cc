#include "gelenk/import/urdf_element.h"

#include <cmath>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "gelenk/formats/decimal_number.h"
#include "gelenk/math/euler.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

// As much of a value as an error repeats.
constexpr size_t kMaxQuotedBytes = 40;

std::string Quoted(absl::string_view text) {
  const bool cut = text.size() > kMaxQuotedBytes;
  return absl::StrCat("\"", absl::CHexEscape(text.substr(0, kMaxQuotedBytes)),
                      cut ? "...\"" : "\"");
}

// What xacro would have replaced.
bool IsUnexpanded(absl::string_view text) {
  return absl::StrContains(text, "${") || absl::StrContains(text, "$(");
}

}  // namespace

std::string UrdfLine(int line) { return absl::StrCat("line ", line); }

std::optional<UrdfElement> UrdfElement::Child(const char* name) const {
  const tinyxml2::XMLElement* child = xml_->FirstChildElement(name);
  if (child == nullptr) return std::nullopt;
  UrdfElement element(*child, title_, *findings_);
  element.is_child_ = true;
  if (const auto* next = child->NextSiblingElement(name); next != nullptr) {
    UrdfElement ignored(element);
    ignored.xml_ = next;
    ignored.Warn(
        absl::StrCat("ignored: the one on line ", element.line(), " counts"));
  }
  return element;
}

std::optional<absl::string_view> UrdfElement::Text(
    const char* attribute) const {
  const char* text = xml_->Attribute(attribute);
  if (text == nullptr) return std::nullopt;
  return absl::string_view(text);
}

absl::string_view UrdfElement::RequiredText(const char* attribute) const {
  const std::optional<absl::string_view> text = Text(attribute);
  if (!text) {
    Refuse(nullptr, absl::StrCat("no attribute ", attribute));
    return "";
  }
  if (text->empty()) Refuse(attribute, "empty");
  return *text;
}

bool UrdfElement::Parse(const char* attribute, absl::string_view text,
                        double& number) const {
  double parsed = 0;
  std::errc error{};
  if (!ParseDecimal(absl::StripAsciiWhitespace(text), parsed, error) ||
      !std::isfinite(parsed)) {
    Refuse(attribute, IsUnexpanded(text)
                          ? "not expanded: run `xacro FILE > ROBOT.urdf` first"
                          : "not a number");
    return false;
  }
  if (error != std::errc()) {
    Refuse(attribute, "out of the range of numbers");
    return false;
  }
  number = parsed;
  return true;
}

void UrdfElement::ReadNumber(const char* attribute, double& number) const {
  const std::optional<absl::string_view> text = Text(attribute);
  if (text) Parse(attribute, *text, number);
}

void UrdfElement::ReadVector(const char* attribute,
                             Eigen::Vector3d& vector) const {
  const std::optional<absl::string_view> text = Text(attribute);
  if (!text) return;
  const std::vector<absl::string_view> pieces =
      absl::StrSplit(*text, absl::ByAnyChar(" \t\r\n"), absl::SkipEmpty());
  Eigen::Vector3d parsed;
  for (size_t i = 0; i < pieces.size() && i < 3; ++i) {
    if (!Parse(attribute, pieces[i], parsed[i])) return;
  }
  if (pieces.size() != 3) {
    Refuse(attribute, absl::StrCat("want 3 numbers, got ", pieces.size()));
  } else if (parsed.cwiseAbs().maxCoeff() > kMaxMagnitude) {
    Refuse(attribute, "want numbers of at most 1e9");
  } else {
    vector = parsed;
  }
}

void UrdfElement::ReadTransform(RigidTransform& transform) const {
  ReadVector("xyz", transform.translation);
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();
  ReadVector("rpy", rpy);
  transform.rotation = RotationFromEuler({2, 1, 0}, rpy.reverse());
}

std::string UrdfElement::Described(const char* attribute) const {
  if (attribute == nullptr && !is_child_ && !title_.empty()) return title_;
  std::string text = absl::StrCat("<", xml_->Name());
  if (attribute != nullptr) {
    absl::StrAppend(&text, " ", attribute, "=",
                    Quoted(xml_->Attribute(attribute)));
  }
  absl::StrAppend(&text, ">");
  if (!title_.empty()) absl::StrAppend(&text, " of ", title_);
  return text;
}

void UrdfElement::Refuse(const char* attribute,
                         absl::string_view reason) const {
  const int at = attribute == nullptr
                     ? line()
                     : xml_->FindAttribute(attribute)->GetLineNum();
  findings_->violations.Add(UrdfLine(at),
                            absl::StrCat(Described(attribute), ": ", reason));
}

void UrdfElement::Warn(absl::string_view text) const {
  findings_->warnings.push_back(
      absl::StrCat(UrdfLine(line()), ": ", Described(nullptr), ": ", text));
}

}  // namespace gelenk

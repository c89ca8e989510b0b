// One element of a URDF: its attributes as numbers and names, and the words to
// object to them.
#ifndef GELENK_IMPORT_URDF_ELEMENT_H_
#define GELENK_IMPORT_URDF_ELEMENT_H_

#include <tinyxml2.h>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"
#include "gelenk/math/rigid_transform.h"

namespace gelenk {

struct UrdfFindings {
  Violations violations;
  std::vector<std::string> warnings;
};

// The field of a violation: "line 42".
std::string UrdfLine(int line);

class UrdfElement {
 public:
  // No length of a robot and no mass comes near; keeps squares finite.
  static constexpr double kMaxMagnitude = 1e9;

  // `title` is how messages call it, and its children after it: `joint
  // "elbow"`; may be empty. `xml` and `findings` outlive the element.
  UrdfElement(const tinyxml2::XMLElement& xml, std::string title,
              UrdfFindings& findings)
      : xml_(&xml), title_(std::move(title)), findings_(&findings) {}

  int line() const { return xml_->GetLineNum(); }

  // The first child of that name. Warns where there are several.
  std::optional<UrdfElement> Child(const char* name) const;

  // Nothing where the attribute is missing.
  std::optional<absl::string_view> Text(const char* attribute) const;

  // Refuses an attribute that is missing or empty; the result is then empty.
  absl::string_view RequiredText(const char* attribute) const;

  // Each leaves its result as it is where the attribute is missing, and where
  // it refuses it. Numbers are finite decimal ones, whatever the locale.
  void ReadNumber(const char* attribute, double& number) const;
  void ReadVector(const char* attribute, Eigen::Vector3d& vector) const;
  // xyz, and rpy: turns about the fixed axes x, y, z in this order.
  void ReadTransform(RigidTransform& transform) const;

  // `line 42: <limit lower="abc"> of joint "elbow": <reason>`. Without an
  // attribute it is about the element as a whole.
  void Refuse(const char* attribute, absl::string_view reason) const;
  void Warn(absl::string_view text) const;

 private:
  std::string Described(const char* attribute) const;
  // False, and refused, unless `text` is a number.
  bool Parse(const char* attribute, absl::string_view text,
             double& number) const;

  const tinyxml2::XMLElement* xml_;
  // Of this element or of the one that it is a child of.
  std::string title_;
  bool is_child_ = false;
  UrdfFindings* findings_;
};

}  // namespace gelenk

#endif  // GELENK_IMPORT_URDF_ELEMENT_H_

// When a foot stands: contacts of heel, ball and tip, from height and speed.
//
// A point is in contact when it is low and slow, with hysteresis. Its speed is
// that over a fixed time, not over one frame, so that the frame rate does not
// matter. Where both heel and ball are in contact but the foot turns about one
// of them, the other one is turning, not planted.
//
// The floor is known (a Ground) or is estimated: a plane at the height where
// slow points are, and per point a bias from it, because virtual soles are
// rarely flat. A running minimum would be 1 to 3 cm too low.
//
// A noisy stream has speeds of its own: thresholds rise above them
// (PointNoise).
//
// Online: no look-ahead, no added latency. Offline: contact_labels.h.
#ifndef GELENK_CONTACT_CONTACT_DETECTOR_H_
#define GELENK_CONTACT_CONTACT_DETECTOR_H_

#include <array>
#include <memory>

#include "gelenk/contact/foot_points.h"
#include "gelenk/contact/ground.h"
#include "gelenk/contact/point_noise.h"
#include "gelenk/math/state_numbers.h"

namespace gelenk {

enum class Contact : unsigned char { kNone, kPlanted, kTurning };

using FootContacts = PerFootPoint<Contact>;

// For a leg of kReferenceLegM; m and m/s.
struct ContactThresholds {
  double max_height_on = 0.03;
  double max_height_off = 0.05;
  double max_speed_on = 0.25;
  double max_speed_off = 0.35;
  // Speeds are means over this time.
  double speed_window_s = 0.033;
  // The foot turns about a point when the other goes round it at this speed,
  // and the point itself moves at most at this part of it.
  double min_turning_speed_on = 0.12;
  double min_turning_speed_off = 0.06;
  double max_still_part = 0.4;
};

// How the feet of a body relate to their ground.
struct FeetGeometry {
  PlantedHeights planted_heights = {};
  double leg_length_m = kReferenceLegM;
};

// Hysteresis of the three points of one foot.
class FootContactState {
 public:
  // `heights` above the floor in planted position and `velocities` of heel,
  // ball and tip, for a leg of kReferenceLegM.
  void Update(const ContactThresholds& thresholds,
              const std::array<double, kFootPointCount>& heights,
              const std::array<Eigen::Vector3d, kFootPointCount>& velocities,
              const Eigen::Vector3d& ball_from_heel);

  const std::array<Contact, kFootPointCount>& contacts() const {
    return contacts_;
  }

  void Exchange(StateNumbers& state) {
    for (Contact& contact : contacts_) state.Choice(contact, Contact::kTurning);
  }

 private:
  void FindTurning(
      const ContactThresholds& thresholds,
      const std::array<Eigen::Vector3d, kFootPointCount>& velocities,
      const Eigen::Vector3d& ball_from_heel);

  std::array<Contact, kFootPointCount> contacts_ = {};
};

class ContactDetector {
 public:
  // Without `ground` the floor is estimated. `ground` is in the source's
  // canonical coordinates.
  explicit ContactDetector(const FeetGeometry& feet,
                           std::shared_ptr<const Ground> ground = nullptr,
                           const ContactThresholds& thresholds = {});

  // The frame `dt_s` > 0 after the one before; of the first frame only
  // heights are known. Allocates nothing.
  const FootContacts& Update(const FootPoints& points, double dt_s);

  const FootContacts& contacts() const { return contacts_; }
  // Where the floor is under `point`, as far as is known.
  double FloorAt(const Eigen::Vector3d& point) const;
  void Reset();

  // All that later frames depend on: of the frames so far those that speeds are
  // measured from.
  void Exchange(StateNumbers& state);

 private:
  // Frames of the speed's window; more than that at a kilohertz are thinned
  // out.
  static constexpr int kHistory = 48;

  struct Moment {
    double time_s;
    FootPoints points;
  };

  // Place in `history_` of the latest frame that is a window old, or of the
  // oldest.
  int WindowStart() const;
  // How many of the latest frames there are up to WindowStart, which later
  // frames never look behind.
  int LiveCount() const;
  void Remember(const FootPoints& points);
  // Thresholds of speeds that are means over `window_s`, above the noise.
  ContactThresholds ThresholdsInNoise(double window_s) const;
  // Of a point in planted position above the estimated or known floor.
  double HeightOf(const FootPoints& points, int side, int point) const;
  void StartFloor(const FootPoints& points);
  void FollowFloor(const FootPoints& points, const PerFootPoint<double>& speeds,
                   double dt_s);

  FeetGeometry feet_;
  std::shared_ptr<const Ground> ground_;
  ContactThresholds thresholds_;
  double size_;
  std::array<Moment, kHistory> history_;
  int history_count_ = 0;
  int history_next_ = 0;
  double time_s_ = 0;
  double floor_m_ = 0;
  PerFootPoint<double> bias_m_ = {};
  PointNoise noise_;
  std::array<FootContactState, 2> states_;
  FootContacts contacts_ = {};
};

}  // namespace gelenk

#endif  // GELENK_CONTACT_CONTACT_DETECTOR_H_

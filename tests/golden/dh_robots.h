// Written by make_dh_robots.py, which says how.
#ifndef GELENK_TESTS_GOLDEN_DH_ROBOTS_H_
#define GELENK_TESTS_GOLDEN_DH_ROBOTS_H_

// clang-format off
namespace gelenk::golden {

inline constexpr double kPandaFlange = 0.107;
// a, alpha, d, theta
inline constexpr double kPandaRows[][4] = {
  {0.0, 0.0, 0.333, 0.0},
  {0.0, -1.5707963267948966, 0.0, 0.0},
  {0.0, 1.5707963267948966, 0.316, 0.0},
  {0.0825, 1.5707963267948966, 0.0, 0.0},
  {-0.0825, -1.5707963267948966, 0.384, 0.0},
  {0.0, 1.5707963267948966, 0.0, 0.0},
  {0.088, 1.5707963267948966, 0.0, 0.0},
};
inline constexpr double kPandaPose[] = {0.3, -0.5, 0.2, -1.9, 0.4, 1.7, 0.6};
// Rows of the tip's 3 x 4 matrix.
inline constexpr double kPandaTip[12] = {0.9910243977345417, -0.08077574684734112, 0.10651723717851058, 0.32429789529706315, -0.11658947626454758, -0.9120884847704693, 0.39306677546374735, 0.2504656953135003, 0.06540288311112402, -0.4019575533192077, -0.9133195433200741, 0.7189173815703802};

// a, alpha, d, theta
inline constexpr double kUr5Rows[][4] = {
  {0.0, 1.5707963267948966, 0.089159, 0.0},
  {-0.425, 0.0, 0.0, 0.0},
  {-0.39225, 0.0, 0.0, 0.0},
  {0.0, 1.5707963267948966, 0.10915, 0.0},
  {0.0, -1.5707963267948966, 0.09465, 0.0},
  {0.0, 0.0, 0.0823, 0.0},
};
inline constexpr double kUr5Pose[] = {0.7, -1.1, 1.3, -0.4, 0.9, 0.2};
// Rows of the tip's 3 x 4 matrix.
inline constexpr double kUr5Tip[12] = {0.9814303301734257, -0.043904590135773885, -0.1867267896706048, -0.40090753769273907, -0.17710548451994707, 0.16649044931108645, -0.9700075142189093, -0.5472765938858385, 0.07367600945107781, 0.9850651335080347, 0.1556230329294556, 0.310038557039168};

}  // namespace gelenk::golden
// clang-format on

#endif  // GELENK_TESTS_GOLDEN_DH_ROBOTS_H_

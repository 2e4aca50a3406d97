#include "foucault/core/so3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "foucault/core/constants.h"

namespace foucault::so3 {
namespace {

using Real = long double;  // 64-bit mantissa: 2000 times finer than double
using Vector3l = Eigen::Matrix<Real, 3, 1>;
using Matrix3l = Eigen::Matrix<Real, 3, 3>;

constexpr double kEps = 2.3e-16;
/// Of central differences: its square is the error of the formula, eps / step that of rounding.
constexpr double kStep = 1e-5;

/// From far below any threshold, across each of them, to pi and beyond.
const std::vector<double> kAngles{
    0,        1e-300, 1e-160, 1e-30, 1e-12,  1e-8,       1e-5,       9.999e-5,   1e-4,
    1.001e-4, 1e-3,   1e-2,   0.1,   0.2999, 0.3,        0.31,       0.5,        0.99,
    1.0,      1.01,   2,      3,     3.14,   kPi - 1e-6, kPi - 1e-9, kPi - 1e-13};

Eigen::Vector3d random_direction(std::mt19937& rng) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
}

template <class Body>
void for_rotations(const std::vector<double>& angles, Body body) {
  std::mt19937 rng{42};
  for (const double angle : angles) {
    for (int i = 0; i < 20; ++i) {
      SCOPED_TRACE(angle);
      body(Eigen::Vector3d(angle * random_direction(rng)));
    }
  }
}

Matrix3l skew_l(const Vector3l& v) {
  Matrix3l m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Sum over k of (-1)^k [r]^k / (k + shift)!; shift 0 with sign + is the rotation matrix.
Matrix3l power_series(const Eigen::Vector3d& rotation, int shift, int sign) {
  const Matrix3l r = sign * skew_l(rotation.cast<Real>());
  Matrix3l term = Matrix3l::Identity();
  Matrix3l sum = term;
  for (int k = 1; k < 60; ++k) {
    term = term * r / static_cast<Real>(k + shift);
    sum += term;
  }
  return sum;
}

Matrix3l rotation_series(const Eigen::Vector3d& r) { return power_series(r, 0, 1); }
Matrix3l right_jacobian_series(const Eigen::Vector3d& r) { return power_series(r, 1, -1); }

TEST(So3, SkewIsTheCrossProduct) {
  const Eigen::Vector3d a(1, -2, 3);
  const Eigen::Vector3d b(-0.5, 4, 2);
  EXPECT_EQ(skew(a) * b, a.cross(b));
}

TEST(So3, ExpAgreesWithTheMatrixSeries) {
  for_rotations(kAngles, [](const Eigen::Vector3d& r) {
    const Eigen::Quaterniond q = exp(r);
    EXPECT_NEAR(q.norm(), 1, 2 * kEps);
    const Matrix3l difference = q.toRotationMatrix().cast<Real>() - rotation_series(r);
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 8 * kEps);
  });
}

TEST(So3, ExpKeepsTinyAnglesToTheLastDigits) {
  for (const double angle : {1e-300, 1e-160, 1e-20, 1e-9, 1e-5}) {
    const Eigen::Quaterniond q = exp(Eigen::Vector3d(angle, 0, 0));
    const double expected = static_cast<double>(std::sin(static_cast<Real>(angle) / 2));
    EXPECT_NEAR(q.x() / expected, 1, 2 * kEps) << angle;
  }
}

TEST(So3, LogInvertsExp) {
  for_rotations(kAngles, [](const Eigen::Vector3d& r) {
    // Relative to the vector: nothing is lost at tiny angles. Squares of components below 1e-154
    // leave the range of double; the series serves them too.
    EXPECT_LE((log(exp(r)) - r).norm(), 6 * kEps * r.norm());
  });
}

TEST(So3, LogTakesTheShorterWayOfBothHemispheres) {
  for_rotations(kAngles, [](const Eigen::Vector3d& r) {
    const Eigen::Quaterniond q = exp(r);
    const Eigen::Quaterniond opposite(-q.w(), -q.x(), -q.y(), -q.z());
    EXPECT_EQ(log(opposite), log(q));
  });
  const Eigen::Vector3d beyond(0, 0, kPi + 0.1);
  EXPECT_NEAR(log(exp(beyond)).z(), -kPi + 0.1, 4 * kEps);
}

TEST(So3, LogAtExactlyPi) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 2) / 3;
  const Eigen::Quaterniond q(0, axis.x(), axis.y(), axis.z());
  EXPECT_LT((log(q) - kPi * axis).norm(), 4 * kEps);
}

TEST(So3, RightJacobianAgreesWithItsSeries) {
  for_rotations(kAngles, [](const Eigen::Vector3d& r) {
    const Matrix3l difference = right_jacobian(r).cast<Real>() - right_jacobian_series(r);
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 4 * kEps);
  });
}

TEST(So3, RightJacobianIsTheDerivativeOfExp) {
  for_rotations({0, 1e-8, 1e-3, 0.5, 1.5, 3, kPi - 1e-3}, [](const Eigen::Vector3d& r) {
    Eigen::Matrix3d numeric;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
      numeric.col(i) = log(exp(r - d).conjugate() * exp(r + d)) / (2 * kStep);
    }
    EXPECT_LT((numeric - right_jacobian(r)).cwiseAbs().maxCoeff(), 2e-10);
  });
}

TEST(So3, InverseRightJacobianInvertsItsSeries) {
  std::vector<double> angles = kAngles;
  angles.insert(angles.end(), {kPi, 4, 5, 6});
  for_rotations(angles, [](const Eigen::Vector3d& r) {
    const Matrix3l inverse = right_jacobian_inverse(r).cast<Real>();
    const Matrix3l difference = inverse * right_jacobian_series(r) - Matrix3l::Identity();
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 16 * kEps * inverse.cwiseAbs().maxCoeff());
  });
}

TEST(So3, InverseRightJacobianIsTheDerivativeOfLog) {
  for_rotations({0, 1e-8, 1e-3, 0.2, 1.5, 2.5}, [](const Eigen::Vector3d& r) {
    Eigen::Matrix3d numeric;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
      numeric.col(i) = (log(exp(r) * exp(d)) - log(exp(r) * exp(-d))) / (2 * kStep);
    }
    EXPECT_LT((numeric - right_jacobian_inverse(r)).cwiseAbs().maxCoeff(), 5e-10);
  });
}

TEST(So3, SeriesAndClosedFormsMeetAtTheThresholds) {
  const Eigen::Vector3d axis = Eigen::Vector3d(2, -1, 2) / 3;
  for (const double threshold : {1e-4, 0.3, 1.0}) {
    const Eigen::Vector3d below = threshold * (1 - 1e-15) * axis;
    const Eigen::Vector3d above = threshold * (1 + 1e-15) * axis;
    EXPECT_LT((right_jacobian(above) - right_jacobian(below)).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT((right_jacobian_inverse(above) - right_jacobian_inverse(below)).cwiseAbs().maxCoeff(),
              1e-15);
  }
}

TEST(So3, EulerOfPlainAttitudes) {
  const Euler north = to_euler(Eigen::Quaterniond::Identity());
  EXPECT_EQ(north.roll, 0);
  EXPECT_EQ(north.pitch, 0);
  EXPECT_EQ(north.heading, 0);

  const auto about = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
  };
  EXPECT_NEAR(to_euler(about(0.2, Eigen::Vector3d::UnitX())).roll, 0.2, 4 * kEps);
  EXPECT_NEAR(to_euler(about(0.3, Eigen::Vector3d::UnitY())).pitch, 0.3, 4 * kEps);
  // Turning right, about down, the heading grows; west is 270 degrees.
  EXPECT_NEAR(to_euler(about(-kPi / 2, Eigen::Vector3d::UnitZ())).heading, 1.5 * kPi, 8 * kEps);
}

TEST(So3, EulerRoundTripInItsRanges) {
  std::mt19937 rng{7};
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 10'000; ++i) {
    const Euler euler{kPi * unit(rng), 1.5 * unit(rng), kPi * (1 + unit(rng))};
    const Euler back = to_euler(from_euler(euler));
    // 1 / cos(pitch) reaches 14.
    EXPECT_NEAR(wrap(back.roll - euler.roll), 0, 100 * kEps);
    EXPECT_NEAR(back.pitch, euler.pitch, 100 * kEps);
    EXPECT_NEAR(wrap(back.heading - euler.heading), 0, 100 * kEps);
    EXPECT_GE(back.heading, 0);
    EXPECT_LT(back.heading, 2 * kPi);
  }
}

TEST(So3, EulerKeepsTheRotationAtVerticalPitch) {
  for (const double pitch : {kPi / 2, -kPi / 2, kPi / 2 - 1e-9, -kPi / 2 + 1e-12}) {
    const Eigen::Quaterniond q = from_euler({0.4, pitch, 1.3});
    const Eigen::Quaterniond back = from_euler(to_euler(q));
    EXPECT_LT(log(q.conjugate() * back).norm(), 1e-7) << pitch;
  }
}

TEST(So3, EulerHeadingOfATinyTurnLeftStaysBelowTwoPi) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(-1e-20, Eigen::Vector3d::UnitZ()));
  EXPECT_EQ(to_euler(q).heading, 0);
}

TEST(So3, EulerJacobianIsTheDerivative) {
  constexpr double h = 1e-6;
  std::mt19937 rng{3};
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const Euler euler{kPi * unit(rng), 1.3 * unit(rng), kPi * (1 + unit(rng))};
    const Eigen::Quaterniond q = from_euler(euler);
    Eigen::Matrix3d numeric;
    for (int k = 0; k < 3; ++k) {
      const Euler plus = to_euler(q * exp(h * Eigen::Vector3d::Unit(k)));
      const Euler minus = to_euler(q * exp(-h * Eigen::Vector3d::Unit(k)));
      numeric.col(k) = Eigen::Vector3d(wrap(plus.roll - minus.roll), plus.pitch - minus.pitch,
                                       wrap(plus.heading - minus.heading)) /
                       (2 * h);
    }
    EXPECT_LT((numeric - euler_jacobian(euler)).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(So3, Wrap) {
  EXPECT_EQ(wrap(kPi), kPi);
  EXPECT_EQ(wrap(-kPi), kPi);
  EXPECT_EQ(wrap(0.5), 0.5);
  EXPECT_NEAR(wrap(2 * kPi + 0.5), 0.5, 4 * kEps);
  EXPECT_NEAR(wrap(-3 * kPi / 2), kPi / 2, 4 * kEps);
  EXPECT_NEAR(wrap(100 * kPi + 1), 1, 400 * kEps);
}

}  // namespace
}  // namespace foucault::so3

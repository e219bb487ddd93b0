/// @file Running sums of points, from which a plane can be had at any time.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace ca2 {

/// Total least squares in single precision: points are summed relative to an
/// anchor close to them.
class PlaneSums {
 public:
  explicit PlaneSums(const Eigen::Vector3f& anchor) : anchor_(anchor) {}

  void add(const Eigen::Vector3f& point) {
    const Eigen::Vector3f p = point - anchor_;
    sum_ += p;
    square_ += p.cwiseAbs2();
    mixed_ += Eigen::Vector3f(p.x() * p.y(), p.y() * p.z(), p.z() * p.x());
    ++count_;
  }
  int count() const { return count_; }

  struct Fit {
    Eigen::Vector3f normal;  ///< unit, towards the origin
    float offset;            ///< m, >= 0
    float rms;               ///< m
    float thinness;          ///< middle over largest standard deviation in the plane: 0
                             ///< for a line
  };
  Fit fit() const {
    const float n = static_cast<float>(std::max(count_, 1));
    const Eigen::Vector3f mean = sum_ / n;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen;
    Eigen::Matrix3f moments;
    moments << square_.x(), mixed_.x(), mixed_.z(),  //
        mixed_.x(), square_.y(), mixed_.y(),         //
        mixed_.z(), mixed_.y(), square_.z();
    eigen.computeDirect(moments / n - mean * mean.transpose());
    Fit fit;
    fit.normal = eigen.eigenvectors().col(0);
    fit.offset = -fit.normal.dot(anchor_ + mean);
    if (fit.offset < 0) fit.normal = -fit.normal, fit.offset = -fit.offset;
    const Eigen::Vector3f values = eigen.eigenvalues().cwiseMax(0.0f);
    // The plane took three degrees of freedom.
    fit.rms = std::sqrt(values(0) * n / std::max(n - 3, 1.0f));
    fit.thinness = std::sqrt(values(1) / std::max(values(2), 1e-12f));
    return fit;
  }

 private:
  Eigen::Vector3f anchor_;
  Eigen::Vector3f sum_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f square_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f mixed_ = Eigen::Vector3f::Zero();  ///< xy, yz, zx
  int count_ = 0;
};

}  // namespace ca2

// Quaternions are normalised, and matrices projected to the nearest rotation by their quaternion.
#include "pose.h"

#include <cmath>

#include "kerf/error.h"

namespace kerf_python {
namespace {

constexpr const char* wanted =
    ": give a position (3 numbers), a pair of a position and a quaternion (w, x, y, z), or a rigid 4 x 4 matrix";

Eigen::Quaterniond quaternion_from(py::handle object, const std::string& name) {
  const auto values = numbers_from(object, name);
  if (values.size() != 4) throw geo::InputError(name + wanted);
  const Eigen::Quaterniond q(values[0], values[1], values[2], values[3]);
  const double norm = q.norm();
  if (!(norm > 1e-9) || !std::isfinite(norm)) throw geo::InputError(name + ": the quaternion has no direction");
  return std::abs(norm - 1) < 1e-12 ? q : q.normalized();
}

geo::Pose pose_of_matrix(const std::vector<double>& values, const std::string& name) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(values.data());
  const geo::Mat3 r = m.topLeftCorner<3, 3>();
  const bool last = m.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-9);
  if (!last || !(r * r.transpose()).isApprox(geo::Mat3::Identity(), 1e-6) || r.determinant() < 0)
    throw geo::InputError(name + ": the matrix is not rigid: a rotation, a translation, and 0 0 0 1 below");
  return {m.topRightCorner<3, 1>(), Eigen::Quaterniond(r).normalized()};
}

}  // namespace

geo::Pose pose_from(py::handle object, const std::string& name) {
  const bool pair = (py::isinstance<py::tuple>(object) || py::isinstance<py::list>(object)) && py::len(object) == 2;
  geo::Pose pose;
  if (pair) {
    const auto sequence = py::reinterpret_borrow<py::sequence>(object);
    pose = {point_from(py::object(sequence[0]), name), quaternion_from(py::object(sequence[1]), name)};
  } else {
    const auto [shape, values] = values_from(object, name, 1, 2);
    if (shape.size() == 1 && shape[0] == 3)
      pose.position = {values[0], values[1], values[2]};
    else if (shape.size() == 2 && shape[0] == 4 && shape[1] == 4)
      pose = pose_of_matrix(values, name);
    else
      throw geo::InputError(name + wanted);
  }
  if (!geo::in_range(pose.position)) throw geo::InputError(name + ": the position is above 1e60; correct it");
  return pose;
}

py::tuple pose_to(const geo::Pose& pose) {
  const auto& q = pose.rotation;
  return py::make_tuple(point(pose.position), moved<double>(std::vector<double>{q.w(), q.x(), q.y(), q.z()}));
}

}  // namespace kerf_python

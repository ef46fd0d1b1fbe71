// Three components with a name each. The samples carry no linear-algebra library; sim/ converts to
// Eigen at its edge.
#pragma once

namespace rigwire {

struct Vector3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  friend bool operator==(const Vector3&, const Vector3&) = default;
};

}  // namespace rigwire

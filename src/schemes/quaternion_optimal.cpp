// The scheme quaternion:optimal. It uses the frames that interpolate normals best, which answers the paper's open
// question (docs/theory.md, section 4.6).
//
// All pairs of frames are described by one angle phi (eq. 6), so the best pair is found by a search over one variable
// per face. If a face turns mildly, the search starts from the circle through the exact normal in the middle
// (kernels/optimal_arcs.h). Otherwise the search starts from a grid of phi and from the frames that other schemes
// construct, and refines the lowest points by golden section. The mean angular error of the result over t is within 0.2
// percent of the smallest that any quaternion slerp on the shorter arc can have.

#include <cmath>
#include <limits>
#include <vector>

#include "schemes/frames.h"
#include "schemes/kernels/optimal_arcs.h"
#include "schemes/makers.h"
#include "schemes/mean_error.h"
#include "schemes/minimize.h"

namespace chronormal::inline internal {
namespace {

struct OptimalQuaternion : UniformArc {
  void begin(const ElementBlock& block) {
    first_ = block.elements.first;
    phis_.resize(block.normals.size());
    find_optimal_arcs(block.normals, phis_);
  }

  void fit(ElementMotion& element, double* c) const {
    const CircleFamily circles(element.start().vector, element.end().vector);
    if (circles.kind == CircleFamily::Kind::kEqual) {
      put_arc(c, circles.great_arc());
      return;
    }
    const double known = phis_.empty() ? kUnknown : phis_[element.element() - first_];
    put_arc(c, circles.arc(std::isnan(known) ? best_phi(element, circles) : known));
  }

 private:
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  static double best_phi(const ElementMotion& element, const CircleFamily& circles) {
    const ExactSamples exact(element.control_normals());
    // If the ends are antipodal, every arc of the family is half a turn, so phi is searched from -pi to pi.
    const double limit = circles.kind == CircleFamily::Kind::kAntipodal ? kPi : kPi / 2;
    constexpr std::size_t kGrid = 21;
    std::array<double, kGrid + 4> points;
    std::size_t count = 0;
    for (; count < kGrid; ++count) points[count] = limit * (2.0 * static_cast<double>(count) / (kGrid - 1) - 1);

    // The middle point of the grid is phi = 0, which is slerp. The phi of the frames that are constructed from the
    // edges of a face, and the phi of the circle through the middle normal, are added to the grid.
    if (element.is_face()) {
      for (const auto& frames : {matrix_frames(element), edge_frames(element), polar_frames(element)}) {
        if (!frames) continue;
        const Arc arc = shorter_arc(*frames);
        if (arc.angle > 0) points[count++] = std::clamp(circles.phi_of(cross(arc.p, arc.q)), -limit, limit);
      }
    }
    const Vec3d middle = unit_normal_at(element.control_normals(), 0.5).vector;
    const Vec3d axis = cross(middle - circles.u0, circles.u1 - circles.u0);
    if (length(axis) > 0) points[count++] = std::clamp(circles.phi_of(axis), -limit, limit);

    std::sort(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count));
    return minimize(std::span(points).first(count), [&](double phi) { return exact.mean_error(circles.arc(phi)); });
  }

  std::size_t first_ = 0;
  std::vector<double> phis_;  // phi of each element of a block; NaN for elements that need the slower search
};

}  // namespace

std::unique_ptr<Scheme> make_quaternion_optimal() {
  return std::make_unique<CurveScheme<OptimalQuaternion>>(OptimalQuaternion{});
}

}  // namespace chronormal::inline internal

// Bounds how fast joints move and how much their paths bend.
//
// Over an interval of length h, a curve f with |f''| <= b has |f| at most h^2 b / 8 above the larger of its values at
// the ends, and f' differs from the slope of the chord by at most h b / 2. A rotation that turns by w(t) per second has
// a matrix R with |R'| = w and |R''| <= w^2 + |w'|. The product rule gives all other bounds: the bounds of a joint's
// own matrix follow from those of its scale, rotation and translation, and the bounds of matrices in the world follow
// from the roots down to the joints. The length of a matrix is the length of the longest image of a unit vector.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>

#include "core/portable_math.h"
#include "io/gltf/gltf_skin.h"

namespace chronormal::inline internal {
namespace {

// Bounds of the length of a curve's value, of its first derivative and of its second derivative.
struct Bound {
  double size = 0, speed = 0, bend = 0;
};

Bound product(const Bound& a, const Bound& b) {
  return {a.size * b.size, a.size * b.speed + a.speed * b.size,
          a.size * b.bend + 2 * a.speed * b.speed + a.bend * b.size};
}

template <std::size_t N>
double length_of(const std::array<double, N>& v) {
  double sum = 0;
  for (const double c : v) sum += c * c;
  return std::sqrt(sum);
}

template <std::size_t N>
double largest_of(const std::array<double, N>& v) {
  double largest = 0;
  for (const double c : v) largest = std::max(largest, std::fabs(c));
  return largest;
}

// The values of a curve at both ends of an interval, their difference, and bounds of the second derivatives of all
// components.
template <std::size_t N>
struct Interval {
  std::array<double, N> from{}, to{}, step{}, bend{};
  double duration = 0;

  Interval(const gltf::WeightCurve& curve, double start, double end) : duration(end - start) {
    curve.at(start, false, from);
    curve.at(end, true, to);
    for (std::size_t i = 0; i < N; ++i) step[i] = to[i] - from[i];
    curve.curvature(start, end, bend);
  }

  template <class Length>
  [[nodiscard]] Bound bound(const Length& length) const {
    const double b = length(bend);
    return {std::max(length(from), length(to)) + duration * duration * b / 8,
            length(step) / duration + duration * b / 2, b};
  }
};

// Returns the angle in radians between two rotations, by the shorter way.
double angle_between(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  std::array<double, 4> sum{}, difference{};
  const double from = 1 / length_of(a), to = 1 / length_of(b);
  for (std::size_t i = 0; i < 4; ++i) {
    sum[i] = from * a[i] + to * b[i];
    difference[i] = from * a[i] - to * b[i];
  }
  const double chord = length_of(difference), diagonal = length_of(sum);
  return 4 * portable::atan2(std::min(chord, diagonal), std::max(chord, diagonal));
}

// Bounds the rotation u = q / |q| by a cubic curve q of quaternions: |u'| <= |q'| / |q|, and |u''| along the sphere is
// at most |q''| / |q| + 2 |q'|^2 / |q|^2. The rotation turns by 2 |u'|.
Bound rotation_bound(const Interval<4>& q) {
  const Bound all = q.bound(length_of<4>);
  std::array<double, 4> middle{};
  for (std::size_t i = 0; i < 4; ++i) middle[i] = q.from[i] + q.to[i];
  double from = 0, to = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    from += q.from[i] * middle[i];
    to += q.to[i] * middle[i];
  }
  const double shortest = std::min(from, to) / length_of(middle) - q.duration * q.duration * all.bend / 8;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (!(shortest > 0)) return {1, kNone, kNone};
  const double speed = all.speed / shortest, turn = 2 * speed;
  return {1, turn, turn * turn + 2 * (all.bend / shortest + 2 * speed * speed)};
}

// Returns a bound of the length of the linear part of a matrix. The bound is exact for a rotation with the same scale
// on all axes.
double length_of(const AffineTransform& matrix) {
  double largest = 0;
  for (const Vec3d& a : matrix.columns) {
    double sum = 0;
    for (const Vec3d& b : matrix.columns) sum += std::fabs(dot(a, b));
    largest = std::max(largest, sum);
  }
  return std::sqrt(largest);
}

}  // namespace

bool GltfSkin::jumps() const noexcept {
  return std::any_of(curves_.begin(), curves_.end(), [](const Curve& moving) { return moving.curve.jumps(); });
}

std::optional<std::size_t> GltfSkin::meeting_bone(std::size_t a, std::size_t b) const noexcept {
  // Parents come before their children, so the bone with the larger index is not above the other one.
  while (a != b) {
    std::size_t& later = a > b ? a : b;
    if (!bones_[later].parent) return std::nullopt;
    later = *bones_[later].parent;
  }
  return a;
}

std::vector<BoneBounds> GltfSkin::bounds(double from, double to) const {
  struct Parts {
    Bound translation, rotation{1, 0, 0}, scale;
  };
  std::vector<Parts> parts(bones_.size());
  for (std::size_t b = 0; b < bones_.size(); ++b) {
    if (const auto* const node = std::get_if<NodeTransform>(&bones_[b].placement)) {
      parts[b].translation.size = length(node->translation);
      parts[b].rotation.size = length_of(affine_transform({{}, node->rotation, {1, 1, 1}}));
      parts[b].scale.size = max_abs(node->scale);
    } else {
      const AffineTransform& matrix = std::get<AffineTransform>(bones_[b].placement);
      parts[b].translation.size = length(matrix.offset);
      parts[b].scale.size = length_of(matrix);
    }
  }
  using Path = gltf::NodeChannel::Path;
  for (const Curve& moving : curves_) {
    Parts& of_bone = parts[moving.bone];
    switch (moving.path) {
      case Path::kTranslation:
        of_bone.translation = Interval<3>(moving.curve, from, to).bound(length_of<3>);
        break;
      case Path::kScale:
        of_bone.scale = Interval<3>(moving.curve, from, to).bound(largest_of<3>);
        break;
      case Path::kRotation:
        if (moving.interpolation == GltfInterpolation::kCubicSpline) {
          of_bone.rotation = rotation_bound(Interval<4>(moving.curve, from, to));
        } else {
          const double turn =
              angle_between(rotation_at(moving, from, false), rotation_at(moving, to, true)) / (to - from);
          of_bone.rotation = {1, turn, turn * turn};
        }
        break;
    }
  }
  std::vector<BoneBounds> result;
  result.reserve(bones_.size());
  for (std::size_t b = 0; b < bones_.size(); ++b) {
    const BoneBounds above = bones_[b].parent ? result[*bones_[b].parent] : BoneBounds{};
    const Bound parent{above.size, above.speed, above.bend};
    const Bound linear = product(parent, product(parts[b].rotation, parts[b].scale));
    result.push_back(
        {linear.size, linear.speed, linear.bend, above.path_bend + product(parent, parts[b].translation).bend});
  }
  return result;
}

}  // namespace chronormal::inline internal

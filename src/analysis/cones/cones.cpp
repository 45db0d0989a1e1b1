#include "chronormal/analysis/cones.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "analysis/cones/interval_normals.h"
#include "analysis/cones/kernels/cones_of_three.h"
#include "core/portable_math.h"
#include "normals/control/local_time.h"

namespace chronormal {
namespace {

constexpr std::size_t kBlock = 256;  // number of elements in a block; their control normals take 18 KiB
constexpr std::size_t kRefinements = 10;
constexpr double kSineRounding = 0x1p-46;  // relative rounding error of the sine of a sum of angles

bool is_zero(const Vec3d& v) { return v == Vec3d{}; }

bool is_whole(double t0, double t1) { return t0 == 0 && t1 == 1; }

// Writes the cones of up to kBlock elements over the times [t0, t1]. If double cannot determine the direction of a
// control normal over this interval, calls settle(i), which returns the cone of element i.
template <class Settle>
void cones_of_block(std::span<const ControlNormals> normals, double t0, double t1, std::span<NormalCone> result,
                    const Settle& settle) noexcept {
  std::array<std::uint16_t, kBlock / kConesPerFlags> flags;
  const Restriction restriction = Restriction::to(t0, t1);
  if (is_whole(t0, t1)) {
    cones_of_three(normals.data(), normals.size(), kNormalShare, result.data(), flags.data());
  } else {
    cones_of_parts(normals.data(), normals.size(), restriction, result.data(), flags.data());
  }
  for (std::size_t b = 0; b * kConesPerFlags < normals.size(); ++b) {
    for (std::size_t bit = 0; flags[b] >> bit != 0; ++bit) {
      if ((flags[b] >> bit & 1) == 0) continue;
      const std::size_t i = b * kConesPerFlags + bit;
      const IntervalNormals part = is_whole(t0, t1) ? IntervalNormals{normals[i]} : part_of(normals[i], restriction);
      result[i] = part.is_known() ? cone_around(part) : settle(i);
    }
  }
}

// The direction, of all directions in a list of cones, that is farthest from a given unit axis. The direction is
// described by the sine and the cosine of its angle to this axis.
struct Farthest {
  double sine = 0, cosine = 2;
  Vec3d axis;  // the axis of the cone to which the direction belongs

  // Returns a number that decreases as the angle grows from 0 to 270 degrees. Angles are compared by this number, since
  // it needs no trigonometry.
  [[nodiscard]] double nearness() const noexcept { return sine >= 0 ? cosine : -2 - cosine; }
};

// Finds the direction in a list of cones that is farthest from an axis. across_of(v, along) is the length of the part
// of v that is perpendicular to the axis.
template <class AcrossOf>
Farthest farthest_of(std::span<const NormalCone> cones, const Vec3d& axis, const AcrossOf& across_of) noexcept {
  Farthest farthest;
  for (const NormalCone& cone : cones) {
    if (cone.is_empty()) continue;
    const double sine = double{cone.sine}, cosine = std::sqrt((1 - sine) * (1 + sine));
    const auto [v, along, across] = across_of(to_double(cone.axis), axis);
    const Farthest far{across * cosine + along * sine, along * cosine - across * sine, v};
    if (far.nearness() < farthest.nearness()) farthest = far;
  }
  return farthest;
}

struct Split {
  Vec3d v;
  double along = 0, across = 0;
};

// Splits a unit vector that is stored in float32 into its parts along and across an axis. The rounding of the vector is
// ignored, so the result is only accurate enough to search for an axis.
Split rough_split(const Vec3d& v, const Vec3d& axis) noexcept {
  const double along = dot(v, axis);
  return {v, along, std::sqrt(std::fmax(0, (1 - along) * (1 + along)))};
}

Split exact_split(const Vec3d& direction, const Vec3d& axis) noexcept {
  const Vec3d v = unit(direction);
  const double along = dot(v, axis);
  return {v, along, length(v - along * axis)};
}

}  // namespace

double half_angle(const NormalCone& cone) noexcept {
  return cone.is_whole_sphere() ? 180 / kDegreesPerRadian : portable::asin(double{cone.sine});
}

void normal_cones(std::span<const ControlNormals> normals, double t0, double t1,
                  std::span<NormalCone> result) noexcept {
  assert(result.size() == normals.size() && 0 <= t0 && t0 <= t1 && t1 <= 1);
  const double from = local_time(t0), to = local_time(t1);
  for (std::size_t first = 0; first < normals.size(); first += kBlock) {
    const auto block = normals.subspan(first, std::min(kBlock, normals.size() - first));
    cones_of_block(block, from, to, result.subspan(first, block.size()),
                   [&](std::size_t i) { return cone_around({block[i]}); });
  }
}

void face_normal_cones(const Segment& segment, IndexRange faces, double t0, double t1,
                       std::span<NormalCone> result) noexcept {
  assert(result.size() == faces.count && faces.end() <= segment.topology->face_count());
  assert(0 <= t0 && t0 <= t1 && t1 <= 1);
  const double from = local_time(t0), to = local_time(t1);
  std::array<ControlNormals, kBlock> memory;
  for (std::size_t first = 0; first < faces.count; first += kBlock) {
    const std::span<ControlNormals> normals(memory.data(), std::min(kBlock, faces.count - first));
    face_control_normals(segment, {faces.first + first, normals.size()}, normals);
    cones_of_block(normals, from, to, result.subspan(first, normals.size()), [&](std::size_t i) {
      const auto face = segment.topology->face(faces.first + first + i);
      return cone_around(exact_part_of(ExactCurve::of_polygon(segment, face), from, to));
    });
  }
}

NormalCone normal_cone_of_faces(const Segment& segment, std::span<const std::uint32_t> faces, double t0,
                                double t1) noexcept {
  assert(0 <= t0 && t0 <= t1 && t1 <= 1);
  return cone_around(exact_part_of(ExactCurve::of_faces(segment, faces), local_time(t0), local_time(t1)));
}

NormalCone enclosing_cone(std::span<const NormalCone> cones) noexcept {
  Vec3d sum;
  const NormalCone* only = nullptr;
  std::size_t count = 0;
  for (const NormalCone& cone : cones) {
    if (cone.is_whole_sphere()) return cone;
    if (cone.is_empty()) continue;
    sum = sum + to_double(cone.axis);
    only = &cone;
    ++count;
  }
  if (count == 0) return NormalCone::empty();
  if (count == 1) return *only;

  // The axis moves towards the farthest direction by ever smaller steps (Badoiu, Clarkson 2003). The best axis is kept.
  Vec3d axis = unit(sum), best = axis;
  double best_nearness = -3;
  for (std::size_t i = 0; i < kRefinements && !is_zero(axis); ++i) {
    const Farthest far = farthest_of(cones, axis, rough_split);
    if (far.nearness() > best_nearness) {
      best_nearness = far.nearness();
      best = axis;
    }
    const Vec3d away = unit(far.axis - dot(far.axis, axis) * axis), point = far.cosine * axis + far.sine * away;
    axis = unit(axis + (1 / static_cast<double>(i + 2)) * (point - axis));
  }

  // The axis of the result is rounded to float32. The sine must therefore be the sine of the cone around the rounded
  // axis.
  const Vec3f rounded = to_float(best);
  const Farthest far = farthest_of(cones, unit(to_double(rounded)), exact_split);
  const double sine = far.sine + kSineRounding;
  if (is_zero(best) || far.nearness() <= 0 || !(sine <= 1)) return NormalCone::whole_sphere();
  return {rounded, static_cast<float>(std::fmin(sine * (1 + 0x1p-23), 1.0))};
}

}  // namespace chronormal

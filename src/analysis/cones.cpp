#include "chronormal/analysis/cones.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "analysis/kernels/cones.h"
#include "analysis/part_normals.h"
#include "core/portable_math.h"
#include "normals/control/local_time.h"

namespace chronormal {
namespace {

constexpr std::size_t kBlock = 256;  // control normals of a block are 18 KiB
constexpr std::size_t kRefinements = 16;
constexpr double kRounding = 0x1p-46;  // of the sine of a sum of angles

bool is_zero(const Vec3d& v) { return v == Vec3d{}; }

bool is_whole(double t0, double t1) { return t0 == 0 && t1 == 1; }

// Writes the cones of up to kBlock elements. settle(i) gives that of an element of which double cannot say where a control
// normal of the part points.
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
      const PartNormals part = is_whole(t0, t1) ? PartNormals{normals[i]} : part_of(normals[i], restriction);
      result[i] = part.is_known() ? cone_around(part) : settle(i);
    }
  }
}

// A cone as its unit axis and its half-angle.
struct Cap {
  Vec3d axis;
  double sine = 0, cosine = 1;

  [[nodiscard]] static Cap of(const NormalCone& cone) noexcept {
    const double sine = double{cone.sine};
    return {unit(to_double(cone.axis)), sine, std::sqrt((1 - sine) * (1 + sine))};
  }
};

// The direction of a cone that is farthest from an axis: its angle, and the point of the sphere.
struct Farthest {
  double sine = 0, cosine = 1;
  Vec3d point;

  [[nodiscard]] static Farthest of(const Cap& cap, const Vec3d& axis) noexcept {
    const double along = dot(cap.axis, axis);
    const Vec3d off = cap.axis - along * axis;
    const double across = length(off);
    const Vec3d away = across > 0 ? (1 / across) * off : any_perpendicular(axis);
    Farthest far{across * cap.cosine + along * cap.sine, along * cap.cosine - across * cap.sine, {}};
    far.point = far.cosine * axis + far.sine * away;
    return far;
  }

  // Falls as the angle grows from 0 to 270 degrees.
  [[nodiscard]] double nearness() const noexcept { return sine >= 0 ? cosine : -2 - cosine; }
};

Farthest farthest_of(std::span<const NormalCone> cones, const Vec3d& axis) noexcept {
  Farthest farthest{0, 2, {}};
  for (const NormalCone& cone : cones) {
    if (cone.is_empty()) continue;
    const Farthest far = Farthest::of(Cap::of(cone), axis);
    if (far.nearness() < farthest.nearness()) farthest = far;
  }
  return farthest;
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
      return cone_around(exact_part_of(segment, segment.topology->face(faces.first + first + i), from, to));
    });
  }
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

  // Move towards the farthest direction by ever smaller steps (Badoiu, Clarkson 2003), and keep the best axis on the way.
  Vec3d axis = unit(sum), best = axis;
  double best_nearness = -3;
  for (std::size_t i = 0; i < kRefinements && !is_zero(axis); ++i) {
    const Farthest far = farthest_of(cones, axis);
    if (far.nearness() > best_nearness) {
      best_nearness = far.nearness();
      best = axis;
    }
    axis = unit(axis + (1 / static_cast<double>(i + 2)) * (far.point - axis));
  }

  // The cone must hold around the axis as it is rounded.
  const Vec3f rounded = to_float(best);
  const Farthest far = farthest_of(cones, unit(to_double(rounded)));
  const double sine = far.sine + kRounding;
  if (is_zero(best) || far.nearness() <= 0 || !(sine <= 1)) return NormalCone::whole_sphere();
  return {rounded, static_cast<float>(std::fmin(sine * (1 + 0x1p-23), 1.0))};
}

}  // namespace chronormal

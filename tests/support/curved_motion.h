/// Makes a motion whose vertices turn, swell and wander. Also computes the positions of its vertices on curves through
/// the keyframes by textbook formulas. This file shares no code with chronormal.
#ifndef CHRONORMAL_TESTS_SUPPORT_CURVED_MOTION_H_
#define CHRONORMAL_TESTS_SUPPORT_CURVED_MOTION_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/motion/motion.h"

namespace chronormal::test {

/// Makes a round body with bumps, which turns by `angle` radians between the times 0 and 1. By default, the body has
/// more faces than the library computes in one block.
[[nodiscard]] inline Motion curved_motion(const std::vector<double>& times, double angle, std::size_t around = 48,
                                          std::size_t up = 24) {
  constexpr double kPi = 3.14159265358979323846;
  Motion motion;
  std::vector<std::array<double, 3>> places;
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i <= up; ++i) {
    for (std::size_t j = 0; j < around; ++j) {
      const double u = kPi * (0.1 + 0.8 * static_cast<double>(i) / static_cast<double>(up)),
                   v = 2 * kPi * static_cast<double>(j) / static_cast<double>(around),
                   radius = 1 + 0.2 * std::cos(3 * v + u);
      places.push_back({radius * std::sin(u) * std::cos(v), std::cos(u), radius * std::sin(u) * std::sin(v)});
      if (i == up) continue;
      const std::size_t a = i * around + j, b = i * around + (j + 1) % around;
      for (const std::size_t corner : {a, b, a + around, b, b + around, a + around})
        corners.push_back(static_cast<std::uint32_t>(corner));
    }
  }
  motion.topology = Topology::triangles(places.size(), corners).value();
  for (const double time : times) {
    Motion::Keyframe& keyframe = motion.keyframes.emplace_back();
    keyframe.time = time;
    const double c = std::cos(angle * time), s = std::sin(angle * time);
    for (const auto& [x, y, z] : places) {
      const double swell = 1 + 0.3 * time * time * y;
      for (const double p : {swell * (c * x + s * z), y + 0.2 * std::sin(3 * time + x), swell * (c * z - s * x)})
        keyframe.positions.push_back(static_cast<float>(p));
    }
  }
  motion.connect_as_sequence();
  return motion;
}

/// Returns the positions (V, 3) of all vertices at local t on the cubic curve from keyframe s to keyframe s + 1. If
/// `given`, uses the velocities that the keyframes store. Otherwise, the velocity at a keyframe is the slope of the
/// parabola through this keyframe and its neighbours. At the first and the last keyframe, the velocity is the slope of
/// the cubic through the nearest four keyframes, or of the polynomial through all keyframes if there are fewer.
[[nodiscard]] inline std::vector<long double> on_curve(const Motion& motion, std::size_t s, long double t,
                                                       bool given = false) {
  const auto& keys = motion.keyframes;
  const auto velocity = [&](std::size_t k, std::size_t c) -> long double {
    if (given && !keys[k].velocities.empty()) return keys[k].velocities[c];
    const bool is_end = k == 0 || k + 1 == keys.size();
    const std::size_t used = std::min<std::size_t>(is_end ? 4 : 3, keys.size()), first = k == 0   ? 0
                                                                                         : is_end ? keys.size() - used
                                                                                                  : k - 1;
    // Differentiates the polynomial, in the form of Newton's divided differences, at the time of keyframe k.
    std::vector<long double> x, f;
    for (std::size_t i = 0; i < used; ++i) {
      x.push_back(keys[first + i].time);
      f.push_back(keys[first + i].positions[c]);
    }
    for (std::size_t level = 1; level < used; ++level)
      for (std::size_t i = used - 1; i >= level; --i) f[i] = (f[i] - f[i - 1]) / (x[i] - x[i - level]);
    const long double at = keys[k].time;
    long double value = f[used - 1], slope = 0;
    for (std::size_t i = used - 1; i-- > 0;) {
      slope = slope * (at - x[i]) + value;
      value = value * (at - x[i]) + f[i];
    }
    return slope;
  };
  std::vector<long double> result(keys[s].positions.size());
  const long double d = static_cast<long double>(keys[s + 1].time) - static_cast<long double>(keys[s].time), t2 = t * t,
                    t3 = t2 * t;
  for (std::size_t c = 0; c < result.size(); ++c)
    result[c] = (2 * t3 - 3 * t2 + 1) * static_cast<long double>(keys[s].positions[c]) +
                (3 * t2 - 2 * t3) * static_cast<long double>(keys[s + 1].positions[c]) +
                d * (t3 - 2 * t2 + t) * velocity(s, c) + d * (t3 - t2) * velocity(s + 1, c);
  return result;
}

/// Returns the normals of all faces at the given positions of the vertices or, if of_vertices, the area-weighted
/// normals of all vertices. The normals do not have unit length.
[[nodiscard]] inline std::vector<std::array<long double, 3>> normals_of(const Motion& motion,
                                                                        const std::vector<long double>& positions,
                                                                        bool of_vertices) {
  std::vector<std::array<long double, 3>> faces(motion.topology.face_count()), vertices(motion.topology.vertex_count());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto face = motion.topology.face(f);
    const auto edge = [&](std::size_t to, std::size_t c) {
      return positions[3 * std::size_t{face[to]} + c] - positions[3 * std::size_t{face[0]} + c];
    };
    for (std::size_t k = 2; k < face.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c)
        faces[f][c] +=
            edge(k - 1, (c + 1) % 3) * edge(k, (c + 2) % 3) - edge(k - 1, (c + 2) % 3) * edge(k, (c + 1) % 3);
    for (const std::uint32_t v : face)
      for (std::size_t c = 0; c < 3; ++c) vertices[v][c] += faces[f][c];
  }
  return of_vertices ? vertices : faces;
}

/// Returns the angle between two directions, in radians.
template <class A, class B>
[[nodiscard]] double angle_of(const A& a, const B& b) {
  long double cross = 0, dot = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t d = (c + 1) % 3;
    const long double n = static_cast<long double>(a[c]) * b[d] - static_cast<long double>(a[d]) * b[c];
    cross += n * n;
    dot += static_cast<long double>(a[c]) * b[c];
  }
  return static_cast<double>(std::atan2(std::sqrt(cross), dot));
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_CURVED_MOTION_H_

// Measures how fast the error of each scheme falls as keyframes get closer. Also measures how far the exact normals of
// straight paths are from the true normals if the motion between keyframes is curved. docs/theory.md shows the output
// and proves the orders.
//
// Two smooth motions are sampled at the ends of 1, 2, 4, 8 and 16 segments: the built-in column, in which each layer
// turns continuously, and a sheet through which waves of random direction and speed run. The first rows compare schemes
// with the exact normals of straight segments. The last four rows compare normals of straight segments and of curved
// paths with the normals of the motion itself. Fails if a measured order differs from the proven one, or if the error
// of order 2 in 16 segments differs from the prediction of eq. 55.

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/chronormal_io.h"

namespace {

using namespace chronormal;

constexpr double kPi = 3.14159265358979323846;
constexpr std::array<std::size_t, 5> kSegments = {1, 2, 4, 8, 16};

constexpr int kSamples = 21;

/// The average error in degrees that eq. 55 of docs/theory.md predicts for a scheme of order 2. The prediction follows
/// from the tangential acceleration of the exact normals: `all` takes the whole acceleration, `along` its part along
/// the path of the normal, and `across` its part across the path.
struct Leading {
  double all = 0, along = 0, across = 0;
};

struct Row {
  const char* name;
  double order;                        // order that docs/theory.md proves; 0 if only rounding errors remain
  double Leading::*leading = nullptr;  // the prediction of the error, if docs/theory.md has one
  double divisor = 1;
};

constexpr Row kSchemes[] = {{"quaternion:random:1", 1},
                            {"linear", 2, &Leading::all},
                            {"slerp", 2, &Leading::all},
                            {"linear:scaled", 2, &Leading::across},
                            {"decasteljau:4", 2, &Leading::all, 3},
                            {"quaternion:matrix", 2},
                            {"quaternion:edge", 2},
                            {"quaternion:polar", 2},
                            {"quaternion:optimal", 2, &Leading::along},
                            {"circle", 2, &Leading::along},
                            {"circle:timed", 3},
                            {"quadratic", 3},
                            {"cubic", 4},
                            {"polynomial", 0}};

using Errors = std::array<double, kSegments.size()>;  // average errors in degrees

/// A motion with known positions at every time from 0 to 1.
struct SmoothMotion {
  const char* name;
  Topology topology;
  std::function<std::vector<Vec3d>(double)> positions;

  [[nodiscard]] Motion sampled(std::size_t segments) const {
    Motion motion;
    motion.topology = topology;
    for (std::size_t k = 0; k <= segments; ++k) {
      const double time = static_cast<double>(k) / static_cast<double>(segments);
      Motion::Keyframe keyframe{{}, time, {}};
      for (const Vec3d& p : positions(time)) {
        for (const double c : {p.x, p.y, p.z}) keyframe.positions.push_back(static_cast<float>(c));
      }
      motion.keyframes.push_back(std::move(keyframe));
    }
    motion.connect_as_sequence();
    return motion;
  }
};

SmoothMotion turning_column() {
  const Motion twist = make_builtin_morph("twist").value();
  // Only every 19th face is measured, which changes the figures by less than a percent.
  std::vector<std::uint32_t> corners;
  for (std::size_t f = 0; f < twist.topology.face_count(); f += 19) {
    for (const std::uint32_t corner : twist.topology.face(f)) corners.push_back(corner);
  }
  return {"column", Topology::triangles(twist.topology.vertex_count(), corners).value(),
          [start = twist.keyframes[0].positions](double time) {
            std::vector<Vec3d> result;
            for (std::size_t i = 0; i < start.size(); i += 3) {
              const double x = start[i], y = start[i + 1], height = start[i + 2];
              const double angle = time * 2 * kPi / 3 * height / 3, c = std::cos(angle), s = std::sin(angle);
              result.push_back({c * x - s * y, s * x + c * y, height});
            }
            return result;
          }};
}

SmoothMotion random_waves() {
  constexpr std::uint32_t kSide = 21;
  constexpr int kWaves = 6;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t row = 0; row + 1 < kSide; ++row) {
    for (std::uint32_t v = row * kSide; v + 1 < (row + 1) * kSide; ++v)
      corners.insert(corners.end(), {v, v + 1, v + kSide + 1, v, v + kSide + 1, v + kSide});
  }
  struct Wave {
    Vec3d push;
    double along_x, along_y, in_time, phase;
  };
  std::mt19937_64 random(1);
  const auto uniform = [&random] { return std::ldexp(static_cast<double>(random() >> 11), -52) - 1; };  // [-1, 1)
  std::vector<Wave> waves(kWaves);
  for (Wave& w : waves) {
    for (double* c : {&w.push.x, &w.push.y, &w.push.z}) *c = 0.1 * uniform();
    w.along_x = 4 * uniform(), w.along_y = 4 * uniform(), w.in_time = 3 * uniform(), w.phase = kPi * uniform();
  }
  return {"waves", Topology::triangles(std::size_t{kSide} * kSide, corners).value(), [waves](double time) {
            std::vector<Vec3d> result;
            for (std::uint32_t v = 0; v < kSide * kSide; ++v) {
              const double x = v % kSide / 10.0 - 1, y = v / kSide / 10.0 - 1;
              Vec3d p{x, y, 0};
              for (const Wave& w : waves)
                p = p + std::sin(w.along_x * x + w.along_y * y + w.in_time * time + w.phase) * w.push;
              result.push_back(p);
            }
            return result;
          }};
}

Leading leading_terms(const Motion& sampled) {
  const std::size_t faces = sampled.topology.face_count();
  Leading sum;
  std::vector<ControlNormals> normals(faces);
  for (std::size_t s = 0; s < sampled.segments.size(); ++s) {
    face_control_normals(sampled.segment(s), {0, faces}, normals);
    for (const ControlNormals& c : normals) {
      // Eq. 54 needs n(t) and its derivatives at t = 1/2.
      const Vec3d n = 0.25 * (c.n0 + 2.0 * c.m + c.n1), d1 = c.n1 - c.n0, d2 = 2.0 * (c.n0 - 2.0 * c.m + c.n1);
      const double size = length(n);
      const Vec3d u = (1 / size) * n;
      const auto across_u = [&u](const Vec3d& v) { return v - dot(v, u) * u; };
      const Vec3d u1 = (1 / size) * across_u(d1);
      const Vec3d a = (1 / size) * across_u(d2) - (2 * dot(u, d1) / size) * u1;
      sum.all += length(a);
      sum.along += std::fabs(dot(a, u1)) / length(u1);
      sum.across += std::fabs(dot(a, cross(u, u1))) / length(u1);
    }
  }
  double mean = 0;  // average of t (1 - t) / 2 over the samples
  for (int i = 0; i < kSamples; ++i) mean += i * (kSamples - 1.0 - i) / (2 * kSamples * std::pow(kSamples - 1.0, 2));
  const double factor = mean * kDegreesPerRadian / static_cast<double>(faces * sampled.segments.size());
  return {factor * sum.all, factor * sum.along, factor * sum.across};
}

/// The errors against the normals of the motion itself: of the exact normals of straight segments, and of interpolated
/// end normals.
struct AgainstMotion {
  double exact = 0, linear = 0;  // average errors in degrees
};

AgainstMotion against_motion(const SmoothMotion& smooth, const Motion& sampled) {
  const std::size_t faces = sampled.topology.face_count(), segments = sampled.segments.size();
  AgainstMotion sum;
  std::vector<ControlNormals> normals(faces);
  for (std::size_t s = 0; s < segments; ++s) {
    face_control_normals(sampled.segment(s), {0, faces}, normals);
    for (int i = 0; i < kSamples; ++i) {
      const double t = i / (kSamples - 1.0);
      const std::vector<Vec3d> p = smooth.positions((static_cast<double>(s) + t) / static_cast<double>(segments));
      for (std::size_t f = 0; f < faces; ++f) {
        const auto corners = sampled.topology.face(f);
        const Vec3d truth = cross(p[corners[1]] - p[corners[0]], p[corners[2]] - p[corners[0]]);
        const Vec3d start = unit_normal_at(normals[f], 0).vector, end = unit_normal_at(normals[f], 1).vector;
        sum.exact += angle_between(unit_normal_at(normals[f], t).vector, truth);
        sum.linear += angle_between(lerp(start, end, t), truth);
      }
    }
  }
  const double degrees = kDegreesPerRadian / static_cast<double>(faces * segments * kSamples);
  return {sum.exact * degrees, sum.linear * degrees};
}

/// Returns the cubic of segment s on a curved path. Positions are in double, since rounding keyframes to float32 would
/// hide that the error has order 4.
CubicSegment curve_of(const SmoothMotion& smooth, std::size_t segments, std::size_t s, PathKind path) {
  std::vector<double> times;
  for (std::size_t k = 0; k <= segments; ++k) times.push_back(static_cast<double>(k) / static_cast<double>(segments));
  const auto velocities = [&](std::size_t key) {
    std::vector<Vec3d> result(smooth.topology.vertex_count());
    const auto add = [&](double share, double time) {
      const std::vector<Vec3d> p = smooth.positions(time);
      for (std::size_t v = 0; v < p.size(); ++v) result[v] = result[v] + share * p[v];
    };
    if (path == PathKind::kHermite) {
      // Approximates the derivative of the motion by five points.
      constexpr double kStep = 1e-3;
      for (const auto& [share, steps] : {std::pair{1.0, -2.0}, {-8.0, -1.0}, {8.0, 1.0}, {-1.0, 2.0}})
        add(share / (12 * kStep), times[key] + steps * kStep);
      return result;
    }
    const VelocityShares velocity = velocity_shares(times, key);
    for (std::size_t k = 0; k < velocity.share.size(); ++k) add(velocity.share[k], times[velocity.first + k]);
    return result;
  };
  CubicSegment curve{{}, times[s], times[s + 1]};
  curve.control = {smooth.positions(times[s]), velocities(s), velocities(s + 1), smooth.positions(times[s + 1])};
  const double third = (times[s + 1] - times[s]) / 3;
  for (std::size_t v = 0; v < curve.control[0].size(); ++v) {
    curve.control[1][v] = curve.control[0][v] + third * curve.control[1][v];
    curve.control[2][v] = curve.control[3][v] - third * curve.control[2][v];
  }
  return curve;
}

/// Returns the average angle, in degrees, between the exact normals of curved paths and the normals of the motion
/// itself.
double curve_against_motion(const SmoothMotion& smooth, std::size_t segments, PathKind path) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t s = 0; s < segments; ++s) {
    const CubicSegment curve = curve_of(smooth, segments, s, path);
    const auto normal = [](std::span<const std::uint32_t> face, const auto& at) {
      return cross(at(face[1]) - at(face[0]), at(face[2]) - at(face[0]));
    };
    for (int i = 0; i < kSamples; ++i) {
      const double t = i / (kSamples - 1.0);
      const std::vector<Vec3d> p = smooth.positions((static_cast<double>(s) + t) / static_cast<double>(segments));
      for (std::size_t f = 0; f < smooth.topology.face_count(); ++f, ++count) {
        const Vec3d shown = normal(smooth.topology.face(f), [&](std::uint32_t v) { return curve.position(v, t); });
        sum += angle_between(shown, normal(smooth.topology.face(f), [&](std::uint32_t v) { return p[v]; }));
      }
    }
  }
  return kDegreesPerRadian * sum / static_cast<double>(count);
}

double order_of(const Errors& errors) { return std::log2(errors[errors.size() - 2] / errors.back()); }

}  // namespace

int main() {
  CompareOptions options;
  for (const Row& row : kSchemes) options.schemes.emplace_back(row.name);
  bool holds = true;
  options.samples = kSamples;
  std::printf("mean degrees, segments         1         2         4         8        16  order   eq. 55\n");
  for (const SmoothMotion& smooth : {turning_column(), random_waves()}) {
    std::vector<Errors> errors(std::size(kSchemes));
    Errors exact{}, linear{}, catmull_rom{}, hermite{};
    for (std::size_t n = 0; n < kSegments.size(); ++n) {
      const Motion sampled = smooth.sampled(kSegments[n]);
      const Comparison comparison = compare(sampled, options).value();
      for (std::size_t i = 0; i < errors.size(); ++i) {
        const Quality& quality = comparison.schemes[i].quality;
        errors[i][n] = quality.sum / static_cast<double>(quality.count) * kDegreesPerRadian;
      }
      const AgainstMotion against = against_motion(smooth, sampled);
      exact[n] = against.exact, linear[n] = against.linear;
      catmull_rom[n] = curve_against_motion(smooth, kSegments[n], PathKind::kCatmullRom);
      hermite[n] = curve_against_motion(smooth, kSegments[n], PathKind::kHermite);
    }
    const Leading leading = leading_terms(smooth.sampled(kSegments.back()));
    const auto print = [&](const Row& row, const Errors& measured) {
      std::printf("%-6s %-19s", smooth.name, row.name);
      for (const double e : measured) std::printf("%#10.3g", e);
      if (row.order > 0) std::printf("%7.2f", order_of(measured));
      holds &= row.order == 0 ? measured.back() < 1e-5 : std::fabs(order_of(measured) - row.order) < 0.25;
      if (row.leading != nullptr) {
        const double expected = leading.*row.leading / row.divisor;
        std::printf("%#9.3g", expected);
        holds &= std::fabs(measured.back() - expected) < 0.01 * expected;
      }
      std::printf("\n");
    };
    for (std::size_t i = 0; i < errors.size(); ++i) print(kSchemes[i], errors[i]);
    std::printf("       against the motion itself\n");
    print({"linear", 2}, linear);
    print({"polynomial", 2}, exact);
    print({"catmull-rom", 3}, catmull_rom);
    print({"hermite", 4}, hermite);
  }
  return holds ? 0 : 1;
}

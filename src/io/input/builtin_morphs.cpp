#include "chronormal/io/input.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "chronormal/core/vec3.h"
#include "core/portable_math.h"

namespace chronormal {
namespace {

constexpr double kPi = 3.14159265358979323846;

constexpr std::array kMorphs = {
    BuiltinMorph{"cloth", "a sheet with a wave running through it, 4 segments, 35,112 faces"},
    BuiltinMorph{"bend", "a tube bent by a quarter turn, 44,700 faces"},
    BuiltinMorph{"twist", "a square column twisted by 120 degrees, 15,200 faces"},
    BuiltinMorph{"eversion", "a sphere that collapses and turns inside out, 21,000 faces"},
    BuiltinMorph{"soup", "separate triangles that move between random positions, 5,000 faces"},
};

constexpr std::array kBlendShapes = {
    BuiltinMorph{"bumps", "a head with 12 blend shapes (morph targets) that overlap on its front, 6,144 faces"},
};

// A grid of (columns + 1) x (rows + 1) points, in which each cell consists of two triangles. If `closed` is true, the
// last column is joined to the first.
struct Grid {
  std::size_t columns, rows;
  bool closed;

  [[nodiscard]] std::size_t points_per_row() const { return closed ? columns : columns + 1; }
  [[nodiscard]] std::size_t vertex_count() const { return points_per_row() * (rows + 1); }

  [[nodiscard]] Topology topology() const {
    std::vector<std::uint32_t> corners;
    corners.reserve(6 * columns * rows);
    const auto vertex = [this](std::size_t column, std::size_t row) {
      return static_cast<std::uint32_t>(row * points_per_row() + column % points_per_row());
    };
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t column = 0; column < columns; ++column) {
        const std::uint32_t a = vertex(column, row), b = vertex(column + 1, row);
        const std::uint32_t c = vertex(column + 1, row + 1), d = vertex(column, row + 1);
        corners.insert(corners.end(), {a, b, c, a, c, d});
      }
    }
    return Topology::triangles(vertex_count(), std::move(corners)).value();
  }

  // Returns a keyframe at `time` with the positions point(u, v). u runs from 0 to 1 over the columns, and v over the
  // rows.
  template <class Point>
  [[nodiscard]] Motion::Keyframe keyframe(double time, Point point) const {
    Motion::Keyframe keyframe{{}, time, {}};
    keyframe.positions.reserve(3 * vertex_count());
    for (std::size_t row = 0; row <= rows; ++row) {
      for (std::size_t column = 0; column < points_per_row(); ++column) {
        const Vec3f p = to_float(point(static_cast<double>(column) / static_cast<double>(columns),
                                       static_cast<double>(row) / static_cast<double>(rows)));
        keyframe.positions.insert(keyframe.positions.end(), {p.x, p.y, p.z});
      }
    }
    return keyframe;
  }
};

Vec3d turned_about_z(const Vec3d& p, double angle) {
  const double c = portable::cos(angle), s = portable::sin(angle);
  return {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

Motion connected(Topology topology, std::vector<Motion::Keyframe> keyframes) {
  Motion motion{std::move(topology), std::move(keyframes), {}};
  motion.connect_as_sequence();
  return motion;
}

// Makes a cloth with a wave in which every point moves around an ellipse, and a weaker wave across it.
Motion cloth() {
  const Grid grid{133, 132, false};
  std::vector<Motion::Keyframe> keyframes;
  for (int k = 0; k <= 4; ++k) {
    const double phase = 0.4 * kPi * k;
    keyframes.push_back(grid.keyframe(k, [phase](double u, double v) {
      const double along = 3 * kPi * u - phase, across = 5 * v + phase;
      return Vec3d{u - 0.5 - 0.05 * portable::sin(along), v - 0.5 + 0.03 * portable::cos(across) * u,
                   0.08 * (0.4 + v) * portable::cos(along) + 0.03 * portable::sin(across) * u};
    }));
  }
  return connected(grid.topology(), std::move(keyframes));
}

// Makes a tube along y that bends. The middle line of the tube keeps its length.
Motion bend() {
  const Grid grid{149, 150, true};
  const auto tube = [&grid](double time, double bend_angle) {
    return grid.keyframe(time, [bend_angle](double u, double v) {
      constexpr double kLength = 4, kRadius = 0.5;
      const double around = -2 * kPi * u;
      const double x = kRadius * portable::cos(around), z = kRadius * portable::sin(around), y = kLength * v;
      if (bend_angle == 0) return Vec3d{x, y, z};
      const double middle = kLength / bend_angle, angle = bend_angle * v;
      return Vec3d{middle - (middle - x) * portable::cos(angle), (middle - x) * portable::sin(angle), z};
    });
  };
  return connected(grid.topology(), {tube(0, 0), tube(1, kPi / 2)});
}

// Makes a column that twists. Its square cross-section gives the column flat sides and sharp edges.
Motion twist() {
  const Grid grid{100, 76, true};
  const auto column = [&grid](double time, double twist_angle) {
    return grid.keyframe(time, [twist_angle](double u, double v) {
      const double side = 4 * u, along = 2 * (side - std::floor(side)) - 1;
      const Vec3d on_side = {1, along, 3 * v};
      return turned_about_z(on_side, kPi / 2 * std::floor(side) + twist_angle * v);
    });
  };
  return connected(grid.topology(), {column(0, 0), column(1, 2 * kPi / 3)});
}

// Makes a sphere that turns inside out. Every point moves past the centre to the opposite side, and rotates on the way.
Motion eversion() {
  const Grid grid{100, 105, true};
  const auto sphere = [&grid](double time, double scale, double turn) {
    return grid.keyframe(time, [scale, turn](double u, double v) {
      const double around = 2 * kPi * u, down = kPi * (0.02 + 0.96 * v);
      const Vec3d p{portable::sin(down) * portable::cos(around), portable::sin(down) * portable::sin(around),
                    -portable::cos(down)};
      return scale * turned_about_z(p, turn * p.z);
    });
  };
  return connected(grid.topology(), {sphere(0, 1, 0), sphere(1, -0.8, 1.2)});
}

Motion soup() {
  constexpr std::size_t kFaces = 5000;
  std::mt19937_64 random(20110601);
  std::vector<std::uint32_t> corners(3 * kFaces);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
  // The standard distributions differ between libraries, so random numbers are made without them.
  const auto coordinate = [&random] {
    return static_cast<float>(std::ldexp(static_cast<double>(random() >> 40), -23) - 1);
  };
  std::vector<Motion::Keyframe> keyframes(2);
  for (Motion::Keyframe& keyframe : keyframes) {
    keyframe.positions.resize(9 * kFaces);
    for (float& value : keyframe.positions) value = coordinate();
  }
  keyframes[1].time = 1;
  return connected(Topology::triangles(3 * kFaces, std::move(corners)).value(), std::move(keyframes));
}

// Makes an egg with ripples, and targets that move parts of its front. Neighbouring targets overlap, as the targets of
// a human face do.
Motion bumps() {
  constexpr std::size_t kTargets = 12;
  const Grid grid{64, 48, true};
  const auto head = [&grid](std::size_t target) {
    return grid.keyframe(target == 0 ? 0 : 1, [target](double u, double v) {
      const double around = 2 * kPi * u, down = kPi * (0.03 + 0.94 * v);
      const Vec3d out{portable::sin(down) * portable::cos(around), portable::sin(down) * portable::sin(around),
                      portable::cos(down)};
      const double radius = 1 + 0.03 * portable::sin(5 * around) * portable::sin(6 * down);
      const Vec3d base = radius * Vec3d{out.x, 0.85 * out.y, 1.2 * out.z};
      if (target == 0) return base;
      // The front of the egg, which faces x, has four rows of three targets. Every second target pushes outwards, and
      // the others move vertices along the surface.
      const std::size_t row = (target - 1) / 3, column = (target - 1) % 3;
      const double centre_around = 0.45 * (static_cast<double>(column) - 1);
      const double centre_down = kPi / 2 + 0.35 * (static_cast<double>(row) - 1.5);
      const Vec3d centre{portable::sin(centre_down) * portable::cos(centre_around),
                         portable::sin(centre_down) * portable::sin(centre_around), portable::cos(centre_down)};
      const Vec3d off = out - centre;
      const double distance = std::sqrt(dot(off, off)) / (0.5 + 0.05 * static_cast<double>(column));
      if (distance >= 1) return base;
      const double size = 0.25 * (1 - distance * distance) * (1 - distance * distance);
      const Vec3d along = row % 2 == 0 ? Vec3d{0, 0, 1} : Vec3d{0, column == 0 ? -1.0 : 1.0, 0};
      return base + size * (target % 2 == 0 ? out : along);
    });
  };
  Motion motion{grid.topology(), {}, {}};
  for (std::size_t k = 0; k <= kTargets; ++k) {
    motion.keyframes.push_back(head(k));
    motion.keyframes.back().name = k == 0 ? "head" : std::string("bump_").append(std::to_string(k));
  }
  motion.connect_as_targets();
  return motion;
}

}  // namespace

std::span<const BuiltinMorph> builtin_blend_shapes() noexcept { return kBlendShapes; }

std::span<const BuiltinMorph> builtin_morphs() noexcept { return kMorphs; }

Result<Motion> make_builtin_morph(std::string_view name) {
  if (name == "cloth") return cloth();
  if (name == "bend") return bend();
  if (name == "twist") return twist();
  if (name == "eversion") return eversion();
  if (name == "soup") return soup();
  if (name == "bumps") return bumps();
  std::string message = "there is no built-in morph '" + std::string(name) + "'; choose one of";
  const char* separator = " ";
  const auto list = [&](std::span<const BuiltinMorph> morphs) {
    for (const BuiltinMorph& morph : morphs) {
      message += separator + std::string(morph.name);
      separator = ", ";
    }
  };
  list(kMorphs);
  list(kBlendShapes);
  return Error{ErrorCode::kUsage, "", std::move(message)};
}

}  // namespace chronormal

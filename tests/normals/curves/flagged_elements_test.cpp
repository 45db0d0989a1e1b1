// Tests flagged elements, for which float32 is not accurate enough. Mixes them with other elements in every pattern,
// and compares the results with those of the same elements prepared alone.

#include "normals/curves/flagged_elements.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "chronormal/normals/normal_curves.h"
#include "normals/control/exact_curve.h"
#include "normals/control/kernels/face_tiles.h"
#include "normals/control/polygon_normals.h"
#include "normals/curves/certificate.h"
#include "normals/curves/curve_builder.h"
#include "normals/groups/group_sum.h"
#include "normals/groups/kernels/group_tiles.h"
#include "tests/support/fixtures.h"

namespace chronormal::flagged_elements_test {
namespace {

enum class Kind { kSmooth, kInsideOut, kInsideOutNeedle };
using Pattern = std::function<Kind(std::size_t face, fixtures::Random& random)>;

// Makes faces that share no vertices. Depending on the pattern, a face turns inside out or hardly moves.
Motion patterned(std::size_t faces, const Pattern& kind_of) {
  Motion motion = fixtures::soup({.face_count = faces, .seed = 5, .motion = 0.02});
  fixtures::Random random(20261126);
  std::vector<float>& from = motion.keyframes[0].positions;
  std::vector<float>& to = motion.keyframes[1].positions;
  for (std::size_t f = 0; f < faces; ++f) {
    const Kind kind = kind_of(f, random);
    if (kind == Kind::kSmooth) continue;
    // Puts one corner on the line through the two others, except for rounding, so the normal is hardly more than
    // rounding error.
    for (std::size_t i = 9 * f; kind == Kind::kInsideOutNeedle && i < 9 * f + 3; ++i)
      from[i + 6] = 0.7F * from[i] + 0.3F * from[i + 3];
    for (std::size_t i = 9 * f; i < 9 * f + 9; ++i) to[i] = -1.02F * from[i] + 0.03F * (to[i] - from[i]);
  }
  return motion;
}

struct Elements {
  std::size_t count = 0;
  std::function<BoundedNormals(std::size_t)> alone, of_tile;  // return element i, computed alone or as a part of a tile
};

// Returns the control normals that were computed in double or, if these are hardly more than rounding error, the exact
// control normals.
BoundedNormals settled(const BoundedNormals& rounded, const std::function<ExactCurve()>& exact) {
  return rounded.largest_share() <= kLargestShare ? rounded : BoundedNormals{exact().rounded(), {}};
}

Elements faces_of(const Segment& segment) {
  const auto alone = [&segment](std::size_t i) {
    const PolygonNormals polygon = polygon_control_normals(segment, segment.topology->face(i));
    return settled({polygon.normals, polygon.errors},
                   [&] { return ExactCurve::of_polygon(segment, segment.topology->face(i)); });
  };
  const auto of_tile = [&segment](std::size_t i) {
    ControlTile rounded;
    BoundedTile tile;
    face_control_tiles(segment, {i, 1}, std::span(&rounded, 1), std::span(&tile, 1));
    return BoundedNormals{element_of(tile.normals, 0), {tile.errors[0][0], tile.errors[1][0], tile.errors[2][0]}};
  };
  return {segment.topology->face_count(), alone, of_tile};
}

Elements elements_of(const Segment& segment, const NormalGroups& groups) {
  const auto alone = [&](std::size_t i) {
    return settled(control_normals_of_group(SharedFaces(segment), groups, i),
                   [&] { return ExactCurve::of_faces(segment, groups.faces(i)); });
  };
  const auto of_tile = [&](std::size_t i) {
    const std::size_t first = i / kTile * kTile, lane = i % kTile;
    ControlTile rounded;
    BoundedTile tile;
    GroupTiles(segment, groups, false)
        .write({first, std::min(kTile, groups.size() - first)}, std::span(&rounded, 1), std::span(&tile, 1));
    return BoundedNormals{element_of(tile.normals, lane),
                          {tile.errors[0][lane], tile.errors[1][lane], tile.errors[2][lane]}};
  };
  return {groups.size(), alone, of_tile};
}

bool is_like(const FlaggedElements& flagged, std::size_t index, const BoundedNormals& c) {
  const FlaggedNormals expected = FlaggedNormals::scaled(c.normals, smallest_certain(c.largest_share()));
  const FlaggedTile& tile = flagged.tiles[index / kTile];
  for (std::size_t k = 0; k < 3; ++k)
    if (tile.limits[k][index % kTile] != expected.limits[k]) return false;
  return flagged.scaled_normals(index) == expected.normals && flagged.exponents[index] == expected.exponent;
}

// Checks which elements of the curves are flagged, and their control normals. Describes the first fault, or returns "".
std::string fault_of(const CurveData& curves, const Elements& elements, double tolerance) {
  const PrecisionLimits limits = PrecisionLimits::for_tolerance(tolerance);
  std::size_t next = 0;
  for (std::size_t i = 0; i < elements.count; ++i) {
    const BoundedNormals alone = elements.alone(i);
    const bool is_flagged = next < curves.flagged.size() && curves.flagged.numbers[next] == i;
    if (is_flagged != !precision_for(alone.normals, limits))
      return "element " + std::to_string(i) + (is_flagged ? " is flagged" : " is not flagged");
    if (!is_flagged) continue;
    if (!is_like(curves.flagged, next, alone) && !is_like(curves.flagged, next, elements.of_tile(i)))
      return "element " + std::to_string(i) + " is something else";
    ++next;
  }
  return next == curves.flagged.size() ? "" : "too many are flagged";
}

const std::vector<std::pair<const char*, Pattern>>& patterns() {
  constexpr Kind kSmooth = Kind::kSmooth, kInsideOut = Kind::kInsideOut, kNeedle = Kind::kInsideOutNeedle;
  using fixtures::Random;
  static const std::vector<std::pair<const char*, Pattern>> all = {
      {"all", [](std::size_t, Random&) { return kInsideOut; }},
      {"few", [](std::size_t, Random& random) { return random.below(20) == 0 ? kInsideOut : kSmooth; }},
      {"half", [](std::size_t, Random& random) { return random.below(2) == 0 ? kInsideOut : kSmooth; }},
      {"most", [](std::size_t, Random& random) { return random.below(20) == 0 ? kSmooth : kInsideOut; }},
      {"runs", [](std::size_t face, Random&) { return face / 90 % 3 == 1 ? kInsideOut : kSmooth; }},
      {"tiles", [](std::size_t face, Random&) { return face == 3 || face / 32 % 2 == 1 ? kInsideOut : kSmooth; }},
      {"needles", [](std::size_t, Random& random) { return random.below(4) == 0 ? kNeedle : kInsideOut; }},
      {"any", [](std::size_t, Random& random) {
         return std::array{kSmooth, kInsideOut, kNeedle}[random.below(3)];
       }}};
  return all;
}

TEST(FlaggedElements, are_what_each_is_alone_in_every_pattern) {
  for (const auto& [name, pattern] : patterns()) {
    for (const std::size_t faces : {16U, 37U, 1003U, 4000U}) {
      const Motion motion = patterned(faces, pattern);
      const Segment segment = motion.segment(0);
      // Every vertex has only one face, and is next to the other vertices of that face.
      const NormalGroups groups =
          NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
      for (const double tolerance : {kExactTolerance, kCompactTolerance}) {
        for (const Threads threads : {Threads::kOne, Threads::kAll}) {
          const CurveData of_faces = build_curves(segment, {.tolerance = tolerance}, threads, nullptr);
          ASSERT_EQ(fault_of(of_faces, faces_of(segment), tolerance), "") << name << ", " << faces << " faces";
          const CurveData of_vertices = build_curves(segment, groups, {.tolerance = tolerance}, threads, nullptr);
          ASSERT_EQ(fault_of(of_vertices, elements_of(segment, groups), tolerance), "")
              << name << ", vertices of " << faces << " faces";
        }
      }
    }
  }
}

TEST(FlaggedElements, are_appended_wherever_their_lanes_are) {
  fixtures::Random random(20261126);
  FlaggedElements of_one_by_one, of_neighbours;
  for (int round = 0; round < 2000; ++round) {
    FlaggedTile tile;
    std::vector<FlaggedNormals> all;
    for (std::size_t lane = 0; lane < kTile; ++lane) {
      const auto vector = [&random] {
        return Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      };
      all.push_back(FlaggedNormals::scaled({vector(), vector(), vector()}, random.uniform(0, 1)));
      tile.set(lane, all.back());
    }
    const std::size_t first = random.below(kTile),
                      count = random.below(3) == 0 ? kTile - first : 1 + random.below(kTile - first);
    std::vector<std::size_t> numbers;
    std::vector<std::int16_t> exponents;
    for (std::size_t i = 0; i < count; ++i) {
      numbers.push_back(of_one_by_one.size());
      exponents.push_back(all[first + i].exponent);
      of_one_by_one.add(numbers.back(), all[first + i]);
    }
    of_neighbours.append(numbers, tile, first, exponents);
  }
  FlaggedElements behind_others = of_neighbours;
  behind_others.append(of_one_by_one);
  ASSERT_EQ(of_neighbours.numbers, of_one_by_one.numbers);
  ASSERT_EQ(of_neighbours.exponents, of_one_by_one.exponents);
  ASSERT_EQ(behind_others.size(), 2 * of_neighbours.size());
  for (std::size_t i = 0; i < behind_others.size(); ++i) {
    const std::size_t like = i % of_one_by_one.size();
    ASSERT_EQ(behind_others.scaled_normals(i), of_one_by_one.scaled_normals(like)) << i;
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(behind_others.tiles[i / kTile].limits[k][i % kTile],
                of_one_by_one.tiles[like / kTile].limits[k][like % kTile])
          << i;
  }
}

}  // namespace
}  // namespace chronormal::flagged_elements_test

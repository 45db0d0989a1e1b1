// Compares the control normals that the kernel computes in tiles of 16 faces with the public function for single faces,
// which does not use SIMD lanes, and with sums of products in long double.

#include "normals/control/kernels/face_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "normals/control/exact_curve.h"
#include "simd/targets.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/float_tiles.h"
#include "tests/support/hard_motions.h"

namespace chronormal::face_tiles_test {
namespace {

using fixtures::Point;

// Returns the control normals of a single face. For fewer than four faces, face_control_normals() does not use the
// kernel, and therefore no SIMD lanes.
ControlNormals one_face(const Segment& segment, std::size_t f) {
  ControlNormals normals;
  face_control_normals(segment, {f, 1}, {&normals, 1});
  return normals;
}

std::vector<double> components(const ControlNormals& c) {
  return {c.n0.x, c.n0.y, c.n0.z, c.m.x, c.m.y, c.m.z, c.n1.x, c.n1.y, c.n1.z};
}

template <class T>
bool same_bits(T a, T b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

// Returns the largest sum of absolute products in any component of the four cross products of a triangle, as a measure
// of rounding errors.
long double largest_products(const Segment& segment, std::size_t f) {
  const auto face = segment.topology->face(f);
  const auto edge = [&](const VectorView<const float>& points, std::size_t corner) {
    const Vec3f a = points[face[0]], b = points[face[corner]];
    return std::vector<long double>{std::fabs((long double)(b.x) - a.x), std::fabs((long double)(b.y) - a.y),
                                    std::fabs((long double)(b.z) - a.z)};
  };
  long double largest = 0;
  for (const auto* e_of : {&segment.from, &segment.to}) {
    for (const auto* f_of : {&segment.from, &segment.to}) {
      const auto e = edge(*e_of, 1), g = edge(*f_of, 2);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        largest = std::max(largest, e[i] * g[j] + e[j] * g[i]);
      }
    }
  }
  return largest;
}

// Compares the tiles of a range of faces with the same faces computed one by one. Returns a description of the first
// difference, or "".
std::string difference(const Segment& segment, IndexRange faces) {
  std::vector<ControlTile> tiles((faces.count + kTile - 1) / kTile);
  face_control_tiles(segment, faces, tiles);
  for (std::size_t i = 0; i < tiles.size() * kTile; ++i) {
    const std::size_t f = faces.first + std::min(i, faces.count - 1);
    const ControlTile& tile = tiles[i / kTile];
    const std::size_t lane = i % kTile;
    const ControlNormals expected = one_face(segment, f);
    std::string place = "lane ";
    place += std::to_string(i) + ", face " + std::to_string(f) + " of " + target_name(current_target()) + ": ";
    const auto c = components(expected);
    for (std::size_t k = 0; k < 9; ++k) {
      if (!same_bits(tile.normals[k][lane], static_cast<float>(c[k])))
        return place + "component " + std::to_string(k) + " is " + std::to_string(tile.normals[k][lane]) + " and not " +
               std::to_string(c[k]);
    }
    if (tile.degree[lane] != degree(expected)) return place + "degree " + std::to_string(tile.degree[lane]);
    if (segment.topology->all_triangles() &&
        !(static_cast<long double>(tile.magnitude[lane]) >= largest_products(segment, f)))
      return place + "magnitude " + std::to_string(tile.magnitude[lane]);
  }
  return "";
}

std::string difference_on_all_targets(const Segment& segment, IndexRange faces) {
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    std::string found = difference(segment, faces);
    if (!found.empty()) return found;
  }
  return "";
}

std::string difference_on_all_targets(const Segment& segment) {
  return difference_on_all_targets(segment, {0, segment.topology->face_count()});
}

// Positions in a chosen layout, in memory that ends exactly after the last coordinate.
class Laid {
 public:
  enum class Layout { kPacked, kPlanes, kStrideFour, kStrideSeven };

  Laid(const VectorView<const float>& points, Layout layout) : count_(points.count), layout_(layout) {
    const std::size_t stride = stride_of(layout);
    const std::size_t size = layout == Layout::kPlanes ? 3 * count_ : stride * (count_ - 1) + 3;
    memory_ = std::make_unique<float[]>(size);
    for (std::size_t i = 0; i < count_; ++i) view_of(memory_.get()).set(i, points[i]);
  }

  VectorView<const float> view() const { return view_of(memory_.get()); }

 private:
  static std::size_t stride_of(Layout layout) {
    return layout == Layout::kPlanes ? 1 : layout == Layout::kPacked ? 3 : layout == Layout::kStrideFour ? 4 : 7;
  }
  VectorView<float> view_of(float* p) const {
    if (layout_ == Layout::kPlanes) return VectorView<float>::planes(p, p + count_, p + 2 * count_, count_);
    return {p, p + 1, p + 2, count_, stride_of(layout_)};
  }

  std::size_t count_;
  Layout layout_;
  std::unique_ptr<float[]> memory_;
};

constexpr Laid::Layout kLayouts[] = {Laid::Layout::kPacked, Laid::Layout::kPlanes, Laid::Layout::kStrideFour,
                                     Laid::Layout::kStrideSeven};

// Makes motions of the same faces in which n(t) has the degree 2, 0 or 1.
std::vector<Motion> motions_of_every_degree() {
  const Motion start = fixtures::smooth_morph(5);
  const auto moved = [&start](auto change) {
    Motion motion = start;
    auto& to = motion.keyframes[1].positions;
    const auto& from = motion.keyframes[0].positions;
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = change(from[i], i);
    return motion;
  };
  std::vector<Motion> motions = {start};
  motions.push_back(moved([](float v, std::size_t) { return v; }));
  // Positions are rounded to float32, so n(t) of the next three motions has the degree 0 or 1 only approximately.
  motions.push_back(moved([](float v, std::size_t) { return v + 2; }));
  motions.push_back(moved([](float v, std::size_t i) { return i % 3 == 0 ? 3 * v : v; }));  // stretches x
  motions.push_back(moved([](float v, std::size_t i) { return i == 21 ? v + 1 : v; }));     // moves one vertex
  // In the last motion, positions change by about the tolerance within which n(t) counts as constant.
  motions.push_back(moved([](float v, std::size_t i) { return v + (i % 5 == 0 ? 1e-6F : 0); }));
  return motions;
}

TEST(FaceTiles, have_the_bits_of_single_faces_for_every_count_and_offset) {
  const Motion motion = fixtures::shaken(fixtures::icosphere(2), 0.3, 5);
  const Segment segment = motion.segment(0);
  for (std::size_t count = 1; count <= 40; ++count) {
    for (const std::size_t first : std::initializer_list<std::size_t>{0, 1, 5, 15, 16, 37, 280})
      ASSERT_EQ(difference_on_all_targets(segment, {first, std::min<std::size_t>(count, 320 - first)}), "");
  }
}

TEST(FaceTiles, read_any_layout_of_positions_and_no_byte_beyond_the_last) {
  const Motion motion = fixtures::moderate_soup(37);  // the last corner refers to the last vertex
  const Segment packed = motion.segment(0);
  for (const auto from : kLayouts) {
    for (const auto to : kLayouts) {
      const Laid laid_from(packed.from, from), laid_to(packed.to, to);
      Segment segment = packed;
      segment.from = laid_from.view();
      segment.to = laid_to.view();
      for (const std::size_t first : std::initializer_list<std::size_t>{0, 3, 21, 36})
        ASSERT_EQ(difference_on_all_targets(segment, {first, 37 - first}), "");
    }
  }
}

TEST(FaceTiles, have_the_degree_of_single_faces) {
  for (const Motion& motion : motions_of_every_degree()) ASSERT_EQ(difference_on_all_targets(motion.segment(0)), "");
}

TEST(FaceTiles, agree_where_faces_are_thin_far_from_the_origin_tiny_or_huge) {
  for (const Motion& motion :
       {fixtures::large_soup(200), fixtures::needle_soup(200), fixtures::far_soup(200), fixtures::tiny_soup(200),
        fixtures::huge_soup(200), fixtures::collapsing_soup(1e-9, 200), fixtures::inside_out_soup(200),
        fixtures::thinnest_soup(true, 200), fixtures::thinnest_soup(false, 200), fixtures::graded_soup(200)})
    ASSERT_EQ(difference_on_all_targets(motion.segment(0)), "");
}

constexpr fixtures::Shape kShapes[] = {fixtures::Shape::kTriangle, fixtures::Shape::kLine, fixtures::Shape::kPoint};

TEST(FaceTiles, have_no_noise_where_a_component_vanishes_and_no_negative_zero) {
  for (const auto start : kShapes) {
    for (const auto end : kShapes)
      ASSERT_EQ(difference_on_all_targets(fixtures::degenerate_soup(start, end).segment(0)), "");
  }
  // The faces of this test lie in planes that are parallel to axes or diagonals, where products are zero or cancel. The
  // planes have all orientations.
  for (std::size_t k = 0; k < 3; ++k) {
    for (const double slope : {0.0, 1.0, -1.0, 1.0 / 3}) {
      const Motion motion = test::with_positions(fixtures::moderate_soup(100), [k, slope](const Point& p) {
        Point q = p;
        q[k] = slope * p[(k + 1) % 3];
        return q;
      });
      ASSERT_EQ(difference_on_all_targets(motion.segment(0)), "");
    }
  }
}

TEST(FaceTiles, overflow_to_infinity_and_underflow_to_zero_as_rounding_does) {
  for (const double scale : {3e38, 1e25, 1e19, 1e-19, 1e-25, 1e-37, 1e-44}) {
    const Motion motion = test::with_positions(fixtures::large_soup(100), [scale](const Point& p) {
      return Point{scale * p[0], scale * p[1], scale * p[2]};
    });
    ASSERT_EQ(difference_on_all_targets(motion.segment(0)), "") << scale;
  }
  // In each face, one edge exceeds the range of float32, and the other edge is zero or tiny.
  const float huge = std::numeric_limits<float>::max(), tiny = std::numeric_limits<float>::denorm_min();
  Motion motion = fixtures::moderate_soup(16);
  for (auto& keyframe : motion.keyframes) {
    for (std::size_t f = 0; f < 16; ++f) {
      const float other = f % 2 == 0 ? 0 : tiny;
      const float corners[9] = {-huge, 0, 0, huge, huge, 1, -huge, other, 0};
      std::copy_n(corners, 9, keyframe.positions.data() + 9 * f);
    }
  }
  ASSERT_EQ(difference_on_all_targets(motion.segment(0)), "");
}

TEST(FaceTiles, have_a_magnitude_that_is_not_far_above_the_products) {
  const Motion motion = fixtures::large_soup(320);
  const Segment segment = motion.segment(0);
  std::vector<ControlTile> tiles(20);
  face_control_tiles(segment, {0, 320}, tiles);
  for (std::size_t f = 0; f < 320; ++f)
    ASSERT_LE(static_cast<long double>(tiles[f / kTile].magnitude[f % kTile]), 12 * largest_products(segment, f));
}

TEST(FaceTiles, bound_the_errors_of_triangles_in_double) {
  fixtures::Random random(20261125);
  std::size_t counted = 0, rounded = 0;
  for (int round = 0; round < 40; ++round) {
    for (const test::HardMotions& family : test::hard_motions()) {
      const Motion motion = family.make(random);
      const Segment segment = motion.segment(0);
      if (!segment.topology->all_triangles()) continue;
      const std::size_t faces = segment.topology->face_count();
      for (const auto target : supported_targets()) {
        const ScopedTarget scope(target);
        for (std::size_t f = 0; f < faces; f += kTile) {
          BoundedTile tile;
          const IndexRange range{f, std::min(kTile, faces - f)};
          ControlTile tiles_of;
          face_control_tiles(segment, range, std::span(&tiles_of, 1), std::span(&tile, 1));
          for (std::size_t lane = 0; lane < kTile; ++lane) {
            const std::size_t i = std::min(f + lane, faces - 1);
            const ControlNormals c = element_of(tile.normals, lane);
            const auto found = components(c), public_ones = components(one_face(segment, i));
            ASSERT_TRUE(std::equal(found.begin(), found.end(), public_ones.begin(), same_bits<double>));
            const BoundedNormals bounded{c, {tile.errors[0][lane], tile.errors[1][lane], tile.errors[2][lane]}};
            if (!(bounded.largest_share() <= 0x1p-30)) continue;
            ++counted;
            const auto exact = components(ExactCurve::of_polygon(segment, segment.topology->face(i)).rounded());
            for (std::size_t k = 0; k < 9; ++k) {
              const double off = std::fabs(found[k] - exact[k]);
              rounded += off > 0 ? 1U : 0U;
              ASSERT_LE(off, bounded.errors[k / 3]) << family.name << " " << target_name(target) << " " << i;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(counted, 5000U);
  EXPECT_GT(rounded, 5000U);
}

TEST(FaceTiles, take_polygons) {
  const Motion motion = fixtures::shaken(fixtures::box_grid(3), 0.3, 6);
  ASSERT_FALSE(motion.topology.all_triangles());
  const Segment segment = motion.segment(0);
  for (std::size_t count = 1; count <= 40; ++count) ASSERT_EQ(difference_on_all_targets(segment, {7, count}), "");
}

TEST(FaceTiles, agree_where_neighbours_are_far_apart_in_memory) {
  // The vertices are in random order in memory, so the kernel prefetches positions.
  fixtures::Random random(9);
  Motion motion = fixtures::moderate_soup(30000);
  std::vector<std::uint32_t> corners(3000);
  for (auto& c : corners) c = static_cast<std::uint32_t>(random.below(90000));
  motion.topology = fixtures::make_triangles(90000, corners);
  ASSERT_EQ(difference_on_all_targets(motion.segment(0)), "");
}

TEST(FaceControlNormals, have_the_bits_of_single_faces_on_every_target) {
  for (const Motion& motion : {fixtures::shaken(fixtures::icosphere(2), 0.3, 5), fixtures::needle_soup(200),
                               fixtures::degenerate_soup(fixtures::Shape::kLine, fixtures::Shape::kTriangle)}) {
    const Segment segment = motion.segment(0);
    for (const auto target : supported_targets()) {
      const ScopedTarget scope(target);
      for (std::size_t count = 1; count <= 40; ++count) {
        const std::size_t first = count % 7;
        std::vector<ControlNormals> found(count + 1, ControlNormals{{7, 7, 7}, {7, 7, 7}, {7, 7, 7}});
        face_control_normals(segment, {first, count}, std::span(found).first(count));
        for (std::size_t i = 0; i < count; ++i) {
          const auto a = components(found[i]), b = components(one_face(segment, first + i));
          ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), same_bits<double>)) << target_name(target) << " " << i;
        }
        ASSERT_EQ(found[count].n0.x, 7);
      }
    }
  }
}

// ---- tiles in float32 ----------------------------------------------------------------------------------------------

// Compares the float32 tiles of all triangles with the control normals of single faces, and adds the differences to
// `seen`. All instruction sets must give the same bits.
void look_at(test::FloatTileFaults& seen, const Motion& motion) {
  const Segment segment = motion.segment(0);
  const std::size_t count = segment.topology->face_count();
  std::vector<ControlTile> first;
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    std::vector<ControlTile> tiles((count + kTile - 1) / kTile);
    float_triangle_tiles(segment, {0, count}, tiles);
    if (first.empty()) first = tiles;
    if (std::memcmp(first.data(), tiles.data(), tiles.size() * sizeof(ControlTile)) != 0)
      seen.fault = std::string("other bits on ") + target_name(target);
  }
  for (std::size_t f = 0; f < count; ++f)
    seen.look_at(first[f / kTile], f % kTile, one_face(segment, f), static_cast<double>(largest_products(segment, f)),
                 1);
}

TEST(FloatFaceTiles, are_off_by_no_more_than_they_say) {
  test::FloatTileFaults seen;
  for (const std::size_t cells : {1U, 2U, 5U, 40U}) look_at(seen, fixtures::smooth_morph(cells));
  EXPECT_EQ(seen.bending, seen.elements);
  EXPECT_LT(seen.largest_bound, 2e-6);
  fixtures::Random random(20261125);
  for (int round = 0; round < 40; ++round) {
    const double flat = std::ldexp(1, -static_cast<int>(random.below(24))),
                 scale = std::ldexp(1, static_cast<int>(random.below(60)) - 30), away = random.below(2) == 0 ? 0 : 1000;
    look_at(seen, test::with_positions(fixtures::smooth_morph(12), [&](const Point& p) {
              return Point{scale * (p[0] + away), scale * (flat * p[1] - away), scale * flat * p[2]};
            }));
  }
  EXPECT_EQ(seen.fault, "");
  std::cout << "  largest error: " << seen.largest_share << " of its bound\n";
  EXPECT_GT(seen.largest_share, 0.05);
}

TEST(FloatFaceTiles, never_take_a_line_for_a_curve) {
  for (int kind = 0; kind < 4; ++kind) {
    test::FloatTileFaults seen;
    look_at(seen, test::of_low_degree(fixtures::smooth_morph(12), kind));
    EXPECT_EQ(seen.fault, "") << kind;
    EXPECT_EQ(seen.bending, 0U) << kind;
  }
}

TEST(FloatFaceTiles, are_off_by_no_more_than_they_say_where_a_line_stands_for_a_curve) {
  test::expect_lines_within_their_errors(
      fixtures::smooth_morph(20), [](test::FloatTileFaults& seen, const Motion& motion) { look_at(seen, motion); });
}

}  // namespace
}  // namespace chronormal::face_tiles_test

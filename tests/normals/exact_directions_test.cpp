// Compares every direction that is computed from positions with the exact direction, which the oracle computes in
// integers of any size. A case is one element at one t. The test has 100,000 cases from a fixed seed, or as many as the
// variable CHRONORMAL_FULL_CASES asks for (./test --full exact).

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "normals/recompute/recompute.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"
#include "tests/support/read_input.h"

namespace chronormal::exact_directions_test {
namespace {

using test::IntegerNormals;
using test::IntegerTime;
using test::IntegerVector;

constexpr double kPromised = 1e-6;  // in radians, the guaranteed largest error
constexpr std::uint64_t kSeed = 20170;

std::size_t wanted_cases() {
  const char* const full = std::getenv("CHRONORMAL_FULL_CASES");
  return full == nullptr ? 100000 : static_cast<std::size_t>(std::strtoull(full, nullptr, 10));
}

// Returns |n(t)| of a face, in long double.
long double size_at(const Segment& segment, std::size_t f, double t) {
  using Real = long double;
  const auto face = segment.topology->face(f);
  const auto edge = [&](std::size_t c) {
    const Vec3f a0 = segment.from[face[0]], a1 = segment.to[face[0]], b0 = segment.from[face[c]],
                b1 = segment.to[face[c]];
    const Real s = 1 - Real{t};
    return std::array<Real, 3>{s * (Real{b0.x} - a0.x) + t * (Real{b1.x} - a1.x),
                               s * (Real{b0.y} - a0.y) + t * (Real{b1.y} - a1.y),
                               s * (Real{b0.z} - a0.z) + t * (Real{b1.z} - a1.z)};
  };
  const auto e = edge(1), g = edge(2);
  return std::hypot(e[1] * g[2] - e[2] * g[1], e[2] * g[0] - e[0] * g[2], e[0] * g[1] - e[1] * g[0]);
}

// Returns the t at which |n(t)| is smallest, to the last bit.
double hardest_time(const Segment& segment, std::size_t f) {
  double best = 0;
  for (int i = 1; i <= 16; ++i) {
    if (size_at(segment, f, i / 16.0) < size_at(segment, f, best)) best = i / 16.0;
  }
  double low = std::max(0.0, best - 1 / 16.0), high = std::min(1.0, best + 1 / 16.0);
  for (int i = 0; i < 80; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (size_at(segment, f, a) < size_at(segment, f, b) ? high : low) =
        size_at(segment, f, a) < size_at(segment, f, b) ? b : a;
  }
  return size_at(segment, f, low) < size_at(segment, f, best) ? low : best;
}

// Draws times at which the direction of a normal is hard to compute: for one of the faces, or for most faces.
std::vector<double> some_times(const Segment& segment, fixtures::Random& random) {
  constexpr std::array<double, 16> kSimple{0,           1,           0.5,  0.25,    0.75,     0.125,
                                           1.0 / 3,     0.8,         1e-9, 0x1p-40, 0x1p-150, 0x1p-250,
                                           1 - 0x1p-53, 1 - 0x1p-30, 0.4,  1e-310};
  std::vector<double> times{kSimple[random.below(kSimple.size())], random.uniform(0, 1)};
  const double hardest = hardest_time(segment, random.below(segment.topology->face_count()));
  const auto near = [&random](double t) {
    const double step = std::ldexp(random.uniform(0.5, 1), -static_cast<int>(random.below(54)));
    return std::clamp(random.below(2) == 0 ? t + step : t - step, 0.0, 1.0);
  };
  times.push_back(hardest);
  times.push_back(near(hardest));
  times.push_back(near(std::round(8 * hardest) / 8));
  times.push_back(std::nextafter(hardest, random.below(2) == 0 ? 0 : 1));
  return times;
}

// The number of tested cases, the number of wrong results, and the largest error of all other results, in radians.
struct Tally {
  std::size_t cases = 0, violations = 0;
  double largest = 0;
  std::string first_violation;

  void add(const Vec3f& u, const IntegerVector& n, const IntegerVector& beside, double t, const std::string& what) {
    const bool is_none = test::is_zero(n) && test::is_zero(beside);
    const double angle = is_none ? 0 : test::angle_between(u, test::direction_of(test::is_zero(n) ? beside : n));
    const double length = std::sqrt(double{u.x} * u.x + double{u.y} * u.y + double{u.z} * u.z);
    const bool is_right = is_none ? length == 0 : angle <= kPromised && std::fabs(length - 1) <= kPromised;
    if (is_right) {
      largest = std::max(largest, angle);
    } else if (violations++ == 0) {
      first_violation = what + " at t = " + std::to_string(t) + ": off by " + std::to_string(angle) + " rad";
    }
  }
};

// Compares the normals of all elements, from curves and recomputed from positions, with exact directions, at several
// times t.
template <class ElementOf>
void judge(const NormalCurves& curves, NormalRecompute& recompute, const IntegerNormals& oracle,
           const std::vector<double>& times, const char* what, Tally& tally, const ElementOf& element_of) {
  const std::size_t count = curves.size();
  std::vector<float> by_curves(3 * count), anew(3 * count);
  const auto curve_view = VectorView<float>::packed(by_curves.data(), count),
             anew_view = VectorView<float>::packed(anew.data(), count);
  for (const double t : times) {
    const std::size_t zeros = curves.unit_normals(t, curve_view);
    EXPECT_EQ(recompute.unit_normals(t, anew_view), zeros);
    EXPECT_EQ(curves.uncertain_count(t), 0u);
    const IntegerTime time = IntegerTime::of(t < 0x1p-200 ? 0 : t);
    const std::vector<IntegerVector> normals = oracle.at(time);
    std::vector<IntegerVector> beside;
    for (std::size_t i = 0; i < count; ++i) {
      const IntegerVector n = element_of(normals, i);
      IntegerVector limit = n;
      if (test::is_zero(n)) {
        if (beside.empty()) beside = oracle.at(time.moved(time.t == 0 ? 1 : -1));
        limit = element_of(beside, i);
      }
      ++tally.cases;
      tally.add(curve_view[i], n, limit, t, std::string(what).append(" of curves"));
      tally.add(anew_view[i], n, limit, t, std::string(what).append(" made anew"));
    }
  }
}

TEST(ExactDirections, are_within_a_millionth_of_a_radian_in_every_family) {
  const std::size_t wanted = wanted_cases();
  const auto& families = test::hard_motions();
  std::size_t all = 0;
  for (std::size_t k = 0; k < families.size(); ++k) {
    fixtures::Random random(kSeed + k);
    Tally tally;
    while (tally.cases < wanted / families.size() + 1) {
      const Motion motion = families[k].make(random);
      const Segment segment = motion.segment(0);
      const IntegerNormals oracle(segment);
      const std::vector<double> times = some_times(segment, random);
      NormalRecompute faces(segment);
      judge(NormalCurves::of_faces(segment), faces, oracle, times, "a face", tally,
            [](const std::vector<IntegerVector>& normals, std::size_t f) { return normals[f]; });
      if (motion.topology.vertex_count() >= 3 * motion.topology.face_count()) continue;
      const NormalGroups groups =
          NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
      NormalRecompute vertices(segment, groups);
      judge(NormalCurves::of_groups(segment, groups), vertices, oracle, times, "a vertex", tally,
            [&groups](const std::vector<IntegerVector>& normals, std::size_t e) {
              return test::sum_of(normals, groups.faces(e));
            });
    }
    std::cout << "  " << families[k].name << ": " << tally.cases << " cases from seed " << kSeed + k << ", "
              << tally.violations << " violations, largest error of the others " << tally.largest << " rad\n";
    EXPECT_EQ(tally.violations, 0u) << families[k].name << ": " << tally.first_violation;
    all += tally.cases;
  }
  std::cout << "  " << all << " cases\n";
  EXPECT_GE(all, wanted);
}

// Compares the normals of all faces and vertices of a mesh with exact directions.
Tally judged(const Motion& motion, const std::vector<double>& times) {
  const Segment segment = motion.segment(0);
  const IntegerNormals oracle(segment);
  const NormalGroups groups =
      NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
  Tally tally;
  NormalRecompute faces(segment), vertices(segment, groups);
  judge(NormalCurves::of_faces(segment), faces, oracle, times, "a face", tally,
        [](const std::vector<IntegerVector>& normals, std::size_t f) { return normals[f]; });
  judge(NormalCurves::of_groups(segment, groups), vertices, oracle, times, "a vertex", tally,
        [&groups](const std::vector<IntegerVector>& normals, std::size_t e) {
          return test::sum_of(normals, groups.faces(e));
        });
  return tally;
}

// Tests small meshes for which an earlier version computed normals with errors of up to 180 degrees.
TEST(ExactDirections, are_right_where_an_attack_found_them_wrong) {
  struct Found {
    const char* name;
    std::vector<fixtures::Point> points;
    std::vector<std::uint32_t> corners;
  };
  const std::vector<Found> all{
      {"sizes of 1e9 and 1e-9",
       {{4.98534195e+09, 1.08089114e+09, 1.88841715e+09},
        {3.17071591e-09, 3.39089778e-09, -1.1170644e-08},
        {6.27459551e-09, 2.57805421e-09, 9.306238e-10}},
       {0, 1, 2}},
      {"sizes of 1e7 and 1e-2",
       {{24892986, -12788380, 2213886.75},
        {-11557858, -6513180, 28962818},
        {0.00630061328, -0.00385841983, -0.0183484964}},
       {0, 1, 2}},
      {"a sliver near the origin",
       {{6.60010241e-13, 3.92661815e-13, -3.48537198e-13},
        {-1.90513515, -0.342684895, 0.262716949},
        {-3.81027031, -0.68536979, 0.525433898}},
       {0, 1, 2}},
      {"another",
       {{1e-12, 2e-12, -1e-12},
        {0.3333333333333333, 0.7, 0.2},
        {0.6666666865348816, 1.399999976158142, 0.4000000059604645}},
       {0, 1, 2}},
      {"huge faces that cancel",
       {{0, 0, 0}, {10000, 10, 0}, {0, 10000, 30}, {0.0001, 0, 0}, {0, 0.0001, 0.0001}},
       {0, 1, 2, 0, 2, 1, 0, 3, 4}},
  };
  for (const auto& [name, points, corners] : all) {
    const Motion motion = fixtures::make_motion(fixtures::make_triangles(points.size(), corners), points, points);
    const Tally tally = judged(motion, {0, 0.3, 1});
    EXPECT_EQ(tally.violations, 0u) << name << ": " << tally.first_violation;
  }
}

TEST(ExactDirections, are_right_in_files_that_broke_them) {
  const char* const folder = std::getenv("CHRONORMAL_DATA");
  if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(folder) / "attack")) {
    if (entry.path().extension() != ".obj") continue;
    SCOPED_TRACE(entry.path().string());
    InputOptions options = test::files({entry.path().string()});
    options.allow_mesh = true;
    Result<Motion> read = test::read_motion(options);
    ASSERT_TRUE(read) << read.error().text();
    Motion motion = std::move(read).value();
    motion.segments = {{0, 0}};
    const Tally tally = judged(motion, {0, 0.5});
    EXPECT_EQ(tally.violations, 0u) << tally.first_violation;
    ++files;
  }
  EXPECT_GE(files, 8u);
}

// The curves of this test are made from control normals in double, without positions. Near a zero of n(t), the
// direction is therefore uncertain, and the result must count the element as uncertain.
TEST(UncertainDirections, are_counted_where_there_are_no_positions) {
  const Vec3d z{0, 0, 1};
  const ControlNormals turning{z, {}, -z}, steady{z, z, z};
  const std::vector<ControlNormals> normals{steady, turning, steady, turning, ControlNormals{}};
  const NormalCurves curves(normals);
  for (const double t : {0.0, 0.3, 0.49, 1.0}) EXPECT_EQ(curves.uncertain_count(t), 0u) << t;
  for (const double t : {0.5, 0.5 + 1e-12}) EXPECT_EQ(curves.uncertain_count(t), 2u) << t;
  EXPECT_EQ(curves.uncertain_count(std::nan("")), 0u);
}

TEST(UncertainDirections, are_less_than_one_in_a_million_of_ordinary_ones) {
  fixtures::Random random(21);
  std::size_t uncertain = 0, all = 0;
  for (const Motion& motion : {fixtures::smooth_morph(64), fixtures::moderate_soup(20000), fixtures::large_soup(20000),
                               fixtures::shaken(fixtures::icosphere(5), 0.02, 22), fixtures::needle_soup(20000)}) {
    const NormalCurves curves(all_face_control_normals(motion.segment(0)));
    for (int i = 0; i < 20; ++i) {
      uncertain += curves.uncertain_count(i == 0 ? 0.5 : random.uniform(0, 1));
      all += curves.size();
    }
  }
  EXPECT_GE(all, 1000000u);
  EXPECT_LE(uncertain, all / 1000000) << all;
}

}  // namespace
}  // namespace chronormal::exact_directions_test

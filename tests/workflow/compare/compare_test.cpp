#include "chronormal/workflow/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "chronormal/io/input.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"
#include "tests/support/reference.h"
#include "tests/support/reference_elements.h"
#include "workflow/compare/compared.h"

namespace chronormal::compare_test {
namespace {

using reference::Real;

const SchemeComparison& row(const Comparison& comparison, const std::string& scheme) {
  for (const SchemeComparison& r : comparison.schemes) {
    if (r.scheme == scheme) return r;
  }
  ADD_FAILURE() << "no row " << scheme;
  return comparison.schemes.front();
}

TEST(Compare, one_face_by_hand) {
  // The normal turns by 90 degrees from +z to +x. At t = 1/2, linear interpolation is compared with the exact cross
  // product.
  Motion motion;
  motion.topology = Topology::triangles(3, {0, 1, 2}).value();
  motion.keyframes = {{{0, 0, 0, 1, 0, 0, 0, 1, 0}, 0, ""}, {{0, 0, 0, 0, 1, 0, 0, 0, 1}, 1, ""}};
  motion.connect_as_sequence();
  CompareOptions options{{"linear", "polynomial"}, 3, Access::kRandom, {}};
  const auto comparison = compare(motion, options);
  ASSERT_TRUE(comparison.ok());
  // At t = 1/2, the vertices are (1,1,0)/2 and (0,1,1)/2, so n = (1, -1, 1) / 4. Linear interpolation gives the
  // direction (1, 0, 1).
  const double expected = std::acos(2 / std::sqrt(2.0) / std::sqrt(3.0));
  EXPECT_NEAR(row(comparison.value(), "linear").quality.sum, expected, 1e-7);
  EXPECT_EQ(row(comparison.value(), "linear").quality.count, 3u);
  EXPECT_EQ(row(comparison.value(), "linear").quality.max_at.t, 0.5);
  EXPECT_EQ(*row(comparison.value(), "linear").relative_to_linear, 1);
  EXPECT_LT(row(comparison.value(), "polynomial").quality.sum, 1e-6);
}

TEST(Compare, vertices_may_be_more_than_faces) {
  // The mesh has 4 vertices and 1 face, so three vertices have an index that no face has. No scheme may look up a face
  // by the index of a vertex.
  const Motion motion = fixtures::make_motion(fixtures::make_polygons(4, {0, 4}, {0, 1, 2, 3}),
                                              {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                              {{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0.5}});
  CompareOptions options;
  options.elements.kind = ElementKind::kVertices;
  for (const SchemeDescription& scheme : scheme_descriptions()) {
    const std::string name(scheme.name.substr(0, scheme.name.find_first_of("KS")));
    const std::string numbered = name.ends_with(':') ? name + "4" : name;
    options.schemes = {numbered};
    const auto compared = compare(motion, options);
    if (make_scheme(numbered).value()->needs_faces())
      EXPECT_EQ(compared.error().code, ErrorCode::kUsage) << numbered;
    else
      EXPECT_EQ(compared.value().schemes.front().quality.count, 4U * 21) << numbered;
  }
}

// Compares the whole table of results with an independent implementation, which averages angles over faces and samples.
TEST(Compare, agrees_with_the_oracle_to_the_printed_digits) {
  constexpr const char* kSchemes[] = {
      "recompute",         "polynomial",      "rational",         "linear",
      "quadratic",         "cubic",           "lagrange:5",       "slerp",
      "decasteljau:4",     "decasteljau:6",   "circle",           "circle:timed",
      "quaternion:matrix", "quaternion:edge", "quaternion:polar", "quaternion:random:3"};
  for (const Motion& motion : {fixtures::smooth_morph(16), fixtures::large_soup(400), fixtures::moderate_soup(400)}) {
    CompareOptions options;
    options.schemes.assign(std::begin(kSchemes), std::end(kSchemes));
    const auto comparison = compare(motion, options).value();
    const Segment segment = motion.segment(0);
    for (const char* name : kSchemes) {
      double sum = 0;
      std::size_t judged = 0;
      for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
        reference::Triangle triangle{};
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const auto vertex = motion.topology.face(f)[corner];
          const Vec3d p = to_double(segment.from[vertex]), q = to_double(segment.to[vertex]);
          triangle.from[corner] = {p.x, p.y, p.z};
          triangle.to[corner] = {q.x, q.y, q.z};
        }
        for (int i = 0; i <= 20; ++i) {
          const reference::Real t = i / reference::Real(20);
          const auto exact = reference::exact_unit_normal(triangle, t);
          const auto approximate = reference::unit_normal(name, triangle, t, {f, 0});
          if (!exact || !approximate) continue;
          sum += static_cast<double>(reference::angle(*exact, *approximate));
          ++judged;
        }
      }
      const Quality& quality = row(comparison, name).quality;
      EXPECT_GT(judged, quality.count * 98 / 100) << name;
      EXPECT_NEAR(quality.mean() * kDegreesPerRadian, sum / static_cast<double>(judged) * kDegreesPerRadian, 2e-4)
          << name;
    }
  }
}

TEST(Compare, the_order_of_table_1_holds_on_every_mild_morph) {
  for (const char* name : {"cloth", "bend", "twist"}) {
    const Motion motion = make_builtin_morph(name).value();
    const auto comparison = compare(motion, {}).value();
    const auto sum = [&](const char* scheme) { return row(comparison, scheme).quality.sum; };
    EXPECT_GT(sum("linear"), sum("quadratic"));
    EXPECT_GT(sum("quadratic"), sum("cubic"));
    EXPECT_GT(sum("cubic"), sum("polynomial"));
    EXPECT_GT(sum("slerp"), sum("linear"));
    EXPECT_LT(sum("quaternion:optimal"), sum("quaternion:matrix"));
    EXPECT_LT(sum("quaternion:optimal"), sum("slerp"));
    EXPECT_LT(sum("circle:timed"), sum("quaternion:optimal"));
    EXPECT_LT(row(comparison, "polynomial").quality.max * kDegreesPerRadian, 1e-4);
  }
}

TEST(Compare, relative_to_linear_needs_no_linear_row) {
  const Motion motion = make_builtin_morph("soup").value();
  const auto with = compare(motion, {{"linear", "slerp"}, 5, Access::kRandom, {}}).value();
  const auto without = compare(motion, {{"slerp"}, 5, Access::kRandom, {}}).value();
  ASSERT_EQ(without.schemes.size(), 1u);
  EXPECT_EQ(*without.schemes[0].relative_to_linear, *row(with, "slerp").relative_to_linear);
}

TEST(Compare, results_are_the_same_bits_on_every_run) {
  const Motion motion = make_builtin_morph("eversion").value();
  const auto a = compare(motion, {}).value(), b = compare(motion, {}).value();
  for (std::size_t i = 0; i < a.schemes.size(); ++i) {
    EXPECT_EQ(a.schemes[i].quality.sum, b.schemes[i].quality.sum);
    EXPECT_EQ(a.schemes[i].quality.max_at.element, b.schemes[i].quality.max_at.element);
  }
}

TEST(Compare, a_motion_without_error_has_no_ratio) {
  Motion motion;
  motion.topology = Topology::triangles(3, {0, 1, 2}).value();
  motion.keyframes = {{{0, 0, 0, 1, 0, 0, 0, 1, 0}, 0, ""}, {{0, 0, 1, 1, 0, 1, 0, 1, 1}, 1, ""}};
  motion.connect_as_sequence();
  const auto comparison = compare(motion, {}).value();
  for (const SchemeComparison& r : comparison.schemes) {
    EXPECT_FALSE(r.relative_to_linear.has_value()) << r.scheme;
    EXPECT_EQ(r.quality.degenerate, 0u);
  }
}

TEST(Compare, a_face_without_area_is_counted_in_every_sample) {
  Motion motion;
  motion.topology = Topology::triangles(4, {0, 1, 2, 0, 1, 1}).value();
  motion.keyframes = {{{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0}, 0, ""}, {{0, 0, 1, 1, 0, 2, 0, 1, 1, 0, 0, 0}, 1, ""}};
  motion.connect_as_sequence();
  const auto comparison = compare(motion, {}).value();
  for (const SchemeComparison& r : comparison.schemes) EXPECT_EQ(r.quality.degenerate, 21u) << r.scheme;
}

TEST(Compare, progress_reaches_its_end) {
  const Motion motion = make_builtin_morph("soup").value();
  std::size_t last = 0, total = 0;
  CompareOptions options{{"linear"}, 2, Access::kRandom, [&](std::size_t done, std::size_t all) {
                           EXPECT_GT(done, last);
                           last = done;
                           total = all;
                         }};
  ASSERT_TRUE(compare(motion, options).ok());
  EXPECT_GT(total, 0u);
  EXPECT_EQ(last, total);
}

TEST(Compare, refuses_what_makes_no_table) {
  const Motion motion = make_builtin_morph("soup").value();
  EXPECT_EQ(compare(motion, {{"linear"}, 1, Access::kRandom, {}}).error().code, ErrorCode::kUsage);
  EXPECT_EQ(compare(motion, {{""}, 21, Access::kRandom, {}}).error().code, ErrorCode::kUsage);
  EXPECT_EQ(compare(motion, {{"bicubic"}, 21, Access::kRandom, {}}).error().code, ErrorCode::kUsage);
  CompareOptions each_sample;
  each_sample.keep_samples = true;
  MotionStream stream(motion);
  CompareRun run;
  run.shard = Shard{};
  EXPECT_EQ(compare(stream, each_sample, run).error().text(),
            "a run with --shard or --resume cannot keep the error of every sample; leave one of the two out");
}

// The elements of the oracle: the corners of each element, and the first vertex or corner that belongs to it.
struct OracleElements {
  reference::Mesh mesh;
  std::vector<std::vector<reference::Corner>> corners;
  std::vector<std::size_t> first_output;
};

OracleElements oracle_elements(const Motion& motion, const ElementOptions& options) {
  OracleElements elements{test::reference_mesh(motion.segment(0)), {}, {}};
  const reference::Mesh& mesh = elements.mesh;
  const auto all = reference::corners_of(mesh);
  const std::vector<std::size_t> point = reference::flood(mesh.from.size(), [&](std::size_t a, std::size_t b) {
    return a == b || (options.weld && mesh.from[a] == mesh.from[b] && mesh.to[a] == mesh.to[b]);
  });
  const bool vertices = options.kind == ElementKind::kVertices;
  const auto classes =
      vertices ? point : reference::crease_classes(mesh, point, static_cast<reference::Real>(options.crease_angle));
  for (std::size_t output = 0; output < classes.size(); ++output) {
    if (classes[output] == elements.first_output.size()) elements.first_output.push_back(output);
  }
  elements.corners.resize(elements.first_output.size());
  for (std::size_t c = 0; c < all.size(); ++c)
    elements.corners[classes[vertices ? vertex_of(mesh, all[c]) : c]].push_back(all[c]);
  return elements;
}

// Returns the normal of an element at t by a scheme. exact(t) returns the exact unit normals from which the scheme
// interpolates.
std::optional<reference::Vector> oracle_normal(const std::string& scheme,
                                               const std::function<reference::Vector(reference::Real)>& exact,
                                               reference::Real t) {
  using reference::add, reference::scaled;
  const auto nodes = [&exact](std::size_t count) {
    std::vector<reference::Vector> result;
    for (std::size_t i = 0; i < count; ++i)
      result.push_back(exact(static_cast<reference::Real>(i) / static_cast<reference::Real>(count - 1)));
    return result;
  };
  if (scheme == "polynomial") return exact(t);
  if (scheme == "slerp") return reference::slerp(exact(0), exact(1), t);
  if (scheme == "decasteljau:4") return reference::spherical_de_casteljau(nodes(4), t);
  if (scheme == "linear") return add(scaled(1 - t, exact(0)), scaled(t, exact(1)));
  const auto n = nodes(3);  // quadratic: the Lagrange polynomial through three normals
  return add(scaled((1 - t) * (1 - 2 * t), n[0]), add(scaled(4 * t * (1 - t), n[1]), scaled(t * (2 * t - 1), n[2])));
}

TEST(Compare, vertices_and_corners_agree_with_the_oracle) {
  const Motion torn = test::torn(fixtures::shaken(fixtures::icosphere(1), 0.8, 21));
  const std::vector<std::string> schemes = {"linear", "quadratic", "polynomial", "slerp", "decasteljau:4"};
  constexpr std::size_t kSamples = 11;
  for (const auto& [elements, count] : {std::pair{ElementOptions{ElementKind::kVertices, true, 180}, std::size_t{42}},
                                        std::pair{ElementOptions{ElementKind::kVertices, false, 180}, std::size_t{240}},
                                        std::pair{ElementOptions{ElementKind::kCorners, true, 20}, std::size_t{0}}}) {
    CompareOptions options{schemes, kSamples, Access::kRandom, {}, elements};
    const auto comparison = compare(torn, options).value();
    const OracleElements oracle = oracle_elements(torn, elements);
    EXPECT_EQ(comparison.kind, elements.kind);
    EXPECT_EQ(comparison.vertices, 240U);
    EXPECT_EQ(comparison.elements, oracle.corners.size());
    if (count > 0)
      EXPECT_EQ(comparison.elements, count);
    else
      EXPECT_TRUE(comparison.elements > 42 && comparison.elements < 240)
          << comparison.elements << ": some edges are hard";
    for (const std::string& scheme : schemes) {
      reference::Real sum = 0, worst = 0;
      std::size_t worst_element = 0, worst_sample = 0;
      for (std::size_t e = 0; e < oracle.corners.size(); ++e) {
        const auto exact = [&](reference::Real t) {
          return reference::normalised(reference::element_normal(oracle.mesh, oracle.corners[e], "area", t));
        };
        for (std::size_t i = 0; i < kSamples; ++i) {
          const reference::Real t = static_cast<reference::Real>(i) / (kSamples - 1);
          const reference::Real error = reference::angle(exact(t), oracle_normal(scheme, exact, t).value());
          sum += error;
          if (error > worst) std::tie(worst, worst_element, worst_sample) = std::tuple{error, e, i};
        }
      }
      const Quality& quality = row(comparison, scheme).quality;
      EXPECT_EQ(quality.count, oracle.corners.size() * kSamples);
      EXPECT_NEAR(static_cast<double>(quality.sum / static_cast<double>(quality.count)),
                  static_cast<double>(sum) / static_cast<double>(quality.count), 1e-7)
          << scheme;
      if (scheme == "polynomial") continue;  // the error of this scheme is only rounding
      EXPECT_NEAR(quality.sum, static_cast<double>(sum), 1e-6 * static_cast<double>(sum)) << scheme;
      EXPECT_EQ(quality.max_at.element, oracle.first_output[worst_element]) << scheme << ": a vertex, or a corner";
      EXPECT_NEAR(quality.max_at.t, static_cast<double>(worst_sample) / (kSamples - 1), 1e-12) << scheme;
    }
  }
}

// Tests schemes on weighted normals. Only area-weighted normals are exact quadratics in t.
TEST(Compare, every_weighting_agrees_with_the_oracle) {
  fixtures::Random random(20261127);
  const Motion motion = fixtures::shaken(fixtures::box_grid(2), 0.3, random.below(1000));
  const std::vector<std::string> schemes = {"linear", "quadratic", "slerp", "decasteljau:4", "cubic", "polynomial"};
  constexpr std::size_t kSamples = 11;
  for (const WeightingInfo& info : kAllWeightings) {
    CompareOptions options{schemes, kSamples, Access::kRandom, {}, {ElementKind::kVertices}};
    options.weighting = info.weighting;
    const auto comparison = compare(motion, options).value();
    EXPECT_EQ(comparison.weighting, info.weighting);
    const OracleElements oracle = oracle_elements(motion, options.elements);
    const std::string weighting(info.name);
    for (const std::string& scheme : schemes) {
      Real sum = 0;
      for (const auto& corners : oracle.corners) {
        const reference::MovingElement element{oracle.mesh, corners, weighting};
        for (std::size_t i = 0; i < kSamples; ++i) {
          const Real t = static_cast<Real>(i) / (kSamples - 1);
          const auto exact = reference::exact_unit_normal(element, t);
          // For weightings other than area, `polynomial` is a quadratic curve through three normals. Only the library
          // knows the lengths of these normals, so the test uses the exact normal here.
          const auto found = scheme == "polynomial" ? exact : reference::unit_normal(scheme, element, t);
          sum += reference::angle(exact.value(), found.value());
        }
      }
      const Quality& quality = row(comparison, scheme).quality;
      EXPECT_EQ(quality.count, oracle.corners.size() * kSamples);
      if (scheme != "polynomial") {
        EXPECT_NEAR(quality.sum, static_cast<double>(sum), 1e-6 * static_cast<double>(quality.count))
            << scheme << ", " << weighting;
      } else if (info.weighting == Weighting::kArea) {
        EXPECT_LT(quality.mean(), 1e-6);
      } else {
        EXPECT_GT(quality.mean(), 1e-6) << weighting << " has no quadratic";
        EXPECT_LT(quality.mean(), row(comparison, "linear").quality.mean()) << weighting;
      }
    }
  }
}

TEST(Compare, weightings_are_of_vertices_and_have_no_certificates) {
  const Motion motion = fixtures::smooth_morph(3);
  CompareOptions options{{"linear"}, 3, Access::kRandom, {}};
  options.weighting = Weighting::kAngle;
  EXPECT_NE(compare(motion, options).error().text().find("no meaning for normals of faces"), std::string::npos);
  options.elements.kind = ElementKind::kVertices;
  EXPECT_TRUE(compare(motion, options).ok());
  options.certify = true;
  EXPECT_NE(compare(motion, options).error().text().find("weighted by area"), std::string::npos);
}

TEST(Compare, max_at_names_a_vertex_of_the_mesh) {
  // The 240 corners are separate vertices at 42 points. The largest error must be reported for a vertex, and not for a
  // point.
  Motion motion = test::torn(fixtures::shaken(fixtures::icosphere(1), 0.01, 22));
  for (std::size_t v = 0; v < 240; ++v) {  // only the point of vertex 239 moves far
    bool same = true;
    for (std::size_t k = 0; k < 3; ++k)
      same = same && motion.keyframes[0].positions[3 * v + k] == motion.keyframes[0].positions[3 * 239 + k];
    if (same) motion.keyframes[1].positions[3 * v] += 2;
  }
  CompareOptions options{{"linear"}, 5, Access::kRandom, {}, {ElementKind::kVertices}};
  const std::size_t welded = compare(motion, options).value().schemes[0].quality.max_at.element;
  options.elements.weld = false;
  const std::size_t apart = compare(motion, options).value().schemes[0].quality.max_at.element;
  EXPECT_LT(welded, 240U);
  EXPECT_LT(apart, 240U);
  // If vertices are welded, the reported vertex is the first vertex at its point.
  for (std::size_t v = 0; v < welded; ++v) {
    EXPECT_FALSE(std::equal(motion.keyframes[0].positions.begin() + static_cast<std::ptrdiff_t>(3 * v),
                            motion.keyframes[0].positions.begin() + static_cast<std::ptrdiff_t>(3 * v + 3),
                            motion.keyframes[0].positions.begin() + static_cast<std::ptrdiff_t>(3 * welded)))
        << v;
  }
}

TEST(Compare, schemes_that_need_faces_are_refused_for_others) {
  const Motion motion = fixtures::smooth_morph(4);
  for (const ElementKind kind : {ElementKind::kVertices, ElementKind::kCorners}) {
    for (const char* const scheme : {"quaternion:edge", "quaternion:polar"}) {
      EXPECT_TRUE(compare(motion, {{scheme}, 3, Access::kRandom, {}, {ElementKind::kFaces}}).ok());
      const auto refused = compare(motion, {{"linear", scheme}, 3, Access::kRandom, {}, {kind}});
      ASSERT_FALSE(refused.ok()) << scheme;
      EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
      EXPECT_NE(refused.error().message.find(scheme), std::string::npos) << refused.error().message;
      EXPECT_NE(refused.error().message.find(element_kind_name(kind)), std::string::npos) << refused.error().message;
    }
    EXPECT_EQ(compare(motion, {{}, 3, Access::kRandom, {}, {kind}}).value().schemes.size(),
              default_schemes(kind).size());
  }
  EXPECT_EQ(compare(motion, {{}, 3, Access::kRandom, {}, {ElementKind::kCorners, true, 181}}).error().code,
            ErrorCode::kUsage);
}

TEST(CompareCertified, no_sample_exceeds_the_bound_of_any_element) {
  const std::vector<std::string> schemes = {
      "recompute",        "linear",        "quadratic",    "cubic",  "polynomial",
      "rational",         "linear:scaled", "slerp",        "circle", "quaternion:optimal",
      "quaternion:polar", "circle:timed",  "decasteljau:3"};
  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices, ElementKind::kCorners}) {
    CompareOptions options{schemes, 41, Access::kRandom, {}, {kind, true, 40}};
    if (kind != ElementKind::kFaces)
      std::erase_if(options.schemes, [](const auto& name) { return make_scheme(name).value()->needs_faces(); });
    options.certify = true;
    for (const Motion& motion : {fixtures::smooth_morph(12), fixtures::shaken(fixtures::icosphere(3), 0.1, 3)}) {
      const Comparison compared = compare(motion, options).value();
      for (const SchemeComparison& row : compared.schemes) {
        ASSERT_TRUE(row.certified);
        EXPECT_LE(row.quality.max, row.certified->upper) << row.scheme;
        EXPECT_LE(row.certified->lower, row.certified->upper) << row.scheme;
        EXPECT_LE(row.certified->upper - row.certified->lower, 2e-3 * row.certified->upper + 1e-4) << row.scheme;
        EXPECT_EQ(row.certified->unbounded, 0U) << row.scheme;
      }
    }
  }
}

// A vertex whose face normals cancel exactly at a sample has no normal, and the sample is not judged. The test finds
// such samples with integers.
TEST(CompareCertified, vertices_whose_faces_cancel_are_seen) {
  fixtures::Random random(4917);
  constexpr std::size_t kSamples = 5;
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE("star " + std::to_string(i) + " from seed 4917");
    const Motion motion = test::cancelling_star(random);
    CompareOptions options{{"polynomial", "linear"}, kSamples, Access::kRandom, {}, {ElementKind::kVertices, false}};
    options.certify = true;
    const Comparison compared = compare(motion, options).value();
    const NormalGroups vertices =
        NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
    const test::IntegerNormals oracle(motion.segment(0));
    std::size_t without = 0;
    for (std::size_t k = 0; k < kSamples; ++k) {
      const auto faces = oracle.at(test::IntegerTime::of(static_cast<double>(k) / (kSamples - 1)));
      for (std::size_t v = 0; v < vertices.size(); ++v)
        without += test::is_zero(test::sum_of(faces, vertices.faces(v))) ? 1U : 0U;
    }
    for (const SchemeComparison& row : compared.schemes) {
      EXPECT_EQ(row.quality.degenerate, without) << row.scheme;
      EXPECT_LE(row.quality.max, row.certified->upper) << row.scheme;
    }
    EXPECT_LE(row(compared, "polynomial").quality.max, 2e-6);
  }
}

TEST(CompareCertified, bounds_are_the_same_on_any_number_of_threads) {
  CompareOptions options;
  options.schemes = {"linear", "slerp"};
  options.samples = 2;
  options.certify = true;
  const Motion motion = fixtures::large_soup(5000);
  const auto certified = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    std::vector<double> values;
    const Comparison compared = compare(motion, options).value();
    for (const SchemeComparison& row : compared.schemes)
      values.insert(values.end(),
                    {row.certified->lower, row.certified->upper, static_cast<double>(row.certified->element)});
    return values;
  };
  EXPECT_EQ(certified(1), certified(3));
}

TEST(CompareCertified, the_choice_is_the_cheapest_that_is_within_the_tolerance) {
  const Motion motion = fixtures::smooth_morph(8);
  for (const double tolerance : {60.0, 5.0, 1.0, 0.01}) {
    const Choice choice = choose(motion, tolerance).value();
    ASSERT_TRUE(choice.scheme) << tolerance;
    double cost = 0;
    for (const SchemeComparison& row : choice.comparison.schemes)
      if (row.scheme == *choice.scheme) cost = evaluation_cost(row);
    for (const SchemeComparison& row : choice.comparison.schemes) {
      const bool is_within = row.certified->upper * kDegreesPerRadian <= tolerance;
      EXPECT_TRUE(is_within || row.scheme != *choice.scheme) << tolerance;
      if (!is_within) continue;
      EXPECT_LE(cost, evaluation_cost(row)) << row.scheme << ", " << tolerance;
    }
  }
  EXPECT_FALSE(choose(motion, 0).value().scheme);
  EXPECT_EQ(choose(motion, -1).error().code, ErrorCode::kUsage);
  CompareOptions vertices;
  vertices.elements.kind = ElementKind::kVertices;
  EXPECT_TRUE(choose(motion, 0.01, vertices).value().scheme);
}

TEST(CompareCertified, is_refused_for_what_is_played) {
  CompareOptions options;
  options.schemes = {"linear"};
  options.access = Access::kSequential;
  options.certify = true;
  EXPECT_EQ(compare(fixtures::smooth_morph(4), options).error().code, ErrorCode::kUsage);
}

TEST(BuiltinMorphs, are_there_by_name_and_have_the_faces_that_they_say) {
  for (const BuiltinMorph& morph : builtin_morphs()) {
    const auto motion = make_builtin_morph(morph.name);
    ASSERT_TRUE(motion.ok());
    std::string digits = std::to_string(motion.value().topology.face_count());
    digits.insert(digits.size() - 3, 1, ',');
    EXPECT_NE(morph.summary.find(digits + " faces"), std::string::npos) << morph.name << " has " << digits;
  }
  const auto unknown = make_builtin_morph("teapot");
  ASSERT_FALSE(unknown.ok());
  EXPECT_EQ(unknown.error().code, ErrorCode::kUsage);
  EXPECT_NE(unknown.error().message.find("eversion"), std::string::npos);
}

TEST(BuiltinMorphs, eversion_turns_inside_out) {
  // The mesh turns inside out, so its volume, which the divergence theorem gives, changes its sign.
  const Motion motion = make_builtin_morph("eversion").value();
  const auto volume = [&motion](VectorView<const float> p) {
    double sum = 0;
    for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
      const auto face = motion.topology.face(f);
      sum += dot(to_double(p[face[0]]), cross(to_double(p[face[1]]), to_double(p[face[2]]))) / 6;
    }
    return sum;
  };
  EXPECT_GT(volume(motion.segment(0).from), 3);
  EXPECT_LT(volume(motion.segment(0).to), -1);
}

// Makes a motion of one polygon that bends.
Motion polygon(std::uint32_t corners) {
  Motion motion;
  std::vector<std::uint32_t> around(corners);
  std::iota(around.begin(), around.end(), 0U);
  motion.topology = Topology::polygons(corners, {0, corners}, around).value();
  for (int k = 0; k < 3; ++k) {
    Motion::Keyframe& keyframe = motion.keyframes.emplace_back();
    keyframe.time = k;
    for (std::uint32_t v = 0; v < corners; ++v) {
      const double angle = 2 * std::numbers::pi * v / corners;
      for (const double x : {std::cos(angle), std::sin(angle), 0.3 * k * std::cos(angle + k)})
        keyframe.positions.push_back(static_cast<float>(x));
    }
  }
  motion.connect_as_sequence();
  return motion;
}

// A vertex with a single polygon must have the normal of the polygon. If a polygon has more than 32 and more than
// samples / 16 corners, its normal is computed once for all vertices. The normal of a smaller polygon is computed anew
// for each vertex.
TEST(Compare, vertices_of_a_polygon_have_the_errors_of_its_face) {
  for (const std::uint32_t corners : {3U, 5U, 32U, 33U, 34U, 200U}) {
    for (const std::size_t samples : {std::size_t{2}, std::size_t{5}, std::size_t{1000}}) {
      CompareOptions options;
      options.schemes = {"linear"};
      options.samples = samples;
      const Motion motion = polygon(corners);
      const Comparison face = compare(motion, options).value();
      options.elements.kind = ElementKind::kVertices;
      const Comparison vertices = compare(motion, options).value();
      EXPECT_EQ(vertices.schemes[0].quality.max, face.schemes[0].quality.max) << corners;
      EXPECT_NEAR(vertices.schemes[0].quality.mean(), face.schemes[0].quality.mean(), 1e-12) << corners;
      EXPECT_EQ(vertices.schemes[0].quality.count, corners * face.schemes[0].quality.count);
    }
  }
}

}  // namespace
}  // namespace chronormal::compare_test

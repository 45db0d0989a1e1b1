// Compares the terms of blend shapes with exact arithmetic. The difference must not exceed the noise (the bound of the
// error) that BlendTerms states. Tests terms in stored lists and terms that are requested one by one.
#include "normals/blend/blend_terms.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <set>
#include <vector>

#include "tests/support/blend_oracle.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"

namespace chronormal::blend_terms_test {
namespace {

using exact::Rational;

BlendTerms terms_of(const BlendSet& set, const NormalGroups* groups) {
  return groups ? BlendTerms(set, *groups) : BlendTerms(set);
}

// Returns B(p, q) + B(q, p), or only B(p, q) unless `both`, for each element, without rounding. B is a bilinear form,
// summed over the faces of the element: at positions p, the normal is B(p, p).
std::vector<exact::Vector> exact_term(const BlendSet& set, const NormalGroups* groups, const test::ExactPositions& p,
                                      const test::ExactPositions& q, bool both) {
  std::vector<exact::Vector> result;
  for (const auto& faces : test::faces_of_elements(set, groups)) {
    exact::Vector sum{0, 0, 0};
    for (const std::uint32_t f : faces) {
      const exact::Vector pq = test::exact_form(set.topology.face(f), p, q);
      const exact::Vector qp = test::exact_form(set.topology.face(f), q, p);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += both ? Rational(pq[c] + qp[c]) : pq[c];
    }
    result.push_back(sum);
  }
  return result;
}

// Checks each element of a term: its value must be within its noise of the exact value. Elements that the term does not
// list must be zero, up to 1e-14. Returns the number of listed elements.
std::size_t expect_term(const BlendTerm& term, const std::vector<exact::Vector>& expected, const char* name) {
  EXPECT_TRUE(std::is_sorted(term.elements.begin(), term.elements.end())) << name;
  EXPECT_EQ(term.values.size(), term.noise.size()) << name;
  const bool all = term.elements.empty() && !term.values.empty();
  std::size_t listed = 0;
  for (std::size_t e = 0; e < expected.size(); ++e) {
    const bool is_listed = all || (listed < term.elements.size() && term.elements[listed] == e);
    const Vec3d value = is_listed ? term.values[listed] : Vec3d{};
    const double noise = is_listed ? term.noise[listed] : 1e-14;
    const exact::Vector difference = exact::subtract(exact::vector(value.x, value.y, value.z), expected[e]);
    EXPECT_LE(exact::max_abs(difference).get_d(), noise) << name << ", element " << e;
    if (is_listed) {
      EXPECT_LE(noise, 1e-13) << name << ", element " << e;
      ++listed;
    }
  }
  EXPECT_EQ(listed, term.values.size()) << name;
  return listed;
}

void expect_all_terms(const BlendSet& set, const NormalGroups* groups) {
  const BlendTerms terms = terms_of(set, groups);
  const test::ExactPositions b = test::exact_base(set);
  expect_term(terms.base_term(), exact_term(set, groups, b, b, false), "base");
  for (std::size_t i = 0; i < set.targets.size(); ++i) {
    const test::ExactPositions di = test::exact_deltas(set, i);
    expect_term(terms.linear(i), exact_term(set, groups, b, di, true), "linear");
    for (std::size_t j = 0; j < set.targets.size(); ++j) {
      const test::ExactPositions dj = test::exact_deltas(set, j);
      expect_term(terms.pair(i, j), exact_term(set, groups, di, dj, i != j), "pair");
    }
  }
}

RC_GTEST_PROP(BlendTerms, each_coefficient_is_the_form_of_its_targets_within_its_noise, ()) {
  const BlendSet set =
      test::random_blend_set(*rc::gen::arbitrary<std::uint64_t>(), {.cells = 4, .targets = 3, .reach = 0.8});
  const NormalGroups vertices = test::vertices_of(set);
  expect_all_terms(set, &vertices);
  expect_all_terms(set, nullptr);
}

TEST(BlendTerms, base_and_base_term_are_the_same) {
  const BlendSet set = test::random_blend_set(4);
  const NormalGroups vertices = test::vertices_of(set);
  EXPECT_EQ(BlendTerms(set, vertices).base(), BlendTerms(set, vertices).base_term().values);
}

RC_GTEST_PROP(BlendTerms, counts_say_beforehand_where_terms_are_not_zero, ()) {
  const BlendSet set = test::random_blend_set(*rc::gen::arbitrary<std::uint64_t>(), {.targets = 6, .reach = 0.5});
  const NormalGroups vertices = test::vertices_of(set);
  for (const NormalGroups* groups : {&vertices, static_cast<const NormalGroups*>(nullptr)}) {
    const BlendTerms terms = terms_of(set, groups);
    const auto faces_of = test::faces_of_elements(set, groups);
    const auto all = terms.pair_elements();
    std::vector<std::vector<double>> one(set.targets.size(), std::vector<double>(set.targets.size()));
    for (std::size_t i = 0; i < set.targets.size(); ++i) {
      one[i][i] = 1;
      const std::vector<bool> touched = test::touched_elements(set, groups, one[i]);
      std::vector<std::uint32_t> listed;
      for (std::uint32_t e = 0; e < touched.size(); ++e)
        if (touched[e]) listed.push_back(e);
      RC_ASSERT(terms.elements(i) == listed);
      // Counts, face by face, the elements that have a face that both targets of a pair move.
      std::vector<BlendTerms::PairCount> expected;
      for (std::size_t j = 0; j < set.targets.size(); ++j) {
        std::uint32_t count = 0;
        for (const auto& faces : faces_of) {
          count += std::any_of(faces.begin(), faces.end(),
                               [&](std::uint32_t f) {
                                 const auto has = [f](std::span<const std::uint32_t> list) {
                                   return std::count(list.begin(), list.end(), f) > 0;
                                 };
                                 return has(terms.faces(i)) && has(terms.faces(j));
                               })
                       ? 1U
                       : 0U;
        }
        if (i == j) continue;
        RC_ASSERT(terms.overlap(i, j) == (count > 0));
        if (count > 0) expected.push_back({static_cast<std::uint32_t>(j), count});
        RC_ASSERT(terms.pair(i, j).elements.size() <= count);
      }
      std::erase_if(expected, [i](const BlendTerms::PairCount& pair) { return pair.other < i; });
      RC_ASSERT(all[i] == expected);
    }
  }
}

TEST(BlendTerms, targets_apart_have_no_terms_in_common_and_rigid_ones_no_square) {
  BlendSet set;
  set.topology = fixtures::make_triangles(6, {0, 1, 2, 3, 4, 5});
  set.base = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1};
  // The first target translates the first face, and the second target moves one corner of the second face.
  set.targets = {{"", {0, 1, 2}, {1, 2, 3, 1, 2, 3, 1, 2, 3}}, {"", {5}, {0, 0, 1}}, {"", {}, {}}};
  const BlendTerms terms(set);
  EXPECT_TRUE(terms.linear(0).elements.empty());
  EXPECT_TRUE(terms.pair(0, 0).elements.empty());
  EXPECT_EQ(terms.linear(1).elements, (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(terms.linear(1).values, (std::vector<Vec3d>{{0, -1, 0}}));
  EXPECT_TRUE(terms.pair(1, 1).elements.empty());  // a single corner that moves gives no quadratic term
  EXPECT_TRUE(terms.pair(0, 1).elements.empty());
  EXPECT_FALSE(terms.overlap(0, 1));
  EXPECT_TRUE(terms.linear(2).elements.empty() && terms.faces(2).empty() && terms.elements(2).empty());
}

RC_GTEST_PROP(BlendTerms, shuffled_faces_give_the_same_bits, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const BlendSet set = test::random_blend_set(seed, {.targets = 2, .reach = 1});
  BlendSet shuffled = set;
  Motion motion;
  motion.topology = set.topology;
  shuffled.topology = test::with_faces_in_order(motion, test::shuffled_order(set.topology.face_count(), seed)).topology;
  const NormalGroups groups = test::vertices_of(set), other_groups = test::vertices_of(shuffled);
  const BlendTerms terms(set, groups), other(shuffled, other_groups);
  RC_ASSERT(terms.base() == other.base());
  for (std::size_t i = 0; i < 2; ++i) {
    RC_ASSERT(terms.linear(i).values == other.linear(i).values);
    RC_ASSERT(terms.pair(0, i).elements == other.pair(0, i).elements);
    RC_ASSERT(terms.pair(0, i).values == other.pair(0, i).values);
  }
}

TEST(BlendTerms, sets_without_faces_vertices_or_targets_have_none) {
  const BlendSet nothing;
  EXPECT_EQ(BlendTerms(nothing).size(), 0U);
  EXPECT_TRUE(BlendTerms(nothing).base().empty());
  EXPECT_TRUE(BlendTerms(nothing).pair_elements().empty());
  BlendSet isolated;
  isolated.topology = fixtures::make_triangles(2, {});
  isolated.base = {0, 0, 0, 1, 1, 1};
  isolated.targets = {{"", {1}, {1, 0, 0}}};
  const NormalGroups groups = test::vertices_of(isolated);
  const BlendTerms terms(isolated, groups);
  EXPECT_EQ(terms.base(), std::vector<Vec3d>(2));
  EXPECT_TRUE(terms.linear(0).elements.empty() && terms.pair(0, 0).elements.empty());
}

// For small meshes, BlendTerms stores the contribution of every face in lists. For meshes with more than 100,000 faces,
// BlendTerms computes each requested term anew.
TEST(BlendTerms, have_the_same_bits_in_lists_and_element_by_element_on_large_meshes) {
  const Motion motion = fixtures::smooth_morph(230);  // 105,800 faces
  const std::size_t count = motion.topology.vertex_count();
  BlendSet set;
  set.topology = motion.topology;
  set.base = motion.keyframes[0].positions;
  const auto add_target = [&](std::size_t first, std::size_t last) {
    BlendTarget& target = set.targets.emplace_back();
    for (std::size_t v = first; v < last; ++v) {
      target.vertices.push_back(static_cast<std::uint32_t>(v));
      for (std::size_t c = 3 * v; c < 3 * v + 3; ++c)
        target.deltas.push_back(motion.keyframes[1].positions[c] - set.base[c]);
    }
  };
  add_target(0, count);
  add_target(count / 3, count / 2);
  const NormalGroups groups = NormalGroups::of_vertices(motion.topology, weld_coincident(motion));
  const BlendTerms terms(set, groups);
  const auto expect_same = [](const BlendTerm& list, const BlendTerms::Term& term) {
    ASSERT_GT(list.elements.size(), 1000U);
    for (std::size_t n = 0; n < list.elements.size(); ++n) ASSERT_EQ(list.values[n], term(list.elements[n])) << n;
  };
  for (std::size_t i = 0; i < 2; ++i) {
    expect_same(terms.linear(i), terms.linear_by_element(i));
    for (std::size_t j = 0; j < 2; ++j) expect_same(terms.pair(i, j), terms.pair_by_element(i, j));
  }
  const std::vector<Vec3d> base = terms.base();
  for (std::uint32_t e = 0; e < base.size(); ++e) ASSERT_EQ(base[e], terms.base_of(e)) << e;
}

}  // namespace
}  // namespace chronormal::blend_terms_test

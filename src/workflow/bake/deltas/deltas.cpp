// Computes the deltas of vertices. Every delta starts as a term of the quadratic form n(w) of an element (terms.h), or
// as the best single delta that is computed from the linear and the square term of a target. The delta is then turned
// and scaled for each vertex that shows the element, to fit the stored normal of the vertex.
#include "workflow/bake/deltas/deltas.h"

#include <cmath>
#include <numbers>

#include "analysis/fits/end_delta.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kDeltasBlock = 1024;
// The length of the shortest stored base normal that can get deltas. A stored normal should have length 1, and no
// viewer renders a normal shorter than kShortest right.
constexpr double kShortest = 1e-3;
// The length of the longest stored normal that stays as it is. If the deltas of such a normal are up to 1e6 times as
// long, float32 can still hold the squared length of the sum, and the inverse of this square.
constexpr double kLongestStored = 1e10;

Vec3d stored_normal(std::span<const float> normals, std::size_t vertex) {
  const float* const n = normals.data() + 3 * vertex;
  return to_double(Vec3f{n[0], n[1], n[2]});
}

VertexTerms terms_of_vertex(const DeltaSource& source, std::uint32_t element, std::size_t vertex) {
  return {source.terms.base_of(element), source.plan.largest[element], stored_normal(source.base_normals, vertex)};
}

// Returns the largest angle, in radians, between the true normal and the normal that the best single delta gives. Takes
// the largest angle over all weights in `range`.
double error_within(const WeightRange& range, const ControlNormals& normals, const EndDelta& best) {
  if (range.low == 0 && range.high == 1) return best.error;
  const Vec3d base = unit_normal_at(normals, 0).vector;
  const Vec3d from = base + range.low * best.delta, to = base + range.high * best.delta;
  if (max_abs(from) == 0 || max_abs(to) == 0) return std::numbers::pi;
  return largest_line_error(normals_between(normals, range.low, range.high), from, to);
}

// The results for a block of vertices: whether any delta is not zero, and the largest error of a normal in radians.
struct Found {
  bool any = false;
  double error = 0;
};

// Collects the deltas of all vertices that show one of these elements. find_delta(element, vertex, delta, error) writes
// the delta of a vertex, and returns true if the vertex has a delta.
template <class FindDelta>
TargetDeltas gather(const GltfShading& shading, std::span<const std::uint32_t> elements, const FindDelta& find_delta) {
  TargetDeltas result;
  std::vector<bool> is_asked(shading.groups.size(), false);
  for (const std::uint32_t e : elements) is_asked[e] = true;
  for (const GltfPart& part : shading.parts) {
    std::vector<float> deltas(3 * part.vertex_count);
    const auto take = [&](std::size_t n, Found& found) {
      const std::size_t vertex = part.first_vertex + n;
      const std::uint32_t element = shading.element_of_vertex[vertex];
      Vec3d delta;
      if (element == GltfShading::kNoElement || !is_asked[element]) return;
      if (!find_delta(element, vertex, delta, found.error)) return;
      VectorView<float>::packed(deltas.data(), part.vertex_count).set(n, to_float(delta));
      found.any = true;
    };
    const Found found = parallel_fold<Found>(part.vertex_count, kDeltasBlock, take, [](Found& all, const Found& each) {
      all.any |= each.any;
      all.error = std::fmax(all.error, each.error);
    });
    result.error = std::fmax(result.error, found.error);
    result.of_parts.push_back(found.any ? std::move(deltas) : std::vector<float>());
  }
  return result;
}

TargetDeltas end_deltas(const DeltaSource& source, std::size_t target) {
  const NormalTerms::Term linear = source.terms.linear_by_element(target);
  const NormalTerms::Term square = source.terms.pair_by_element(target, target);
  const std::vector<std::uint32_t> elements = source.terms.elements(target);
  return gather(source.shading, elements, [&](std::uint32_t element, std::size_t vertex, Vec3d& delta, double&) {
    Vec3d a, c;
    const bool has_linear = linear.find(element, a), has_square = square.find(element, c);
    if (!has_linear && !has_square) return false;
    delta = terms_of_vertex(source, element, vertex)(a + c);
    return true;
  });
}

TargetDeltas single_deltas(const DeltaSource& source, std::size_t target) {
  const NormalTerms::Term linear = source.terms.linear_by_element(target);
  const NormalTerms::Term square = source.terms.pair_by_element(target, target);
  const std::vector<std::uint32_t> elements = source.terms.elements(target);
  return gather(source.shading, elements, [&](std::uint32_t element, std::size_t vertex, Vec3d& delta, double& error) {
    Vec3d a, c;
    const bool has_linear = linear.find(element, a), has_square = square.find(element, c);
    if (!has_linear && !has_square) return false;
    const VertexTerms of_vertex = terms_of_vertex(source, element, vertex);
    if (source.plan.lines.find(target, element, delta)) {
      delta = of_vertex.fitted_delta(delta);
      return true;
    }
    const ControlNormals normals = of_powers(source.terms.base_of(element), a, c);
    const EndDelta best = best_end_delta(normals);
    error = std::fmax(error, error_within(source.plan.ranges[target], normals, best));
    delta = of_vertex.end_delta(best.delta, normals);
    return true;
  });
}

}  // namespace

NewBaseNormals new_base_normals(const GltfShading& shading, const NormalTerms& terms,
                                const std::vector<bool>& is_recomputed) {
  NewBaseNormals result{{}, std::vector<bool>(shading.parts.size(), false), 0};
  const auto replace = [&](std::size_t part, std::size_t vertex, const Vec3d& normal) {
    if (result.normals.empty()) result.normals = shading.normals;
    VectorView<float>::packed(result.normals.data(), result.normals.size() / 3).set(vertex, to_float(normal));
    result.is_replaced[part] = true;
  };
  for (std::size_t p = 0; p < shading.parts.size(); ++p) {
    const GltfPart& part = shading.parts[p];
    result.is_replaced[p] = is_recomputed[p];
    for (std::size_t v = part.first_vertex; v < part.first_vertex + part.vertex_count; ++v) {
      const std::uint32_t element = shading.element_of_vertex[v];
      const Vec3d stored = stored_normal(shading.normals, v);
      if (is_recomputed[p]) {
        const Vec3d normal = element == GltfShading::kNoElement ? Vec3d{} : unit(terms.base_of(element));
        if (max_abs(normal) > 0)
          replace(p, v, normal);
        else
          replace(p, v, stored == Vec3d{} ? Vec3d{0, 0, 1} : stored);
      } else if (element != GltfShading::kNoElement && stored != Vec3d{} &&
                 (max_abs(stored) > kLongestStored || max_abs(stored) < 1 / kLongestStored)) {
        replace(p, v, unit(stored));
        ++result.rescaled;
      }
    }
  }
  return result;
}

BaseFaults find_base_faults(const DeltaSource& source) {
  const std::vector<std::uint32_t>& elements = source.shading.element_of_vertex;
  const auto look = [&](std::size_t v, BaseFaults& faults) {
    const std::uint32_t e = elements[v];
    if (e == GltfShading::kNoElement) return;
    if (!VertexTerms::has_base(source.terms.base_of(e), source.plan.largest[e])) ++faults.without_base;
    if (length(stored_normal(source.base_normals, v)) < kShortest) ++faults.without_stored;
  };
  return parallel_fold<BaseFaults>(elements.size(), kDeltasBlock, look, [](BaseFaults& all, const BaseFaults& each) {
    all.without_base += each.without_base;
    all.without_stored += each.without_stored;
  });
}

TargetDeltas own_target_deltas(const DeltaSource& source, std::size_t target) {
  if (!moves(source.shading, target)) return {std::vector<std::vector<float>>(source.shading.parts.size()), 0};
  TargetDeltas deltas = source.plan.is_line[target] ? single_deltas(source, target) : end_deltas(source, target);
  deltas.error += source.terms.fit_error(target);
  return deltas;
}

TargetDeltas extra_target_deltas(const DeltaSource& source, const ExtraWeight& extra) {
  const NormalTerms::Term term = source.terms.pair_by_element(extra.i, extra.j);
  const double sign = extra.i == extra.j ? -1 : 1;
  const std::vector<std::uint32_t> elements = source.terms.elements(extra.i, extra.j);
  return gather(source.shading, elements, [&](std::uint32_t element, std::size_t vertex, Vec3d& delta, double&) {
    Vec3d value;
    if (!term.find(element, value)) return false;
    delta = sign * terms_of_vertex(source, element, vertex)(value);
    return true;
  });
}

}  // namespace chronormal::inline internal

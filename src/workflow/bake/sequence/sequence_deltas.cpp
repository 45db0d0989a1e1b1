// Computes base normals and deltas of a sequence.
#include "workflow/bake/sequence/sequence_deltas.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/fits/end_delta.h"
#include "core/blocks.h"
#include "core/float32.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 256;

}  // namespace

// With N = n_0 / |n_0|, float32 keeps the directions at other keys only where the normals there are not much smaller;
// and where n_0 = 0 there is no such N.
Result<std::vector<SequenceElement>> sequence_elements(const SequenceNormals& normals) {
  constexpr double kMuchSmaller = 0x1p-10, kMuchLarger = 0x1p40, kWidest = 0x1p-60;
  struct Sizes {
    double at_key_0 = 0, smallest = std::numeric_limits<double>::infinity(), largest = 0;  // over the segments
  };
  std::vector<SequenceElement> elements(normals.elements());
  std::vector<Sizes> sizes(normals.elements());
  const Status status = each_segment(normals, [&](std::size_t s, const SegmentForm& form) -> Status {
    parallel_each(elements.size(), kBlock, [&](std::size_t e) {
      const ControlNormals n = form.control_normals(e);
      if (elements[e].has_none) {
        elements[e].normal = rounded_to_float(unit_normal_at(n, 0).vector);
        elements[e].has_none = elements[e].normal == Vec3d{};
      }
      const double size = std::max({length(n.n0), length(n.m), length(n.n1)});
      if (s == 0) sizes[e].at_key_0 = length(n.n0);
      if (size > 0) sizes[e].smallest = std::min(sizes[e].smallest, size);
      sizes[e].largest = std::max(sizes[e].largest, size);
    });
    return Success{};
  });
  if (!status) return status.error();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto& [at_key_0, smallest, largest] = sizes[e];
    if (elements[e].has_none) {
      elements[e].normal = kAnyNormal;
      continue;
    }
    elements[e].frees_base = at_key_0 == 0 || smallest < kMuchSmaller * at_key_0 || largest > kMuchLarger * at_key_0;
    elements[e].scale = elements[e].frees_base ? std::max(smallest, kWidest * largest) : at_key_0;
  }
  return elements;
}

std::vector<Vec3d> key_deltas(std::span<const SequenceElement> elements, std::span<const Vec3d> at_key) {
  // What is left of rounding N would only fill the file.
  constexpr double kNothing = 0x1p-23;
  std::vector<Vec3d> deltas(elements.size());
  parallel_each(elements.size(), kBlock, [&](std::size_t e) {
    const Vec3d delta = (1 / elements[e].scale) * at_key[e] - elements[e].normal;
    if (!elements[e].has_none && !(max_abs(delta) < kNothing)) deltas[e] = delta;
  });
  return deltas;
}

std::vector<Vec3d> bend_deltas(std::span<const SequenceElement> elements, const SegmentForm& form) {
  // A bend that turns nothing by more than 1e-8 rad is none (degree() has the same limit).
  constexpr double kNothing = 0x1p-28;
  std::vector<Vec3d> deltas(elements.size());
  parallel_each(elements.size(), kBlock, [&](std::size_t e) {
    const double size = std::max(max_abs(form.from[e]), max_abs(form.to[e]));
    if (!(max_abs(form.bends[e]) <= kNothing * size)) deltas[e] = (-1 / elements[e].scale) * form.bends[e];
  });
  if (std::all_of(deltas.begin(), deltas.end(), [](const Vec3d& d) { return d == Vec3d{}; })) deltas.clear();
  return deltas;
}

// The direction in a segment depends on the ratio of the lengths at its two keys alone, so that every segment can have
// its own best one: they multiply up.
EndDeltas end_deltas(std::span<const SequenceElement> elements, const SegmentForm& form, std::span<const double> bounds,
                     const std::vector<Vec3d>& before) {
  constexpr double kShortest = 0x1p-10, kLongest = 0x1p16;  // beyond, float32 sums lose digits
  EndDeltas result{before, 0};
  const auto fit = [&](std::size_t e, double& error) {
    const ControlNormals n = form.control_normals(e);
    const Vec3d direction = unit_normal_at(n, 1).vector;
    const Vec3d start = elements[e].normal + before[e];
    if (direction != Vec3d{}) {
      const double size = std::clamp(length(start) * best_end_delta(n).scale, kShortest, kLongest);
      result.deltas[e] = rounded_to_float(size * direction - elements[e].normal);
    }
    const double bound = bounds.empty() ? 0 : bounds[e];
    error = std::max(error, largest_line_error(n, start, elements[e].normal + result.deltas[e]) + bound);
  };
  result.error =
      parallel_fold<double>(elements.size(), kBlock, fit, [](double& all, double each) { all = std::max(all, each); });
  return result;
}

}  // namespace chronormal::inline internal

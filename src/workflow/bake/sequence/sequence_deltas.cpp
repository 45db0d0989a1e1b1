// Computes base normals and deltas of a sequence.
#include "workflow/bake/sequence/sequence_deltas.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/fits/end_delta.h"
#include "core/blocks.h"
#include "core/float32.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 256;

// Limits for the length of an element's normals, relative to its normal at key 0. If a normal is beyond these limits,
// the normal at key 0 cannot be the base normal.
constexpr double kMuchSmaller = 0x1p-10, kMuchLarger = 0x1p40;

// The lengths of the control normals of an element: the length at key 0, and the smallest and the largest length over
// all segments.
struct Sizes {
  double at_key_0 = 0, smallest = std::numeric_limits<double>::infinity(), largest = 0;
};

double size_of(const ControlNormals& n) { return std::max({length(n.n0), length(n.m), length(n.n1)}); }

void look_at(const ControlNormals& n, bool is_first, SequenceElement& element, Sizes& sizes) {
  if (element.has_none) {
    element.normal = rounded_to_float(unit_normal_at(n, 0).vector);
    element.has_none = element.normal == Vec3d{};
  }
  const double size = size_of(n);
  if (is_first) sizes.at_key_0 = length(n.n0);
  if (size > 0) sizes.smallest = std::min(sizes.smallest, size);
  sizes.largest = std::max(sizes.largest, size);
}

// Decides the base normal N of an element. Usually N = n_0 / |n_0|, where n_0 is the normal at key 0. Another N is used
// if n_0 = 0, or if normals at other keys are much shorter (kMuchSmaller) or longer (kMuchLarger) than n_0. For
// example, the directions of much shorter normals would be lost in float32.
void settle(const Sizes& sizes, SequenceElement& element) {
  constexpr double kWidest = 0x1p-60;
  const auto& [at_key_0, smallest, largest] = sizes;
  if (element.has_none) {
    element.normal = kAnyNormal;
    return;
  }
  element.frees_base = at_key_0 == 0 || smallest < kMuchSmaller * at_key_0 || largest > kMuchLarger * at_key_0;
  element.scale = element.frees_base ? std::max(smallest, kWidest * largest) : at_key_0;
}

// Returns true if a segment needs no other base normal than settle() found for an element from the segments before.
bool is_as_supposed(const SequenceElement& element, const ControlNormals& n) {
  if (element.has_none) return rounded_to_float(unit_normal_at(n, 0).vector) == Vec3d{};
  if (element.frees_base) return false;
  // The length of a vector is at least its largest component, and less than twice this component.
  const double largest = std::max({max_abs(n.n0), max_abs(n.m), max_abs(n.n1)});
  if (largest >= kMuchSmaller * element.scale && 2 * largest <= kMuchLarger * element.scale) return true;
  const double size = size_of(n);
  return size == 0 || !(size < kMuchSmaller * element.scale || size > kMuchLarger * element.scale);
}

Vec3d key_delta(const SequenceElement& element, const Vec3d& at_key) {
  // Drops a delta that is only the rounding error of the base normal, because it would needlessly make the file larger.
  constexpr double kNothing = 0x1p-23;
  const Vec3d delta = (1 / element.scale) * at_key - element.normal;
  return !element.has_none && !(max_abs(delta) < kNothing) ? delta : Vec3d{};
}

Vec3d bend_delta(const SequenceElement& element, const Vec3d& from, const Vec3d& to, const Vec3d& bend) {
  // Drops a bend that turns no normal by more than 1e-8 rad. degree() (normals/control) has the same limit.
  constexpr double kNothing = 0x1p-28;
  const double size = std::max(max_abs(from), max_abs(to));
  return !(max_abs(bend) <= kNothing * size) ? (-1 / element.scale) * bend : Vec3d{};
}

VectorView<float> view_of(std::vector<float>& values) {
  return VectorView<float>::packed(values.data(), values.size() / 3);
}

// Returns the base normals and the scales of all elements, computed from the first `segments` segments alone.
Result<std::vector<SequenceElement>> elements_of(const SequenceNormals& normals, std::size_t segments) {
  std::vector<SequenceElement> elements(normals.elements());
  std::vector<Sizes> sizes(normals.elements());
  const Status status = each_segment(normals, segments, [&](std::size_t s, const SegmentForm& form) -> Status {
    parallel_each(elements.size(), kBlock,
                  [&](std::size_t e) { look_at(form.control_normals(e), s == 0, elements[e], sizes[e]); });
    return Success{};
  });
  if (!status) return status.error();
  parallel_each(elements.size(), kBlock, [&](std::size_t e) { settle(sizes[e], elements[e]); });
  return elements;
}

}  // namespace

Result<std::vector<SequenceElement>> sequence_elements(const SequenceNormals& normals) {
  return elements_of(normals, normals.keys() - 1);
}

Result<std::vector<SequenceElement>> elements_of_start(const SequenceNormals& normals) {
  const std::size_t segments = std::min<std::size_t>(normals.keys() - 1, 1);
  if (const Status status = normals.check_deltas(segments + 1); !status) return status.error();
  return elements_of(normals, segments);
}

Result<bool> each_exact_segment(const SequenceNormals& normals, std::span<const SequenceElement> elements,
                                bool are_final,
                                const std::function<Status(std::size_t segment, const ExactSegment& values)>& body) {
  ExactSegment values;
  values.key.resize(3 * elements.size());
  values.bend.resize(3 * elements.size());
  std::vector<Vec3d> at_key;
  SequenceNormals::Rows rows;
  for (std::size_t s = 0; s + 1 < normals.keys(); ++s) {
    if (const Status status = normals.hold(s, s + 1); !status) return status.error();
    normals.deltas(s + 1, values.positions);
    if (const Status status = SequenceNormals::check_deltas(s + 1, values.positions); !status) return status.error();
    values.start.clear();
    if (s == 0) {
      at_key = normals.at_key(0);
      values.start.resize(3 * elements.size());
      const VectorView<float> start = view_of(values.start);
      parallel_each(elements.size(), kBlock,
                    [&](std::size_t e) { start.set(e, to_float(key_delta(elements[e], at_key[e]))); });
    }
    std::atomic<bool> bends = false, as_supposed = true;
    normals.each_block(s, rows, [&](IndexRange some, std::span<const Vec3d> of_key, std::span<const Vec3d> of_bend) {
      const VectorView<float> key = view_of(values.key), bend = view_of(values.bend);
      bool block_bends = false, block_as_supposed = true;
      for (std::size_t e = some.first; e < some.end(); ++e) {
        const SequenceElement& element = elements[e];
        const Vec3d from = at_key[e], to = of_key[e - some.first], d = of_bend[e - some.first];
        at_key[e] = to;
        const Vec3d of_segment = bend_delta(element, from, to, d);
        block_as_supposed = block_as_supposed && is_as_supposed(element, control_normals_of(from, to, d));
        block_bends = block_bends || !(of_segment == Vec3d{});
        key.set(e, to_float(key_delta(element, to)));
        bend.set(e, to_float(of_segment));
      }
      if (block_bends) bends = true;
      if (!block_as_supposed) as_supposed = false;
    });
    if (!are_final && !as_supposed) return false;
    values.bends = bends;
    if (const Status status = body(s, values); !status) return status.error();
  }
  return true;
}

// Finds the deltas of a key with the smallest error in the segment before the key. The directions in a segment depend
// only on the ratio of the lengths at its two keys. For this reason every segment can have the best ratio, and the
// lengths at keys are products of ratios.
EndDeltas end_deltas(std::span<const SequenceElement> elements, const SegmentForm& form, std::span<const double> bounds,
                     const std::vector<Vec3d>& before) {
  // The smallest and the largest length of N plus the delta of a key. Beyond these lengths, sums in float32 lose
  // digits.
  constexpr double kShortest = 0x1p-10, kLongest = 0x1p16;
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

#include "workflow/bake/sequence/sequence_normals.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "chronormal/normals/weighting.h"
#include "core/bits.h"
#include "core/blocks.h"
#include "normals/control/shared_faces.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kVertexBlock = 8192;  // the number of vertices that one task handles

// Writes three coordinates for each vertex into `rows`. coordinate_at(i) returns coordinate i of all vertices: x, y, z
// of the first vertex, then those of the second, and so on.
template <class CoordinateAt>
void write_rows(std::size_t vertices, PointRows& rows, const CoordinateAt& coordinate_at) {
  constexpr std::size_t kRow = 4;
  if (rows.size() != kRow * vertices) rows = PointRows(kRow * vertices);
  double* const to = rows.data();
  parallel_each(vertices, kVertexBlock, [=, &coordinate_at](std::size_t v) {
    for (std::size_t k = 0; k < 3; ++k) to[kRow * v + k] = coordinate_at(3 * v + k);
    to[kRow * v + 3] = 0;
  });
}

float delta_of(float position, float base) { return position - base; }

bool is_far(float delta) {
  constexpr std::uint32_t kExponent = 0x7F800000;
  return (bit_cast<std::uint32_t>(delta) & kExponent) == kExponent;
}

}  // namespace

Result<SequenceNormals> SequenceNormals::make(MotionStream& stream, const NormalGroups& groups, Weighting weighting,
                                              VectorView<const float> stored) {
  SequenceNormals normals(stream, groups);
  if (const Status status = normals.hold(0, 0); !status) return status.error();
  normals.base_ = normals.motion().keyframes[0].positions;
  if (weighting != Weighting::kArea) {
    if (const Status status = normals.check_deltas(normals.keys()); !status) return status.error();
    if (const Status status = normals.fit(weighting); !status) return status.error();
  }
  if (const Status status = normals.hold(0, 0); !status) return status.error();
  normals.find_offsets(stored);
  return normals;
}

Status SequenceNormals::check_deltas(std::size_t keys) const {
  std::vector<float> of_key;
  for (std::size_t k = 1; k < keys; ++k) {
    if (Status status = hold(k, k); !status) return status;
    deltas(k, of_key);
    if (Status status = check_deltas(k, of_key); !status) return status;
  }
  return Success{};
}

Status SequenceNormals::check_deltas(std::size_t key, std::span<const float> deltas) {
  constexpr std::size_t kTogether = 4096;  // the number of deltas that a loop without branches checks together
  for (std::size_t first = 0; first < deltas.size(); first += kTogether) {
    const std::span<const float> some = deltas.subspan(first, std::min(kTogether, deltas.size() - first));
    bool any_far = false;
    for (const float delta : some) any_far |= is_far(delta);
    if (!any_far) continue;
    const auto at = static_cast<std::size_t>(std::find_if(some.begin(), some.end(), is_far) - some.begin());
    return invalid_input("keyframe " + std::to_string(key) + ", vertex " + std::to_string((first + at) / 3),
                         "the vertex is so far from its place in keyframe 0 that float32 cannot hold the difference; "
                         "scale the mesh down");
  }
  return Success{};
}

Status SequenceNormals::fit(Weighting weighting) {
  // The tolerance up to which the fits of neighbouring segments agree at their common key, relative to the normal. At
  // both ends of a segment, every fit has the length of the normal weighted by area.
  constexpr double kSame = 1e-6;
  for (std::size_t s = 0; s + 1 < keys(); ++s) {
    if (Status status = hold(s, s + 1); !status) return status;
    WeightingFit fit = fit_weighting(motion().segment(s), *groups_, weighting);
    std::vector<Vec3d> from(elements()), to(elements()), bends(elements());
    for (std::size_t e = 0; e < elements(); ++e) {
      const ControlNormals& n = fit.normals[e];
      from[e] = n.n0;
      to[e] = n.n1;
      bends[e] = (n.n0 - n.m) + (n.n1 - n.m);
      if (s > 0 && length(from[e] - fitted_keys_[s][e]) > kSame * std::max(length(from[e]), length(fitted_keys_[s][e])))
        return Error{ErrorCode::kUsage, "keyframe " + std::to_string(s) + ", element " + std::to_string(e),
                     "a face has no area, so the normal weighted by " + std::string(weighting_name(weighting)) +
                         " jumps; use --weighting area"};
    }
    if (s == 0) fitted_keys_.push_back(std::move(from));
    fitted_keys_.push_back(std::move(to));
    fitted_bends_.push_back(std::move(bends));
    bounds_.push_back(std::move(fit.bounds));
  }
  return Success{};
}

std::vector<float> SequenceNormals::deltas(std::size_t key) const {
  std::vector<float> result;
  deltas(key, result);
  return result;
}

void SequenceNormals::deltas(std::size_t key, std::vector<float>& result) const {
  const std::vector<float>& positions = motion().keyframes[key].positions;
  assert(positions.size() == base_.size());
  result.resize(base_.size());
  parallel_each(result.size(), 3 * kVertexBlock, [&](std::size_t i) { result[i] = delta_of(positions[i], base_[i]); });
}

void SequenceNormals::write_positions(std::size_t key, PointRows& rows) const {
  const float *const positions = motion().keyframes[key].positions.data(), *const base = base_.data();
  write_rows(base_.size() / 3, rows,
             [=](std::size_t i) { return double{delta_of(positions[i], base[i])} + double{base[i]}; });
}

void SequenceNormals::write_displacements(std::size_t segment, PointRows& rows) const {
  const float *const from = motion().keyframes[segment].positions.data(),
                     *const to = motion().keyframes[segment + 1].positions.data(), *const base = base_.data();
  write_rows(base_.size() / 3, rows,
             [=](std::size_t i) { return double{delta_of(to[i], base[i])} - double{delta_of(from[i], base[i])}; });
}

namespace {

// Returns a function that computes exact sums of the areas at the points a + b, in integers. The arrays a and b are
// made by make_a and make_b when they are first needed. At t = 1/2 of a segment from a to b, the points are half of a +
// b, so the areas are a fourth of these sums.
template <class MakeA, class MakeB>
AreaSums::Exact exact_sums(const Topology& topology, const NormalGroups& groups, const MakeA& make_a,
                           const MakeB& make_b) {
  struct Points {
    std::once_flag made;
    std::vector<float> a, b;
    std::optional<SharedFaces> faces;
  };
  return [&topology, &groups, make_a, make_b, points = std::make_shared<Points>()](std::size_t element) {
    std::call_once(points->made, [&] {
      points->a = make_a();
      points->b = make_b();
      const auto view = [](const std::vector<float>& p) { return VectorView<const float>::packed(std::span(p)); };
      points->faces.emplace(Segment{&topology, view(points->a), view(points->b)});
    });
    return 4.0 * points->faces->exact_sum(groups.faces(element)).normal_at(0.5);
  };
}

// Returns the deltas of a keyframe, multiplied by sign, which is 1 or -1. Computes them on the calling thread.
std::vector<float> signed_deltas(std::span<const float> positions, std::span<const float> base, float sign) {
  std::vector<float> result(base.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = sign * delta_of(positions[i], base[i]);
  return result;
}

}  // namespace

AreaSums::Exact SequenceNormals::exact_at_key(std::size_t key) const {
  return exact_sums(
      motion().topology, *groups_, [this] { return base_; },
      [this, key] { return signed_deltas(motion().keyframes[key].positions, base_, 1); });
}

AreaSums::Exact SequenceNormals::exact_bend(std::size_t segment) const {
  const auto deltas = [this](std::size_t key, float sign) {
    return signed_deltas(motion().keyframes[key].positions, base_, sign);
  };
  return exact_sums(
      motion().topology, *groups_, [=] { return deltas(segment + 1, 1); }, [=] { return deltas(segment, -1); });
}

std::vector<Vec3d> SequenceNormals::vector_areas(const PointRows& points, const AreaSums::Exact& exact) const {
  std::vector<Vec3d> result(elements());
  sums_.each_block(points, nullptr, exact, {},
                   [&](IndexRange elements, std::span<const Vec3d> sums, std::span<const Vec3d>) {
                     std::copy(sums.begin(), sums.end(), result.begin() + static_cast<std::ptrdiff_t>(elements.first));
                   });
  return result;
}

std::vector<Vec3d> SequenceNormals::computed_at_key(std::size_t key) const {
  if (!fitted_keys_.empty()) return fitted_keys_[key];
  PointRows positions;
  write_positions(key, positions);
  return vector_areas(positions, exact_at_key(key));
}

// Computes the bend d of each element in a segment: the sum of the cross products de x df. The bend is twice the vector
// area of the polygon whose corners are the displacements of the corners.
std::vector<Vec3d> SequenceNormals::computed_bends(std::size_t segment) const {
  if (!fitted_bends_.empty()) return fitted_bends_[segment];
  PointRows displacements;
  write_displacements(segment, displacements);
  return vector_areas(displacements, exact_bend(segment));
}

void SequenceNormals::each_computed_block(std::size_t segment, Rows& rows, const AreaSums::Body& body) const {
  if (!fitted_keys_.empty()) {
    const std::span<const Vec3d> n = fitted_keys_[segment + 1], d = fitted_bends_[segment];
    return parallel_blocks(elements(), kVertexBlock, [&](IndexRange some) {
      body(some, n.subspan(some.first, some.count), d.subspan(some.first, some.count));
    });
  }
  write_positions(segment + 1, rows.positions);
  write_displacements(segment, rows.displacements);
  sums_.each_block(rows.positions, &rows.displacements, exact_at_key(segment + 1), exact_bend(segment), body);
}

void SequenceNormals::find_offsets(VectorView<const float> stored) {
  constexpr double kNone = 1e-4;  // radians; a stored normal so near to the geometry's normal counts as equal
  if (stored.count == 0) return;
  const std::vector<Vec3d> n = computed_at_key(0);
  std::vector<ShownTurn> turns(n.size());
  bool any = false;
  for (std::size_t e = 0; e < n.size(); ++e) {
    const auto corners = groups_->corners(e);
    if (corners.empty()) continue;
    const Vec3d shown = to_double(stored[corners[0]]);
    if (n[e] == Vec3d{} || shown == Vec3d{} || angle_between(n[e], shown) <= kNone) continue;
    turns[e] = ShownTurn(shown, n[e]);
    any = true;
  }
  if (any) turns_ = std::move(turns);
}

void SequenceNormals::add_offsets(std::size_t first_element, std::span<Vec3d> vectors) const {
  for (std::size_t i = 0; has_offsets() && i < vectors.size(); ++i) vectors[i] = turns_[first_element + i](vectors[i]);
}

std::vector<Vec3d> SequenceNormals::at_key(std::size_t key) const {
  std::vector<Vec3d> n = computed_at_key(key);
  add_offsets(0, n);
  return n;
}

std::vector<Vec3d> SequenceNormals::bends(std::size_t segment) const {
  std::vector<Vec3d> d = computed_bends(segment);
  add_offsets(0, d);
  return d;
}

void SequenceNormals::each_block(std::size_t segment, Rows& rows, const AreaSums::Body& body) const {
  if (!has_offsets()) return each_computed_block(segment, rows, body);
  each_computed_block(segment, rows, [&](IndexRange some, std::span<const Vec3d> n, std::span<const Vec3d> d) {
    std::vector<Vec3d> at_key(n.begin(), n.end()), bend(d.begin(), d.end());
    add_offsets(some.first, at_key);
    add_offsets(some.first, bend);
    body(some, at_key, bend);
  });
}

}  // namespace chronormal::inline internal

// Blends positions and stored normals of a mesh by its weights, as a viewer does.
#include "workflow/audit/blend_source.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/quality/kernels/shown_angles.h"
#include "core/blocks.h"
#include "workflow/audit/measure.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 2048;
// The smallest number of morph targets for which adding up all deltas takes longer than interpolating between the
// positions at both ends of a segment.
constexpr std::ptrdiff_t kManyTargets = 8;

}  // namespace

AuditPlace place_of(const GltfShading& shading, std::size_t vertex) {
  const auto after = std::upper_bound(shading.parts.begin(), shading.parts.end(), vertex,
                                      [](std::size_t v, const GltfPart& part) { return v < part.first_vertex; });
  const GltfPart& part = *(after - 1);
  return {part.mesh, part.primitive, vertex - part.first_vertex, 0, 0};
}

BlendSource::BlendSource(const GltfShading& shading, const AuthorTruth& truth, const JudgedPart& part, AuditRule rule,
                         std::vector<std::size_t> involved, Weights weights, Moment moment, std::size_t samples,
                         MeshSkin* skin, std::size_t segments)
    : shading_(shading),
      truth_(truth),
      part_(part),
      rule_(rule),
      involved_(std::move(involved)),
      weights_at_(std::move(weights)),
      moment_(std::move(moment)),
      skin_(skin),
      moved_(involved_.size()),
      samples_(samples),
      segments_(segments),
      sums_(shading, part.outputs(), involved_) {
  std::vector<Vec3d> positions(part.vertices().size());
  place_base(positions);
  PartNormals normals;
  part.normals(positions, normals);
  turn_at(std::vector<double>(involved_.size()), positions, normals.elements);
  turns_.resize(part.outputs().size());
  parallel_each(turns_.size(), kBlock, [&](std::size_t i) {
    const JudgedOutput& output = part.outputs()[i];
    turns_[i] = ShownTurn(to_double(vector_at(shading.normals, output.vertex)), normals.elements[output.element]);
  });
}

bool BlendSource::place(std::size_t segment, double t, std::span<Vec3d> positions) {
  if (rule_ != AuditRule::kGltf) {
    start_ = weights(segment, 0);
    end_ = weights(segment, 1);
  }
  std::vector<double> now = weights(segment, t);
  const bool turns = skin_ != nullptr && skin_->pose(moment_(segment, t), t == 1 && segment + 1 < segments_);
  const bool same = known_ && !turns && now == now_ && (rule_ == AuditRule::kGltf || start_ == end_);
  known_ = true;
  segment_ = segment;
  t_ = t;
  if (same) return false;
  ++placed_;
  now_ = std::move(now);
  const auto active = std::count_if(now_.begin(), now_.end(), [](double weight) { return weight != 0; });
  if (active < kManyTargets) {
    place_at(now_, positions);
    return true;
  }
  if (!ends_ || ends_->segment != segment) place_ends(segment);
  if (t == 0 || t == 1) {
    std::copy_n(t == 0 ? ends_->from.begin() : ends_->to.begin(), positions.size(), positions.begin());
  } else if (is_between_ends(t)) {
    parallel_each(positions.size(), kBlock,
                  [&](std::size_t i) { positions[i] = ends_->from[i] + t * (ends_->to[i] - ends_->from[i]); });
  } else {
    place_at(now_, positions);
  }
  return true;
}

// Computes the positions at both ends of a segment. If the segment starts at the end of the last segment, reuses the
// positions of that end.
void BlendSource::place_ends(std::size_t segment) {
  if (!ends_) ends_ = SegmentEnds{};
  std::vector<double> start = weights(segment, 0), end = weights(segment, 1);
  const std::size_t count = part_.vertices().size();
  const bool goes_on = ends_->to.size() == count && ends_->end == start;
  if (goes_on) {
    std::swap(ends_->from, ends_->to);
  } else {
    ends_->from.resize(count);
    place_at(start, ends_->from);
  }
  ends_->to.resize(count);
  place_at(end, ends_->to);
  ends_->segment = segment;
  ends_->start = std::move(start);
  ends_->end = std::move(end);
}

// Returns true if the current weights lie on the straight line between the weights at both ends, up to rounding errors.
bool BlendSource::is_between_ends(double t) const {
  constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
  for (std::size_t k = 0; k < now_.size(); ++k) {
    const double from = ends_->start[k], to = ends_->end[k];
    const double off = std::fabs(now_[k] - ((1 - t) * from + t * to));
    if (!(off <= kRounding * std::fmax(std::fabs(from), std::fabs(to)))) return false;
  }
  return true;
}

void BlendSource::turn_at(std::span<const double> weights, std::span<const Vec3d> positions,
                          std::span<Vec3d> normals) const {
  if (truth_.offset_count() == 0) return;
  std::vector<double> all(shading_.set.targets.size());
  for (std::size_t i = 0; i < involved_.size(); ++i) all[involved_[i]] = weights[i];
  const AuthorTruth::Pose pose = truth_.pose(all);
  parallel_each(normals.size(), kBlock, [&](std::size_t e) {
    const auto position = [&](std::uint32_t v) { return positions[part_.place_of(v)]; };
    normals[e] = truth_.with_offset(part_.elements()[e], normals[e], position, pose);
  });
}

void BlendSource::show() {
  if (rule_ == AuditRule::kGltf) {
    if (sums_.find(now_).empty()) sums_.add_up(now_and_next());
    shown_now_ = sums_.find(now_);
  } else if (rule_ != AuditRule::kFlat) {
    if (sums_.find(start_).empty() || sums_.find(end_).empty()) sums_.add_up({start_, end_});
    shown_start_ = sums_.find(start_);
    shown_end_ = sums_.find(end_);
  }
  if (skin_ == nullptr) return;
  carriers_.resize(part_.outputs().size());
  parallel_each(carriers_.size(), kBlock,
                [&](std::size_t i) { carriers_[i] = skin_->of_vertex(part_.outputs()[i].vertex); });
}

Vec3d BlendSource::seen(std::size_t i, const Vec3d& normal, SkinRule rule) const noexcept {
  return skin_ == nullptr ? normal : skin_->carried(rule, part_.outputs()[i].vertex, carriers_[i], normal);
}

bool BlendSource::hides(const JudgedOutput& output, const Vec3d& normal, SkinRule rule) const {
  if (skin_ == nullptr) return false;
  Vec3d is_seen = normal;
  right(number(output), std::span(&is_seen, 1), rule);
  return is_seen == Vec3d{} || !is_finite(is_seen);
}

void BlendSource::place_at(std::span<const double> weights, std::span<Vec3d> positions) {
  place_base(positions);
  std::vector<std::size_t> active;
  for (std::size_t k = 0; k < weights.size(); ++k)
    if (weights[k] != 0 && !moved(k).empty()) active.push_back(k);
  parallel_blocks(positions.size(), kBlock, [&](IndexRange range) {
    const std::size_t end = range.first + range.count;
    for (const std::size_t k : active) {
      const std::vector<Delta>& deltas = *moved_[k];
      auto at = std::lower_bound(deltas.begin(), deltas.end(), range.first,
                                 [](const Delta& delta, std::size_t vertex) { return delta.first < vertex; });
      for (; at != deltas.end() && at->first < end; ++at)
        positions[at->first] = positions[at->first] + weights[k] * to_double(at->second);
    }
  });
}

void BlendSource::shown(std::size_t first, std::span<Vec3d> normals) const {
  for (std::size_t k = 0; k < normals.size(); ++k) {
    const std::size_t i = first + k;
    if (rule_ == AuditRule::kGltf)
      normals[k] = to_double(vector_at(shown_now_, i));
    else
      normals[k] = to_double(
          blend_stored(rule_, to_double(vector_at(shown_start_, i)), to_double(vector_at(shown_end_, i)), t_));
  }
  if (rule_ == AuditRule::kGltf) {
    if (skin_ == nullptr) return make_rounded_units(normals);
    make_units(normals);
  }
  for (std::size_t k = 0; k < normals.size(); ++k) normals[k] = to_double(to_float(seen(first + k, normals[k])));
}

void BlendSource::right(std::size_t first, std::span<Vec3d> normals, SkinRule rule) const {
  make_units(normals);
  for (std::size_t k = 0; k < normals.size(); ++k) normals[k] = seen(first + k, turns_[first + k](normals[k]), rule);
}

std::size_t BlendSource::number(const JudgedOutput& output) const {
  return static_cast<std::size_t>(&output - part_.outputs().data());
}

AuditPlace BlendSource::at(std::size_t segment, double t, const JudgedOutput& output) const {
  AuditPlace place = place_of(shading_, output.vertex);
  place.segment = segment;
  place.at = moment_(segment, t);
  return place;
}

std::vector<double> BlendSource::weights(std::size_t segment, double t) const {
  std::vector<double> result(involved_.size());
  weights_at_(segment, t, result);
  return result;
}

void BlendSource::place_base(std::span<Vec3d> positions) const {
  const auto vertices = part_.vertices();
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] = to_double(vector_at(shading_.set.base, vertices[i]));
}

// Returns the deltas of the k-th involved target. Each delta names its vertex by the index of the vertex in the part.
const std::vector<BlendSource::Delta>& BlendSource::moved(std::size_t k) {
  if (moved_[k]) return *moved_[k];
  std::vector<Delta>& result = moved_[k].emplace();
  const BlendTarget& target = shading_.set.targets[involved_[k]];
  const auto vertices = part_.vertices();
  result.reserve(std::min(vertices.size(), target.vertices.size()));
  for (std::size_t i = 0, n = 0; i < vertices.size() && n < target.vertices.size();) {
    if (vertices[i] == target.vertices[n])
      result.emplace_back(static_cast<std::uint32_t>(i), vector_at(target.deltas, n));
    if (vertices[i] <= target.vertices[n])
      ++i;
    else
      ++n;
  }
  return result;
}

// Returns the weights of the current sample, followed by the weights of the next samples in the same segment.
std::vector<std::vector<double>> BlendSource::now_and_next() const {
  std::vector<std::vector<double>> result = {now_};
  // Finds the index of the first sample after t_. There may be a million samples, and they are evenly spaced, so no
  // sample after t_ has an index below t_ times the number of samples.
  auto i = static_cast<std::size_t>(t_ * static_cast<double>(samples_));
  while (i < samples_ && time_of_sample(i, samples_) <= t_) ++i;
  for (; i < samples_ && result.size() < StoredSums::kAtOnce; ++i)
    result.push_back(weights(segment_, time_of_sample(i, samples_)));
  return result;
}

JudgedPart judged_part(const GltfShading& shading, const AuthorTruth& truth, std::vector<JudgedOutput> outputs,
                       AuditRule rule) {
  return {shading.set.topology, shading.groups,           truth.rule().weighting,
          std::move(outputs),   rule == AuditRule::kFlat, truth.is_plain() ? nullptr : &truth.sums()};
}

namespace {

// Returns true if the face with this first corner can have an area. A face with two corners at one place has no area in
// any pose, so no viewer draws it, and the normal of a vertex without any other face does not matter.
bool is_drawn(const GltfShading& shading, std::size_t first_corner) {
  const auto corners = shading.set.topology.corners().subspan(first_corner, 3);
  const std::uint32_t a = shading.place_of(corners[0]), b = shading.place_of(corners[1]),
                      c = shading.place_of(corners[2]);
  return a != b && b != c && c != a;
}

}  // namespace

std::vector<JudgedOutput> moving_outputs(const GltfShading& shading, const AuthorTruth& truth,
                                         std::span<const std::size_t> involved, AuditRule rule) {
  const Topology& topology = shading.set.topology;
  std::vector<bool> moves(topology.vertex_count()), element_moves(shading.groups.size()),
      has_drawn_face(topology.vertex_count());
  for (const std::size_t k : involved)
    for (const std::uint32_t v : shading.set.targets[k].vertices) moves[v] = true;
  const auto corners = topology.corners();
  const auto element_of_vertex = shading.groups.element_of_output();
  for (std::size_t first = 0; first < corners.size(); first += 3) {
    if (!is_drawn(shading, first)) continue;
    const auto face = corners.subspan(first, 3);
    const bool is_moved = std::any_of(face.begin(), face.end(), [&](std::uint32_t v) { return moves[v]; });
    for (const std::uint32_t v : face) {
      has_drawn_face[v] = true;
      if (is_moved) element_moves[element_of_vertex[v]] = true;
    }
  }
  if (!truth.is_plain()) {
    for (const std::size_t k : involved)
      for (const std::uint32_t e : truth.elements_of(k)) element_moves[e] = true;
  }
  const auto is_judged = [&](std::uint32_t v) {
    const std::uint32_t e = shading.element_of_vertex[v];
    if (e == GltfShading::kNoElement || !has_drawn_face[v]) return false;
    if (element_moves[e]) return true;
    return std::any_of(involved.begin(), involved.end(), [&](std::size_t k) {
      return !shading.normal_deltas[k].empty() && vector_at(shading.normal_deltas[k], v) != Vec3f{};
    });
  };
  std::vector<JudgedOutput> outputs;
  if (rule == AuditRule::kFlat) {
    for (std::uint32_t c = 0; c < corners.size(); ++c)
      if (is_judged(corners[c])) outputs.push_back({corners[c], element_of_vertex[corners[c]], c / 3, c});
    return outputs;
  }
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < shading.element_of_vertex.size(); ++v) count += is_judged(v) ? 1U : 0U;
  outputs.reserve(count);
  for (std::uint32_t v = 0; v < shading.element_of_vertex.size(); ++v) {
    if (!is_judged(v)) continue;
    const std::uint32_t e = shading.element_of_vertex[v];
    outputs.push_back({v, e, shading.groups.faces(e)[0], 0});
  }
  return outputs;
}

}  // namespace chronormal::inline internal

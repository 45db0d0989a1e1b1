// Makes the part of a motion that does not come from a glTF file. The part has the keyframes, their stored normals, and
// the segments between keyframes.
#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <utility>

#include "chronormal/core/views.h"
#include "workflow/audit/watched_audit.h"
#include "workflow/report/report_parts.h"

namespace chronormal::inline internal {
namespace {

const float* stored_at(const StoredNormals& normals, std::size_t keyframe, std::size_t corner) {
  return normals.of_keyframes[keyframe].data() + 3 * corner;
}

// Returns true if two corners have the same stored normals at every keyframe, or if some keyframe has no stored
// normals.
bool same_normals(const Motion& motion, const StoredNormals& normals, std::size_t a, std::size_t b) {
  if (normals.of_keyframes.size() != motion.keyframes.size()) return true;
  for (std::size_t k = 0; k < normals.of_keyframes.size(); ++k) {
    const float* const first = stored_at(normals, k, a);
    if (!std::equal(first, first + 3, stored_at(normals, k, b))) return false;
  }
  return true;
}

// Returns the vectors that differ from those of keyframe 0, with their vertices. Returns all vectors if this takes
// fewer bytes.
ModelVectors changes(const std::vector<float>& first, std::vector<float> now) {
  ModelVectors result;
  const std::size_t vertices = now.size() / 3;
  for (std::size_t v = 0; v < vertices; ++v) {
    if (std::equal(&now[3 * v], &now[3 * v] + 3, &first[3 * v])) continue;
    result.vertices.push_back(static_cast<std::uint32_t>(v));
    result.values.insert(result.values.end(), &now[3 * v], &now[3 * v] + 3);
  }
  // Compares the bytes of both forms: a vector with the index of its vertex takes 16 bytes, and a vector without this
  // index 12 bytes.
  result.is_dense = 4 * result.vertices.size() > 3 * vertices;
  if (result.is_dense) result = {true, {}, std::move(now)};
  return result;
}

void add_keyframes(const Motion& motion, const StoredNormals& normals, const MotionVertices& vertices,
                   ModelPart& part) {
  const bool has_normals = normals.of_keyframes.size() == motion.keyframes.size();
  std::vector<float> first_positions, first_normals;
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    std::vector<float> positions, stored;
    for (std::size_t v = 0; v < vertices.labels.size(); ++v) {
      const float* const p = &motion.keyframes[k].positions[3 * std::size_t{vertices.labels[v]}];
      positions.insert(positions.end(), p, p + 3);
      if (!has_normals) continue;
      const float* const n = stored_at(normals, k, vertices.corners[v]);
      stored.insert(stored.end(), n, n + 3);
    }
    if (k == 0) {
      first_positions = positions;
      first_normals = stored;
      part.keyframe_positions.push_back({true, {}, std::move(positions)});
      if (has_normals) part.keyframe_normals.push_back({true, {}, std::move(stored)});
    } else {
      part.keyframe_positions.push_back(changes(first_positions, std::move(positions)));
      if (has_normals) part.keyframe_normals.push_back(changes(first_normals, std::move(stored)));
    }
    part.times.push_back(motion.keyframes[k].time);
    part.keyframe_numbers.push_back(k);
  }
  for (const Motion::SegmentKeys& keys : motion.segments) {
    part.segments.push_back(static_cast<std::uint32_t>(keys.from));
    part.segments.push_back(static_cast<std::uint32_t>(keys.to));
  }
  part.positions = std::move(first_positions);
}

void add_schemes(const Comparison& comparison, ModelMotion& motion) {
  const std::size_t samples = comparison.samples;
  for (const SchemeComparison& row : comparison.schemes) {
    ModelMotion::Scheme& scheme = motion.schemes.emplace_back();
    scheme.name = row.scheme;
    for (std::size_t i = 0; i < motion.at.size(); ++i) {
      // In the comparison, sample i of the audit is sample i % samples of its segment, because an audit judges segment
      // after segment.
      const Quality& quality = row.samples[motion.segments[i] * samples + i % samples];
      scheme.worst.push_back(static_cast<float>(quality.max * kDegreesPerRadian));
      scheme.mean.push_back(static_cast<float>(quality.mean() * kDegreesPerRadian));
    }
  }
}

}  // namespace

Result<MotionVertices> motion_vertices(const Motion& motion, const StoredNormals& normals) {
  constexpr bool kWeld = true;
  MotionStream stream(motion);
  const Result<NormalGroups> groups = audited_groups(stream, normals, kWeld);
  if (!groups) return groups.error();
  const std::span<const std::uint32_t> corners = motion.topology.corners();
  struct Shown {
    std::uint32_t vertex = 0, element = 0, corner = 0;
  };
  std::vector<Shown> shown;
  std::vector<std::uint32_t> shown_by(corners.size());  // for each corner, the first corner that shows the same normal
  for (std::uint32_t e = 0; e < groups.value().size(); ++e) {
    const std::size_t first = shown.size();
    for (const std::uint32_t c : groups.value().corners(e)) {
      const auto known = std::find_if(
          shown.begin() + static_cast<std::ptrdiff_t>(first), shown.end(),
          [&](const Shown& s) { return s.vertex == corners[c] && same_normals(motion, normals, s.corner, c); });
      shown_by[c] = known == shown.end() ? c : known->corner;
      if (known == shown.end()) shown.push_back({corners[c], e, c});
    }
  }
  std::sort(shown.begin(), shown.end(),
            [](const Shown& a, const Shown& b) { return std::tie(a.vertex, a.corner) < std::tie(b.vertex, b.corner); });
  MotionVertices result;
  std::vector<std::uint32_t> number(corners.size());
  for (const Shown& s : shown) {
    number[s.corner] = static_cast<std::uint32_t>(result.labels.size());
    result.labels.push_back(s.vertex);
    result.elements.push_back(s.element);
    result.corners.push_back(s.corner);
  }
  for (const std::uint32_t c : shown_by) result.of_corner.push_back(number[c]);
  result.element_count = groups.value().size();
  return result;
}

ModelPart motion_part(const Motion& motion, const StoredNormals& normals, const MotionVertices& vertices,
                      const Comparison& comparison, WatchedPart watched) {
  ModelPart part;
  part.labels = vertices.labels;
  if (part.labels.size() == motion.topology.vertex_count()) {
    std::vector<std::uint32_t> same(part.labels.size());
    std::iota(same.begin(), same.end(), 0U);
    if (part.labels == same) part.labels.clear();
  }
  part.primitives.push_back({0, 0, vertices.labels.size(), false});
  std::uint32_t corner = 0;
  for (std::uint32_t f = 0; f < motion.topology.face_count(); ++f) {
    const auto corners = static_cast<std::uint32_t>(motion.topology.face(f).size());
    for (std::uint32_t i = 2; i < corners; ++i) {
      for (const std::uint32_t c : {corner, corner + i - 1, corner + i})
        part.triangles.push_back(vertices.of_corner[c]);
      if (!motion.topology.all_triangles()) part.faces.push_back(f);
    }
    corner += corners;
  }
  part.elements = vertices.element_count;
  part.element = vertices.elements;
  part.weighting = watched.motions[0].subject.weighting;
  add_keyframes(motion, normals, vertices, part);
  part.motions = std::move(watched.motions);
  part.peaks = std::move(watched.peaks);
  for (ModelMotion& m : part.motions) add_schemes(comparison, m);
  return part;
}

}  // namespace chronormal::inline internal

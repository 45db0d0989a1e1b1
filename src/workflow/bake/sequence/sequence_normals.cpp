#include "workflow/bake/sequence/sequence_normals.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "chronormal/normals/weighting.h"
#include "core/blocks.h"
#include "core/rounding.h"
#include "core/vector_area.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kTaskBlock = 1024;  // faces or elements that one task takes

// The normal of a polygon, with components that are nothing but the rounding of its products set to zero.
Vec3d polygon_normal(std::span<const std::uint32_t> face, const std::vector<Vec3d>& positions) {
  CrossSum sum;
  const Vec3d a = positions[face[0]];
  const auto edge_to = [&](std::size_t c) { return positions[face[c]] - a; };
  for_fan(face.size(), edge_to, [&sum](const Vec3d& e, const Vec3d& f) { sum.add(e, f); });
  return sum.without_rounding();
}

}  // namespace

Result<SequenceNormals> SequenceNormals::make(MotionStream& stream, const NormalGroups& groups, Weighting weighting) {
  SequenceNormals normals(stream, groups);
  if (const Status status = normals.hold(0, 0); !status) return status.error();
  normals.base_ = normals.motion().keyframes[0].positions;
  for (std::size_t k = 1; k < normals.keys(); ++k) {
    if (const Status status = normals.hold(k, k); !status) return status.error();
    const std::vector<float> deltas = normals.deltas(k);
    const auto far = std::find_if(deltas.begin(), deltas.end(), [](float delta) { return !std::isfinite(delta); });
    if (far != deltas.end())
      return invalid_input("keyframe " + std::to_string(k) + ", vertex " + std::to_string((far - deltas.begin()) / 3),
                           "it is too far from where it was in keyframe 0 for float32");
  }
  if (weighting != Weighting::kArea) {
    if (const Status status = normals.fit(weighting); !status) return status.error();
  }
  return normals;
}

Status SequenceNormals::fit(Weighting weighting) {
  // Fits have the length of the area at both ends, so that neighbours agree but for rounding.
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
                     "the normal by " + std::string(weighting_name(weighting)) +
                         " jumps there, where a face has no area; weight by area"};
    }
    if (s == 0) fitted_keys_.push_back(std::move(from));
    fitted_keys_.push_back(std::move(to));
    fitted_bends_.push_back(std::move(bends));
    bounds_.push_back(std::move(fit.bounds));
  }
  return Success{};
}

std::vector<float> SequenceNormals::deltas(std::size_t key) const {
  const std::vector<float>& positions = motion().keyframes[key].positions;
  assert(positions.size() == base_.size());
  std::vector<float> result(base_.size());
  for (std::size_t i = 0; i < base_.size(); ++i) result[i] = positions[i] - base_[i];
  return result;
}

std::vector<Vec3d> SequenceNormals::moved(std::size_t key) const {
  const std::vector<float> delta = deltas(key);
  std::vector<Vec3d> result(delta.size() / 3);
  for (std::size_t v = 0; v < result.size(); ++v)
    result[v] = {double{delta[3 * v]}, double{delta[3 * v + 1]}, double{delta[3 * v + 2]}};
  return result;
}

std::vector<Vec3d> SequenceNormals::vector_areas(const std::vector<Vec3d>& positions) const {
  const Topology& topology = motion().topology;
  std::vector<Vec3d> faces(topology.face_count()), result(elements());
  parallel_each(faces.size(), kTaskBlock,
                [&](std::size_t f) { faces[f] = polygon_normal(topology.face(f), positions); });
  parallel_each(result.size(), kTaskBlock, [&](std::size_t e) {
    VectorSum sum;
    for (const std::uint32_t f : groups_->faces(e)) sum.add(faces[f]);
    result[e] = sum.without_rounding();
  });
  return result;
}

std::vector<Vec3d> SequenceNormals::at_key(std::size_t key) const {
  if (!fitted_keys_.empty()) return fitted_keys_[key];
  std::vector<Vec3d> positions = moved(key);
  for (std::size_t v = 0; v < positions.size(); ++v)
    positions[v] = positions[v] + Vec3d{double{base_[3 * v]}, double{base_[3 * v + 1]}, double{base_[3 * v + 2]}};
  return vector_areas(positions);
}

// d = sum of de x df is twice the vector area of the polygon that the displacements of the corners make.
std::vector<Vec3d> SequenceNormals::bends(std::size_t segment) const {
  if (!fitted_bends_.empty()) return fitted_bends_[segment];
  std::vector<Vec3d> displacements = moved(segment + 1);
  const std::vector<Vec3d> before = moved(segment);
  for (std::size_t v = 0; v < displacements.size(); ++v) displacements[v] = displacements[v] - before[v];
  return vector_areas(displacements);
}

}  // namespace chronormal::inline internal

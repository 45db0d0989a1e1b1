#include "workflow/bake/sequence_normals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "chronormal/normals/weighting.h"
#include "core/blocks.h"
#include "core/noise.h"

namespace chronormal {
namespace {

constexpr std::size_t kBlock = 1024;  // faces or elements that one task takes

// Twice the vector area of a polygon, with components that are nothing but the rounding of its products set to zero.
Vec3d vector_area(std::span<const std::uint32_t> face, const std::vector<Vec3d>& positions) {
  Vec3d sum, magnitude;
  const Vec3d a = positions[face[0]];
  Vec3d e = positions[face[1]] - a;
  for (std::size_t c = 2; c < face.size(); ++c) {
    const Vec3d f = positions[face[c]] - a;
    sum = sum + cross(e, f);
    const Vec3d p{std::fabs(e.x), std::fabs(e.y), std::fabs(e.z)}, q{std::fabs(f.x), std::fabs(f.y), std::fabs(f.z)};
    magnitude = magnitude + Vec3d{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
    e = f;
  }
  const double noise = 4 * std::numeric_limits<double>::epsilon() * static_cast<double>(face.size() - 2);
  const auto keep = [noise](double v, double m) { return std::fabs(v) <= noise * m ? 0.0 : v; };
  return {keep(sum.x, magnitude.x), keep(sum.y, magnitude.y), keep(sum.z, magnitude.z)};
}

}  // namespace

Result<SequenceNormals> SequenceNormals::make(const Motion& motion, const NormalGroups& groups, Weighting weighting) {
  SequenceNormals normals(motion, groups);
  for (std::size_t k = 1; k < normals.keys(); ++k) {
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
    WeightingFit fit = fit_weighting(motion_->segment(s), *groups_, weighting);
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
  const std::vector<float>& base = motion_->keyframes[0].positions;
  const std::vector<float>& positions = motion_->keyframes[key].positions;
  std::vector<float> result(base.size());
  for (std::size_t i = 0; i < base.size(); ++i) result[i] = positions[i] - base[i];
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
  const Topology& topology = motion_->topology;
  std::vector<Vec3d> faces(topology.face_count()), result(elements());
  numbered_blocks(faces.size(), kBlock, [&](std::size_t, std::size_t first, std::size_t end) {
    for (std::size_t f = first; f < end; ++f) faces[f] = vector_area(topology.face(f), positions);
  });
  numbered_blocks(result.size(), kBlock, [&](std::size_t, std::size_t first, std::size_t end) {
    for (std::size_t e = first; e < end; ++e) {
      VectorSum sum;
      for (const std::uint32_t f : groups_->faces(e)) sum.add(faces[f]);
      result[e] = sum.without_noise();
    }
  });
  return result;
}

std::vector<Vec3d> SequenceNormals::at_key(std::size_t key) const {
  if (!fitted_keys_.empty()) return fitted_keys_[key];
  std::vector<Vec3d> positions = moved(key);
  const std::vector<float>& base = motion_->keyframes[0].positions;
  for (std::size_t v = 0; v < positions.size(); ++v)
    positions[v] = positions[v] + Vec3d{double{base[3 * v]}, double{base[3 * v + 1]}, double{base[3 * v + 2]}};
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

}  // namespace chronormal

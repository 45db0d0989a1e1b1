#include "workflow/shading/corner_terms.h"

#include <cmath>

#include "analysis/quality/kernels/shown_angles.h"

namespace chronormal::inline internal {

Vec3d corner_term(Weighting weighting, const Vec3d& n, const Vec3d& e, const Vec3d& f) noexcept {
  if (weighting == Weighting::kArea) return n;
  if (weighting == Weighting::kUniform || n == Vec3d{}) return unit(n);
  if (e == Vec3d{} || f == Vec3d{}) return {};
  if (weighting == Weighting::kMax) return (1 / (dot(e, e) * dot(f, f))) * cross(e, f);
  const double squares = dot(e, e) * dot(f, f);
  if (weighting == Weighting::kInverseEdges) return (1 / std::sqrt(squares)) * unit(n);
  if (weighting == Weighting::kInverseRoots) return (1 / std::sqrt(std::sqrt(squares))) * unit(n);
  return angle_between(e, f) * (weighting == Weighting::kAngle ? unit(n) : n);
}

CornerTerms& CornerTerms::emptied(Weighting weighting) {
  thread_local CornerTerms terms;
  terms.weighting_ = weighting;
  terms.needs_edges_ = weighting != Weighting::kArea && weighting != Weighting::kUniform;
  ++terms.use_;
  for (std::vector<Vec3d>* const vectors : {&terms.faces_, &terms.next_, &terms.previous_}) vectors->clear();
  terms.face_of_corner_.clear();
  return terms;
}

void CornerTerms::finish() {
  areas_.resize(faces_.size());
  lengths_of(faces_, areas_);
  if (weighting_ == Weighting::kAngle || weighting_ == Weighting::kUniform) make_units(faces_);
  terms_.resize(face_of_corner_.size());
  for (std::size_t i = 0; i < terms_.size(); ++i) terms_[i] = faces_[face_of_corner_[i]];
  if (weighting_ == Weighting::kAngle || weighting_ == Weighting::kAreaAngle) {
    angles_.resize(terms_.size());
    angles_of_pairs(next_, previous_, angles_, 1);
    for (std::size_t i = 0; i < terms_.size(); ++i) terms_[i] = angles_[i] * terms_[i];
  } else if (needs_edges_) {
    for (std::size_t i = 0; i < terms_.size(); ++i)
      terms_[i] = corner_term(weighting_, terms_[i], next_[i], previous_[i]);
  }
  lengths_.resize(terms_.size());
  lengths_of(terms_, lengths_);
}

}  // namespace chronormal::inline internal

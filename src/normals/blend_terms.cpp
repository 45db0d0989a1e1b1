#include "chronormal/normals/blend_terms.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <numeric>

#include "normals/noise.h"

namespace chronormal {
namespace {

constexpr double kHalfEpsilon = 0x1p-53;

using Indices = std::vector<std::uint32_t>;

// What a target adds at the corners of a face, or where these are in the base.
class CornerDeltas {
 public:
  explicit CornerDeltas(const BlendTarget& target) : target_(target) {}

  [[nodiscard]] std::span<const Vec3d> of(std::span<const std::uint32_t> face) {
    deltas_.assign(face.size(), {});
    for (std::size_t c = 0; c < face.size(); ++c) {
      const auto found = std::lower_bound(target_.vertices.begin(), target_.vertices.end(), face[c]);
      if (found == target_.vertices.end() || *found != face[c]) continue;
      const float* const d = target_.deltas.data() + 3 * (found - target_.vertices.begin());
      deltas_[c] = {d[0], d[1], d[2]};
    }
    return deltas_;
  }

 private:
  const BlendTarget& target_;
  std::vector<Vec3d> deltas_;
};

class CornerPositions {
 public:
  explicit CornerPositions(const BlendSet& set) : base_(set.base.data()) {}

  [[nodiscard]] std::span<const Vec3d> of(std::span<const std::uint32_t> face) {
    positions_.resize(face.size());
    for (std::size_t c = 0; c < face.size(); ++c) {
      const float* const p = base_ + 3 * std::size_t{face[c]};
      positions_[c] = {p[0], p[1], p[2]};
    }
    return positions_;
  }

 private:
  const float* base_;
  std::vector<Vec3d> positions_;
};

double sum_abs(const Vec3d& v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); }

// A vector and how far rounding may have taken it.
struct Rounded {
  Vec3d value;
  double noise = 0;
};

// A sum of products of edges.
class ProductSum {
 public:
  // Adds B(p, q) of a face from its corners: over its fan, the edges of p from the first corner times those of q. Edges
  // and both products of a component are within 10 half eps of the absolute products, and each triangle adds a
  // rounding.
  void add(std::span<const Vec3d> p, std::span<const Vec3d> q) {
    Vec3d e = p[1] - p[0];
    for (std::size_t c = 2; c < p.size(); ++c) {
      const Vec3d f = q[c] - q[0];
      sum_.add(cross(e, f));
      products_ += sum_abs(e) * sum_abs(f);
      e = p[c] - p[0];
    }
    roundings_ += static_cast<double>(10 + p.size());
  }

  [[nodiscard]] Rounded result() const { return {sum_.without_noise(), kHalfEpsilon * roundings_ * products_}; }

 private:
  VectorSum sum_;
  double products_ = 0, roundings_ = 0;
};

// The sum of faces around an element.
class ElementSum {
 public:
  void add(const Rounded& face) {
    sum_.add(face.value);
    noise_ += face.noise;
    size_ += sum_abs(face.value);
    ++count_;
  }

  [[nodiscard]] Rounded result() const { return {sum_.without_noise(), noise_ + kHalfEpsilon * count_ * size_}; }

 private:
  VectorSum sum_;
  double noise_ = 0, size_ = 0, count_ = 0;
};

Indices common(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  Indices result;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

void make_set(Indices& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

// Which faces lie around each vertex.
class FacesOfVertices {
 public:
  explicit FacesOfVertices(const Topology& topology)
      : offsets_(topology.vertex_count() + 1), faces_(topology.corner_count()) {
    for (const std::uint32_t v : topology.corners()) ++offsets_[v + std::size_t{1}];
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    Indices next(offsets_.begin(), offsets_.end() - 1);
    for (std::size_t f = 0; f < topology.face_count(); ++f)
      for (const std::uint32_t v : topology.face(f)) faces_[next[v]++] = static_cast<std::uint32_t>(f);
  }

  // The faces around all of these vertices, ascending.
  [[nodiscard]] Indices around(std::span<const std::uint32_t> vertices) const {
    Indices result;
    std::size_t count = 0;
    for (const std::uint32_t v : vertices) count += offsets_[v + std::size_t{1}] - offsets_[v];
    result.reserve(count);
    for (const std::uint32_t v : vertices)
      result.insert(result.end(), faces_.begin() + offsets_[v], faces_.begin() + offsets_[v + std::size_t{1}]);
    make_set(result);
    result.shrink_to_fit();
    return result;
  }

 private:
  Indices offsets_, faces_;
};

}  // namespace

// Counts the elements that targets have in common, from which targets move each face.
class BlendTerms::PairCounter {
 public:
  explicit PairCounter(const BlendTerms& terms)
      : terms_(terms),
        offsets_(terms.set_.topology.face_count() + 1),
        is_moved_(terms.set_.topology.face_count()),
        last_element_(terms.faces_of_target_.size()),
        counts_(terms.faces_of_target_.size()) {
    for (const Indices& faces : terms.faces_of_target_)
      for (const std::uint32_t f : faces) ++offsets_[f + std::size_t{1}];
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    targets_.resize(offsets_.back());
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    for (std::size_t i = 0; i < terms.faces_of_target_.size(); ++i)
      for (const std::uint32_t f : terms.faces_of_target_[i]) targets_[next[f]++] = static_cast<std::uint32_t>(i);
  }

  // With the targets from `first` on, but for i itself.
  [[nodiscard]] std::vector<PairCount> count(std::size_t i, std::size_t first) {
    std::fill(last_element_.begin(), last_element_.end(), kNone);
    std::fill(counts_.begin(), counts_.end(), 0);
    for (const std::uint32_t f : terms_.faces(i)) is_moved_[f] = true;
    for (const std::uint32_t e : terms_.elements(i)) {
      terms_.for_faces_of(e, [&](std::uint32_t f) {
        if (!is_moved_[f]) return;
        for (std::size_t t = offsets_[f]; t < offsets_[f + std::size_t{1}]; ++t) {
          const std::uint32_t other = targets_[t];
          if (std::exchange(last_element_[other], e) != e) ++counts_[other];
        }
      });
    }
    for (const std::uint32_t f : terms_.faces(i)) is_moved_[f] = false;
    std::vector<PairCount> result;
    for (std::size_t other = first; other < counts_.size(); ++other) {
      if (other != i && counts_[other] > 0) result.push_back({static_cast<std::uint32_t>(other), counts_[other]});
    }
    return result;
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  const BlendTerms& terms_;
  std::vector<std::size_t> offsets_;  // of each face, into targets_
  Indices targets_;
  std::vector<bool> is_moved_;
  Indices last_element_, counts_;  // of each target
};

BlendTerms::BlendTerms(const BlendSet& set, const NormalGroups* groups) : set_(set), groups_(groups) {
  assert(groups == nullptr || groups->element_of_corner().size() == set.topology.corner_count());
  const FacesOfVertices faces(set.topology);
  faces_of_target_.reserve(set.targets.size());
  for (const BlendTarget& target : set.targets) faces_of_target_.push_back(faces.around(target.vertices));
}

void BlendTerms::target_added() {
  faces_of_target_.push_back(FacesOfVertices(set_.topology).around(set_.targets.back().vertices));
  assert(faces_of_target_.size() == set_.targets.size());
}

void BlendTerms::target_removed(std::size_t i) {
  faces_of_target_.erase(faces_of_target_.begin() + static_cast<std::ptrdiff_t>(i));
  assert(faces_of_target_.size() == set_.targets.size());
}

std::size_t BlendTerms::size() const noexcept { return groups_ ? groups_->size() : set_.topology.face_count(); }

template <class Body>
void BlendTerms::for_elements_of(std::uint32_t face, const Body& body) const {
  if (groups_ == nullptr) return body(face);
  const auto corners = set_.topology.face(face);
  const std::uint32_t* const elements =
      groups_->element_of_corner().data() + (corners.data() - set_.topology.corners().data());
  for (std::size_t c = 0; c < corners.size(); ++c) body(elements[c]);
}

template <class Body>
void BlendTerms::for_faces_of(std::uint32_t element, const Body& body) const {
  if (groups_ == nullptr) return body(element);
  for (const std::uint32_t f : groups_->faces(element)) body(f);
}

Indices BlendTerms::elements_of(std::span<const std::uint32_t> faces) const {
  std::size_t count = 0;
  for (const std::uint32_t f : faces) count += groups_ ? set_.topology.face(f).size() : 1;
  Indices elements;
  elements.reserve(count);
  for (const std::uint32_t f : faces) for_elements_of(f, [&](std::uint32_t e) { elements.push_back(e); });
  make_set(elements);
  return elements;
}

Indices BlendTerms::elements(std::size_t i) const { return elements_of(faces(i)); }

BlendTerm BlendTerms::base_term() const {
  std::vector<Rounded> of_faces(set_.topology.face_count());
  CornerPositions positions(set_);
  for (std::size_t f = 0; f < of_faces.size(); ++f) {
    const auto b = positions.of(set_.topology.face(f));
    ProductSum normal;
    normal.add(b, b);
    of_faces[f] = normal.result();
  }
  BlendTerm result;
  result.values.resize(size());
  result.noise.resize(size());
  for (std::size_t e = 0; e < size(); ++e) {
    ElementSum sum;
    for_faces_of(static_cast<std::uint32_t>(e), [&](std::uint32_t f) { sum.add(of_faces[f]); });
    const Rounded normal = sum.result();
    result.values[e] = normal.value;
    result.noise[e] = normal.noise;
  }
  return result;
}

template <class OfFace>
BlendTerm BlendTerms::sum(std::span<const std::uint32_t> faces, const OfFace& of_face) const {
  BlendTerm term;
  if (faces.empty()) return term;
  std::vector<Rounded> values(faces.size());
  const std::uint32_t first = faces.front(), last = faces.back();
  Indices places(last - first + std::size_t{1}, static_cast<std::uint32_t>(faces.size()));
  for (std::size_t i = 0; i < faces.size(); ++i) {
    values[i] = of_face(set_.topology.face(faces[i]));
    places[faces[i] - first] = static_cast<std::uint32_t>(i);
  }
  term.elements = elements_of(faces);
  term.values.reserve(term.elements.size());
  term.noise.reserve(term.elements.size());
  for (const std::uint32_t e : term.elements) {
    ElementSum total;
    for_faces_of(e, [&](std::uint32_t f) {
      const std::size_t place = f >= first && f <= last ? places[f - first] : faces.size();
      if (place < faces.size()) total.add(values[place]);
    });
    const Rounded normal = total.result();
    if (normal.value == Vec3d{}) continue;
    term.elements[term.values.size()] = e;
    term.values.push_back(normal.value);
    term.noise.push_back(normal.noise);
  }
  term.elements.resize(term.values.size());
  return term;
}

BlendTerm BlendTerms::linear(std::size_t i) const {
  CornerPositions positions(set_);
  CornerDeltas deltas(set_.targets[i]);
  return sum(faces(i), [&](std::span<const std::uint32_t> face) {
    const auto b = positions.of(face), d = deltas.of(face);
    ProductSum normal;
    normal.add(b, d);
    normal.add(d, b);
    return normal.result();
  });
}

BlendTerm BlendTerms::pair(std::size_t i, std::size_t j) const {
  CornerDeltas first(set_.targets[i]), second(set_.targets[j]);
  const Indices shared = i == j ? faces_of_target_[i] : common(faces(i), faces(j));
  return sum(shared, [&](std::span<const std::uint32_t> face) {
    const auto di = first.of(face), dj = second.of(face);
    ProductSum normal;
    normal.add(di, dj);
    if (i != j) normal.add(dj, di);
    return normal.result();
  });
}

bool BlendTerms::overlap(std::size_t i, std::size_t j) const noexcept {
  const std::span<const std::uint32_t> a = faces(i), b = faces(j);
  for (std::size_t x = 0, y = 0; x < a.size() && y < b.size();) {
    if (a[x] == b[y]) return true;
    ++(a[x] < b[y] ? x : y);
  }
  return false;
}

std::vector<BlendTerms::PairCount> BlendTerms::pair_elements(std::size_t i) const {
  return PairCounter(*this).count(i, 0);
}

std::vector<std::vector<BlendTerms::PairCount>> BlendTerms::pair_elements() const {
  PairCounter counter(*this);
  std::vector<std::vector<PairCount>> result;
  result.reserve(faces_of_target_.size());
  for (std::size_t i = 0; i < faces_of_target_.size(); ++i) result.push_back(counter.count(i, i + 1));
  return result;
}

std::size_t BlendTerms::bytes() const noexcept {
  std::size_t bytes = faces_of_target_.capacity() * sizeof(Indices);
  for (const Indices& faces : faces_of_target_) bytes += faces.capacity() * sizeof(std::uint32_t);
  return bytes;
}

std::size_t BlendTerms::term_bytes(std::size_t faces, std::size_t corners) const noexcept {
  constexpr std::size_t kOfElement = sizeof(std::uint32_t) + sizeof(Vec3d) + sizeof(double);
  const std::size_t of_faces = faces * (2 * sizeof(std::uint32_t) + sizeof(Rounded));
  return of_faces + corners * kOfElement + set_.topology.face_count() * sizeof(std::uint32_t);
}

std::size_t BlendTerms::base_bytes() const noexcept {
  return set_.topology.face_count() * sizeof(Rounded) + size() * (sizeof(Vec3d) + sizeof(double));
}

std::size_t BlendTerms::counting_bytes(std::size_t pairs) const noexcept {
  std::size_t moved = 0;
  for (const Indices& faces : faces_of_target_) moved += faces.size();
  const std::size_t of_face = 2 * sizeof(std::size_t) + 1, of_target = 4 * sizeof(std::uint32_t) + sizeof(Indices);
  return set_.topology.face_count() * of_face + moved * sizeof(std::uint32_t) + faces_of_target_.size() * of_target +
         2 * pairs * sizeof(PairCount);
}

}  // namespace chronormal

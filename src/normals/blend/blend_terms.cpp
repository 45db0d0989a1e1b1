// Computes the terms of n(w) face by face in double, and adds them up for each element over its faces.
#include "normals/blend/blend_terms.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/blocks.h"
#include "normals/blend/blend_sums.h"

namespace chronormal::inline internal {
namespace {

using Indices = std::vector<std::uint32_t>;

constexpr std::uint32_t kNoPlace = ~std::uint32_t{0};
constexpr std::size_t kTermsTogether = 1024;
// The largest number of faces for which it takes little memory to store the contribution of each face.
constexpr std::size_t kFewFaces = 100000;
// The largest average distance between the numbers of a term's faces at which a table from the first to the last face
// takes little enough memory.
constexpr std::size_t kFarApart = 16;

Indices common(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  Indices result;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

void make_set(Indices& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

// Finds the faces around vertices.
class FacesOfVertices {
 public:
  explicit FacesOfVertices(const Topology& topology) : topology_(topology) {}

  // Returns the faces that have at least one of `vertices`, in ascending order.
  [[nodiscard]] Indices around(std::span<const std::uint32_t> vertices) {
    // The faces around many vertices are found by going through the whole mesh, which takes less memory than sorting.
    constexpr std::size_t kFew = 16;
    if (vertices.size() > topology_.vertex_count() / kFew) return among_all(vertices);
    if (offsets_.empty()) list();
    Indices result;
    std::size_t count = 0;
    for (const std::uint32_t v : vertices) count += offsets_[v + std::size_t{1}] - offsets_[v];
    result.reserve(count);
    for (const std::uint32_t v : vertices)
      result.insert(result.end(), faces_.data() + offsets_[v], faces_.data() + offsets_[v + std::size_t{1}]);
    make_set(result);
    result.shrink_to_fit();
    return result;
  }

 private:
  void list() {
    const Topology& topology = topology_;
    offsets_.resize(topology.vertex_count() + 1);
    faces_.resize(topology.corner_count());
    for (const std::uint32_t v : topology.corners()) ++offsets_[v + std::size_t{1}];
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    Indices next(offsets_.begin(), offsets_.end() - 1);
    for (std::size_t f = 0; f < topology.face_count(); ++f)
      for (const std::uint32_t v : topology.face(f)) faces_[next[v]++] = static_cast<std::uint32_t>(f);
  }

  [[nodiscard]] Indices among_all(std::span<const std::uint32_t> vertices) const {
    std::vector<bool> is_one(topology_.vertex_count());
    for (const std::uint32_t v : vertices) is_one[v] = true;
    const auto has_one = [&](std::size_t f) {
      const auto face = topology_.face(f);
      return std::any_of(face.begin(), face.end(), [&](std::uint32_t v) { return is_one[v]; });
    };
    std::size_t count = 0;
    for (std::size_t f = 0; f < topology_.face_count(); ++f) count += has_one(f) ? 1U : 0U;
    Indices result;
    result.reserve(count);
    for (std::size_t f = 0; f < topology_.face_count(); ++f)
      if (has_one(f)) result.push_back(static_cast<std::uint32_t>(f));
    return result;
  }

  const Topology& topology_;
  Indices offsets_, faces_;
};

}  // namespace

// Counts the elements that two targets have in common. The object has a list of the targets that move each face.
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

  // Counts the elements that target i has in common with each later target.
  [[nodiscard]] std::vector<PairCount> count(std::size_t i) {
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
    for (std::size_t other = i + 1; other < counts_.size(); ++other)
      if (counts_[other] > 0) result.push_back({static_cast<std::uint32_t>(other), counts_[other]});
    return result;
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  const BlendTerms& terms_;
  std::vector<std::size_t> offsets_;  // for each face, its first place in targets_, and the end
  Indices targets_;
  std::vector<bool> is_moved_;
  Indices last_element_, counts_;  // for each other target, the last element that was counted, and the count
};

BlendTerms::BlendTerms(const BlendSet& set, const NormalGroups* groups) : set_(set), groups_(groups) {
  FacesOfVertices faces(set.topology);
  faces_of_target_.reserve(set.targets.size());
  for (const BlendTarget& target : set.targets) faces_of_target_.push_back(faces.around(target.vertices));
}

std::size_t BlendTerms::size() const noexcept { return groups_ ? groups_->size() : set_.topology.face_count(); }

template <class Body>
void BlendTerms::for_elements_of(std::uint32_t face, const Body& body) const {
  if (groups_ == nullptr) return body(face);
  const auto corners = set_.topology.face(face);
  if (groups_->outputs_are_vertices()) {
    for (const std::uint32_t v : corners) body(groups_->element_of_output()[v]);
    return;
  }
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
  Indices elements;
  // Elements are found by marking a bit for each element of the mesh, or by sorting a list of elements, which takes 32
  // bits for each corner of the faces. The method that needs less memory is used.
  if (faces.size() > size() / 64) {
    std::vector<bool> is_one(size());
    std::size_t count = 0;
    for (const std::uint32_t f : faces) {
      for_elements_of(f, [&](std::uint32_t e) {
        if (!is_one[e]) ++count;
        is_one[e] = true;
      });
    }
    elements.reserve(count);
    for (std::size_t e = 0; e < is_one.size(); ++e)
      if (is_one[e]) elements.push_back(static_cast<std::uint32_t>(e));
    return elements;
  }
  std::size_t count = 0;
  for (const std::uint32_t f : faces) count += groups_ ? set_.topology.face(f).size() : 1;
  elements.reserve(count);
  for (const std::uint32_t f : faces) for_elements_of(f, [&](std::uint32_t e) { elements.push_back(e); });
  make_set(elements);
  return elements;
}

Indices BlendTerms::elements(std::size_t i) const { return elements_of(faces(i)); }

Indices BlendTerms::elements(std::size_t i, std::size_t j) const {
  return i == j ? elements(i) : elements_of(common_faces(i, j));
}

Indices BlendTerms::common_faces(std::size_t i, std::size_t j) const { return common(faces(i), faces(j)); }

Vec3d BlendTerms::base_of(std::uint32_t element) const {
  ElementSum sum;
  for_faces_of(element, [&](std::uint32_t f) {
    const CornerVectors b = positions_of(set_, set_.topology.face(f));
    ProductSum normal;
    normal.add(b, b);
    sum.add(normal.value(), normal.noise());
  });
  return sum.value();
}

BlendTerm BlendTerms::base_term() const {
  std::vector<Term::Rounded> of_faces(set_.topology.face_count());
  numbered_blocks(of_faces.size(), kTermsTogether, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t f = first; f < last; ++f) {
      const CornerVectors b = positions_of(set_, set_.topology.face(f));
      ProductSum normal;
      normal.add(b, b);
      of_faces[f] = {normal.value(), normal.noise()};
    }
  });
  BlendTerm result;
  result.values.resize(size());
  result.noise.resize(size());
  numbered_blocks(size(), kTermsTogether, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) {
      ElementSum sum;
      for_faces_of(static_cast<std::uint32_t>(e),
                   [&](std::uint32_t f) { sum.add(of_faces[f].value, of_faces[f].noise); });
      result.values[e] = sum.value();
      result.noise[e] = sum.noise();
    }
  });
  return result;
}

BlendTerms::Term::Places::Places(const BlendTarget& listed) : target(&listed) {
  constexpr std::size_t kFar = 16;
  const Indices& vertices = listed.vertices;
  if (vertices.empty()) return;
  first = vertices.front();
  const std::size_t range = vertices.back() - first + std::size_t{1};
  if (range / kFar > vertices.size()) return;
  of_vertices.assign(range, kNoPlace);
  for (std::size_t n = 0; n < vertices.size(); ++n) of_vertices[vertices[n] - first] = static_cast<std::uint32_t>(n);
}

const float* BlendTerms::Term::Places::find(std::uint32_t vertex) const noexcept {
  if (!of_vertices.empty()) {
    const std::size_t place = vertex - std::size_t{first};  // a large number if the vertex is before the first
    const std::uint32_t n = place < of_vertices.size() ? of_vertices[place] : kNoPlace;
    return n == kNoPlace ? nullptr : target->deltas.data() + 3 * std::size_t{n};
  }
  const auto found = std::lower_bound(target->vertices.begin(), target->vertices.end(), vertex);
  if (found == target->vertices.end() || *found != vertex) return nullptr;
  return target->deltas.data() + 3 * (found - target->vertices.begin());
}

BlendTerms::Term::Term(const BlendTerms& terms, std::size_t i)
    : terms_(terms), first_(terms.set_.targets[i]), is_linear_(true) {
  keep_large(terms.faces(i));
}

BlendTerms::Term::Term(const BlendTerms& terms, std::size_t i, std::size_t j, std::span<const std::uint32_t> faces)
    : terms_(terms), first_(terms.set_.targets[i]), is_linear_(false) {
  if (i != j) second_.emplace(terms.set_.targets[j]);
  keep_large(faces);
}

void BlendTerms::Term::keep_large(std::span<const std::uint32_t> faces) {
  if (terms_.set_.topology.all_triangles()) return;
  for (const std::uint32_t f : faces)
    if (terms_.set_.topology.face(f).size() > kSmallFace) large_faces_.push_back(f);
  of_large_faces_.resize(large_faces_.size());
  for (std::size_t n = 0; n < large_faces_.size(); ++n) (void)of_face(large_faces_[n], of_large_faces_[n]);
}

void BlendTerms::Term::keep_all(std::span<const std::uint32_t> faces) {
  if (faces.empty()) return;
  const std::size_t range = faces.back() - faces.front() + std::size_t{1};
  if (range > kFarApart * faces.size()) return;
  std::vector<Rounded> of_all(faces.size());
  numbered_blocks(faces.size(), kTermsTogether, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) (void)find_face(faces[n], of_all[n]);
  });
  first_face_ = faces.front();
  face_places_.assign(range, kNoPlace);
  for (std::size_t n = 0; n < faces.size(); ++n) face_places_[faces[n] - first_face_] = static_cast<std::uint32_t>(n);
  of_all_faces_ = std::move(of_all);
}

bool BlendTerms::Term::of_face(std::uint32_t face, Rounded& result) const {
  const BlendSet& set = terms_.set_;
  const auto corners = set.topology.face(face);
  const auto deltas_of = [&](const Places& places, CornerVectors& deltas) {
    bool any = false;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const float* const delta = places.find(corners[c]);
      if (delta != nullptr) deltas[c] = vector_at(delta);
      any = any || delta != nullptr;
    }
    return any;
  };
  ProductSum normal;
  CornerVectors first(corners.size());
  if (!deltas_of(first_, first)) return false;
  if (is_linear_ || second_) {
    CornerVectors second(corners.size());
    if (is_linear_)
      second = positions_of(set, corners);
    else if (!deltas_of(*second_, second))
      return false;
    const CornerVectors &a = is_linear_ ? second : first, &b = is_linear_ ? first : second;
    normal.add(a, b);
    normal.add(b, a);
  } else {
    normal.add(first, first);
  }
  result = {normal.value(), normal.noise()};
  return true;
}

bool BlendTerms::Term::find_face(std::uint32_t face, Rounded& result) const {
  if (!of_all_faces_.empty()) {
    const std::size_t place = face - std::size_t{first_face_};  // a large number if the face is before the first face
    const std::uint32_t n = place < face_places_.size() ? face_places_[place] : kNoPlace;
    if (n != kNoPlace) result = of_all_faces_[n];
    return n != kNoPlace;
  }
  if (terms_.set_.topology.face(face).size() <= kSmallFace) return of_face(face, result);
  const auto found = std::lower_bound(large_faces_.begin(), large_faces_.end(), face);
  if (found == large_faces_.end() || *found != face) return false;
  result = of_large_faces_[static_cast<std::size_t>(found - large_faces_.begin())];
  return true;
}

BlendTerms::Term::Rounded BlendTerms::Term::at(std::uint32_t element) const {
  ElementSum sum;
  terms_.for_faces_of(element, [&](std::uint32_t f) {
    Rounded face;
    if (find_face(f, face)) sum.add(face.value, face.noise);
  });
  return {sum.value(), sum.noise()};
}

BlendTerm BlendTerms::listed(Term term, std::span<const std::uint32_t> faces, Indices elements) {
  if (term.terms_.groups_ != nullptr) term.keep_all(faces);
  BlendTerm result;
  result.elements = std::move(elements);
  const std::size_t count = result.elements.size();
  result.values.resize(count);
  result.noise.resize(count);
  numbered_blocks(count, kTermsTogether, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) {
      const Term::Rounded value = term.at(result.elements[n]);
      result.values[n] = value.value;
      result.noise[n] = value.noise;
    }
  });
  std::size_t kept = 0;
  for (std::size_t n = 0; n < count; ++n) {
    if (result.values[n] == Vec3d{}) continue;
    result.elements[kept] = result.elements[n];
    result.values[kept] = result.values[n];
    result.noise[kept++] = result.noise[n];
  }
  result.elements.resize(kept);
  result.values.resize(kept);
  result.noise.resize(kept);
  return result;
}

BlendTerms::Term BlendTerms::linear_by_element(std::size_t i) const {
  Term term(*this, i);
  if (groups_ != nullptr && faces(i).size() <= kFewFaces) term.keep_all(faces(i));
  return term;
}

BlendTerms::Term BlendTerms::pair_by_element(std::size_t i, std::size_t j) const {
  const Indices shared = i == j ? Indices() : common_faces(i, j);
  const std::span<const std::uint32_t> faces = i == j ? this->faces(i) : std::span<const std::uint32_t>(shared);
  Term term(*this, i, j, faces);
  if (groups_ != nullptr && faces.size() <= kFewFaces) term.keep_all(faces);
  return term;
}

BlendTerm BlendTerms::linear(std::size_t i) const { return listed(linear_by_element(i), faces(i), elements(i)); }

BlendTerm BlendTerms::pair(std::size_t i, std::size_t j) const {
  const Indices shared = i == j ? Indices() : common_faces(i, j);
  const std::span<const std::uint32_t> faces = i == j ? this->faces(i) : std::span<const std::uint32_t>(shared);
  if (faces.empty()) return {};
  return listed(Term(*this, i, j, faces), faces, elements_of(faces));
}

bool BlendTerms::overlap(std::size_t i, std::size_t j) const noexcept {
  const std::span<const std::uint32_t> a = faces(i), b = faces(j);
  for (std::size_t x = 0, y = 0; x < a.size() && y < b.size();) {
    if (a[x] == b[y]) return true;
    ++(a[x] < b[y] ? x : y);
  }
  return false;
}

std::vector<std::vector<BlendTerms::PairCount>> BlendTerms::pair_elements() const {
  PairCounter counter(*this);
  std::vector<std::vector<PairCount>> result;
  result.reserve(faces_of_target_.size());
  for (std::size_t i = 0; i < faces_of_target_.size(); ++i) result.push_back(counter.count(i));
  return result;
}

std::size_t BlendTerms::bytes() const noexcept {
  std::size_t bytes = faces_of_target_.capacity() * sizeof(Indices);
  for (const Indices& faces : faces_of_target_) bytes += faces.capacity() * sizeof(std::uint32_t);
  return bytes;
}

std::size_t BlendTerms::term_bytes(std::size_t faces, std::size_t corners) const noexcept {
  constexpr std::size_t kOfElement = sizeof(std::uint32_t) + sizeof(Vec3d) + sizeof(double);
  const std::size_t of_faces = faces * (2 * sizeof(std::uint32_t) + sizeof(Term::Rounded));
  const std::size_t of_places = std::min(kFarApart * faces, set_.topology.face_count()) * sizeof(std::uint32_t);
  return of_faces + of_places + corners * kOfElement + size() / 8 +
         2 * set_.topology.vertex_count() * sizeof(std::uint32_t);
}

std::size_t BlendTerms::base_bytes() const noexcept {
  return set_.topology.face_count() * sizeof(Term::Rounded) + size() * (sizeof(Vec3d) + sizeof(double));
}

std::size_t BlendTerms::counting_bytes(std::size_t pairs) const noexcept {
  std::size_t moved = 0;
  for (const Indices& faces : faces_of_target_) moved += faces.size();
  const std::size_t of_face = 2 * sizeof(std::size_t) + 1, of_target = 4 * sizeof(std::uint32_t) + sizeof(Indices);
  return set_.topology.face_count() * of_face + moved * sizeof(std::uint32_t) + faces_of_target_.size() * of_target +
         2 * pairs * sizeof(PairCount);
}

}  // namespace chronormal::inline internal

// Numbers the vertices and faces that a judged part needs, and computes its true normals.
#include "workflow/audit/judged_part.h"

#include <algorithm>
#include <utility>

#include "core/blocks.h"
#include "core/rounding.h"
#include "core/vector_area.h"
#include "workflow/shading/corner_terms.h"

namespace chronormal::inline internal {
namespace {

constexpr std::uint32_t kUnused = static_cast<std::uint32_t>(-1);

// Numbers the entries of `marks` that are not kUnused by 0, 1, 2 and so on, and replaces each entry by its number.
// Returns the indices of these entries.
std::vector<std::uint32_t> number_used(std::vector<std::uint32_t>& marks) {
  std::vector<std::uint32_t> used;
  used.reserve(marks.size() - static_cast<std::size_t>(std::count(marks.begin(), marks.end(), kUnused)));
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i] == kUnused) continue;
    marks[i] = static_cast<std::uint32_t>(used.size());
    used.push_back(static_cast<std::uint32_t>(i));
  }
  return used;
}

}  // namespace

JudgedPart::JudgedPart(const Topology& topology, const NormalGroups& groups, Weighting weighting,
                       std::vector<JudgedOutput> outputs, bool needs_faces, const AuthorSums* sums)
    : weighting_(weighting), sums_(sums), keeps_faces_(needs_faces), outputs_(std::move(outputs)) {
  std::vector<std::uint32_t> element(groups.size(), kUnused), face(topology.face_count(), kUnused);
  std::vector<std::uint32_t> vertex(topology.vertex_count(), kUnused);
  for (const JudgedOutput& output : outputs_) element[output.element] = 0;
  elements_ = number_used(element);
  for (const std::uint32_t e : elements_)
    for (const std::uint32_t f : groups.faces(e)) face[f] = 0;
  const std::vector<std::uint32_t> faces = number_used(face);
  for (const std::uint32_t f : faces)
    for (const std::uint32_t v : topology.face(f)) vertex[v] = 0;
  if (sums_ != nullptr) {
    for (const std::uint32_t e : elements_) sums_->for_vertices(e, [&](std::uint32_t v) { vertex[v] = 0; });
  }
  vertices_ = number_used(vertex);

  // Keeps the normals of faces in memory if these normals take little memory, or if computing them again for each
  // element would take long.
  constexpr std::size_t kSmallFace = 4, kFewFaces = 100000;
  const bool has_corners = weighting != Weighting::kArea;
  keeps_faces_ = keeps_faces_ || (!has_corners && faces.size() <= kFewFaces);
  std::size_t face_corners = 0, element_corners = 0;
  for (const std::uint32_t f : faces) {
    face_corners += topology.face(f).size();
    keeps_faces_ = keeps_faces_ || (!has_corners && topology.face(f).size() > kSmallFace);
  }
  for (const std::uint32_t e : elements_) element_corners += groups.faces(e).size();
  face_vertices_.reserve(face_corners);
  face_offsets_.reserve(faces.size() + 1);
  faces_of_element_.reserve(element_corners);
  element_offsets_.reserve(elements_.size() + 1);
  if (has_corners) corners_of_element_.reserve(element_corners);
  for (const std::uint32_t f : faces) {
    for (const std::uint32_t v : topology.face(f)) face_vertices_.push_back(vertex[v]);
    face_offsets_.push_back(static_cast<std::uint32_t>(face_vertices_.size()));
  }
  for (const std::uint32_t e : elements_) {
    for (std::size_t i = 0; i < groups.faces(e).size(); ++i) {
      const std::uint32_t f = groups.faces(e)[i];
      const auto first_corner = topology.face(f).data() - topology.corners().data();
      faces_of_element_.push_back(face[f]);
      if (has_corners) corners_of_element_.push_back(groups.corners(e)[i] - static_cast<std::uint32_t>(first_corner));
    }
    element_offsets_.push_back(static_cast<std::uint32_t>(faces_of_element_.size()));
  }
  for (JudgedOutput& output : outputs_) {
    output.element = element[output.element];
    output.face = face[output.face];
  }
  if (sums_ != nullptr) places_ = std::move(vertex);
}

void JudgedPart::set_edges(std::span<const std::array<std::uint32_t, 2>> edges, std::size_t vertex_count) {
  const auto none = static_cast<std::uint32_t>(outputs_.size());
  output_of_.assign(vertex_count, none);
  for (std::uint32_t i = 0; i < none; ++i) output_of_[outputs_[i].vertex] = i;
  edges_ = edges;
  if (2 * outputs_.size() > vertex_count) return;  // a list of its own would cost more memory than it saves time
  for (const auto& [a, b] : edges)
    if (output_of_[a] != none || output_of_[b] != none) own_edges_.push_back({a, b});
  if (own_edges_.empty()) edges_ = {};
}

void JudgedPart::normals(std::span<const Vec3d> positions, PartNormals& result) const {
  result.faces.resize(keeps_faces_ ? face_offsets_.size() - 1 : 0);
  result.elements.resize(elements_.size());
  result.sizes.resize(elements_.size());
  parallel_each(result.faces.size(), kRange, [&](std::size_t f) { result.faces[f] = face_normal(positions, f); });
  if (sums_ != nullptr) return given_normals(positions, result);
  if (weighting_ != Weighting::kArea) return weighted_normals(positions, result);
  numbered_blocks(result.elements.size(), kRange, [&](std::size_t, std::size_t first, std::size_t last) {
    // A face whose normal was computed recently. The normal is kept because neighbouring elements often need the same
    // faces.
    struct Known {
      std::uint32_t face = kUnused;
      Vec3d normal;
    };
    constexpr std::size_t kKnown = 4096;
    std::vector<Known> lately(keeps_faces_ ? 0 : kKnown);
    const auto normal_of = [&](std::uint32_t f) -> const Vec3d& {
      if (keeps_faces_) return result.faces[f];
      Known& known = lately[f % kKnown];
      if (known.face != f) known = {f, face_normal(positions, f)};
      return known.normal;
    };
    for (std::size_t e = first; e < last; ++e) {
      Vec3d sum;
      double size = 0;
      for (std::uint32_t i = element_offsets_[e]; i < element_offsets_[e + 1]; ++i) {
        const Vec3d& normal = normal_of(faces_of_element_[i]);
        sum = sum + normal;
        size += max_abs(normal);
      }
      result.sizes[e] = size;
      result.elements[e] = without_rounding(sum, kRoundingOfTerms * size);
    }
  });
}

void JudgedPart::given_normals(std::span<const Vec3d> positions, PartNormals& result) const {
  parallel_blocks(elements_.size(), kElementsOfBlock, [&](IndexRange range) {
    sums_->for_each(
        std::span(elements_).subspan(range.first, range.count), [&](std::uint32_t v) { return positions[places_[v]]; },
        [&](std::size_t i, const AuthorSum& sum) {
          result.elements[range.first + i] = sum.normal;
          result.sizes[range.first + i] = sum.terms;
        });
  });
}

void JudgedPart::weighted_normals(std::span<const Vec3d> positions, PartNormals& result) const {
  parallel_blocks(result.elements.size(), kElementsOfBlock, [&](IndexRange range) {
    CornerTerms& corners = CornerTerms::emptied(weighting_);
    const std::uint32_t begin = element_offsets_[range.first], end = element_offsets_[range.end()];
    for (std::uint32_t i = begin; i < end; ++i)
      corners.add(faces_of_element_[i], corners_of(faces_of_element_[i]), corners_of_element_[i],
                  [&](std::uint32_t v) { return positions[v]; });
    corners.finish();
    for (std::size_t e = range.first; e < range.end(); ++e) {
      Vec3d sum;
      double size = 0;
      for (std::uint32_t i = element_offsets_[e]; i < element_offsets_[e + 1]; ++i) {
        sum = sum + corners.terms()[i - begin];
        size += max_abs(corners.terms()[i - begin]);
      }
      result.sizes[e] = size;
      result.elements[e] = without_rounding(sum, kRoundingOfTerms * size);
    }
  });
}

double JudgedPart::rounding_of(std::span<const Vec3d> positions, std::size_t element) const {
  double sum = 0;
  for (std::uint32_t i = element_offsets_[element]; i < element_offsets_[element + 1]; ++i) {
    const std::uint32_t f = faces_of_element_[i];
    const std::span<const std::uint32_t> corners = corners_of(f);
    const double of_face = rounding_of_area(corners.size(), [&](std::size_t c) { return positions[corners[c]]; });
    if (corners_of_element_.empty()) {
      sum += of_face;
      continue;
    }
    const Vec3d normal = face_normal(positions, f);
    if (normal != Vec3d{}) sum += length(term(positions, f, corners_of_element_[i], normal)) / length(normal) * of_face;
  }
  return sum;
}

Vec3d JudgedPart::face_normal(std::span<const Vec3d> positions, std::size_t face) const {
  const std::uint32_t* const vertices = face_vertices_.data() + face_offsets_[face];
  const auto at = [&](std::size_t c) -> const Vec3d& { return positions[vertices[c]]; };
  const std::size_t corners = face_offsets_[face + 1] - face_offsets_[face];
  return corners == 3 ? twice_vector_area(3, at) : twice_vector_area(corners, at);
}

Vec3d JudgedPart::term(std::span<const Vec3d> positions, std::size_t face, std::size_t corner,
                       const Vec3d& normal) const {
  const std::span<const std::uint32_t> corners = corners_of(face);
  const auto edge_to = [&](std::size_t c) {
    return positions[corners[c % corners.size()]] - positions[corners[corner]];
  };
  return corner_term(weighting_, normal, edge_to(corner + 1), edge_to(corner + corners.size() - 1));
}

}  // namespace chronormal::inline internal

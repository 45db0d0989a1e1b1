/// Computes the normals of blend shapes as a quadratic form in the weights: the coefficients of all elements, one term
/// at a time.
///
///     n(w) = n_b + sum_i w_i A_i + sum_i w_i^2 C_ii + sum_{i<j} w_i w_j C_ij                          (eq. 32)
///
/// A face has the vector area n(p) = B(p, p) for the positions p of its corners, where B is bilinear. With the base b
/// and the deltas d_i of target i, A_i = B(b, d_i) + B(d_i, b), C_ii = B(d_i, d_i) and C_ij = B(d_i, d_j) + B(d_j,
/// d_i). Elements are sums of faces. A_i is zero at an element if target i moves no corner of the element's faces, and
/// C_ij is zero unless both targets move the same face, so terms are sparse. pair_elements() returns upper bounds of
/// the sizes of the terms C_ij without computing the terms.
///
/// Units      lengths squared, in double; the length of a sum is twice the area.
/// Order      sums are in the order of NormalGroups, so the bits are the same for every number of threads.
/// Ownership  the set and the groups must outlive this object.
#ifndef CHRONORMAL_NORMALS_BLEND_BLEND_TERMS_H_
#define CHRONORMAL_NORMALS_BLEND_BLEND_TERMS_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

/// A term of n(w): the elements whose coefficient is not zero, in ascending order, and their coefficients.
struct BlendTerm {
  std::vector<std::uint32_t> elements;
  std::vector<Vec3d> values;
  std::vector<double> noise;  ///< bound of the error of each value, which comes from rounding in double
};

class BlendTerms {
 public:
  /// Make the terms for the faces of a set, or for the elements of groups, and list the faces that each target moves.
  /// The set must be valid (motion/motion.h), and the groups must belong to its topology. O(corners), and O(n log n)
  /// for n moved vertices of all targets.
  explicit BlendTerms(const BlendSet& set) : BlendTerms(set, nullptr) {}
  BlendTerms(const BlendSet& set, const NormalGroups& groups) : BlendTerms(set, &groups) {}

  [[nodiscard]] std::size_t size() const noexcept;

  /// Returns the term n_b, the normals of all elements in the base. The list `elements` of the term is empty, which
  /// means all elements in order.
  [[nodiscard]] BlendTerm base_term() const;
  [[nodiscard]] std::vector<Vec3d> base() const { return base_term().values; }
  /// Returns n_b of one element. O(corners of its faces). Calling the function for all elements needs no additional
  /// memory, but more time than base().
  [[nodiscard]] Vec3d base_of(std::uint32_t element) const;
  /// Returns the linear term A_i of target i. O(n log n) for n faces that target i moves; uses all cores.
  [[nodiscard]] BlendTerm linear(std::size_t i) const;
  /// Returns the term C_ij of two targets, or the square term C_ii if i = j. O(n log n) for n faces that both targets
  /// move, plus O(faces that the target with fewer faces moves); uses all cores.
  [[nodiscard]] BlendTerm pair(std::size_t i, std::size_t j) const;

  /// A term that is computed element by element, with the same values as linear() or pair(), so that the whole term
  /// need not be in memory. The object keeps at most 4 bytes for each vertex of the mesh and of the target, and the
  /// contributions of faces with more than 4 corners, or of all faces if there are at most 100,000. The constructor is
  /// O(faces that target i moves).
  class Term;
  [[nodiscard]] Term linear_by_element(std::size_t i) const;
  [[nodiscard]] Term pair_by_element(std::size_t i, std::size_t j) const;

  /// Returns the faces that a target moves, in ascending order.
  [[nodiscard]] std::span<const std::uint32_t> faces(std::size_t i) const noexcept { return faces_of_target_[i]; }
  /// Returns the elements that touch a face which target i moves, in ascending order. All other elements have A_i =
  /// C_ii = 0.
  [[nodiscard]] std::vector<std::uint32_t> elements(std::size_t i) const;
  /// Returns the elements that touch a face which both targets i and j move, in ascending order. All other elements
  /// have C_ij = 0.
  [[nodiscard]] std::vector<std::uint32_t> elements(std::size_t i, std::size_t j) const;
  /// Returns true if there is a face that both targets move.
  [[nodiscard]] bool overlap(std::size_t i, std::size_t j) const noexcept;

  /// Another target that moves a face which target i also moves, and an upper bound of the number of elements of
  /// pair(i, other).
  struct PairCount {
    std::uint32_t other = 0;
    std::uint32_t elements = 0;
    friend bool operator==(const PairCount&, const PairCount&) = default;
  };
  /// Returns the pairs of all targets. Each pair is listed only for the earlier target, in ascending order of the later
  /// target. The function computes no term, so for each target it takes O(targets on each of the faces of this target).
  [[nodiscard]] std::vector<std::vector<PairCount>> pair_elements() const;

  /// Returns the bytes of memory that this object keeps.
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Return the largest temporary memory in bytes that calls take, including their results. term_bytes() is for
  /// linear() and pair() with the given numbers of faces and corners, base_bytes() for base_term(), and
  /// counting_bytes() for pair_elements() with the given number of pairs in the results.
  [[nodiscard]] std::size_t term_bytes(std::size_t faces, std::size_t corners) const noexcept;
  [[nodiscard]] std::size_t base_bytes() const noexcept;
  [[nodiscard]] std::size_t counting_bytes(std::size_t pairs) const noexcept;

 private:
  class PairCounter;

  BlendTerms(const BlendSet& set, const NormalGroups* groups);

  [[nodiscard]] static BlendTerm listed(Term term, std::span<const std::uint32_t> faces,
                                        std::vector<std::uint32_t> elements);
  [[nodiscard]] std::vector<std::uint32_t> common_faces(std::size_t i, std::size_t j) const;
  [[nodiscard]] std::vector<std::uint32_t> elements_of(std::span<const std::uint32_t> faces) const;
  template <class Body>
  void for_elements_of(std::uint32_t face, const Body& body) const;
  template <class Body>
  void for_faces_of(std::uint32_t element, const Body& body) const;

  const BlendSet& set_;
  const NormalGroups* groups_;                               // nullptr if the elements are faces
  std::vector<std::vector<std::uint32_t>> faces_of_target_;  // the faces that each target moves, in ascending order
};

class BlendTerms::Term {
 public:
  /// Returns the value of the term at an element, which is zero if the element is not in the term.
  [[nodiscard]] Vec3d operator()(std::uint32_t element) const { return at(element).value; }

 private:
  friend class BlendTerms;

  // A vector and a bound of its rounding error.
  struct Rounded {
    Vec3d value;
    double noise = 0;
  };
  // A table that finds the delta of a target for a vertex.
  struct Places {
    explicit Places(const BlendTarget& listed);
    [[nodiscard]] const float* find(std::uint32_t vertex) const noexcept;

    const BlendTarget* target;
    std::uint32_t first = 0;
    // The places in the target's list of the vertices from `first` on; empty if the vertices are too scattered.
    std::vector<std::uint32_t> of_vertices;
  };

  // Make the linear term of one target, and the term of two targets.
  Term(const BlendTerms& terms, std::size_t i);
  Term(const BlendTerms& terms, std::size_t i, std::size_t j, std::span<const std::uint32_t> faces);

  void keep_large(std::span<const std::uint32_t> faces);
  // Computes the contributions of all faces of the term in advance. Does nothing if the faces are so far apart in the
  // mesh that a table of them would be too large. Uses all threads.
  void keep_all(std::span<const std::uint32_t> faces);
  [[nodiscard]] Rounded at(std::uint32_t element) const;
  // Computes the contribution of a face to the term. Returns false if the face does not move.
  [[nodiscard]] bool of_face(std::uint32_t face, Rounded& result) const;
  [[nodiscard]] bool find_face(std::uint32_t face, Rounded& result) const;

  const BlendTerms& terms_;
  Places first_;
  std::optional<Places> second_;
  bool is_linear_;
  // The faces with more than kSmallFace corners in ascending order, and their contributions. Computing a contribution
  // again for each element that touches such a face would take too long.
  std::vector<std::uint32_t> large_faces_;
  std::vector<Rounded> of_large_faces_;
  std::vector<Rounded> of_all_faces_;       // empty if contributions are not kept
  std::uint32_t first_face_ = 0;            // the first face in of_all_faces_
  std::vector<std::uint32_t> face_places_;  // for the faces from first_face_ on, their indices into of_all_faces_
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_TERMS_H_

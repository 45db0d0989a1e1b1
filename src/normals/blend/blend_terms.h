/// The normals of blend shapes as a quadratic form in the weights: its coefficients, one term at a time.
///
///     n(w) = n_b + sum_i w_i A_i + sum_i w_i^2 C_ii + sum_{i<j} w_i w_j C_ij                          (eq. 32)
///
/// For a face with the vector area n(p) = B(p, p), a bilinear form of its corners, A_i = B(b, d_i) + B(d_i, b),
/// C_ii = B(d_i, d_i) and C_ij = B(d_i, d_j) + B(d_j, d_i); elements are sums of faces. A_i is zero where target i
/// moves no corner of the element's faces, C_ij unless both targets move the same face, so terms are sparse. What that
/// comes to is known from counts alone: pair_elements().
///
/// Units      lengths squared, in double; lengths of the sums are twice the area.
/// Order      sums run in the order of NormalGroups: the same bits on every number of threads.
/// Ownership  the set and the groups must outlive this. Where targets of the set are added or removed, say so.
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

/// The elements where a coefficient is not zero, ascending, and its values there.
struct BlendTerm {
  std::vector<std::uint32_t> elements;
  std::vector<Vec3d> values;
  std::vector<double> noise;  ///< how far each value may be off, by the rounding of double
};

class BlendTerms {
 public:
  /// Of the faces of a set, or of the elements of groups. Lists the faces that each target moves. set must be valid
  /// (motion/motion.h) and groups those of its topology. O(corners + sizes of targets, log).
  explicit BlendTerms(const BlendSet& set) : BlendTerms(set, nullptr) {}
  BlendTerms(const BlendSet& set, const NormalGroups& groups) : BlendTerms(set, &groups) {}

  /// How many elements there are.
  [[nodiscard]] std::size_t size() const noexcept;

  /// n_b of all elements, of which `elements` is empty: all of them, in order.
  [[nodiscard]] BlendTerm base_term() const;
  /// The same, values only.
  [[nodiscard]] std::vector<Vec3d> base() const { return base_term().values; }
  /// n_b of one element. O(corners of its faces): all of them need no memory, but more time than base().
  [[nodiscard]] Vec3d base_of(std::uint32_t element) const;
  /// A_i. O(faces that target i moves, log); on all cores.
  [[nodiscard]] BlendTerm linear(std::size_t i) const;
  /// C_ij, or C_ii where i = j. O(faces that both move, log, and the shorter list); on all cores.
  [[nodiscard]] BlendTerm pair(std::size_t i, std::size_t j) const;

  /// The same, element by element, so that nobody has to hold all of it. It holds at most 4 bytes for each vertex of
  /// the mesh and target (and what faces add: those of more than 4 corners, and all of them where they are 100,000 or
  /// fewer). O(faces that target i moves) to make.
  class Term;
  [[nodiscard]] Term linear_by_element(std::size_t i) const;
  [[nodiscard]] Term pair_by_element(std::size_t i, std::size_t j) const;

  /// The faces that a target moves, ascending.
  [[nodiscard]] std::span<const std::uint32_t> faces(std::size_t i) const noexcept { return faces_of_target_[i]; }
  /// The elements of these faces, ascending: all others have A_i = C_ii = 0.
  [[nodiscard]] std::vector<std::uint32_t> elements(std::size_t i) const;
  /// The elements of the faces that both targets move, ascending: all others have C_ij = 0.
  [[nodiscard]] std::vector<std::uint32_t> elements(std::size_t i, std::size_t j) const;
  /// Whether two targets move a face in common.
  [[nodiscard]] bool overlap(std::size_t i, std::size_t j) const noexcept;

  /// For each other target that moves a face in common with target i, ascending: which it is, and the number of
  /// elements that their pair() has at most. Nothing is multiplied: O(targets on each of the faces of target i).
  struct PairCount {
    std::uint32_t other = 0;
    std::uint32_t elements = 0;
    friend bool operator==(const PairCount&, const PairCount&) = default;
  };
  [[nodiscard]] std::vector<PairCount> pair_elements(std::size_t i) const;
  /// The same of all targets, each with those behind it only.
  [[nodiscard]] std::vector<std::vector<PairCount>> pair_elements() const;

  /// Takes notice of a target that was appended to the set: O(corners).
  void target_added();

  /// Memory that is kept, in bytes.
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// The most that is taken for a while, results included: by linear() and pair() over so many faces, with so many
  /// corners; by base_term(); and by pair_elements() of targets that move so many faces, each on its own.
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
  const NormalGroups* groups_;                               // nothing: faces
  std::vector<std::vector<std::uint32_t>> faces_of_target_;  // ascending
};

class BlendTerms::Term {
 public:
  /// The value of an element; zero where it has none.
  [[nodiscard]] Vec3d operator()(std::uint32_t element) const { return at(element).value; }

 private:
  friend class BlendTerms;

  // A vector and how far rounding may have taken it.
  struct Rounded {
    Vec3d value;
    double noise = 0;
  };
  // Where a target has the deltas of its vertices.
  struct Places {
    explicit Places(const BlendTarget& listed);
    [[nodiscard]] const float* find(std::uint32_t vertex) const noexcept;

    const BlendTarget* target;
    std::uint32_t first = 0;
    std::vector<std::uint32_t> of_vertices;  // from the first on that the target moves; empty where they lie far apart
  };

  // Of one target, or of two.
  Term(const BlendTerms& terms, std::size_t i);
  Term(const BlendTerms& terms, std::size_t i, std::size_t j, std::span<const std::uint32_t> faces);

  void keep_large(std::span<const std::uint32_t> faces);
  // Computes what all its faces add once and for all, where these are dense enough to be found at once. On all threads.
  void keep_all(std::span<const std::uint32_t> faces);
  [[nodiscard]] Rounded at(std::uint32_t element) const;
  // What a face adds; false where it is not moved.
  [[nodiscard]] bool of_face(std::uint32_t face, Rounded& result) const;
  [[nodiscard]] bool find_face(std::uint32_t face, Rounded& result) const;

  const BlendTerms& terms_;
  Places first_;
  std::optional<Places> second_;
  bool is_linear_;
  std::vector<std::uint32_t> large_faces_;  // ascending: those that would take too long for each of their elements
  std::vector<Rounded> of_large_faces_;
  std::vector<Rounded> of_all_faces_;       // empty where they are not kept
  std::uint32_t first_face_ = 0;            // of these
  std::vector<std::uint32_t> face_places_;  // of the faces from there on, in of_all_faces_
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_TERMS_H_

/// The normals of a sequence on curved paths for every face, vertex or corner, straight from arrays: ElementCurves for
/// paths.h, over all segments of a sequence.
///
///     ElementPathsOptions options;
///     options.path = PathKind::kCatmullRom;
///     Result<ElementPaths> paths = ElementPaths::make(std::move(sequence), options);
///     paths.value().unit_normals(time, VectorView<float>::packed(xyz, paths.value().size()));
///
/// Accuracy   that of PathCurves: within kPathAngle of the exact normal of the path, but for needles (docs/theory.md,
///            section 11).
/// Cost       The curves of one segment are kept, 84 bytes an element: that of the last time. A time in another segment
///            prepares it first, so that times in order are fast.
/// Units      times: seconds of the sequence.
/// Threads    one call at a time on one object.
#ifndef CHRONORMAL_NORMALS_ELEMENT_PATHS_H_
#define CHRONORMAL_NORMALS_ELEMENT_PATHS_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/elements.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/path_curves.h"
#include "chronormal/normals/paths.h"

namespace chronormal {

struct ElementPathsOptions {
  ElementOptions elements = {ElementKind::kVertices};
  PathKind path = PathKind::kCatmullRom;
};

class ElementPaths {
 public:
  /// Keeps the sequence, and decides who shares a normal in all of it.
  /// Errors: those of validate(), check_path() and make_groups(); kUsage for a motion that is no sequence.
  [[nodiscard]] static Result<ElementPaths> make(Motion sequence, const ElementPathsOptions& options = {});

  /// Writes the unit normal of every output at a time; (0, 0, 0) where there is none. Returns how many of those were
  /// written. Errors: those of find_instant().
  /// result must have size() elements
  [[nodiscard]] Result<std::size_t> unit_normals(double time, VectorView<float> result,
                                                 Threads threads = Threads::kOne);

  /// Outputs: faces, vertices or corners.
  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] const Motion& motion() const noexcept { return motion_; }
  [[nodiscard]] const ElementPathsOptions& options() const noexcept { return options_; }
  /// The memory that the curves of the last segment take, in bytes; 0 before the first time.
  [[nodiscard]] std::size_t bytes() const noexcept { return curves_.bytes(); }

 private:
  ElementPaths() = default;

  [[nodiscard]] bool are_faces() const noexcept { return options_.elements.kind == ElementKind::kFaces; }
  void enter(std::size_t segment, Threads threads);

  Motion motion_;
  ElementPathsOptions options_;
  NormalGroups groups_;  // but for faces
  std::optional<std::size_t> segment_;
  PathCurves curves_;           // of that segment
  std::vector<float> scratch_;  // (elements, 3)
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_ELEMENT_PATHS_H_

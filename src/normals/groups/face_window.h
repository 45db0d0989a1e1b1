/// A window that slides over the faces of a mesh, for sums over the faces around one element after the other.
///
/// On a well-ordered mesh, the faces around neighbouring vertices are neighbours, too. So the values of a face that
/// sums need are computed once, for the first element that needs them. The values are kept in a ring until the window
/// has moved on:
///
///     faces        ... 40 41 42 [43 44 45 46 47 48 49 50] 51 52 ...      begin = 43, end = 51, capacity = 8
///     place in it                 3  4  5  6  7  0  1  2                 face f is at f & (capacity - 1)
///
/// The window only records which faces are at which place. It grows at its end, and the oldest faces make room for new
/// ones. If an element needs faces that are elsewhere, the window starts again at those faces. The owner of the window
/// decides whether that is worth its time.
#ifndef CHRONORMAL_NORMALS_GROUPS_FACE_WINDOW_H_
#define CHRONORMAL_NORMALS_GROUPS_FACE_WINDOW_H_

#include <algorithm>
#include <cstddef>

#include "chronormal/core/views.h"

namespace chronormal::inline internal {

struct FaceWindow {
  std::size_t capacity = 0;        ///< number of faces for which there is room; a power of two
  std::size_t begin = 0, end = 0;  ///< the faces in the window, from `begin` to before `end`

  [[nodiscard]] std::size_t place(std::size_t face) const noexcept { return face & (capacity - 1); }
  [[nodiscard]] bool is_empty() const noexcept { return begin == end; }
  [[nodiscard]] bool holds(const IndexRange& faces) const noexcept {
    return begin <= faces.first && faces.end() <= end;
  }

  void start_at(std::size_t face) noexcept { begin = end = face; }

  /// Adds the faces up to `new_end` to the window. write(faces, place) must compute a range of faces, which are written
  /// to the ring from `place` on.
  template <class Write>
  void extend(std::size_t new_end, const Write& write) {
    while (end < new_end) {
      const IndexRange faces{end, std::min(new_end - end, capacity - place(end))};
      write(faces, place(end));
      end = faces.end();
    }
    if (end > capacity) begin = std::max(begin, end - capacity);
  }
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_FACE_WINDOW_H_

/// OBJ files of one sequence that repeat the same faces byte by byte, as most programs write them: their text is compared
/// and not read again.
#ifndef CHRONORMAL_IO_MESH_OBJ_FACES_H_
#define CHRONORMAL_IO_MESH_OBJ_FACES_H_

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace chronormal::inline internal {

/// The part of an OBJ file that begins with its first face.
///
/// Shapes     V = vertices; positions are (V, 3).
/// Threads    const member functions may be called from several threads at a time.
class ObjFaces {
 public:
  /// Of a file that read_obj() accepts, with the positions that it returned. bytes must stay valid.
  ObjFaces(std::string_view bytes, const std::vector<float>& positions);

  /// The positions of another file, where it has as many vertices before its first face and from there on the same text:
  /// then read_obj() would return these positions, and the faces of the first file. Nothing where it does not, or where
  /// something stands before the faces that takes more than a look: numbers that are wrong or many, statements over
  /// several lines, a byte order mark, a file without LF.
  [[nodiscard]] std::optional<std::vector<float>> positions_of(std::string_view bytes) const;

 private:
  std::string_view text_;       // empty where nothing can be compared with it
  std::size_t before_ = 0;      // coordinates of the vertices before it
  std::vector<float> further_;  // of those that follow in it
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_MESH_OBJ_FACES_H_

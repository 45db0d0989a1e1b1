/// Reads OBJ files of a sequence quickly if they repeat the same faces byte by byte, as most programs write them. The
/// text of the faces is then compared and not parsed.
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
  /// Takes a file that read_obj() accepts, and the positions that read_obj() returned. `bytes` must outlive this
  /// object.
  ObjFaces(std::string_view bytes, const std::vector<float>& positions);

  /// Returns the positions in another file if that file has the same number of vertices before its first face, and the
  /// same text from there on. For such a file, read_obj() would return the same positions, and the faces of the first
  /// file. Returns nothing for any other file. Also returns nothing for unusual files: with wrong or additional
  /// numbers, with statements over several lines, with a byte order mark, or without LF.
  [[nodiscard]] std::optional<std::vector<float>> positions_of(std::string_view bytes) const;

 private:
  std::string_view text_;       // empty if the text of faces cannot be compared
  std::size_t before_ = 0;      // number of coordinates before text_ begins
  std::vector<float> further_;  // coordinates of vertices inside text_
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_MESH_OBJ_FACES_H_

/// Lays out an edited glTF document as a file: decides the places of all bytes, and updates the JSON accordingly.
/// Private to io.
#ifndef CHRONORMAL_IO_GLTF_EDIT_GLTF_EDIT_LAYOUT_H_
#define CHRONORMAL_IO_GLTF_EDIT_GLTF_EDIT_LAYOUT_H_

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "io/bytes/file.h"
#include "io/gltf/decode/gltf_bytes.h"
#include "io/gltf/edit/unused_arrays.h"
#include "io/gltf/glb/glb.h"
#include "io/gltf/glb/new_arrays.h"
#include "io/gltf/model/gltf_model.h"
#include "io/json/json_text.h"

namespace chronormal::inline internal::gltf {

/// The document to write. All objects to which it refers must outlive the layout.
struct EditedDocument {
  const Model& model;
  Bytes& bytes;
  const GlbChunks& chunks;
  bool is_glb;
  JsonText& source;  ///< the original JSON
  const NewArrays& arrays;
  bool without_unused = false;  ///< true to leave out arrays that nothing refers to any more
};

struct LayoutTarget {
  std::string name;           ///< name of the result for messages
  bool glb = false;           ///< true for a GLB, false for a .gltf file
  bool stands_alone = false;  ///< true if references to files beside the source would be invalid
  bool with_bytes = true;     ///< false if only the JSON is needed; data URIs are then left empty
};

class EditLayout {
 public:
  /// Prepares a layout. `changed` is the JSON of the document with its changes; run() edits this JSON further.
  EditLayout(const EditedDocument& document, LayoutTarget target, JsonText changed)
      : document_(document), target_(std::move(target)), json_(std::move(changed)) {}
  EditLayout(EditLayout&&) noexcept = default;

  /// Computes the layout. Errors: a buffer or an image that cannot be read, a result that is too large for a GLB, a
  /// change that is not possible.
  [[nodiscard]] Status run();

  /// Return the JSON and the warnings of the result. Call run() before.
  [[nodiscard]] const JsonText& json() const noexcept { return json_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const noexcept { return warnings_; }
  /// Returns the number of bytes of the source that are left out.
  [[nodiscard]] std::size_t unused_bytes() const noexcept { return unused_.bytes(); }
  /// Returns the file, in pieces that are valid as long as this object.
  [[nodiscard]] Result<GlbPieces> file() const;

 private:
  struct Image {
    std::size_t index = 0;
    const char* media_type = "";
    std::string_view bytes;
  };
  // The place to which a buffer of the source has moved.
  struct Moved {
    std::size_t buffer = 0, offset = 0;
  };

  [[nodiscard]] bool is_bin(std::size_t buffer) const;
  [[nodiscard]] bool refers_to_file(std::size_t buffer) const;
  [[nodiscard]] Result<std::string_view> declared_bytes(std::size_t buffer);
  [[nodiscard]] std::size_t add_to_bin(std::string_view bytes, std::size_t alignment);
  [[nodiscard]] Status find_images();
  [[nodiscard]] Status add_arrays(std::size_t buffer, std::size_t offset);
  template <class Holds>
  [[nodiscard]] Status leave_out_unused(const Holds& holds);
  [[nodiscard]] Status lay_out_glb();
  [[nodiscard]] Status move_buffers();
  [[nodiscard]] Status move_view(const std::string& pointer, const std::vector<Moved>& moved,
                                 std::optional<std::size_t> offset);
  [[nodiscard]] Status lay_out_gltf();
  [[nodiscard]] Status set(const std::string& pointer, std::string json);
  [[nodiscard]] Status append(const std::string& pointer, std::string json);
  [[nodiscard]] std::string data_uri(std::string_view media_type, const std::vector<std::string_view>& pieces) const;

  EditedDocument document_;
  LayoutTarget target_;
  JsonText json_;
  std::optional<std::vector<std::string_view>> bin_;
  std::size_t bin_size_ = 0;
  UnusedArrays unused_;                   // filled by leave_out_unused()
  std::vector<JsonMember> first_buffer_;  // filled by move_buffers(): members of the former buffer 0
  std::string other_buffers_;             // filled by move_buffers(): text of the other buffers, each after a comma
  std::vector<Image> images_;
  std::deque<FileBytes> files_;
  std::vector<std::string> warnings_;
};

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_EDIT_GLTF_EDIT_LAYOUT_H_

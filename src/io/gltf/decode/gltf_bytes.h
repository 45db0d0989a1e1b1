/// Reads the bytes of a glTF file as numbers. Buffers are opened, views decompressed and accessors decoded when they
/// are first needed. Private to io.
#ifndef CHRONORMAL_IO_GLTF_DECODE_GLTF_BYTES_H_
#define CHRONORMAL_IO_GLTF_DECODE_GLTF_BYTES_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "io/bytes/expansion.h"
#include "io/bytes/file.h"
#include "io/gltf/model/gltf_model.h"

namespace chronormal::inline internal::gltf {

/// Returns the number at `at` as glTF defines it (section 3.6.2.2 of the specification). If `normalized` is true,
/// integers stand for fractions: 255 of a uint8 is 1.
[[nodiscard]] double load_number(const char* at, Component component, bool normalized) noexcept;

/// The bytes of a buffer view, either in the file, or decompressed and shared by all users.
struct View {
  std::string_view bytes;
  std::shared_ptr<const std::string> owner;  ///< nullptr if the bytes are in the file
};

/// The largest total size of decompressed views that are kept for later use.
inline constexpr std::size_t kMostKeptBytes = std::size_t{64} << 20;

/// The place of a glTF asset, from which the files of the asset are found.
struct Origin {
  std::string name;                     ///< name of the asset for messages
  std::optional<std::string> folder;    ///< folder of the asset's files; no value for standard input
  std::optional<std::string_view> bin;  ///< the BIN chunk of a GLB
  bool allow_external = false;
  Expansion expansion;        ///< limit of memory that the asset itself may ask for
  FileResolver resolve = {};  ///< finds the asset's files; if empty, they are in the file system

  /// Returns the path of a relative URI (io/gltf/model/gltf_uri.h); `place` is for messages.
  [[nodiscard]] Result<std::string> path_of(std::string_view uri, const std::string& place) const;
  /// Opens the file at a path that path_of() returned; `place` is for messages.
  [[nodiscard]] Result<FileBytes> open(const std::string& path, const std::string& place) const;
};

class Bytes {
 public:
  /// Creates a reader of an asset's bytes. The model and the BIN chunk must outlive the reader.
  Bytes(const Model& model, Origin origin) : model_(model), origin_(std::move(origin)) {}

  /// Returns the bytes of a buffer, at least as many as the buffer declares. Errors: the buffer has no bytes or too
  /// few; its file cannot be read.
  [[nodiscard]] Result<std::string_view> buffer(std::size_t index);

  /// Returns the bytes of a buffer view, decompressed if necessary.
  [[nodiscard]] Result<View> view(std::size_t index);

  /// Returns the numbers of an accessor that parse_model() has checked: count elements of `components` numbers each.
  /// Normalised integers become fractions (an int8 c becomes max(c / 127, -1), for example), and other integers keep
  /// their value. Errors: those of buffer(); numbers that are not finite; sparse indices that do not ascend.
  [[nodiscard]] Result<std::vector<float>> floats(std::size_t accessor);

  /// Returns the numbers of an accessor as times of keys in seconds. Errors: those of floats(); times that do not
  /// ascend, or begin below 0.
  [[nodiscard]] Result<std::vector<float>> times(std::size_t accessor);

  /// Returns the numbers of an accessor as indices, each of which must be below vertex_count.
  [[nodiscard]] Result<std::vector<std::uint32_t>> indices(std::size_t accessor, std::size_t vertex_count);

  /// Returns the limit of the memory that the asset may ask for. The limit grows with the bytes that are read: the file
  /// of a buffer counts once, if this file can be opened.
  [[nodiscard]] const Expansion& expansion();

  /// Releases memory that holds parts of buffers in separate files. The system reads such parts again at the next
  /// access.
  void release() const noexcept;

  [[nodiscard]] std::string place(std::string_view pointer) const;
  /// Returns the place of an accessor: "NAME, /accessors/3".
  [[nodiscard]] std::string accessor_place(std::size_t index) const;

  [[nodiscard]] const Origin& origin() const noexcept { return origin_; }

 private:
  [[nodiscard]] Status open_buffer_of(const Accessor& accessor);
  [[nodiscard]] Result<std::string> decompress(std::size_t view_index, const Compression& compression);
  /// Calls put(element, bytes) for each element that the sparse part of the accessor replaces, with the bytes of its
  /// new value.
  template <class Put>
  [[nodiscard]] Status for_each_sparse(std::size_t accessor, const Put& put);
  template <class Read>
  [[nodiscard]] Status read_elements(std::size_t accessor, const Read& read);

  const Model& model_;
  Origin origin_;
  std::map<std::size_t, FileBytes> files_;  // the key is the index of the buffer
  // decoded data URIs; the key is the index of the buffer
  std::map<std::size_t, std::string> embedded_;
  // decompressed views; the key is the index of the view
  std::map<std::size_t, std::shared_ptr<const std::string>> views_;
  std::size_t kept_bytes_ = 0;          // total size of views_ in bytes
  std::optional<Expansion> expansion_;  // set at the first call of expansion()
};

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_DECODE_GLTF_BYTES_H_

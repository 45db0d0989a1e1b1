/// NumPy arrays: a whole motion in one .npz, or positions alone in a .npy.
///
///     np.savez("walk.npz", positions=p, faces=f, times=t)
///
///     positions   (T, V, 3)   float32 or float64         T keyframes of V vertices
///     faces       (F, 3)      any integer type           vertices counted from 0; (F, 4) are quads, and so on
///     times       (T,)        any float or integer type  seconds; optional, else k / frames_per_second
///     kind        ()          a string                   sequence (if it is missing), targets or animation
///
///     velocities  (T, V, 3)   float32 or float64         per second, of a sequence; optional, for hermite paths
///
/// Targets are a base, keyframe 0, and a keyframe for each target; they have no times. In an animation, two
/// neighbouring keyframes at the same time are a jump.
///
/// The reader takes C and Fortran order, both byte orders, versions 1 to 3 of the array header, zip members stored or
/// deflated (savez_compressed), and zip64. The reader skips other arrays in the file. float64 positions are rounded to
/// float32.
///
/// Threads    pure.
#ifndef CHRONORMAL_IO_CACHE_NPZ_H_
#define CHRONORMAL_IO_CACHE_NPZ_H_

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/expansion.h"
#include "io/bytes/output_file.h"
#include "io/bytes/zip.h"
#include "io/cache/cache_layout.h"
#include "io/cache/position_cache.h"

namespace chronormal::inline internal {

/// Reads a motion; `name` is for messages. The result is valid (validate() in motion/motion.h).
///
/// The place of an error begins with the name, followed by the byte of the zip file, or by the array and its element
/// ("walk.npz, positions[3, 17, 0]"). Errors: kInvalidInput for a damaged zip file or array (its checksum is verified),
/// shapes and types other than those at the top of this file, coordinates that are not finite or too large for float32,
/// indices without a vertex, velocities of another shape than the positions, times that do not ascend, and an unknown
/// kind. Sizes that disagree between directory, member and array header are refused before memory is taken. Memory: in
/// proportion to the arrays, which deflate may have compressed by a factor of a thousand. The limit of expansion is
/// therefore checked first, for the bytes and numbers of all deflated arrays, and for the memory that a keyframe takes
/// in addition to its positions.
[[nodiscard]] Result<Motion> read_npz(std::string_view bytes, const std::string& name, double frames_per_second = 1,
                                      std::size_t max_expansion = Expansion::kUsual);

/// Reads a motion, but leaves positions in the file if the positions are stored uncompressed and in C order. In this
/// case, `layout` gets the place of the positions, the keyframes have no positions, and the checksum of the positions
/// is not verified. Otherwise the positions are read, and `layout` has no value. Errors: as for read_npz().
[[nodiscard]] Result<Motion> read_npz_outline(std::string_view bytes, const std::string& name, double frames_per_second,
                                              std::size_t max_expansion, std::optional<CacheLayout>& layout);

/// Reads a .npy file of positions (T, V, 3). The time of sample k is k / options.frames_per_second. Errors: as for
/// read_npz().
[[nodiscard]] Result<PositionCache> read_npy(std::string_view bytes, const std::string& name,
                                             const CacheOptions& options = {});

/// Finds the layout of a file of `size` bytes. `bytes` has its first kLayoutBytes bytes, or all bytes of a smaller
/// file. Errors: those of read_npy(), except for coordinates; kInvalidInput for Fortran order.
[[nodiscard]] Result<CacheLayout> find_npy_layout(std::string_view bytes, std::uint64_t size, const std::string& name,
                                                  const CacheOptions& options);

/// Writes positions (float32) as they are read, faces (int32, or uint32 for more than 2^31 vertices), and times
/// (float64) if there are any. Writes velocities if all keyframes have them, and the kind of a motion unless it is a
/// sequence. The arrays are not compressed, so that other programs can map them into memory. The same motion always
/// gives the same bytes. Errors, without a place: kUsage for a mesh at rest, and for faces with different numbers of
/// corners, which an (F, k) array cannot represent; those of the stream and of the file.
[[nodiscard]] Status write_npz(MotionStream& stream, OutputFile& file);

/// A builder of the bytes of a .npy file: an array in C order, little endian, whose elements are appended in order.
class NpyBytes {
 public:
  /// Begins an array of float32; the caller appends the elements.
  explicit NpyBytes(const std::vector<std::uint64_t>& shape);
  /// Makes a whole array of float64 or of int64.
  NpyBytes(const std::vector<std::uint64_t>& shape, std::span<const double> values);
  NpyBytes(const std::vector<std::uint64_t>& shape, std::span<const std::int64_t> values);
  /// Makes an array of booleans, each 0 or 1.
  NpyBytes(const std::vector<std::uint64_t>& shape, std::span<const std::uint8_t> values);

  void append(std::span<const float> values);

  /// Returns the bytes of the .npy file. Call this function when all elements of the shape have been appended.
  [[nodiscard]] const std::string& bytes() const& noexcept { return bytes_; }
  [[nodiscard]] std::string bytes() && noexcept { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Returns the faces of a mesh as a .npy file, in the form that write_npz() uses. Errors: kUsage for faces with
/// different numbers of corners.
[[nodiscard]] Result<std::string> write_npy_faces(const Topology& topology);

struct NpzMember {
  std::string_view name;  ///< name of the array: "normals"
  std::string_view npy;   ///< the bytes of its .npy file
};

/// Returns the bytes of a .npz file with the given arrays, which are not compressed.
[[nodiscard]] std::string write_npz(std::span<const NpzMember> members);

/// Returns the bytes of positions (V, 3) as float64, with the origin added.
[[nodiscard]] std::string placed_bytes(std::span<const float> positions, const Origin& origin);

/// A writer of a .npz file of uncompressed arrays, several of which may grow at the same time.
///
///     NpzOutput npz(file);
///     const std::size_t normals = npz.add_growing("normals", {moments, outputs, 3});
///     npz.add({"times", npy});
///     ... npz.begin(); npz.append(normals, row); ... npz.finish(); file.finish();      // each a Status
class NpzOutput {
 public:
  /// Begins a .npz file in `file`, which must outlive this object.
  explicit NpzOutput(OutputFile& file) : file_(&file) {}

  /// Adds an array whose elements are all given.
  void add(const NpzMember& member);
  /// Adds an array in C order, of float32 or float64, whose elements are appended later. Returns the index of the array
  /// for append().
  [[nodiscard]] std::size_t add_growing(std::string_view name, const std::vector<std::uint64_t>& shape,
                                        bool is_double = false);

  /// Writes the headers of all arrays, and the elements of the whole arrays. Call begin() once, after all arrays were
  /// added.
  [[nodiscard]] Status begin();
  /// Writes the next bytes of a growing array, in little endian.
  [[nodiscard]] Status append(std::size_t array, std::string_view bytes);
  /// Lets several processes write one file together. join() continues a file that another process has begun
  /// (OutputFile::join()); each process must first add the same arrays. skip() skips the bytes of a growing array that
  /// other processes write. The process that called begin() ends the file. For each growing array, this process calls
  /// add_checksum() once for the bytes of each other process, in the order of these bytes in the file, and then
  /// finish().
  void join();
  void skip(std::size_t array, std::uint64_t bytes) { members_[array].end += bytes; }
  /// Returns the checksum of the bytes that this process appended to an array.
  [[nodiscard]] std::uint32_t checksum(std::size_t array) const noexcept { return members_[array].checksum; }
  void add_checksum(std::size_t array, std::uint32_t checksum, std::uint64_t bytes);

  /// Ends the .npz file. Call finish() when the growing arrays have all bytes of their shapes.
  [[nodiscard]] Status finish();

 private:
  struct Member {
    std::string name, start;
    std::uint64_t size = 0;
    std::uint64_t end = 0;  // offset in the file at which the written bytes of this array end
    std::uint32_t checksum = 0;
  };
  [[nodiscard]] zip::Frame frame() const;

  OutputFile* file_;
  std::vector<Member> members_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_CACHE_NPZ_H_

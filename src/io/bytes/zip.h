/// Reads and writes zip files, with members that are stored or deflated, and with zip64. Private to io.
///
/// The directory at the end of the file gives the place and the size of each member. The reader refuses a member whose
/// own header disagrees with the directory. (PKWARE's APPNOTE defines the layout.)
#ifndef CHRONORMAL_IO_BYTES_ZIP_H_
#define CHRONORMAL_IO_BYTES_ZIP_H_

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal::inline internal::zip {

/// An entry of the directory, which describes one member.
struct Member {
  std::string_view name;
  std::uint16_t flags = 0;
  std::uint16_t method = 0;  ///< compression method: 0 is stored, 8 is deflated
  std::uint32_t checksum = 0;
  std::uint64_t packed_size = 0;  ///< size in the file, in bytes
  std::uint64_t size = 0;         ///< size after unpacking, in bytes
  std::uint64_t header = 0;       ///< offset of the member's own header in the file
};

/// Lists the members of a zip file; the names point into `file`. The place of an error is "NAME, byte N". Errors:
/// kInvalidInput for bytes that are not a zip file, for a directory that does not lie inside the file, and for two
/// members with the same name.
[[nodiscard]] Result<std::vector<Member>> read_directory(std::string_view file, const std::string& name);

/// Reads the first `most` bytes of a member, or all bytes of a shorter member. Returns a view into `file`, or into
/// `storage` if the bytes had to be unpacked. Verifies the checksum if all bytes are read. Never takes more than `most`
/// bytes of memory, and refuses a declared size that deflate cannot produce before it takes memory. The place of an
/// error is "NAME, MEMBER". Errors: kInvalidInput for a member that is encrypted, packed by a method other than
/// deflate, damaged, or of another size than the directory declares.
[[nodiscard]] Result<std::string_view> read_member(std::string_view file, const Member& member, std::uint64_t most,
                                                   std::string& storage, const std::string& name);

/// A member to be written without compression: its name, the size of its bytes, and their checksum.
struct StoredMember {
  std::string_view name;
  std::uint64_t size = 0;
  std::uint32_t checksum = 0;
};

/// A zip file without the bytes of its members: the header of each member with its offset, and the records behind the
/// last member. The bytes of a member follow its header. No offset depends on a checksum, so the caller may pass the
/// checksum 0 until the real checksum is known.
struct Frame {
  struct Header {
    std::uint64_t at = 0;
    std::string bytes;

    [[nodiscard]] std::uint64_t end() const noexcept { return at + bytes.size(); }
  };
  std::vector<Header> headers;
  Header directory;
};
[[nodiscard]] Frame frame_of(std::span<const StoredMember> members, std::uint64_t zip64_from = 0xFFFFFFFF);

struct Part {
  std::string_view name;
  std::string_view bytes;
};

/// Writes a zip file of stored members, dated 1980-01-01. Sizes and offsets of at least `zip64_from` are written to
/// zip64 fields; tests set `zip64_from` to a small number.
[[nodiscard]] std::string write(std::span<const Part> parts, std::uint64_t zip64_from = 0xFFFFFFFF);

}  // namespace chronormal::inline internal::zip

#endif  // CHRONORMAL_IO_BYTES_ZIP_H_

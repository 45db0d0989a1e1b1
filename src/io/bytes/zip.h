/// Zip files: members stored or deflated, with zip64. Private to io.
///
/// The directory at the end of the file gives the place and the size of each member. The reader believes it only if the
/// header of the member agrees. (PKWARE's APPNOTE defines the layout.)
#ifndef CHRONORMAL_IO_BYTES_ZIP_H_
#define CHRONORMAL_IO_BYTES_ZIP_H_

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal::inline internal::zip {

/// An entry of the directory.
struct Member {
  std::string_view name;
  std::uint16_t flags = 0;
  std::uint16_t method = 0;  ///< 0 stored, 8 deflated
  std::uint32_t checksum = 0;
  std::uint64_t packed_size = 0;  ///< bytes in the file
  std::uint64_t size = 0;         ///< bytes when unpacked
  std::uint64_t header = 0;       ///< byte of the member's own header
};

/// Lists the members; views point into file. Errors: kInvalidInput with the place "NAME, byte N": no zip file, a
/// directory that does not lie inside it, the same name twice.
[[nodiscard]] Result<std::vector<Member>> read_directory(std::string_view file, const std::string& name);

/// Reads the first `most` bytes of a member, or all bytes of a shorter member. Returns a view into file, or into
/// storage if the bytes had to be unpacked. The checksum is verified if all bytes are read. Never takes more than
/// `most` bytes of memory, and refuses a declared size that deflate cannot produce before it takes memory. Errors:
/// kInvalidInput with the place "NAME, MEMBER": encrypted, another method, data that are damaged or of another size
/// than the directory says.
[[nodiscard]] Result<std::string_view> read_member(std::string_view file, const Member& member, std::uint64_t most,
                                                   std::string& storage, const std::string& name);

/// A stored member that is to be written: its name, and the size and the checksum of its bytes.
struct StoredMember {
  std::string_view name;
  std::uint64_t size = 0;
  std::uint32_t checksum = 0;
};

/// A zip file without the bytes of its members: the header of each member with its offset, and the records behind the
/// last member. The bytes of a member follow its header. A checksum affects no offset, so it may be 0 until it is
/// known.
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
/// zip64 fields; tests set it to a small number.
[[nodiscard]] std::string write(std::span<const Part> parts, std::uint64_t zip64_from = 0xFFFFFFFF);

}  // namespace chronormal::inline internal::zip

#endif  // CHRONORMAL_IO_BYTES_ZIP_H_

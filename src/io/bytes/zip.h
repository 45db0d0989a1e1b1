/// Zip files: members stored or deflated, with zip64. Private to io.
///
/// The directory at the end of the file says where each member is and how large. It is believed only if the member
/// agrees. (PKWARE's APPNOTE defines the layout.)
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

/// Reads the first `most` bytes of a member, or all of a shorter one: a view into file, or into storage if they had to
/// be unpacked. The checksum is verified if all bytes are read. Takes no more memory than `most` bytes, and none for a
/// size that deflate can not have reached.
/// Errors: kInvalidInput with the place "NAME, MEMBER": encrypted, another method, data that are damaged or of another
/// size than the directory says.
[[nodiscard]] Result<std::string_view> read_member(std::string_view file, const Member& member, std::uint64_t most,
                                                   std::string& storage, const std::string& name);

/// A stored member that is to be written: its name, and the size and the checksum of its bytes.
struct StoredMember {
  std::string_view name;
  std::uint64_t size = 0;
  std::uint32_t checksum = 0;
};

/// A zip file without the bytes of its members: the place of each header, which its member's bytes follow, and the
/// records behind the last member. Checksums do not move any place, so they may be 0 until they are known.
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

/// Writes a zip file of stored members, dated 1980-01-01. Sizes and offsets from `zip64_from` on take zip64 fields;
/// tests make it small.
[[nodiscard]] std::string write(std::span<const Part> parts, std::uint64_t zip64_from = 0xFFFFFFFF);

}  // namespace chronormal::inline internal::zip

#endif  // CHRONORMAL_IO_BYTES_ZIP_H_

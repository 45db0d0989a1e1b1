// Reads the directory and the members of zip files, and makes the headers of zip files that are written.
#include "io/bytes/zip.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <new>
#include <optional>
#include <set>
#include <utility>

#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/bytes/checksum.h"
#include "io/bytes/scan.h"

namespace chronormal::inline internal::zip {
namespace {

constexpr std::endian kOrder = std::endian::little;
constexpr std::uint32_t kMemberWord = 0x04034B50, kEntryWord = 0x02014B50, kEndWord = 0x06054B50;
constexpr std::uint32_t kEnd64Word = 0x06064B50, kLocator64Word = 0x07064B50;
constexpr std::size_t kMemberSize = 30, kEntrySize = 46, kEndSize = 22, kEnd64Size = 56, kLocator64Size = 20;
constexpr std::uint16_t kStored = 0, kDeflated = 8, kZip64Field = 1;
constexpr std::uint32_t kSaturated = 0xFFFFFFFF;  // a number that says "see the zip64 field"
// Bounds of the size of unpacked data: at most 1032 bytes for each deflated byte (kMostPerByte), and a few bytes more
// for the whole member (kSlack).
constexpr std::uint64_t kMostPerByte = 1032, kSlack = 64;

std::uint16_t load16(std::string_view text, std::size_t at) {
  return binary::load<std::uint16_t>(text.data() + at, kOrder);
}
std::uint32_t load32(std::string_view text, std::size_t at) {
  return binary::load<std::uint32_t>(text.data() + at, kOrder);
}
std::uint64_t load64(std::string_view text, std::size_t at) {
  return binary::load<std::uint64_t>(text.data() + at, kOrder);
}

// Finds the end record, which is the last part of the file. The record ends with a comment, and declares the length of
// this comment. The search therefore looks for a place at which the declared length reaches exactly to the end of the
// file.
std::optional<std::size_t> find_end(std::string_view file) {
  constexpr std::size_t kLongestComment = 0xFFFF;
  for (std::size_t comment = 0; comment <= kLongestComment && comment + kEndSize <= file.size(); ++comment) {
    const std::size_t at = file.size() - kEndSize - comment;
    if (load32(file, at) == kEndWord && load16(file, at + 20) == comment) return at;
  }
  return std::nullopt;
}

struct Directory {
  std::uint64_t begin = 0, size = 0, count = 0;
};

// Replaces numbers that are too large for the end record by the numbers of the zip64 record before it. Returns false if
// there is no zip64 record.
bool read_end64(std::string_view file, std::size_t end, Directory& directory) {
  if (end < kLocator64Size || load32(file, end - kLocator64Size) != kLocator64Word) return false;
  const std::uint64_t at = load64(file, end - kLocator64Size + 8);
  if (file.size() < kEnd64Size || at > file.size() - kEnd64Size) return false;
  const auto record = static_cast<std::size_t>(at);
  if (load32(file, record) != kEnd64Word) return false;
  directory = {load64(file, record + 48), load64(file, record + 40), load64(file, record + 32)};
  return true;
}

// Replaces the numbers of a directory entry that say "see the zip64 field" by 64-bit numbers from that field, in their
// fixed order. Returns false if a number is missing.
bool read_zip64_field(std::string_view extra, Member& member) {
  const bool needs_any = member.size == kSaturated || member.packed_size == kSaturated || member.header == kSaturated;
  if (!needs_any) return true;
  while (extra.size() >= 4) {
    const std::uint16_t id = load16(extra, 0);
    const std::size_t size = load16(extra, 2);
    if (size > extra.size() - 4) return false;
    std::string_view field = extra.substr(4, size);
    extra.remove_prefix(4 + size);
    if (id != kZip64Field) continue;
    for (std::uint64_t* const number : {&member.size, &member.packed_size, &member.header}) {
      if (*number != kSaturated) continue;
      if (field.size() < 8) return false;
      *number = load64(field, 0);
      field.remove_prefix(8);
    }
    return true;
  }
  return false;
}

// Unpacks at most `most` bytes. The result is shorter if the data end earlier or are damaged. Sets at_end to true if
// the deflated data ended properly. Throws std::bad_alloc if zlib gets no memory.
std::string inflate_some(std::string_view packed, std::size_t most, bool& at_end) {
  constexpr std::size_t kMostAtOnce = std::numeric_limits<uInt>::max();
  std::string result(most, '\0');
  at_end = false;
  z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  std::size_t done = 0;
  int code = Z_OK;
  // zlib needs a place to write to, even if the result is empty.
  unsigned char none = 0;
  while (code == Z_OK) {
    if (stream.avail_in == 0) {
      stream.avail_in = static_cast<uInt>(std::min(packed.size(), kMostAtOnce));
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // zlib only reads these bytes
      packed.remove_prefix(stream.avail_in);
    }
    const auto room = static_cast<uInt>(std::min(most - done, kMostAtOnce));
    stream.next_out = room == 0 ? &none : reinterpret_cast<Bytef*>(result.data() + done);
    stream.avail_out = room;
    code = ::inflate(&stream, Z_NO_FLUSH);
    done += room - stream.avail_out;
  }
  at_end = code == Z_STREAM_END;
  (void)::inflateEnd(&stream);
  if (code == Z_MEM_ERROR) throw std::bad_alloc();
  result.resize(done);
  return result;
}

}  // namespace

Result<std::vector<Member>> read_directory(std::string_view file, const std::string& name) {
  const std::optional<std::size_t> end = find_end(file);
  if (!end)
    return invalid_input(binary::place(name, file.size()),
                         "this is not a .npz (zip) file, or its end is missing; copy or save the file again");
  Directory directory{load32(file, *end + 16), load32(file, *end + 12), load16(file, *end + 10)};
  const bool is_large = directory.begin == kSaturated || directory.size == kSaturated || directory.count == 0xFFFF;
  if (is_large && !read_end64(file, *end, directory))
    return invalid_input(
        binary::place(name, *end),
        "the .npz (zip) file is damaged, since its zip64 record is missing or wrong; save the file again");
  if (directory.begin > *end || directory.size > *end - directory.begin)
    return invalid_input(
        binary::place(name, *end),
        "the .npz (zip) file is damaged, since its directory lies outside of the file; save the file again");

  std::vector<Member> members;
  std::set<std::string_view> names;
  auto at = static_cast<std::size_t>(directory.begin);
  const std::size_t directory_end = at + static_cast<std::size_t>(directory.size);
  for (std::uint64_t i = 0; i < directory.count; ++i) {
    const auto damaged = [&, at] {
      return invalid_input(binary::place(name, at), "the .npz (zip) file is damaged in entry " + std::to_string(i) +
                                                        " of its directory; save the file again");
    };
    if (directory_end - at < kEntrySize || load32(file, at) != kEntryWord) return damaged();
    const std::size_t name_size = load16(file, at + 28), extra_size = load16(file, at + 30);
    const std::size_t entry_size = kEntrySize + name_size + extra_size + load16(file, at + 32);
    if (entry_size > directory_end - at) return damaged();
    Member member{file.substr(at + kEntrySize, name_size),
                  load16(file, at + 8),
                  load16(file, at + 10),
                  load32(file, at + 16),
                  load32(file, at + 20),
                  load32(file, at + 24),
                  load32(file, at + 42)};
    if (!read_zip64_field(file.substr(at + kEntrySize + name_size, extra_size), member)) return damaged();
    if (!names.insert(member.name).second)
      return invalid_input(binary::place(name, at),
                           "the .npz (zip) file has the array " + scan::quoted(member.name) + " twice; save it once");
    members.push_back(member);
    at += entry_size;
  }
  return members;
}

Result<std::string_view> read_member(std::string_view file, const Member& member, std::uint64_t most,
                                     std::string& storage, const std::string& name) {
  const auto error = [&](std::string message) {
    return invalid_input(name + ", " + scan::quoted(member.name), std::move(message));
  };
  const auto damaged = [&](const std::string& why) { return error(why + "; copy or save the file again"); };
  if ((member.flags & 1U) != 0) return error("the array is encrypted; save it without a password");
  if (member.method != kStored && member.method != kDeflated)
    return error("the array has an unknown compression (zip method " + std::to_string(member.method) +
                 "); save it with numpy.savez or savez_compressed");

  if (member.header > file.size() || file.size() - member.header < kMemberSize)
    return damaged("the array lies partly outside of the file, which is damaged or cut off");
  const std::string_view header = file.substr(static_cast<std::size_t>(member.header));
  const std::size_t name_size = load16(header, 26), extra_size = load16(header, 28);
  if (load32(header, 0) != kMemberWord || header.substr(kMemberSize, name_size) != member.name)
    return damaged("the array is damaged, since its two headers in the .npz (zip) file differ");
  const std::size_t data = kMemberSize + name_size + extra_size;
  if (data > header.size() || member.packed_size > header.size() - data)
    return damaged("the array lies partly outside of the file, which is damaged or cut off");
  const std::string_view packed = header.substr(data, static_cast<std::size_t>(member.packed_size));

  std::string_view result;
  if (member.method == kStored) {
    if (member.size != member.packed_size)
      return damaged("the array is damaged, since it is uncompressed but has two different sizes");
    result = packed.substr(0, static_cast<std::size_t>(std::min(most, member.size)));
  } else {
    if (member.size / kMostPerByte > packed.size() + kSlack)
      return damaged("the array is damaged, since its " + counted(packed.size(), "byte", "bytes") +
                     " cannot unpack to " + counted(member.size, "byte", "bytes"));
    const auto wanted = static_cast<std::size_t>(std::min(most, member.size));
    bool at_end = false;
    storage = inflate_some(packed, wanted, at_end);
    if (storage.size() != wanted) return damaged("the compressed array is damaged or cut off");
    if (wanted == member.size && !at_end)
      return damaged("the compressed array is damaged or longer than its header says");
    result = storage;
  }
  if (result.size() == member.size && checksum_of(result) != member.checksum)
    return damaged("the array is damaged, since its checksum is wrong");
  return result;
}

Frame frame_of(std::span<const StoredMember> members, std::uint64_t zip64_from) {
  Frame frame;
  std::uint64_t end = 0;  // offset in the file at which the headers and members so far end
  std::string& directory = frame.directory.bytes;
  const auto put16 = [](std::string& text, std::uint64_t value) {
    binary::append(text, static_cast<std::uint16_t>(value), kOrder);
  };
  const auto put32 = [](std::string& text, std::uint64_t value) {
    binary::append(text, static_cast<std::uint32_t>(value), kOrder);
  };
  const auto put64 = [](std::string& text, std::uint64_t value) { binary::append(text, value, kOrder); };
  const auto short_form = [&](std::uint64_t value) { return value >= zip64_from ? std::uint64_t{kSaturated} : value; };

  // Writes the fields that are the same in both headers of a member, beginning with "version needed".
  const auto put_common = [&](std::string& text, const StoredMember& member, bool is_large) {
    put16(text, is_large ? 45 : 20);  // version that a reader needs
    put16(text, 0);                   // flags
    put16(text, kStored);
    put16(text, 0);     // time
    put16(text, 0x21);  // date
    put32(text, member.checksum);
    put32(text, is_large ? kSaturated : member.size);
    put32(text, is_large ? kSaturated : member.size);
    put16(text, member.name.size());
  };

  for (const StoredMember& member : members) {
    const std::uint64_t header = end;
    std::string file;
    const bool is_large = member.size >= zip64_from, is_far = header >= zip64_from;
    put32(file, kMemberWord);
    put_common(file, member, is_large);
    put16(file, is_large ? 20 : 0);
    file += member.name;
    if (is_large) {
      put16(file, kZip64Field);
      put16(file, 16);
      put64(file, member.size);
      put64(file, member.size);
    }
    end += file.size() + member.size;
    frame.headers.push_back({header, std::move(file)});

    put32(directory, kEntryWord);
    put16(directory, 45);  // version of the writer
    put_common(directory, member, is_large);
    const std::size_t field = (is_large ? 16U : 0U) + (is_far ? 8U : 0U);
    put16(directory, field == 0 ? 0 : field + 4);
    put16(directory, 0);  // length of the comment
    put16(directory, 0);  // number of the disk
    put16(directory, 0);  // internal attributes
    put32(directory, 0);  // external attributes
    put32(directory, short_form(header));
    directory += member.name;
    if (field != 0) {
      put16(directory, kZip64Field);
      put16(directory, field);
      if (is_large) put64(directory, member.size);
      if (is_large) put64(directory, member.size);
      if (is_far) put64(directory, header);
    }
  }

  const std::uint64_t begin = end, size = directory.size();
  frame.directory.at = begin;
  std::string& file = directory;
  if (begin >= zip64_from || size >= zip64_from) {
    const std::uint64_t end64 = begin + size;
    put32(file, kEnd64Word);
    put64(file, kEnd64Size - 12);
    put16(file, 45);
    put16(file, 45);
    put32(file, 0);
    put32(file, 0);
    put64(file, members.size());
    put64(file, members.size());
    put64(file, size);
    put64(file, begin);
    put32(file, kLocator64Word);
    put32(file, 0);
    put64(file, end64);
    put32(file, 1);
  }
  put32(file, kEndWord);
  put16(file, 0);
  put16(file, 0);
  put16(file, members.size());
  put16(file, members.size());
  put32(file, short_form(size));
  put32(file, short_form(begin));
  put16(file, 0);
  return frame;
}

std::string write(std::span<const Part> parts, std::uint64_t zip64_from) {
  std::vector<StoredMember> members;
  for (const Part& part : parts) members.push_back({part.name, part.bytes.size(), checksum_of(part.bytes)});
  const Frame frame = frame_of(members, zip64_from);
  std::string file;
  file.reserve(static_cast<std::size_t>(frame.directory.end()));
  for (std::size_t i = 0; i < parts.size(); ++i) file.append(frame.headers[i].bytes).append(parts[i].bytes);
  return file.append(frame.directory.bytes);
}

}  // namespace chronormal::inline internal::zip

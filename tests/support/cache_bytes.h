/// Makes point caches, MD2 models, NumPy arrays and zip files byte by byte, without the writers of chronormal.
#ifndef CHRONORMAL_TESTS_SUPPORT_CACHE_BYTES_H_
#define CHRONORMAL_TESTS_SUPPORT_CACHE_BYTES_H_

#include <zlib.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/motion/motion.h"
#include "tests/support/ply_bytes.h"

namespace chronormal::test {

/// Positions of three vertices at two times: a triangle that turns.
inline const std::vector<float> kTurning[2] = {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 0, 0, 0, 1, 0, 0, 0, 1.5F}};

/// Returns the triangle of kTurning as a motion with keyframes at the given times.
[[nodiscard]] inline Motion turning_motion(double first_time, double second_time) {
  Motion motion;
  motion.topology = Topology::triangles(3, {0, 1, 2}).value();
  motion.keyframes = {{kTurning[0], first_time, "a"}, {kTurning[1], second_time, "b"}};
  motion.connect_as_sequence();
  return motion;
}

[[nodiscard]] inline std::string small_pc2(float start, float rate) {
  ByteWriter writer(std::string("POINTCACHE2\0", 12), false);
  writer.add(std::int32_t{1}).add(std::int32_t{3}).add(start).add(rate).add(std::int32_t{2});
  for (const auto& positions : kTurning) {
    for (const float value : positions) writer.add(value);
  }
  return writer.bytes();
}

[[nodiscard]] inline std::string small_mdd(float first_time, float second_time) {
  ByteWriter writer("", true);
  writer.add(std::int32_t{2}).add(std::int32_t{3}).add(first_time).add(second_time);
  for (const auto& positions : kTurning) {
    for (const float value : positions) writer.add(value);
  }
  return writer.bytes();
}

/// Makes an MD2 model with three vertices, one triangle with the corners 0 2 1, and two frames.
[[nodiscard]] inline std::string small_md2() {
  ByteWriter writer("IDP2", false);
  for (const std::int32_t value : {8, 1, 1, 52, 0, 3, 0, 1, 0, 2, 68, 68, 68, 80, 184, 184}) writer.add(value);
  for (const int value : {0, 2, 1, 0, 0, 0}) writer.add(static_cast<std::uint16_t>(value));
  for (int frame = 0; frame < 2; ++frame) {
    for (const float value : {0.5F, 0.25F, 2.0F, -1.0F, 0.0F, 1.0F}) writer.add(value);
    for (const char c :
         std::string_view(frame == 0 ? "stand01\0\0\0\0\0\0\0\0\0" : "run\0\0\0\0\0\0\0\0\0\0\0\0\0", 16))
      writer.add(c);
    for (const int value : {0, 0, 0, 7, 255, 0, 0, 8, 0, 255 - frame, 1, 9})
      writer.add(static_cast<std::uint8_t>(value));
  }
  return writer.bytes();
}

/// Writes chunks of a Maya cache. The size of a chunk has 32 bits (format FOR4) or, if `wide`, 64 bits (FOR8).
class MayaWriter {
 public:
  explicit MayaWriter(bool wide) : wide_(wide) {}

  /// Returns a chunk with the given tag and content. Unless the chunk is a group, its content is padded to a multiple
  /// of four bytes or, if `wide`, of eight bytes.
  [[nodiscard]] std::string chunk(const std::string& tag, const std::string& content, bool is_group = false) const {
    ByteWriter writer(tag, true);
    if (wide_) {
      writer.add(std::uint32_t{0xAB01F00D}).add(static_cast<std::uint64_t>(content.size()));
    } else {
      writer.add(static_cast<std::uint32_t>(content.size()));
    }
    std::string bytes = writer.bytes() + content;
    const std::size_t alignment = wide_ ? 8 : 4;
    if (!is_group) bytes.append((alignment - content.size() % alignment) % alignment, '\0');
    return bytes;
  }
  [[nodiscard]] std::string group(const std::string& name, const std::string& chunks) const {
    return chunk(wide_ ? "FOR8" : "FOR4", name + chunks, true);
  }
  [[nodiscard]] std::string integer(const std::string& tag, std::int32_t value) const {
    return chunk(tag, ByteWriter("", true).add(value).bytes());
  }
  [[nodiscard]] std::string header(std::int32_t start) const {
    return group("CACH", chunk("VRSN", std::string("0.1\0", 4)) + integer("STIM", start) + integer("ETIM", start));
  }
  /// Returns the three chunks of a channel: its name, its size, and its positions.
  template <class Real, class Given = float>
  [[nodiscard]] std::string points(const std::string& channel, const std::vector<Given>& positions) const {
    ByteWriter writer("", true);
    for (const Given value : positions) writer.add(Real{value});
    return chunk("CHNM", channel + '\0') + integer("SIZE", static_cast<std::int32_t>(positions.size() / 3)) +
           chunk(sizeof(Real) == 8 ? "DVCA" : "FVCA", writer.bytes());
  }

 private:
  bool wide_;
};

/// Makes a Maya cache with two times (250 and 375 ticks) and the channels "other" (1 point) and "body" (3 points).
template <class Real>
[[nodiscard]] std::string small_maya(bool wide) {
  const MayaWriter writer(wide);
  std::string bytes = writer.header(0);
  for (int k = 0; k < 2; ++k)
    bytes += writer.group("MYCH", writer.integer("TIME", 250 + 125 * k) + writer.points<Real>("other", {1, 2, 3}) +
                                      writer.chunk("NOTE", "passed over") + writer.points<Real>("body", kTurning[k]));
  return bytes;
}

[[nodiscard]] inline std::string maya_xml(const std::string& type, const std::string& format, int step, int start,
                                          int end) {
  const std::string sampling = " SamplingType=\"Regular\" SamplingRate=\"" + std::to_string(step) + "\" StartTime=\"" +
                               std::to_string(start) + "\" EndTime=\"" + std::to_string(end) + "\"/>";
  return "<?xml version=\"1.0\"?>\n<Autodesk_Cache_File>\n<cacheType Type=\"" + type + "\" Format=\"" + format +
         "\"/>\n<time Range=\"0-1\"/>\n<cacheTimePerFrame "
         "TimePerFrame=\"250\"/>\n<extra>&lt;x&gt;</extra>\n<Channels>\n"
         "<channel0 ChannelName=\"other\" ChannelInterpretation=\"positions\"" +
         sampling + "\n<channel1 ChannelName=\"body\" ChannelInterpretation=\"positions\"" + sampling +
         "\n</Channels>\n</Autodesk_Cache_File>\n";
}

/// Makes a NumPy array from its header and its data. The length of the header is stored in 16 bits in version 1 of the
/// format, and in 32 bits in later versions.
[[nodiscard]] inline std::string npy(const std::string& header, const std::string& data, std::uint8_t version = 1) {
  ByteWriter writer("\x93NUMPY", false);
  writer.add(version).add(std::uint8_t{0});
  if (version == 1) {
    writer.add(static_cast<std::uint16_t>(header.size()));
  } else {
    writer.add(static_cast<std::uint32_t>(header.size()));
  }
  return writer.bytes() + header + data;
}

[[nodiscard]] inline std::string npy_header(const std::string& type, const std::string& shape, bool fortran = false) {
  return "{'descr': '" + type + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }\n";
}

template <class T>
[[nodiscard]] std::string raw(const std::vector<T>& values, bool big_endian = false) {
  ByteWriter writer("", big_endian);
  for (const T value : values) writer.add(value);
  return writer.bytes();
}

/// Returns the two keyframes of kTurning as the elements of an array of shape (2, 3, 3), in Fortran order if `fortran`.
template <class Real>
[[nodiscard]] std::vector<Real> turning_elements(bool fortran) {
  std::vector<Real> elements(18);
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < 9; ++i)
      elements[fortran ? k + 2 * (i / 3 + 3 * (i % 3)) : 9 * k + i] = Real{kTurning[k][i]};
  }
  return elements;
}

struct ZipMember {
  std::string name;
  std::string bytes;
  bool is_deflated = false;
  bool has_zip64_header = false;  ///< in the header of the member, but not in the directory, as np.savez does
  std::uint32_t flags = 0;
};

[[nodiscard]] inline std::string deflated(const std::string& bytes) {
  std::string packed(bytes.size() + 100, '\0');
  z_stream stream{};
  (void)::deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  (void)::deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  (void)::deflateEnd(&stream);
  return packed;
}

/// Makes a zip file. If size_of_first is not 0, the directory states this wrong size for the first member.
[[nodiscard]] inline std::string zip(const std::vector<ZipMember>& members, const std::string& comment = "",
                                     std::uint32_t size_of_first = 0) {
  std::string file, directory;
  for (const ZipMember& member : members) {
    const std::string data = member.is_deflated ? deflated(member.bytes) : member.bytes;
    const auto sum = static_cast<std::uint32_t>(
        ::crc32(0, reinterpret_cast<const Bytef*>(member.bytes.data()), static_cast<uInt>(member.bytes.size())));
    const auto packed_size = static_cast<std::uint32_t>(data.size());
    auto size = static_cast<std::uint32_t>(member.bytes.size());
    if (size_of_first != 0 && directory.empty()) size = size_of_first;
    const auto fields = [&](std::string word, bool is_entry, bool is_wide) {
      ByteWriter writer(std::move(word), false);
      if (is_entry) writer.add(std::uint16_t{20});
      writer.add(std::uint16_t{20}).add(static_cast<std::uint16_t>(member.flags));
      writer.add(static_cast<std::uint16_t>(member.is_deflated ? 8 : 0)).add(std::uint32_t{0}).add(sum);
      writer.add(is_wide ? 0xFFFFFFFFU : packed_size).add(is_wide ? 0xFFFFFFFFU : size);
      writer.add(static_cast<std::uint16_t>(member.name.size()));
      writer.add(static_cast<std::uint16_t>(is_wide ? 20 : is_entry ? 5 : 0));
      return writer.bytes();
    };
    const auto offset = static_cast<std::uint32_t>(file.size());
    file += fields("PK\3\4", false, member.has_zip64_header) + member.name;
    if (member.has_zip64_header)
      file += ByteWriter("", false)
                  .add(std::uint16_t{1})
                  .add(std::uint16_t{16})
                  .add(std::uint64_t{size})
                  .add(std::uint64_t{packed_size})
                  .bytes();
    file += data;
    ByteWriter entry(fields("PK\1\2", true, false), false);
    entry.add(std::uint16_t{0}).add(std::uint16_t{0}).add(std::uint16_t{0}).add(std::uint32_t{0}).add(offset);
    directory += entry.bytes() + member.name + std::string("\x55\x58\1\0x", 5);  // an unknown extra field
  }
  ByteWriter end(file + directory + "PK\5\6", false);
  end.add(std::uint32_t{0});
  end.add(static_cast<std::uint16_t>(members.size())).add(static_cast<std::uint16_t>(members.size()));
  end.add(static_cast<std::uint32_t>(directory.size())).add(static_cast<std::uint32_t>(file.size()));
  end.add(static_cast<std::uint16_t>(comment.size()));
  return end.bytes() + comment;
}

/// Makes an .npz file of a motion with the arrays `positions`, `faces` and `times`, and with an array that the reader
/// does not know. Each array has a different type.
[[nodiscard]] inline std::string small_npz(bool is_deflated) {
  return zip({{"positions.npy", npy(npy_header("<f4", "(2, 3, 3)"), raw(turning_elements<float>(false))), is_deflated},
              {"other.npy", npy("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': ()}", "abcd")},
              {"faces.npy", npy(npy_header(">i8", "(1, 3)"), raw<std::int64_t>({0, 1, 2}, true)), is_deflated, true},
              {"times.npy", npy(npy_header("<f8", "(2,)"), raw<double>({0.5, 2})), is_deflated}},
             is_deflated ? "a comment" : "");
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_CACHE_BYTES_H_

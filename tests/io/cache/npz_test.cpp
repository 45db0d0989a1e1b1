// Checks that NumPy files are read back as they were written, and that invalid files are refused with the place of the
// fault.
#include "io/cache/npz.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "io/bytes/zip.h"
#include "tests/support/cache_bytes.h"
#include "tests/support/random_motion.h"
#include "tests/support/written.h"

namespace chronormal::npz_test {
namespace {

using std::string_literals::operator""s;
using test::npy, test::npy_header, test::raw;

const std::string kPositions = npy(npy_header("<f4", "(2, 3, 3)"), raw(test::turning_elements<float>(false)));
const std::string kFaces = npy(npy_header("<i4", "(1, 3)"), raw<std::int32_t>({0, 1, 2}));

std::string error_of(const std::string& bytes) {
  const Result<Motion> result = read_npz(bytes, "walk.npz");
  EXPECT_FALSE(result.ok());
  return result ? "" : result.error().text();
}

Motion read_good(const std::string& bytes, double frames_per_second = 1) {
  Result<Motion> result = read_npz(bytes, "walk.npz", frames_per_second);
  EXPECT_TRUE(result.ok()) << result.error().text();
  return result ? result.value() : Motion{};
}

void expect_turning(const Motion& motion) {
  ASSERT_EQ(motion.keyframes.size(), 2U);
  EXPECT_EQ(motion.keyframes[0].positions, test::kTurning[0]);
  EXPECT_EQ(motion.keyframes[1].positions, test::kTurning[1]);
  EXPECT_EQ(motion.topology, Topology::triangles(3, {0, 1, 2}).value());
  EXPECT_EQ(motion.segments.size(), 1U);
}

std::string archive(const std::string& positions, const std::string& faces, const std::string& times = "") {
  std::vector<test::ZipMember> members = {{"positions.npy", positions}, {"faces.npy", faces}};
  if (!times.empty()) members.push_back({"times.npy", times});
  return test::zip(members);
}

TEST(ReadNpz, reads_arrays_stored_and_deflated_and_passes_over_others) {
  for (const bool is_deflated : {false, true}) {
    const Motion motion = read_good(test::small_npz(is_deflated));
    expect_turning(motion);
    EXPECT_EQ(motion.keyframes[0].time, 0.5);
    EXPECT_EQ(motion.keyframes[1].time, 2);
  }
}

TEST(ReadNpz, without_times_the_frame_rate_says_them) {
  const Motion motion = read_good(archive(kPositions, kFaces), 24);
  expect_turning(motion);
  EXPECT_EQ(motion.keyframes[0].time, 0);
  EXPECT_EQ(motion.keyframes[1].time, 1.0 / 24);
}

TEST(ReadNpz, reads_positions_of_both_types_orders_and_layouts) {
  for (const bool fortran : {false, true}) {
    for (const bool big : {false, true}) {
      const std::string order = big ? ">" : "<";
      SCOPED_TRACE(order + (fortran ? " Fortran" : " C"));
      expect_turning(read_good(
          archive(npy(npy_header(order + "f4", "(2, 3, 3)", fortran), raw(test::turning_elements<float>(fortran), big)),
                  kFaces)));
      expect_turning(read_good(archive(
          npy(npy_header(order + "f8", "(2, 3, 3)", fortran), raw(test::turning_elements<double>(fortran), big)),
          kFaces)));
    }
  }
}

template <class T>
void expect_faces_of(const std::string& type) {
  for (const bool fortran : {false, true}) {
    for (const bool big : {false, true}) {
      SCOPED_TRACE(type + (fortran ? " Fortran" : " C") + (big ? " big" : " little"));
      const std::vector<T> elements = fortran ? std::vector<T>{0, 2, 1, 1, 2, 0} : std::vector<T>{0, 1, 2, 2, 1, 0};
      const std::string order = sizeof(T) == 1 ? "|" : big ? ">" : "<";
      const Motion motion =
          read_good(archive(kPositions, npy(npy_header(order + type, "(2, 3)", fortran), raw(elements, big))));
      EXPECT_EQ(motion.topology, Topology::triangles(3, {0, 1, 2, 2, 1, 0}).value());
    }
  }
}

TEST(ReadNpz, reads_faces_of_every_integer_type) {
  expect_faces_of<std::int8_t>("i1");
  expect_faces_of<std::int16_t>("i2");
  expect_faces_of<std::int32_t>("i4");
  expect_faces_of<std::int64_t>("i8");
  expect_faces_of<std::uint8_t>("u1");
  expect_faces_of<std::uint16_t>("u2");
  expect_faces_of<std::uint32_t>("u4");
  expect_faces_of<std::uint64_t>("u8");
}

TEST(ReadNpz, reads_times_of_floats_and_integers) {
  const auto second_time = [](const std::string& type, const std::string& data) {
    return read_good(archive(kPositions, kFaces, npy(npy_header(type, "(2,)"), data))).keyframes.at(1).time;
  };
  EXPECT_EQ(second_time("<f4", raw<float>({-1, 0.25F})), 0.25);
  EXPECT_EQ(second_time(">f8", raw<double>({-1, 0.1}, true)), 0.1);
  EXPECT_EQ(second_time("<i8", raw<std::int64_t>({-5, -3})), -3);
  EXPECT_EQ(second_time("|u1", raw<std::uint8_t>({1, 255})), 255);
}

TEST(ReadNpz, array_headers_of_every_version_and_spelling_are_read) {
  const std::string data = raw(test::turning_elements<float>(false));
  for (const std::string& header :
       {npy_header("<f4", "(2, 3, 3)"), "{\"shape\":(2L,3L,3L,),'descr':'<f4','fortran_order':False}"s,
        "  { 'fortran_order' : False , 'shape' : ( 2 , 3 , 3 ) , 'descr' : '<f4' }   \n"s}) {
    for (const std::uint8_t version : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{3}}) {
      SCOPED_TRACE(header);
      expect_turning(read_good(archive(npy(header, data, version), kFaces)));
    }
  }
}

TEST(ReadNpz, faces_of_four_corners_are_quads) {
  const Motion motion =
      read_good(archive(kPositions, npy(npy_header("<i4", "(1, 4)"), raw<std::int32_t>({0, 1, 2, 1}))));
  EXPECT_EQ(motion.topology, Topology::polygons(3, {0, 4}, {0, 1, 2, 1}).value());
}

TEST(ReadNpz, errors_name_array_and_element) {
  auto elements = test::turning_elements<double>(true);
  elements[1 + 2 * (2 + 3 * 1)] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_of(archive(npy(npy_header("<f8", "(2, 3, 3)", true), raw(elements)), kFaces)),
            "walk.npz, positions[1, 2, 1]: the coordinate is NaN or infinite; export the file again");
  elements = test::turning_elements<double>(false);
  elements[13] = -1e39;
  EXPECT_EQ(error_of(archive(npy(npy_header("<f8", "(2, 3, 3)"), raw(elements)), kFaces)),
            "walk.npz, positions[1, 1, 1]: the coordinate is too large for float32; scale the mesh down");
  EXPECT_EQ(error_of(archive(npy(npy_header("<i4", "(2, 3, 3)"), std::string(72, '\0')), kFaces)),
            "walk.npz, positions: positions must be an array of float32 or float64 with the shape (keyframes, "
            "vertices, 3), and must not be empty; this "
            "one is (2, 3, 3) of '<i4'");
  EXPECT_EQ(error_of(archive(npy(npy_header("<f4", "(0, 3, 3)"), ""), kFaces)),
            "walk.npz, positions: positions must be an array of float32 or float64 with the shape (keyframes, "
            "vertices, 3), and must not be empty; this "
            "one is (0, 3, 3) of '<f4'");
  for (const auto& [type, data] : {std::pair{"<i4"s, raw<std::int32_t>({0, 1, 3})},
                                   {"<i8"s, raw<std::int64_t>({0, 1, -1})},
                                   {"<u8"s, raw<std::uint64_t>({0, 1, ~std::uint64_t{0}})}})
    EXPECT_EQ(
        error_of(archive(kPositions, npy(npy_header(type, "(1, 3)"), data))),
        "walk.npz, faces[0, 2]: the face refers to a vertex that does not exist; vertices are counted from 0 to 2");
  EXPECT_EQ(error_of(archive(kPositions, npy(npy_header("<f4", "(1, 3)"), std::string(12, '\0')))),
            "walk.npz, faces: faces must be an array of integers with the shape (faces, 3), or (faces, 4) for quads, "
            "but are (1, 3) of '<f4'");
  for (const char* const shape : {"(0, 3)", "(0, 4)"})
    EXPECT_EQ(error_of(archive(kPositions, npy(npy_header("<i4", shape), ""))),
              "walk.npz, faces: there are no faces; save at least one face");
  EXPECT_EQ(error_of(archive(kPositions, kFaces, npy(npy_header("<f4", "(3,)"), std::string(12, '\0')))),
            "walk.npz, times: times must be an array of 2 numbers, one for each keyframe, but are (3,) of '<f4'");
  EXPECT_EQ(error_of(archive(kPositions, kFaces, npy(npy_header("<f4", "(2,)"), std::string(8, '\0')))),
            "walk.npz, sample 1: the time of this sample, 0 s, is not later than 0 s, the time of sample 0; give each "
            "sample a later time than the one before");
  EXPECT_EQ(error_of(archive(kPositions, kFaces, npy(npy_header("<f8", "(2,)"), raw<double>({0, 1.0 / 0.0})))),
            "walk.npz, times[1]: the time is NaN or infinite; times must be finite numbers");
}

TEST(ReadNpz, missing_and_doubled_arrays_are_errors) {
  EXPECT_EQ(error_of(test::zip({{"positions.npy", kPositions}})),
            "walk.npz, faces: the file has no array of this name, only positions; save the array under this name");
  EXPECT_EQ(error_of(test::zip({})),
            "walk.npz, positions: the file has no array of this name; save the array under this name");
  EXPECT_NE(error_of(test::zip({{"a.npy", "1"}, {"a.npy", "1"}})).find("has the array 'a.npy' twice"),
            std::string::npos);
}

TEST(ReadNpz, damaged_array_headers_are_errors) {
  const std::string data = raw(test::turning_elements<float>(false));
  const auto error_with = [&](const std::string& header) { return error_of(archive(npy(header, data), kFaces)); };
  for (const char* const header : {"", "{}", "{'descr': '<f4', 'fortran_order': False}",
                                   "{'descr': '<f4', 'fortran_order': 0, 'shape': (2, 3, 3)}",
                                   "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 3)}",
                                   "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 3)} x",
                                   "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, -3)}",
                                   "{'descr': '<f4', 'fortran_order': False, 'shape': (2 3, 3)}",
                                   "{'descr': '<f4', 'fortran_order': False, 'shape': (18446744073709551616, 3, 3)}",
                                   "{'descr': '<f4' 'fortran_order': False, 'shape': (2, 3, 3)}"})
    EXPECT_EQ(error_with(header),
              "walk.npz, positions: the array header is not as NumPy writes it; save the array with numpy.save or "
              "numpy.savez")
        << header;
  EXPECT_NE(
      error_with(npy_header("<f2", "(2, 3, 3)"))
          .find(
              "elements of the type '<f2' cannot be read; save it as float32 or float64, or if it holds faces, as int"),
      std::string::npos);
  EXPECT_NE(error_with("{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (2, 3, 3)}").find("has records"),
            std::string::npos);
  // The number of bytes of the large shapes overflows 64 bits. For the first shape, the result of the overflow is
  // exactly the number of bytes in the file. The small shapes need more or fewer bytes than the file has.
  for (const char* const shape :
       {"(4611686018427387906, 3, 3)", "(6148914691236517206, 3, 3)", "(4611686018427387904, 1, 1)",
        "(4294967296, 4294967296, 3)", "(2, 3, 4)", "(2, 3, 2)", "(18446744073709551615, 3, 3)"})
    EXPECT_NE(error_with(npy_header("<f4", shape)).find("but has 72 bytes"), std::string::npos) << shape;
  EXPECT_NE(error_of(archive(npy(npy_header("<f4", "(2, 3, 3)"), data, 4), kFaces)).find("version 4.0"),
            std::string::npos);
}

TEST(ReadNpz, damaged_zip_files_are_errors) {
  EXPECT_EQ(error_of(""),
            "walk.npz, byte 0: this is not a .npz (zip) file, or its end is missing; copy or save the file again");
  std::string bytes = test::small_npz(false);
  bytes[bytes.find("\x93NUMPY") + 128] ^= 1;
  EXPECT_NE(error_of(bytes).find("walk.npz, 'positions.npy': the array is damaged, since its checksum is wrong"),
            std::string::npos);
  bytes = test::zip({{"positions.npy", kPositions, true}, {"faces.npy", kFaces}});
  bytes[bytes.find("positions.npy") + 13 + 40] ^= 0x55;
  EXPECT_NE(error_of(bytes).find("walk.npz, 'positions.npy': "), std::string::npos);
  EXPECT_NE(error_of(test::zip({{"positions.npy", kPositions, false, false, 1}})).find("encrypted"), std::string::npos);
  bytes = test::small_npz(false);
  bytes[8] = 12;  // the compression method in the zip directory counts, not the method in the header of the member
  expect_turning(read_good(bytes));
  bytes = test::small_npz(false);
  bytes[bytes.rfind("positions.npy") - 36] = '\x0C';
  EXPECT_NE(error_of(bytes).find("unknown compression (zip method 12)"), std::string::npos) << error_of(bytes);
}

TEST(ReadNpz, sizes_that_deflate_can_not_reach_are_refused_before_memory_is_taken) {
  const std::string huge = npy(npy_header("<f4", "(119304600, 3, 3)"), "");  // 4 GiB minus a few bytes
  const auto declared = static_cast<std::uint32_t>(huge.size() + std::uint64_t{119304600} * 36);
  EXPECT_NE(error_of(test::zip({{"positions.npy", huge, true}}, "", declared)).find("cannot unpack to"),
            std::string::npos);
  // Deflate could expand the data to the size that the archive declares, but the member expands to fewer bytes.
  const std::string header = npy_header("<f4", "(2, 3, 3)");
  const std::string shorter = npy(header, raw(test::turning_elements<float>(false)).substr(4));
  EXPECT_NE(error_of(test::zip({{"positions.npy", shorter, true}}, "", static_cast<std::uint32_t>(shorter.size() + 4)))
                .find("damaged or cut off"),
            std::string::npos);
  const std::string longer = npy(header, raw(test::turning_elements<float>(false)) + "1234");
  EXPECT_NE(error_of(test::zip({{"positions.npy", longer, true}}, "", static_cast<std::uint32_t>(longer.size() - 4)))
                .find("longer than its header says"),
            std::string::npos);
}

TEST(ReadNpz, arrays_larger_than_the_longest_header_are_unpacked_whole) {
  std::vector<float> values(3 * 30000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 1000);
  for (const bool is_deflated : {false, true}) {
    const Motion motion = read_good(test::zip(
        {{"positions.npy", npy(npy_header("<f4", "(2, 15000, 3)"), raw(values)), is_deflated}, {"faces.npy", kFaces}}));
    ASSERT_EQ(motion.keyframes.size(), 2U);
    EXPECT_TRUE(std::equal(values.begin(), values.begin() + 45000, motion.keyframes[0].positions.begin()));
    EXPECT_TRUE(std::equal(values.begin() + 45000, values.end(), motion.keyframes[1].positions.begin()));
  }
}

TEST(ReadNpy, reads_positions_at_the_frame_rate) {
  const Result<PositionCache> cache = read_npy(kPositions, "walk.npy", {25, 0, ""});
  ASSERT_TRUE(cache.ok()) << cache.error().text();
  EXPECT_EQ(cache.value().vertex_count, 3U);
  EXPECT_EQ(cache.value().samples.at(1).time, 1.0 / 25);
  EXPECT_EQ(cache.value().samples.at(1).positions, test::kTurning[1]);
  EXPECT_EQ(read_npy(kPositions + "x", "walk.npy").error().text(),
            "walk.npy, header: the array should be (2, 3, 3) of '<f4', but has 73 bytes; copy or save the file again");
}

TEST(WriteNpz, writes_the_bytes_that_were_made_by_hand) {
  const auto padded = [](std::string header) {
    header.pop_back();
    while ((10 + header.size() + 1) % 64 != 0) header += ' ';
    header += '\n';
    return header;
  };
  const std::string positions = npy(padded(npy_header("<f4", "(2, 3, 3)")), raw(test::turning_elements<float>(false)));
  const std::string faces = npy(padded(npy_header("<i4", "(1, 3)")), raw<std::int32_t>({0, 1, 2}));
  const std::string times = npy(padded(npy_header("<f8", "(2,)")), raw<double>({0.5, 2}));
  const std::string bytes = test::written(test::turning_motion(0.5, 2), ".npz").value();
  std::size_t at = 0;
  for (const auto& [name, array] :
       {std::pair{"positions.npy"s, positions}, {"faces.npy"s, faces}, {"times.npy"s, times}}) {
    const auto size = static_cast<std::uint32_t>(array.size());
    const auto sum = static_cast<std::uint32_t>(::crc32(0, reinterpret_cast<const Bytef*>(array.data()), size));
    const std::string member = test::ByteWriter("PK\3\4"s, false)
                                   .add(std::uint16_t{20})
                                   .add(std::uint32_t{0})
                                   .add(std::uint32_t{0x00210000})
                                   .add(sum)
                                   .add(size)
                                   .add(size)
                                   .add(static_cast<std::uint16_t>(name.size()))
                                   .add(std::uint16_t{0})
                                   .bytes() +
                               name + array;
    EXPECT_EQ(bytes.substr(at, member.size()), member) << name;
    at += member.size();
  }
  EXPECT_EQ(bytes.substr(at, 4), "PK\1\2"s);
  EXPECT_EQ(bytes.size(), at + 3 * 46 + std::string("positions.npyfaces.npytimes.npy").size() + 22);
}

RC_GTEST_PROP(WriteNpz, what_was_written_reads_back_bit_for_bit, ()) {
  const Motion motion = test::random_motion(false);
  const Result<std::string> bytes = test::written(motion, ".npz");
  RC_ASSERT(bytes.ok());
  const Result<Motion> back = read_npz(bytes.value(), "back.npz");
  RC_ASSERT(back.ok());
  RC_ASSERT(back.value().topology == motion.topology);
  RC_ASSERT(back.value().keyframes.size() == motion.keyframes.size());
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    RC_ASSERT(back.value().keyframes[k].time == motion.keyframes[k].time);
    RC_ASSERT(test::same_bits(back.value().keyframes[k].positions, motion.keyframes[k].positions));
  }
}

// Makes a NumPy array of one string. The type of the array is either '<U7', with four bytes per character, or '|S9',
// with one byte per character.
std::string text_array(const std::string& type, const std::string& text, std::size_t bytes_per_character) {
  std::string data;
  for (const char c : text) data += c + std::string(bytes_per_character - 1, '\0');
  return npy(npy_header(type, "()"), data);
}

TEST(ReadNpz, kind_is_a_string_of_numpy) {
  const auto with_kind = [](const std::string& kind) {
    return test::zip({{"positions.npy", kPositions}, {"faces.npy", kFaces}, {"kind.npy", kind}});
  };
  const Motion targets = read_good(with_kind(text_array("<U7", "targets", 4)));
  EXPECT_EQ(targets.kind, MotionKind::kTargets);
  EXPECT_EQ(targets.segment(0).end_time, 1);
  EXPECT_EQ(targets.keyframes[1].name, "target 0");
  EXPECT_EQ(read_good(with_kind(text_array("|S9", "animation", 1))).kind, MotionKind::kAnimation);
  EXPECT_EQ(read_good(with_kind(text_array("|S9", "sequence"s + '\0', 1))).kind, MotionKind::kSequence);
  EXPECT_EQ(error_of(with_kind(text_array("<U4", "star", 4))),
            "walk.npz, kind: kind must be sequence, targets or animation, but is 'star'");
  EXPECT_EQ(error_of(with_kind(npy(npy_header("<i4", "()"), raw<std::int32_t>({1})))),
            "walk.npz, kind: the array must be a single text, but is () of '<i4'; save it as a string");
  EXPECT_EQ(error_of(with_kind(text_array("<U4", "\xff\xff\xff\xff", 4))),
            "walk.npz, kind: the text must be ASCII; save it again without other characters");
  EXPECT_FALSE(error_of(with_kind(npy(npy_header("<U7", "()"), "targets"))).empty());
}

TEST(WriteNpz, what_is_no_sequence_says_so_and_targets_have_no_times) {
  Motion motion = test::turning_motion(0, 1);
  motion.connect_as_targets();
  const std::string bytes = test::written(motion, ".npz").value();
  EXPECT_EQ(bytes.find("times.npy"), std::string::npos);
  const std::string array = text_array("<U7", "targets", 4);
  EXPECT_NE(bytes.find(array.substr(array.size() - 28)), std::string::npos);
  EXPECT_EQ(read_npz(bytes, "back.npz").value().kind, MotionKind::kTargets);
  motion.segments.clear();
  EXPECT_EQ(test::written(motion, ".npz").error().code, ErrorCode::kUsage);
}

TEST(WriteNpz, refuses_faces_of_different_numbers_of_corners) {
  Motion motion = test::turning_motion(0, 1);
  motion.topology = Topology::polygons(3, {0, 3, 7}, {0, 1, 2, 0, 1, 2, 1}).value();
  const Result<std::string> bytes = test::written(motion, ".npz");
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.error().code, ErrorCode::kUsage);
  EXPECT_NE(bytes.error().message.find("face 0 has 3 corners and face 1 has 4"), std::string::npos);
}

// In an array in Fortran order, the numbers of one keyframe are not contiguous, so the reader cannot read one keyframe
// at a time.
TEST(Npy, no_keyframe_lies_in_one_piece_in_the_order_of_Fortran) {
  for (const bool fortran : {false, true}) {
    const std::string bytes = npy(npy_header("<f4", "(2, 3, 3)", fortran), std::string(72, '\0'));
    const Result<CacheLayout> layout = find_npy_layout(bytes, bytes.size(), "walk.npy", {});
    EXPECT_EQ(layout.ok(), !fortran);
    if (fortran) {
      EXPECT_EQ(layout.error().text(),
                "walk.npy, positions: positions are in Fortran order; save numpy.ascontiguousarray(positions)");
    }
  }
}

// Zip archives of more than 4 GiB use the fields of the extension zip64. In this test, all members at byte `from` or
// later have zip64 fields.
TEST(Zip, members_with_zip64_fields_read_back) {
  const std::array<zip::Part, 3> parts = {{{"positions.npy", kPositions}, {"faces.npy", kFaces}, {"empty", ""}}};
  for (const std::uint64_t from : {0U, 1U, 60U, 100U, 150U, 1000U}) {
    SCOPED_TRACE(from);
    expect_turning(read_good(zip::write(parts, from)));
  }
}

TEST(Zip, damaged_zip64_records_are_errors) {
  const std::array<zip::Part, 2> parts = {{{"positions.npy", kPositions}, {"faces.npy", kFaces}}};
  const std::string good = zip::write(parts, 0);
  for (std::size_t at = good.find("PK\1\2"); at < good.size(); ++at) {
    for (const char* const pattern : {"\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF", "\xFF\xFF\xFF\xFF\xFF\xFF\xFF\x7F", "\x80"}) {
      std::string bytes = good;
      const std::string_view patch(pattern);
      if (at + patch.size() > bytes.size()) continue;
      const Result<Motion> result = read_npz(bytes.replace(at, patch.size(), patch), "walk.npz");
      if (!result) {
        EXPECT_EQ(result.error().code, ErrorCode::kInvalidInput);
      }
    }
  }
}

}  // namespace
}  // namespace chronormal::npz_test

#include "io/cache/md2.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/bytes/scan.h"

namespace chronormal::inline internal {
namespace {

constexpr std::endian kMd2Order = std::endian::little;
constexpr std::size_t kMd2HeaderSize = 68, kTriangleSize = 12, kFrameHeaderSize = 40, kNameAt = 24, kNameSize = 16;

// A table of records that lies completely inside the file.
struct Table {
  std::size_t count = 0, begin = 0, record_size = 0;

  [[nodiscard]] std::size_t record(std::size_t i) const { return begin + i * record_size; }
};

class Md2Reader {
 public:
  Md2Reader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Result<Motion> read(double frames_per_second) {
    if (Status status = read_header(); !status) return status.error();
    Motion motion;
    std::vector<std::uint32_t> corners;
    if (Status status = read_corners(corners); !status) return status.error();
    Result<Topology> topology = Topology::triangles(vertex_count_, std::move(corners));
    if (!topology) return invalid_input(binary::place(name_, triangles_.begin), topology.error().text());
    motion.topology = std::move(topology).value();
    motion.keyframes.resize(frames_.count);
    for (std::size_t k = 0; k < frames_.count; ++k) {
      if (Status status = read_frame(k, motion.keyframes[k]); !status) return status.error();
    }
    set_times(frames_per_second, motion);
    if (Status status = validate(motion); !status)
      return invalid_input(name_ + ", " + status.error().place, status.error().message);
    return motion;
  }

 private:
  [[nodiscard]] Error error(std::size_t at, std::string message) const {
    return invalid_input(binary::place(name_, at), std::move(message));
  }
  [[nodiscard]] std::int32_t field(std::size_t at) const {
    return binary::load<std::int32_t>(bytes_.data() + at, kMd2Order);
  }

  [[nodiscard]] Status read_header() {
    if (!bytes_.starts_with("IDP2"))
      return error(0, "this is not an MD2 file, since it does not begin with IDP2; name an .md2 file");
    if (bytes_.size() < kMd2HeaderSize)
      return error(bytes_.size(), "the file is cut off inside its header of 68 bytes; copy or export it again");
    if (field(4) != 8)
      return error(4, "version " + std::to_string(field(4)) + " of MD2 cannot be read; export the file as version 8");
    if (field(24) <= 0)
      return error(24, "the number of vertices is " + std::to_string(field(24)) +
                           ", but must be at least 1; export a mesh with vertices");
    vertex_count_ = static_cast<std::size_t>(field(24));
    const std::uint64_t frame_size = kFrameHeaderSize + std::uint64_t{4} * vertex_count_;
    if (field(16) <= 0 || static_cast<std::uint64_t>(field(16)) != frame_size)
      return error(16, "the size of a frame in the header is " + std::to_string(field(16)) + ", but " +
                           counted(vertex_count_, "vertex takes", "vertices take") + " " +
                           counted(frame_size, "byte", "bytes") + "; export the file again");
    if (Status status = read_table(32, 52, kTriangleSize, 1, "triangle", "triangles", triangles_); !status)
      return status;
    return read_table(40, 56, static_cast<std::size_t>(frame_size), 2, "frame", "frames", frames_);
  }

  [[nodiscard]] Status read_table(std::size_t count_at, std::size_t begin_at, std::size_t record_size,
                                  std::int32_t fewest, const char* one, const std::string& many, Table& table) const {
    const std::int32_t count = field(count_at), begin = field(begin_at);
    if (count < fewest)
      return error(count_at, "the number of " + many + " is " + std::to_string(count) + ", but must be at least " +
                                 std::to_string(fewest) + "; export at least " + (fewest == 1 ? "one " : "two ") +
                                 (fewest == 1 ? one : many));
    if (begin < 0 || static_cast<std::size_t>(begin) > bytes_.size() ||
        !binary::fits(static_cast<std::uint64_t>(count), record_size, bytes_.size() - static_cast<std::size_t>(begin)))
      return error(begin_at, "the file is cut off, since it should have " +
                                 counted(static_cast<std::uint32_t>(count), one, many) + " from byte " +
                                 std::to_string(begin) + " on, but has only " +
                                 counted(bytes_.size(), "byte", "bytes") + "; copy or export it again");
    table = {static_cast<std::size_t>(count), static_cast<std::size_t>(begin), record_size};
    return Success{};
  }

  [[nodiscard]] Status read_corners(std::vector<std::uint32_t>& corners) const {
    corners.reserve(3 * triangles_.count);
    for (std::size_t f = 0; f < triangles_.count; ++f) {
      for (const std::size_t c : {std::size_t{0}, std::size_t{2}, std::size_t{1}}) {
        const std::size_t at = triangles_.record(f) + 2 * c;
        const auto vertex = binary::load<std::uint16_t>(bytes_.data() + at, kMd2Order);
        if (vertex >= vertex_count_)
          return invalid_input(binary::place(name_, at) + ", triangle " + std::to_string(f),
                               "corner " + std::to_string(c) + " refers to vertex " + std::to_string(vertex) +
                                   ", but the file has only " + counted(vertex_count_, "vertex", "vertices") +
                                   "; export the file again");
        corners.push_back(vertex);
      }
    }
    return Success{};
  }

  [[nodiscard]] Status read_frame(std::size_t k, Motion::Keyframe& keyframe) const {
    const std::size_t at = frames_.record(k);
    std::array<double, 6> scale_and_translate{};
    for (std::size_t i = 0; i < 6; ++i)
      scale_and_translate[i] = double{binary::load<float>(bytes_.data() + at + 4 * i, kMd2Order)};
    const std::string_view label = bytes_.substr(at + kNameAt, kNameSize);
    for (const char c : label.substr(0, label.find('\0'))) keyframe.name += c >= ' ' && c <= '~' ? c : '?';

    keyframe.positions.resize(3 * vertex_count_);
    for (std::size_t i = 0; i < keyframe.positions.size(); ++i) {
      const std::size_t axis = i % 3, byte_at = at + kFrameHeaderSize + 4 * (i / 3) + axis;
      const double value = scale_and_translate[axis] *
                               static_cast<double>(binary::load<std::uint8_t>(bytes_.data() + byte_at, kMd2Order)) +
                           scale_and_translate[3 + axis];
      if (const char* const fault = binary::coordinate_fault(value))
        return invalid_input(
            binary::place(name_, byte_at) + ", frame " + std::to_string(k) + ", vertex " + std::to_string(i / 3),
            fault);
      keyframe.positions[i] = static_cast<float>(value);
    }
    return Success{};
  }

  // Sets the times of frames in seconds. The frames of a clip follow each other. A model of several clips becomes an
  // animation: each clip begins at the time at which the previous clip ends, so there are two keyframes at this time,
  // and no segment between these two.
  static void set_times(double frames_per_second, Motion& motion) {
    std::size_t clips = 1;
    double frame = 0;
    for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
      const bool begins = k > 0 && begins_clip(motion.keyframes[k - 1].name, motion.keyframes[k].name);
      clips += begins ? 1 : 0;
      frame += k == 0 || begins ? 0 : 1;
      motion.keyframes[k].time = frame / frames_per_second;
    }
    // Several clips of one frame each are not an animation, because no segment would remain. Such clips are read as one
    // sequence.
    const bool are_clips = clips > 1 && frame > 0;
    for (std::size_t k = 0; k < motion.keyframes.size() && !are_clips; ++k)
      motion.keyframes[k].time = static_cast<double>(k) / frames_per_second;
    motion.connect(are_clips ? MotionKind::kAnimation : MotionKind::kSequence);
  }

  // Returns true if the names of two neighbouring frames show that a new clip begins, such as run1 after stand02, or
  // death201 after death106. Returns false for names without numbers.
  static bool begins_clip(const std::string& before, const std::string& name) {
    const auto digits_at = [](const std::string& text) {
      const std::size_t last = text.find_last_not_of("0123456789");
      return last == std::string::npos ? 0 : last + 1;
    };
    const std::size_t at = digits_at(name), at_before = digits_at(before);
    if (at == name.size() || at_before == before.size()) return false;
    if (name.compare(0, at, before, 0, at_before) != 0) return true;
    // Names in MD2 have 16 characters, so their last digits fit into 64 bits.
    constexpr std::size_t kMostDigits = 15;
    if (name.size() - at > kMostDigits || before.size() - at_before > kMostDigits) return false;
    const unsigned long long number = std::stoull(name.substr(at)), last = std::stoull(before.substr(at_before));
    return number <= last || (number != last + 1 && number % 100 <= 1);
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t vertex_count_ = 0;
  Table triangles_, frames_;
};

}  // namespace

Result<Motion> read_md2(std::string_view bytes, const std::string& name, double frames_per_second) {
  return Md2Reader(bytes, name).read(frames_per_second);
}

}  // namespace chronormal::inline internal

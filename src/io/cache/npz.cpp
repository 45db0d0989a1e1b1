// Reads NumPy files as a motion. Either the positions themselves are read, or only their layout in the file. Writes
// motions as arrays.
#include "io/cache/npz.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/bytes/checksum.h"
#include "io/bytes/expansion.h"
#include "io/bytes/scan.h"
#include "io/bytes/zip.h"
#include "io/cache/npy.h"

namespace chronormal::inline internal {
namespace {

using npy::Array;
using npy::Kind;

constexpr std::endian kNpzOrder = std::endian::little;  // byte order of written files

std::string element_place(const std::string& place, std::initializer_list<std::size_t> indices) {
  std::string text = place + "[";
  for (const std::size_t index : indices) text += (text.back() == '[' ? "" : ", ") + std::to_string(index);
  return text + "]";
}

Status check_positions(const Array& array, const std::string& place, const std::string& what) {
  if (array.kind == Kind::kFloat && array.shape.size() == 3 && array.shape[2] == 3 && array.element_count() > 0)
    return Success{};
  return invalid_input(place,
                       what +
                           " must be an array of float32 or float64 with the shape (keyframes, vertices, 3), and "
                           "must not be empty; this one is " +
                           array.text());
}

// Returns the layout of an array of positions in C order. `begin` is the offset of the array in its file.
CacheLayout layout_of(const Array& array, std::uint64_t begin, const std::string& what) {
  CacheLayout layout;
  layout.vertex_count = static_cast<std::size_t>(array.shape[1]);
  layout.times.resize(static_cast<std::size_t>(array.shape[0]));
  layout.begin = begin + array.data_begin;
  layout.item_size = array.item_size;
  layout.order = array.order;
  layout.array = what;
  return layout;
}

// Finds the origin from which positions are measured. The first sample decides the origin, but the origin is (0, 0, 0)
// if no sample has more digits than float32 holds. If the array is too large to examine, only the first, the middle and
// the last sample are examined.
Origin origin_of(const Array& array) {
  // number of coordinates above which an array is too large to examine
  constexpr std::uint64_t kMostLooked = std::uint64_t{1} << 22;
  const auto samples = static_cast<std::size_t>(array.shape[0]), vertices = static_cast<std::size_t>(array.shape[1]);
  if (array.item_size != sizeof(double) || array.data.size() / array.item_size < array.element_count()) return {};
  const auto coordinate = [&](std::size_t k, std::size_t i) {
    return array.real(array.is_fortran ? k + samples * (i / 3 + vertices * (i % 3)) : k * 3 * vertices + i);
  };
  std::vector<double> first(3 * vertices);
  for (std::size_t i = 0; i < first.size(); ++i) {
    first[i] = coordinate(0, i);
    if (binary::coordinate_fault(first[i]) != nullptr) return {};
  }
  const Origin origin = far_origin(std::span<const double>(first));
  if (origin == Origin{}) return {};
  const auto has_more_digits = [&](std::size_t k) {
    for (std::size_t i = 0; i < first.size(); ++i)
      if (loses_digits(coordinate(k, i), 0)) return true;
    return false;
  };
  const std::size_t step = array.element_count() <= kMostLooked ? 1 : std::max<std::size_t>(samples / 2, 1);
  for (std::size_t k = 0; k < samples; k += step)
    if (has_more_digits(k)) return origin;
  return has_more_digits(samples - 1) ? origin : Origin{};
}

// Reads the samples of an array (T, V, 3) from the file called `name`; `what` is the name of the array for messages.
Result<PositionCache> read_positions(const Array& array, const std::string& name, const std::string& what,
                                     bool may_be_far = true) {
  const std::string place = name + ", " + what;
  if (Status status = check_positions(array, place, what); !status) return status.error();
  const Origin origin = may_be_far ? origin_of(array) : Origin{};
  if (!array.is_fortran) {
    CacheLayout layout = layout_of(array, 0, what);
    layout.begin = 0;
    layout.origin = origin;
    return read_all_samples(layout, array.data, name);
  }
  const auto samples = static_cast<std::size_t>(array.shape[0]), vertices = static_cast<std::size_t>(array.shape[1]);
  PositionCache cache;
  cache.vertex_count = vertices;
  cache.samples.resize(samples);
  cache.origin = origin;
  for (std::size_t k = 0; k < samples; ++k) {
    std::vector<float>& positions = cache.samples[k].positions;
    positions.resize(3 * vertices);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double value = array.real(k + samples * (i / 3 + vertices * (i % 3)));
      if (const char* const fault = binary::coordinate_fault(value); fault != nullptr)
        return invalid_input(element_place(place, {k, i / 3, i % 3}), fault);
      positions[i] = static_cast<float>(value - origin[i % 3]);
    }
  }
  return cache;
}

// The message about faces in the form of VTK and PyVista, in which the number of corners comes before the corners of
// each face.
constexpr const char* kPadded =
    "each face begins with its number of corners, as in VTK and PyVista; save the corners alone, for triangles "
    "faces.reshape(-1, 4)[:, 1:]";

// Returns true if each row of `width` numbers begins with width - 1, the number of corners that follow. Plain faces may
// also begin with this number, if all of them share the vertex with this index. Returns false for such faces: each face
// names that vertex once, and no two faces share the edge opposite to that vertex.
bool are_padded(const std::vector<std::uint32_t>& rows, std::size_t width) {
  if (width < 4 || rows.size() < 2 * width) return false;
  const auto count = static_cast<std::uint32_t>(width - 1);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  bool is_fan = true;
  for (std::size_t row = 0; row < rows.size(); row += width) {
    if (rows[row] != count) return false;
    for (std::size_t c = 1; c < width; ++c) {
      const std::uint32_t a = rows[row + c], b = rows[row + c + 1 < row + width ? row + c + 1 : row + 1];
      is_fan = is_fan && a != count;
      if (c + 1 < width) is_fan = edges.emplace(std::min(a, b), std::max(a, b)).second && is_fan;
    }
  }
  return !is_fan;
}

// Returns true if a list of faces in one dimension is padded: each face begins with its number of corners.
bool is_padded_list(const Array& array) {
  if (array.kind == Kind::kFloat || array.shape.size() != 1) return false;
  const std::size_t size = array.element_count();
  std::size_t at = 0;
  while (at < size) {
    const std::uint64_t corners = array.vertex(at);
    if (corners < 3 || corners >= size - at) return false;
    at += static_cast<std::size_t>(corners) + 1;
  }
  return size > 0;
}

Result<Topology> read_faces(const Array& array, std::size_t vertex_count, const std::string& place) {
  if (is_padded_list(array)) return invalid_input(place, kPadded);
  if (array.kind == Kind::kFloat || array.shape.size() != 2 || array.shape[1] < 3)
    return invalid_input(
        place, "faces must be an array of integers with the shape (faces, 3), or (faces, 4) for quads, but are " +
                   array.text());
  if (array.shape[0] == 0) return invalid_input(place, "there are no faces; save at least one face");
  constexpr std::uint64_t kMostCorners = std::numeric_limits<std::uint32_t>::max();
  if (array.element_count() > kMostCorners)
    return invalid_input(place, "the mesh has more than 4,294,967,295 corners; split the mesh");
  const auto faces = static_cast<std::size_t>(array.shape[0]), corners = static_cast<std::size_t>(array.shape[1]);
  std::vector<std::uint32_t> indices(faces * corners);
  std::optional<std::size_t> wrong;
  bool counts_corners = corners > 3;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::size_t f = i / corners, c = i % corners;
    const std::uint64_t vertex = array.vertex(array.is_fortran ? f + faces * c : i);
    if (c == 0) counts_corners = counts_corners && vertex == corners - 1;
    if (vertex >= vertex_count && !wrong) wrong = i;
    indices[i] = static_cast<std::uint32_t>(vertex);
  }
  if (wrong)
    return invalid_input(element_place(place, {*wrong / corners, *wrong % corners}),
                         counts_corners
                             ? std::string(kPadded)
                             : "the face refers to a vertex that does not exist; vertices are counted from 0 to " +
                                   std::to_string(vertex_count - 1));
  if (are_padded(indices, corners)) return invalid_input(place, kPadded);
  if (corners == 3) return Topology::triangles(vertex_count, std::move(indices));
  std::vector<std::uint32_t> offsets(faces + 1);
  for (std::size_t f = 0; f <= faces; ++f) offsets[f] = static_cast<std::uint32_t>(f * corners);
  return Topology::polygons(vertex_count, std::move(offsets), std::move(indices));
}

Status read_times(const Array& array, PositionCache& cache, const std::string& place) {
  if (array.shape.size() != 1 || array.shape[0] != cache.samples.size())
    return invalid_input(place, "times must be an array of " + counted(cache.samples.size(), "number", "numbers") +
                                    ", one for each keyframe, but are " + array.text());
  for (std::size_t k = 0; k < cache.samples.size(); ++k) {
    double& time = cache.samples[k].time;
    if (array.kind == Kind::kFloat) time = array.real(k);
    if (array.kind == Kind::kInteger) time = static_cast<double>(array.integer(k));
    if (array.kind == Kind::kUnsigned) time = static_cast<double>(array.vertex(k));
    if (!std::isfinite(time))
      return invalid_input(element_place(place, {k}), "the time is NaN or infinite; times must be finite numbers");
  }
  return Success{};
}

// Reads velocities, in units of the positions per second, from an array of the same shape as the positions.
Status take_velocities(const Array& array, const std::string& name, Motion& motion) {
  Result<PositionCache> read = read_positions(array, name, "velocities", false);
  if (!read) return read.error();
  std::vector<PositionCache::Sample>& samples = read.value().samples;
  if (samples.size() != motion.keyframes.size() || read.value().vertex_count != motion.topology.vertex_count())
    return invalid_input(name + ", velocities",
                         "velocities must have the same shape as positions, but are " + array.text());
  for (std::size_t k = 0; k < samples.size(); ++k) motion.keyframes[k].velocities = std::move(samples[k].positions);
  return Success{};
}

void set_regular_times(PositionCache& cache, double frames_per_second) {
  for (std::size_t k = 0; k < cache.samples.size(); ++k)
    cache.samples[k].time = static_cast<double>(k) / frames_per_second;
}

Result<MotionKind> read_kind(std::string_view bytes, const std::string& place) {
  const Result<std::string> text = npy::read_text(bytes, place);
  if (!text) return text.error();
  for (const MotionKind kind : {MotionKind::kSequence, MotionKind::kTargets, MotionKind::kAnimation})
    if (text.value() == motion_kind_name(kind)) return kind;
  return invalid_input(place, "kind must be sequence, targets or animation, but is " + scan::quoted(text.value()));
}

// A reader of the arrays of a .npz file, one at a time.
class Archive {
 public:
  Archive(std::string_view bytes, const std::string& name, std::vector<zip::Member> members, std::size_t max_expansion)
      : bytes_(bytes), name_(name), members_(std::move(members)), expansion_(max_expansion, bytes.size()) {}

  [[nodiscard]] bool has(std::string_view array) const { return find(array) != nullptr; }
  [[nodiscard]] std::string place(std::string_view array) const { return name_ + ", " + std::string(array); }

  // Returns the bytes of the .npy file of a small array. The bytes are valid until the next call.
  [[nodiscard]] Result<std::string_view> bytes(std::string_view array) {
    const zip::Member* const member = find(array);
    if (member == nullptr) return missing(array);
    return zip::read_member(bytes_, *member, npy::kLongestHeader + 12, storage_, name_);
  }

  // Reads the array with the name `array` into storage_, or finds it in the bytes of the file. The result is valid
  // until the next call.
  [[nodiscard]] Result<Array> read(std::string_view array) {
    const zip::Member* const member = find(array);
    if (member == nullptr) return missing(array);
    Result<std::string_view> start = zip::read_member(bytes_, *member, npy::kLongestHeader + 12, storage_, name_);
    if (!start) return start.error();
    Result<Array> result = npy::read_header(start.value(), member->size, place(array));
    if (!result) return result;
    if (Status status = ask_for(*member, result.value()); !status) return status.error();
    const Result<std::string_view> all =
        start.value().size() == member->size
            ? start
            : zip::read_member(bytes_, *member, std::numeric_limits<std::uint64_t>::max(), storage_, name_);
    if (!all) return all.error();
    result.value().data = all.value().substr(result.value().data_begin);
    return result;
  }

  // Finds the layout of an array of positions that can be read sample by sample. Such an array is not compressed, and
  // is in C order.
  [[nodiscard]] Result<std::optional<CacheLayout>> find_stored(std::string_view array) {
    constexpr std::uint16_t kStored = 0;
    const zip::Member* const member = find(array);
    if (member == nullptr || member->method != kStored) return std::optional<CacheLayout>();
    const Result<std::string_view> start = zip::read_member(bytes_, *member, npy::kLongestHeader + 12, storage_, name_);
    if (!start) return start.error();
    const Result<Array> found = npy::read_header(start.value(), member->size, place(array));
    if (!found) return found.error();
    if (Status status = check_positions(found.value(), place(array), std::string(array)); !status)
      return status.error();
    if (found.value().is_fortran) return std::optional<CacheLayout>();
    CacheLayout layout =
        layout_of(found.value(), static_cast<std::uint64_t>(start.value().data() - bytes_.data()), std::string(array));
    Array with_data = found.value();
    with_data.data = layout.begin <= bytes_.size() ? bytes_.substr(static_cast<std::size_t>(layout.begin)) : "";
    layout.origin = origin_of(with_data);
    return std::optional(std::move(layout));
  }

 private:
  [[nodiscard]] Error missing(std::string_view array) const {
    constexpr std::size_t kMostNamed = 8;
    std::string names;
    for (std::size_t i = 0; i < members_.size() && i <= kMostNamed; ++i) {
      const std::string_view name = members_[i].name;
      names += i == 0 ? "" : ", ";
      names += i == kMostNamed ? "..." : std::string(name.ends_with(".npy") ? name.substr(0, name.size() - 4) : name);
    }
    return invalid_input(place(array), "the file has no array of this name" +
                                           (names.empty() ? std::string("; save the array under this name")
                                                          : ", only " + names + "; save the array under this name"));
  }
  [[nodiscard]] const zip::Member* find(std::string_view array) const {
    for (const zip::Member& member : members_) {
      if (member.name.starts_with(array) && member.name.substr(array.size()) == ".npy") return &member;
    }
    return nullptr;
  }

  // Checks that the limit of expansion allows the memory for an array, in addition to everything that was read before.
  // An array takes memory twice, for its bytes and for its numbers.
  [[nodiscard]] Status ask_for(const zip::Member& member, const Array& array) {
    // upper bound of the bytes of memory for a row, for example for a keyframe
    constexpr std::uint64_t kBytesPerRow = 128;
    const std::uint64_t rows = array.shape.size() == 3 ? array.shape[0] : 0;
    asked_ += 2 * std::min(member.size, kMost) + kBytesPerRow * std::min(rows, kMost);
    return expansion_.check(asked_, place(member.name.substr(0, member.name.find('.'))));
  }
  // A cap for any size in bytes. The cap is larger than any real size, and the sum of a few such sizes cannot overflow.
  static constexpr std::uint64_t kMost = std::uint64_t{1} << 48;

  std::string_view bytes_;
  const std::string& name_;
  std::vector<zip::Member> members_;
  Expansion expansion_;
  std::uint64_t asked_ = 0;
  std::string storage_;
};

// Reads a motion. If `layout` is not nullptr, positions that can be read sample by sample are not read, and `layout`
// gets their place in the file.
Result<Motion> read_npz_around(std::string_view bytes, const std::string& name, double frames_per_second,
                               std::size_t max_expansion, std::optional<CacheLayout>* layout) {
  Result<std::vector<zip::Member>> members = zip::read_directory(bytes, name);
  if (!members) return members.error();
  Archive archive(bytes, name, std::move(members).value(), max_expansion);

  if (layout != nullptr && !archive.has("velocities")) {
    const Result<std::optional<CacheLayout>> found = archive.find_stored("positions");
    if (!found) return found.error();
    *layout = found.value();
  }
  Result<PositionCache> cache = PositionCache{};
  if (layout != nullptr && *layout) {
    cache.value().vertex_count = (*layout)->vertex_count;
    cache.value().samples.resize((*layout)->times.size());
    cache.value().origin = (*layout)->origin;
  } else {
    const Result<Array> positions = archive.read("positions");
    if (!positions) return positions.error();
    cache = read_positions(positions.value(), name, "positions");
    if (!cache) return cache.error();
  }

  const Result<Array> faces = archive.read("faces");
  if (!faces) return faces.error();
  Result<Topology> topology = read_faces(faces.value(), cache.value().vertex_count, archive.place("faces"));
  if (!topology) return topology.error();

  set_regular_times(cache.value(), frames_per_second);
  if (archive.has("times")) {
    const Result<Array> times = archive.read("times");
    if (!times) return times.error();
    if (Status status = read_times(times.value(), cache.value(), archive.place("times")); !status)
      return status.error();
  }
  MotionKind kind = MotionKind::kSequence;
  if (archive.has("kind")) {
    const Result<std::string_view> text = archive.bytes("kind");
    if (!text) return text.error();
    const Result<MotionKind> read = read_kind(text.value(), archive.place("kind"));
    if (!read) return read.error();
    kind = read.value();
  }
  // Targets have no times in the file. Here each target's segment goes from time 0 (weight 0) to time 1 (weight 1).
  for (std::size_t k = 0; k < cache.value().samples.size() && kind == MotionKind::kTargets; ++k)
    cache.value().samples[k].time = k == 0 ? 0 : 1;
  Result<Motion> motion = motion_from_cache(std::move(topology).value(), std::move(cache).value(), name, name, kind);
  if (motion && kind == MotionKind::kSequence && archive.has("velocities")) {
    const Result<Array> velocities = archive.read("velocities");
    if (!velocities) return velocities.error();
    if (Status status = take_velocities(velocities.value(), name, motion.value()); !status) return status.error();
  }
  for (std::size_t k = 0; motion && kind == MotionKind::kTargets && k < motion.value().keyframes.size(); ++k)
    motion.value().keyframes[k].name = k == 0 ? "base" : "target " + std::to_string(k - 1);
  return motion;
}

}  // namespace

Result<CacheLayout> find_npy_layout(std::string_view bytes, std::uint64_t size, const std::string& name,
                                    const CacheOptions& options) {
  const Result<Array> array = npy::read_header(bytes, size, name + ", header");
  if (!array) return array.error();
  if (Status status = check_positions(array.value(), name + ", positions", "positions"); !status) return status.error();
  if (array.value().is_fortran)
    return invalid_input(name + ", positions",
                         "positions are in Fortran order; save numpy.ascontiguousarray(positions)");
  CacheLayout layout = layout_of(array.value(), 0, "positions");
  for (std::size_t k = 0; k < layout.times.size(); ++k)
    layout.times[k] = static_cast<double>(k) / options.frames_per_second;
  return layout;
}

Result<PositionCache> read_npy(std::string_view bytes, const std::string& name, const CacheOptions& options) {
  Result<Array> array = npy::read_header(bytes, bytes.size(), name + ", header");
  if (!array) return array.error();
  array.value().data = bytes.substr(array.value().data_begin);
  Result<PositionCache> cache = read_positions(array.value(), name, "positions");
  if (cache) set_regular_times(cache.value(), options.frames_per_second);
  return cache;
}

Result<Motion> read_npz(std::string_view bytes, const std::string& name, double frames_per_second,
                        std::size_t max_expansion) {
  return read_npz_around(bytes, name, frames_per_second, max_expansion, nullptr);
}

Result<Motion> read_npz_outline(std::string_view bytes, const std::string& name, double frames_per_second,
                                std::size_t max_expansion, std::optional<CacheLayout>& layout) {
  return read_npz_around(bytes, name, frames_per_second, max_expansion, &layout);
}

NpyBytes::NpyBytes(const std::vector<std::uint64_t>& shape) : bytes_(npy::write_header("<f4", shape)) {
  std::uint64_t count = 1;
  for (const std::uint64_t length : shape) count *= length;
  bytes_.reserve(addressable(bytes_.size() + sizeof(float) * count));
}

NpyBytes::NpyBytes(const std::vector<std::uint64_t>& shape, std::span<const double> values)
    : bytes_(npy::write_header("<f8", shape)) {
  for (const double value : values) binary::append(bytes_, value, kNpzOrder);
}

NpyBytes::NpyBytes(const std::vector<std::uint64_t>& shape, std::span<const std::int64_t> values)
    : bytes_(npy::write_header("<i8", shape)) {
  for (const std::int64_t value : values) binary::append(bytes_, value, kNpzOrder);
}

NpyBytes::NpyBytes(const std::vector<std::uint64_t>& shape, std::span<const std::uint8_t> values)
    : bytes_(npy::write_header("|b1", shape)) {
  for (const std::uint8_t value : values) bytes_.push_back(static_cast<char>(value));
}

void NpyBytes::append(std::span<const float> values) {
  for (const float value : values) binary::append(bytes_, value, kNpzOrder);
}

Result<std::string> write_npy_faces(const Topology& topology) {
  const std::size_t faces = topology.face_count(), corners = faces == 0 ? 3 : topology.face(0).size();
  for (std::size_t f = 0; f < faces; ++f) {
    if (topology.face(f).size() != corners)
      return Error{ErrorCode::kUsage, "",
                   "an array of faces needs faces of the same size, but face 0 has " +
                       counted(corners, "corner", "corners") + " and face " + std::to_string(f) + " has " +
                       std::to_string(topology.face(f).size()) + "; triangulate the mesh"};
  }
  std::string bytes = npy::write_header(topology.vertex_count() <= 0x80000000U ? "<i4" : "<u4", {faces, corners});
  bytes.reserve(bytes.size() + 4 * topology.corner_count());
  for (const std::uint32_t vertex : topology.corners()) binary::append(bytes, vertex, kNpzOrder);
  return bytes;
}

std::string write_npz(std::span<const NpzMember> members) {
  std::vector<std::string> names;
  for (const NpzMember& member : members) names.push_back(std::string(member.name) + ".npy");
  std::vector<zip::Part> parts;
  for (std::size_t i = 0; i < members.size(); ++i) parts.push_back({names[i], members[i].npy});
  return zip::write(parts);
}

Status write_npz(MotionStream& stream, OutputFile& file) {
  const Motion& motion = stream.motion();
  if (Status status = check_keyframes(motion); !status) return status;
  const Result<std::string> faces = write_npy_faces(motion.topology);
  if (!faces) return faces.error();
  std::vector<double> times;
  for (const Motion::Keyframe& keyframe : motion.keyframes) times.push_back(keyframe.time);
  const NpyBytes time_array({times.size()}, times);
  const std::string kind = npy::write_text(motion_kind_name(motion.kind));
  std::vector<NpzMember> whole = {{"faces", faces.value()}};
  if (motion.kind != MotionKind::kTargets) whole.push_back({"times", time_array.bytes()});
  if (motion.kind != MotionKind::kSequence) whole.push_back({"kind", kind});
  const bool has_velocities = std::none_of(motion.keyframes.begin(), motion.keyframes.end(),
                                           [](const Motion::Keyframe& key) { return key.velocities.empty(); });
  NpyBytes velocities({has_velocities ? motion.keyframes.size() : 0, motion.topology.vertex_count(), 3});
  if (has_velocities) {
    for (const Motion::Keyframe& keyframe : motion.keyframes) velocities.append(keyframe.velocities);
    whole.push_back({"velocities", velocities.bytes()});
  }
  NpzOutput npz(file);
  const bool is_far = motion.origin != Origin{};
  const std::size_t positions =
      npz.add_growing("positions", {motion.keyframes.size(), motion.topology.vertex_count(), 3}, is_far);
  for (const NpzMember& member : whole) npz.add(member);
  if (Status status = npz.begin(); !status) return status;
  Status written = Success{};
  if (!is_far)
    written = each_keyframe(stream, kNpzOrder, [&](std::string_view row) { return npz.append(positions, row); });
  for (std::size_t k = 0; is_far && written && k < motion.keyframes.size(); ++k) {
    written = stream.hold(k, k);
    if (written) written = npz.append(positions, placed_bytes(motion.keyframes[k].positions, motion.origin));
  }
  return written ? npz.finish() : written;
}

std::string placed_bytes(std::span<const float> positions, const Origin& origin) {
  std::string bytes;
  bytes.reserve(sizeof(double) * positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    binary::append(bytes, double{positions[i]} + origin[i % 3], kNpzOrder);
  return bytes;
}

void NpzOutput::add(const NpzMember& member) {
  members_.push_back({std::string(member.name) + ".npy", std::string(member.npy), member.npy.size()});
}

std::size_t NpzOutput::add_growing(std::string_view name, const std::vector<std::uint64_t>& shape, bool is_double) {
  std::uint64_t size = is_double ? sizeof(double) : sizeof(float);
  for (const std::uint64_t length : shape) size *= length;
  std::string header = npy::write_header(is_double ? "<f8" : "<f4", shape);
  size += header.size();
  members_.push_back({std::string(name) + ".npy", std::move(header), size});
  return members_.size() - 1;
}

zip::Frame NpzOutput::frame() const {
  std::vector<zip::StoredMember> stored;
  for (const Member& member : members_) stored.push_back({member.name, member.size, member.checksum});
  return zip::frame_of(stored);
}

Status NpzOutput::begin() {
  const zip::Frame zip = frame();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    members_[i].end = zip.headers[i].end();
    if (Status status = append(i, members_[i].start); !status) return status;
  }
  return Success{};
}

Status NpzOutput::append(std::size_t array, std::string_view bytes) {
  Member& member = members_[array];
  member.checksum = checksum_of(bytes, member.checksum);
  Status status = file_->put(member.end, bytes);
  member.end += bytes.size();
  return status;
}

void NpzOutput::join() {
  const zip::Frame zip = frame();
  for (std::size_t i = 0; i < members_.size(); ++i) members_[i].end = zip.headers[i].end() + members_[i].start.size();
}

void NpzOutput::add_checksum(std::size_t array, std::uint32_t checksum, std::uint64_t bytes) {
  members_[array].checksum = joined_checksum(members_[array].checksum, checksum, bytes);
}

Status NpzOutput::finish() {
  const zip::Frame zip = frame();
  for (const zip::Frame::Header& header : zip.headers)
    if (Status status = file_->put(header.at, header.bytes); !status) return status;
  return file_->put(zip.directory.at, zip.directory.bytes);
}

}  // namespace chronormal::inline internal

// Implements MeshNormals. An element has its own normal, and an output shows the normal of an element. If output i is
// always element i, kernels write straight to the caller's memory. If outputs share elements, the code goes through the
// outputs in order, and evaluates a tile of elements when an output shows an element of the tile for the first time.
// Tiles are kept in slots on the stack, which hold the last thousand elements. Neighbouring outputs show neighbouring
// elements, so each tile is evaluated about once. For a range of outputs, only that range is visited. Only memory on
// the stack is needed, so any thread may evaluate any range.
#include "chronormal/normals/mesh_normals.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/blocks.h"
#include "core/text.h"
#include "normals/blend/blend_normals.h"
#include "normals/control/local_time.h"
#include "normals/curves/curve_builder.h"
#include "normals/curves/curve_count.h"
#include "normals/curves/curve_data.h"
#include "normals/curves/curve_evaluation.h"
#include "normals/curves/kernels/evaluate.h"
#include "normals/curves/outputs.h"

namespace chronormal {
namespace {

constexpr std::size_t kOutputPiece = 16384;  // number of outputs that a thread writes at a time
constexpr std::size_t kSlotElements = 1024;  // vectors of this many elements take 12 KiB
constexpr std::size_t kElementsOfManyTimes = 8192;

Status check_positions(const Topology& topology, VectorView<const float> positions, std::size_t keyframe) {
  const std::string place = "keyframe " + std::to_string(keyframe);
  if (positions.count != topology.vertex_count()) {
    return invalid_input(place, "the keyframe has " + counted(positions.count, "position", "positions") +
                                    ", but the mesh has " + counted(topology.vertex_count(), "vertex", "vertices") +
                                    "; give one position for each vertex");
  }
  for (std::size_t i = 0; i < positions.count; ++i) {
    if (!is_finite(to_double(positions[i])))
      return invalid_input(place + ", vertex " + std::to_string(i),
                           "the position is NaN or infinite; positions must be finite numbers");
  }
  return Success{};
}

std::vector<float> packed_copy(VectorView<const float> positions) {
  std::vector<float> result(3 * positions.count);
  const auto view = VectorView<float>::packed(result);
  for (std::size_t i = 0; i < positions.count; ++i) view.set(i, positions[i]);
  return result;
}

// Returns a motion with the base, and with the mesh at full weight of each target, as keyframes. These keyframes show
// which vertices coincide in the base and at full weight of every target.
Motion star_of(const BlendSet& set) {
  Motion star;
  star.topology = set.topology;
  star.keyframes = {{set.base, 0, "base"}};
  for (const BlendTarget& target : set.targets) {
    std::vector<float> moved = set.base;
    for (std::size_t n = 0; n < target.vertices.size(); ++n)
      for (std::size_t c = 0; c < 3; ++c) moved[std::size_t{3} * target.vertices[n] + c] += target.deltas[3 * n + c];
    star.keyframes.push_back({std::move(moved), 1, ""});
  }
  star.connect_as_targets();
  return star;
}

bool are_the_outputs(const NormalGroups& groups) {
  const auto elements = groups.element_of_output();
  if (groups.size() != elements.size()) return false;
  for (std::size_t i = 0; i < elements.size(); ++i)
    if (elements[i] != i) return false;
  return true;
}

// The normals of some elements as vectors x y z.
struct Vectors {
  template <std::size_t kCount>
  struct Array {
    alignas(64) float xyz[3 * kCount];
    [[nodiscard]] VectorView<float> view(std::size_t first, std::size_t count) {
      return VectorView<float>::packed(xyz + 3 * first, count);
    }
    [[nodiscard]] Vec3f operator[](std::size_t i) const { return {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]}; }
  };
};
// The normals of some elements in an encoding of four bytes.
template <class Encoded>
struct Words {
  template <std::size_t kCount>
  struct Array {
    alignas(64) Encoded values[kCount];
    [[nodiscard]] std::span<Encoded> view(std::size_t first, std::size_t count) { return {values + first, count}; }
    [[nodiscard]] const Encoded& operator[](std::size_t i) const { return values[i]; }
  };
};

// The type of the memory on the stack that holds normals for a form of output.
template <class Output>
struct ValuesOf {
  using type = Vectors;
};
template <>
struct ValuesOf<OctahedralOutput> {
  using type = Words<Octahedral>;
};
template <>
struct ValuesOf<Rgb10A2Output> {
  using type = Words<Rgb10A2>;
};

template <class Output>
void put(const Output& output, std::size_t i, const Vec3f& value) {
  output.set(i, value);
}
void put(const OctahedralOutput& output, std::size_t i, Octahedral value) { output.result[i] = value; }
void put(const Rgb10A2Output& output, std::size_t i, Rgb10A2 value) { output.result[i] = value; }

// A form of output for memory that begins with element `first` and not with element 0.
template <class Form>
struct Shifted {
  Form form;
  std::size_t first;

  void write(const BlockSpan& span, const CurveWeights& weights, std::size_t element) const {
    form.write(span, weights, element - first);
  }
  void set(std::size_t element, const Vec3f& v) const { form.set(element - first, v); }
};
template <class Form>
Shifted(Form, std::size_t) -> Shifted<Form>;  // clang 14 does not deduce this for an aggregate

PackedOutput form_of(const VectorView<float>& view) { return {view, MemoryAccess{}}; }
OctahedralOutput form_of(std::span<Octahedral> view) { return {view, MemoryAccess{}}; }
Rgb10A2Output form_of(std::span<Rgb10A2> view) { return {view, MemoryAccess{}}; }

// The evaluation of a segment at one t.
struct AtTime {
  // The number of elements of a tile, which is also the number of bits that write_tile() returns. A smaller number
  // would be slower, since starting an evaluation takes as long as evaluating some elements.
  static constexpr std::size_t kTileElements = 64;
  template <class Output>
  using Values = typename ValuesOf<Output>::type;

  AtTime(const CurveData& of_curves, const LocalTime& time)
      : curves(of_curves), t(local_time(time)), weights(CurveWeights::at(t, !of_curves.keeps_lengths)) {}

  [[nodiscard]] std::size_t size() const noexcept { return curves.size; }

  // Writes the normals of a range of elements to their places in the memory for all elements. The first element must be
  // the first of a tile. Returns the number of elements that have no direction.
  template <class Output>
  std::size_t write(IndexRange elements, const Output& output) const noexcept {
    return evaluate_range(curves, elements, t, weights, output);
  }
  // Writes the normals of a range of elements to memory that begins with the first element of the range. Returns a
  // number whose bits mark the elements that have no direction.
  template <class View>
  std::uint64_t write_tile(IndexRange elements, const View& view) const noexcept {
    const std::size_t zeros = evaluate_range(curves, elements, t, weights, Shifted{form_of(view), elements.first});
    return zeros == 0 ? 0 : without_direction(elements);
  }

 private:
  [[nodiscard]] std::uint64_t without_direction(IndexRange elements) const noexcept {
    Vectors::Array<kTileElements> vectors;
    evaluate_range(curves, elements, t, weights, Shifted{form_of(vectors.view(0, elements.count)), elements.first});
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < elements.count; ++i)
      if (vectors[i] == Vec3f{}) bits |= std::uint64_t{1} << i;
    return bits;
  }

  const CurveData& curves;
  LocalTime t;
  CurveWeights weights;
};

// The evaluation of blend shapes at the current weights.
struct AtWeights {
  static constexpr std::size_t kTileElements = 64;
  template <class Output>
  using Values = Vectors;

  explicit AtWeights(const BlendNormals& of_normals) : normals(of_normals) {}

  [[nodiscard]] std::size_t size() const noexcept { return normals.size(); }

  template <class Output>
  std::size_t write(IndexRange elements, const Output& output) const noexcept {
    if constexpr (requires { output.result.x; }) {
      return normals.unit_normals(elements, output.result.part(elements)).zeros;
    } else {
      Vectors::Array<kSlotElements> vectors;
      std::size_t zeros = 0;
      for (std::size_t first = elements.first; first < elements.end(); first += kSlotElements) {
        const IndexRange some{first, std::min(kSlotElements, elements.end() - first)};
        zeros += normals.unit_normals(some, vectors.view(0, some.count)).zeros;
        for (std::size_t i = 0; i < some.count; ++i) put(output, first + i, vectors[i]);
      }
      return zeros;
    }
  }
  std::uint64_t write_tile(IndexRange elements, const VectorView<float>& view) const noexcept {
    if (normals.unit_normals(elements, view).zeros == 0) return 0;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < elements.count; ++i)
      if (view[i] == Vec3f{}) bits |= std::uint64_t{1} << i;
    return bits;
  }

  const BlendNormals& normals;
};

template <class Source>
IndexRange tile_of(const Source& source, std::size_t tile) {
  const std::size_t first = tile * Source::kTileElements;
  return {first, std::min(Source::kTileElements, source.size() - first)};
}

// Writes the normals of a range of outputs if output i is always element i. Memory on the stack is only used for a
// range that begins within a tile.
template <class Source, class Output>
std::size_t write_elements(const Source& source, IndexRange outputs, const Output& output) noexcept {
  constexpr std::size_t kElements = Source::kTileElements;
  const std::size_t inside = outputs.first % kElements;
  if (inside == 0) return outputs.count == 0 ? 0 : source.write(outputs, output);
  typename Source::template Values<Output>::template Array<kElements> values;
  const IndexRange tile = tile_of(source, outputs.first / kElements);
  const std::uint64_t none = source.write_tile(tile, values.view(0, tile.count));
  const std::size_t end = std::min(outputs.end(), tile.end());
  std::size_t zeros = 0;
  for (std::size_t i = outputs.first; i < end; ++i) {
    put(output, i, values[i - tile.first]);
    zeros += none >> (i - tile.first) & 1;
  }
  if (end < outputs.end()) zeros += source.write({end, outputs.end() - end}, output);
  return zeros;
}

// Writes the normals of a range of outputs that share elements.
template <class Source, class Output>
std::size_t write_shared(const Source& source, std::span<const std::uint32_t> element_of_output, IndexRange outputs,
                         const Output& output) noexcept {
  constexpr std::size_t kElements = Source::kTileElements, kSlots = kSlotElements / kElements;
  constexpr std::size_t kEmpty = ~std::size_t{0};
  typename Source::template Values<Output>::template Array<kSlotElements> values;
  std::array<std::size_t, kSlots> tile_in;
  std::array<std::uint64_t, kSlots> none;
  tile_in.fill(kEmpty);
  std::size_t zeros = 0;
  std::uint64_t any_none = 0;
  for (std::size_t i = outputs.first; i < outputs.end(); ++i) {
    const std::size_t element = element_of_output[i], tile = element / kElements, slot = tile % kSlots;
    const std::size_t inside = element % kElements;
    if (tile_in[slot] != tile) {
      const IndexRange elements = tile_of(source, tile);
      none[slot] = source.write_tile(elements, values.view(kElements * slot, elements.count));
      any_none |= none[slot];
      tile_in[slot] = tile;
    }
    put(output, i, values[element % kSlotElements]);
    if (any_none != 0) zeros += none[slot] >> inside & 1;
  }
  return zeros;
}

// Returns the control normals of one element of curves with the tolerance kExactTolerance. (If n(t) is constant or
// linear, these are the control normals that the curves have stored.)
ControlNormals control_normals_of(const CurveData& curves, std::size_t element) {
  const auto& flagged = curves.flagged.numbers;
  const auto at = std::lower_bound(flagged.begin(), flagged.end(), element);
  if (at != flagged.end() && *at == element) {
    const auto index = static_cast<std::size_t>(at - flagged.begin());
    const double scale = std::ldexp(1.0, curves.flagged.exponents[index]);
    const ControlNormals c = curves.flagged.scaled_normals(index);
    return {scale * c.n0, scale * c.m, scale * c.n1};
  }
  const std::size_t block = element / kTile;
  const auto run =
      std::prev(std::upper_bound(curves.runs.begin(), curves.runs.end(), block,
                                 [](std::size_t b, const CurveData::Run& r) { return b < r.first_block; }));
  if (run->kind == BlockKind::kNone) return {};
  const float* const p = reinterpret_cast<const float*>(curves.blocks.data() + run->offset +
                                                        (block - run->first_block) * kTile * bytes_of(run->kind)) +
                         element % kTile;
  const double scale = std::ldexp(1.0, curves.exponents.empty() ? 0 : curves.exponents[block]);
  const auto vector = [p, scale](std::size_t k) {
    const float* const v = p + 3 * kTile * k;
    return scale * to_double(Vec3f{v[0], v[kTile], v[2 * kTile]});
  };
  if (run->kind == BlockKind::kUnitLength) {
    const Vec3d n = static_cast<double>(p[3 * kTile]) * vector(0);
    return {n, n, n};
  }
  const Vec3d n0 = vector(0), last = vector(1);
  if (run->kind == BlockKind::kLinear32) return {n0, 0.5 * (n0 + last), last};
  return {n0, last, vector(2)};
}

std::int32_t snorm(double value, int bits) {
  const double most = static_cast<double>((1 << (bits - 1)) - 1);
  return static_cast<std::int32_t>(std::lrint(std::clamp(value, -1.0, 1.0) * most));
}

void write_control_normals(const ControlNormals& c, ControlFormat format, std::byte* to) {
  const std::array<Vec3d, 3> vectors = {c.n0, c.m, c.n1};
  const double largest = std::max({max_abs(c.n0), max_abs(c.m), max_abs(c.n1)}), scale = largest > 0 ? 1 / largest : 0;
  const auto component = [](const Vec3d& v, std::size_t k) { return k == 0 ? v.x : k == 1 ? v.y : v.z; };
  if (format == ControlFormat::kFloat32) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    std::array<float, 9> values{};
    for (std::size_t i = 0; i < 9; ++i)
      values[i] = static_cast<float>(std::clamp(component(vectors[i / 3], i % 3), -kLargest, kLargest));
    std::memcpy(to, values.data(), sizeof(values));
  } else if (format == ControlFormat::kSnorm16) {
    std::array<std::int16_t, 10> values{};
    for (std::size_t i = 0; i < 9; ++i)
      values[i] = static_cast<std::int16_t>(snorm(scale * component(vectors[i / 3], i % 3), 16));
    std::memcpy(to, values.data(), sizeof(values));
  } else {
    std::array<std::uint32_t, 3> words{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto bits_of = [&](const Vec3d& v, int bits) {
        return static_cast<std::uint32_t>(snorm(scale * component(v, k), bits)) & ((1U << bits) - 1);
      };
      words[k] = bits_of(c.n0, 11) | bits_of(c.n1, 11) << 11U | bits_of(c.m, 10) << 22U;
    }
    std::memcpy(to, words.data(), sizeof(words));
  }
}

}  // namespace

std::size_t bytes_of(ControlFormat format) noexcept {
  return format == ControlFormat::kFloat32 ? 36 : format == ControlFormat::kSnorm16 ? 20 : 12;
}

struct MeshNormals::Parts {
  Parts(Topology of_topology, const MeshNormalsOptions& of_options)
      : mesh(std::make_shared<const Topology>(std::move(of_topology))),
        options(of_options),
        group_of_face(options.elements.group_of_face.begin(), options.elements.group_of_face.end()),
        normal_of_corner(packed_copy(options.elements.normal_of_corner)) {
    options.elements.group_of_face = group_of_face;
    options.elements.normal_of_corner = VectorView<const float>::packed(normal_of_corner);
  }
  // Creates another object for the same mesh, without positions.
  Parts(const Parts& other, std::shared_ptr<const Topology> of_mesh)
      : mesh(std::move(of_mesh)),
        options(other.options),
        group_of_face(other.group_of_face),
        normal_of_corner(other.normal_of_corner),
        groups(other.groups),
        shares(other.shares) {
    options.elements.group_of_face = group_of_face;
    options.elements.normal_of_corner = VectorView<const float>::packed(normal_of_corner);
  }

  [[nodiscard]] const Topology& topology() const noexcept { return *mesh; }

  [[nodiscard]] bool are_faces() const noexcept { return options.elements.kind == ElementKind::kFaces; }
  [[nodiscard]] bool knows_elements() const noexcept { return are_faces() || groups != nullptr; }
  [[nodiscard]] const NormalGroups* elements() const noexcept { return groups.get(); }
  [[nodiscard]] std::size_t size() const noexcept {
    if (are_faces()) return topology().face_count();
    return options.elements.kind == ElementKind::kVertices ? topology().vertex_count() : topology().corner_count();
  }
  [[nodiscard]] IndexRange clamped(IndexRange outputs) const noexcept {
    const std::size_t first = std::min(outputs.first, size());
    return {first, std::min(outputs.count, size() - first)};
  }

  // Decides which outputs share a normal. The groups are made once for each mesh.
  Status share(const Motion& motion) {
    Result<NormalGroups> made = make_groups(motion, options.elements);
    if (!made) return made.error();
    groups = std::make_shared<const NormalGroups>(std::move(made).value());
    shares = !are_the_outputs(*groups);
    group_of_face = {}, normal_of_corner = {};
    options.elements.group_of_face = {}, options.elements.normal_of_corner = {};
    return Success{};
  }

  Status check(VectorView<const float> from, VectorView<const float> to) {
    if (Status status = check_positions(topology(), from, 0); !status) return status;
    if (Status status = check_positions(topology(), to, 1); !status) return status;
    if (knows_elements()) return Success{};
    Motion motion;
    motion.topology = topology();
    motion.keyframes = {{packed_copy(from), 0, "from"}, {packed_copy(to), 1, "to"}};
    motion.connect_as_sequence();
    return share(motion);
  }

  void fit(const Segment& segment) {
    const WeightingFit fitted = fit_weighting(segment, *groups, options.weighting);
    fit_bound = fitted.bounds.empty() ? 0 : *std::max_element(fitted.bounds.begin(), fitted.bounds.end());
    curves = build_curves(fitted.normals, CurveOptions{options.tolerance});
  }

  template <class Source, class Output>
  std::size_t write(const Source& source, IndexRange outputs, const Output& output) const noexcept {
    if (outputs.count == 0) return 0;
    const std::size_t zeros = shares ? write_shared(source, groups->element_of_output(), outputs, output)
                                     : write_elements(source, outputs, output);
    flush_stream();
    return zeros;
  }

  template <class Output>
  static std::size_t write_zeros(IndexRange outputs, const Output& output) noexcept {
    for (std::size_t i = outputs.first; i < outputs.end(); ++i) output.set(i, {});
    return outputs.count;
  }

  // Writes the normals of a range of outputs at one time. Writes zeros if the time is NaN or if there is no segment.
  template <class Output>
  std::size_t write(const LocalTime& t, IndexRange outputs, const Output& output) const noexcept {
    if (std::isnan(t.t) || curves.size == 0) return write_zeros(outputs, output);
    return write(AtTime(curves, t), outputs, output);
  }

  [[nodiscard]] MemoryAccess access(std::size_t bytes_of_result) const noexcept {
    return access_of_pass(curves.blocks.size(), size() * bytes_of_result);
  }

  std::shared_ptr<const Topology> mesh;  // shared by all objects that another() has created
  MeshNormalsOptions options;
  std::vector<std::uint32_t> group_of_face;  // kept until the outputs that share a normal are known
  std::vector<float> normal_of_corner;       // kept until the outputs that share a normal are known
  // The groups, which all objects for one mesh share as soon as the groups are known; nullptr if the elements are
  // faces.
  std::shared_ptr<const NormalGroups> groups;
  bool shares = false;      // true if outputs share elements; false if output i is always element i
  CurveData curves, spare;  // curves of the current segment, and memory for those of the next
  double fit_bound = 0;
  Segment next;
  bool has_next = false;
  std::optional<CurveSlices> slices;  // builds the curves of the next segment; no value if the normals are fits
  std::optional<BlendNormals> blend;
};

MeshNormals::MeshNormals(std::unique_ptr<Parts> parts) noexcept : parts_(std::move(parts)) {}
MeshNormals::MeshNormals(MeshNormals&&) noexcept = default;
MeshNormals& MeshNormals::operator=(MeshNormals&&) noexcept = default;
MeshNormals::~MeshNormals() = default;

Result<MeshNormals> MeshNormals::make(Topology topology, const MeshNormalsOptions& options) {
  if (topology.face_count() == 0)
    return invalid_input("", "the mesh has no faces, so it has no normals; give it faces");
  if (options.elements.kind == ElementKind::kFaces && options.weighting != Weighting::kArea)
    return Error{ErrorCode::kUsage, "weighting",
                 "a weighting has no meaning for normals of faces; choose vertices or corners"};
  return MeshNormals(std::make_unique<Parts>(std::move(topology), options));
}

Result<MeshNormals> MeshNormals::make(const Motion& motion, const MeshNormalsOptions& options) {
  Result<MeshNormals> made = make(motion.topology, options);
  if (!made || made.value().parts_->are_faces()) return made;
  if (const Status status = made.value().parts_->share(motion); !status) return status.error();
  return made;
}

MeshNormals MeshNormals::another() const { return MeshNormals(std::make_unique<Parts>(*parts_, parts_->mesh)); }

Status MeshNormals::set_segment(VectorView<const float> from, VectorView<const float> to) {
  return set_segment(Segment{parts_->mesh.get(), from, to});
}

Status MeshNormals::set_segment(const Segment& given) {
  Parts& parts = *parts_;
  if (Status status = parts.check(given.from, given.to); !status) return status;
  Segment segment = given;
  segment.topology = parts.mesh.get();
  parts.slices.reset();
  parts.has_next = false;
  const CurveOptions options{parts.options.tolerance};
  if (parts.are_faces())
    parts.curves = build_curves(segment, options, parts.options.threads, &parts.curves);
  else if (parts.options.weighting == Weighting::kArea)
    parts.curves = build_curves(segment, *parts.groups, options, parts.options.threads, &parts.curves);
  else
    parts.fit(segment);
  return Success{};
}

Status MeshNormals::begin_segment(VectorView<const float> from, VectorView<const float> to) {
  Parts& parts = *parts_;
  if (Status status = parts.check(from, to); !status) return status;
  parts.next = {parts.mesh.get(), from, to};
  parts.has_next = true;
  parts.slices.reset();
  if (parts.options.weighting == Weighting::kArea)
    parts.slices.emplace(parts.next, parts.elements(), CurveOptions{parts.options.tolerance}, &parts.spare);
  return Success{};
}

bool MeshNormals::prepare(double share) { return !parts_->slices || parts_->slices->advance(share); }

void MeshNormals::finish_segment() {
  Parts& parts = *parts_;
  if (parts.slices) {
    parts.spare = std::exchange(parts.curves, parts.slices->finish());
    parts.slices.reset();
  } else if (parts.has_next) {
    parts.fit(parts.next);
  }
  parts.has_next = false;
}

std::size_t MeshNormals::unit_normals(const LocalTime& t, VectorView<float> result, IndexRange outputs) const noexcept {
  assert(result.count == size());
  return with_output(result, parts_->access(3 * sizeof(float)),
                     [&](const auto& output) { return parts_->write(t, parts_->clamped(outputs), output); });
}

std::size_t MeshNormals::unit_normals(const LocalTime& t, std::span<Octahedral> result,
                                      IndexRange outputs) const noexcept {
  assert(result.size() == size());
  return parts_->write(t, parts_->clamped(outputs), OctahedralOutput(result, parts_->access(sizeof(Octahedral))));
}

std::size_t MeshNormals::unit_normals(const LocalTime& t, std::span<Rgb10A2> result,
                                      IndexRange outputs) const noexcept {
  assert(result.size() == size());
  return parts_->write(t, parts_->clamped(outputs), Rgb10A2Output(result, parts_->access(sizeof(Rgb10A2))));
}

std::size_t MeshNormals::unit_normals(std::span<const double> times, std::span<const VectorView<float>> results,
                                      IndexRange outputs) const noexcept {
  assert(results.size() == times.size());
  const IndexRange all = parts_->clamped(outputs);
  std::size_t zeros = 0;
  for (std::size_t first = all.first; first < all.end();) {
    const std::size_t end = std::min(all.end(), (first / kElementsOfManyTimes + 1) * kElementsOfManyTimes);
    for (std::size_t k = 0; k < times.size(); ++k) zeros += unit_normals(times[k], results[k], {first, end - first});
    first = end;
  }
  return zeros;
}

std::size_t MeshNormals::unit_normals(const LocalTime& t, VectorView<float> result, Threads threads) const {
  std::atomic<std::size_t> zeros = 0;
  blocks_on(threads, size(), kOutputPiece, [&](IndexRange outputs) { zeros += unit_normals(t, result, outputs); });
  return zeros;
}

Status MeshNormals::fill_vertex_buffer(ControlFormat format, std::span<std::byte> bytes) const {
  const Parts& parts = *parts_;
  if (!parts.curves.keeps_lengths || parts.curves.size == 0)
    return Error{ErrorCode::kUsage, "",
                 "a vertex buffer can only be filled after set_segment(), and only if make() got a tolerance of 1e-6; "
                 "call set_segment() first, or make() with 1e-6"};
  const std::size_t each = bytes_of(format);
  if (bytes.size() != size() * each)
    return Error{ErrorCode::kUsage, "bytes",
                 "the buffer has " + counted(bytes.size(), "byte", "bytes") + " for " +
                     counted(size(), "normal", "normals") + ", but must have " + std::to_string(each) + " for each"};
  for (std::size_t i = 0; i < size(); ++i) {
    const std::size_t element = parts.shares ? parts.groups->element_of_output()[i] : i;
    write_control_normals(control_normals_of(parts.curves, element), format, bytes.data() + each * i);
  }
  return Success{};
}

Status MeshNormals::set_targets(BlendSet set) {
  Parts& parts = *parts_;
  if (parts.options.weighting != Weighting::kArea)
    return Error{ErrorCode::kUsage, "weighting",
                 "normals of blend shapes can only be weighted by area; choose this weighting"};
  if (!(set.topology == parts.topology()))
    return invalid_input("", "the blend shapes belong to another mesh; give the blend shapes of this mesh");
  if (Status status = validate(set); !status) return status;
  if (!parts.knows_elements()) {
    if (Status status = parts.share(star_of(set)); !status) return status;
  }
  const BlendNormalsOptions options{parts.options.most_blend_bytes, std::nullopt, parts.options.blends_in_float32};
  parts.blend = parts.are_faces() ? BlendNormals::of_faces(std::move(set), options)
                                  : BlendNormals::of_groups(std::move(set), *parts.groups, options);
  return Success{};
}

void MeshNormals::set_weights(std::span<const double> weights, Threads threads) {
  assert(parts_->blend);
  parts_->blend->set_weights(weights, threads);
}

std::size_t MeshNormals::unit_normals(VectorView<float> result, IndexRange outputs) const noexcept {
  assert(result.count == size() && parts_->blend);
  return with_output(result, MemoryAccess{}, [&](const auto& output) {
    return parts_->write(AtWeights(*parts_->blend), parts_->clamped(outputs), output);
  });
}

std::size_t MeshNormals::unit_normals(std::span<Octahedral> result, IndexRange outputs) const noexcept {
  assert(result.size() == size() && parts_->blend);
  return parts_->write(AtWeights(*parts_->blend), parts_->clamped(outputs), OctahedralOutput(result, MemoryAccess{}));
}

std::size_t MeshNormals::unit_normals(std::span<Rgb10A2> result, IndexRange outputs) const noexcept {
  assert(result.size() == size() && parts_->blend);
  return parts_->write(AtWeights(*parts_->blend), parts_->clamped(outputs), Rgb10A2Output(result, MemoryAccess{}));
}

std::size_t MeshNormals::unit_normals(std::span<const double> weights, VectorView<float> result, Threads threads) {
  set_weights(weights, threads);
  std::atomic<std::size_t> zeros = 0;
  blocks_on(threads, size(), kOutputPiece, [&](IndexRange outputs) { zeros += unit_normals(result, outputs); });
  return zeros;
}

std::size_t MeshNormals::size() const noexcept { return parts_->size(); }

std::size_t MeshNormals::element_count() const noexcept {
  return parts_->groups ? parts_->groups->size() : parts_->size();
}

const Topology& MeshNormals::topology() const noexcept { return parts_->topology(); }
const MeshNormalsOptions& MeshNormals::options() const noexcept { return parts_->options; }
double MeshNormals::fit_bound() const noexcept { return parts_->fit_bound; }

std::size_t MeshNormals::bytes() const noexcept {
  const std::size_t of_curves = parts_->curves.size > 0 ? CurveCount::of(parts_->curves).bytes(parts_->curves.size) : 0;
  return of_curves + (parts_->blend ? parts_->blend->bytes() : 0);
}

}  // namespace chronormal

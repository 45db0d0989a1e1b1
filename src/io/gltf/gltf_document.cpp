#include "chronormal/io/gltf_document.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "core/charconv.h"
#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/bytes/expansion.h"
#include "io/bytes/extension.h"
#include "io/bytes/file.h"
#include "io/bytes/known_kinds.h"
#include "io/gltf/decode/gltf_bytes.h"
#include "io/gltf/decode/gltf_draco.h"
#include "io/gltf/glb/glb.h"
#include "io/gltf/gltf_document_state.h"
#include "io/gltf/gltf_lone_weights.h"
#include "io/gltf/model/gltf_model.h"
#include "io/system/names.h"

namespace chronormal {

namespace {

// Returns the triangles of a list, strip or fan (section 3.7.2.1 of the specification). Every second triangle of a
// strip is reversed, so that all triangles face the same side. Indices that do not complete a triangle are dropped.
std::vector<std::uint32_t> to_triangles(int mode, std::vector<std::uint32_t> elements) {
  if (mode == 4) {
    elements.resize(elements.size() - elements.size() % 3);
    return elements;
  }
  std::vector<std::uint32_t> corners;
  const std::size_t count = elements.size() < 3 ? 0 : elements.size() - 2;
  corners.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    if (mode == 5)
      corners.insert(corners.end(), {elements[i], elements[i + 1 + i % 2], elements[i + 2 - i % 2]});
    else
      corners.insert(corners.end(), {elements[i + 1], elements[i + 2], elements[0]});
  }
  return corners;
}

std::vector<std::uint32_t> all_vertices(std::size_t count) {
  std::vector<std::uint32_t> elements(count);
  for (std::size_t i = 0; i < count; ++i) elements[i] = static_cast<std::uint32_t>(i);
  return elements;
}

}  // namespace

GltfDocument::GltfDocument(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
GltfDocument::GltfDocument(GltfDocument&&) noexcept = default;
GltfDocument& GltfDocument::operator=(GltfDocument&&) noexcept = default;
GltfDocument::~GltfDocument() = default;

const std::string& GltfDocument::name() const noexcept { return state_->name; }
const std::vector<GltfMesh>& GltfDocument::meshes() const noexcept { return state_->model.meshes; }
const std::vector<GltfNode>& GltfDocument::nodes() const noexcept { return state_->model.nodes; }
const std::vector<GltfAnimation>& GltfDocument::animations() const noexcept { return state_->model.animations; }
const std::vector<std::string>& GltfDocument::extensions() const noexcept { return state_->model.extensions; }

const std::vector<Error>& GltfDocument::notes() const noexcept { return state_->model.notes; }

Expansion GltfDocument::expansion() const { return state_->bytes.expansion(); }

AffineTransform GltfDocument::world_transform(std::size_t node) const noexcept {
  const auto& placements = state_->model.placements;
  AffineTransform result;
  for (std::optional<std::uint32_t> at = static_cast<std::uint32_t>(node); at; at = nodes()[*at].parent) {
    const auto found = std::lower_bound(placements.begin(), placements.end(), *at,
                                        [](const auto& entry, std::size_t index) { return entry.first < index; });
    if (found != placements.end() && found->first == *at) result = composed(gltf::transform_of(found->second), result);
  }
  return result;
}

bool GltfDocument::recognises(std::string_view first_bytes) noexcept {
  if (is_glb(first_bytes)) return true;
  if (first_bytes.starts_with("\xEF\xBB\xBF")) first_bytes.remove_prefix(3);
  const std::size_t first = first_bytes.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && first_bytes[first] == '{';
}

Result<GltfDocument> GltfDocument::open(const std::string& path, const GltfOptions& options) {
  Result<FileBytes> file = FileBytes::open(path, options.resolve);
  if (!file) return file.error();
  std::optional<std::string> folder;
  if (path != "-") folder = folder_of(path);
  const std::string name = path == "-" ? "<stdin>" : file_name(path);
  return read(std::move(file).value(), name, folder, options);
}

Result<GltfDocument> GltfDocument::read(FileBytes file, const std::string& name,
                                        const std::optional<std::string>& folder, const GltfOptions& options) {
  Result<GltfDocument> document = read(file.bytes(), name, folder, options);
  // Views of the bytes stay valid after `file` is moved, because the bytes are either mapped, or in a string that is
  // too long to be stored inside the string object.
  if (document) document.value().state_->file = std::move(file);
  return document;
}

namespace {

// Returns the times of the keys of several channels, each of which drives a single weight. The result has each time
// once, in ascending order.
Result<std::vector<float>> times_of_all(gltf::Bytes& bytes, const gltf::TrackSource& source) {
  std::vector<float> times;
  std::set<std::size_t> inputs;
  for (const gltf::ElementSource& element : source.elements) {
    if (!inputs.insert(element.input).second) continue;
    const Result<std::vector<float>> own = bytes.times(element.input);
    if (!own) return own.error();
    const std::uint64_t wanted = sizeof(float) * (std::uint64_t{times.size()} + own.value().size());
    if (Status status = bytes.expansion().check(wanted, bytes.accessor_place(element.input)); !status)
      return status.error();
    times.insert(times.end(), own.value().begin(), own.value().end());
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

// Assembles the keys of a track from channels that drive one weight each. Weights without a channel keep their rest
// value, with tangents of 0.
Result<GltfKeys> assembled_keys(gltf::Bytes& bytes, const gltf::TrackSource& source, const GltfTrack& track) {
  const Result<std::vector<float>> times = times_of_all(bytes, source);
  if (!times) return times.error();
  const bool is_cubic = track.interpolation == GltfInterpolation::kCubicSpline;
  const std::size_t targets = source.rest.size(), rows = times.value().size() * (is_cubic ? 3 : 1);
  const std::uint64_t wanted = std::uint64_t{sizeof(double)} * rows * targets;
  if (Status status = bytes.expansion().check(wanted, bytes.accessor_place(source.output)); !status)
    return status.error();
  GltfKeys keys{{times.value().begin(), times.value().end()}, std::vector<double>(rows * targets)};
  for (std::size_t row = is_cubic ? 1 : 0; row < rows; row += is_cubic ? 3 : 1)
    std::copy(source.rest.begin(), source.rest.end(), keys.values.begin() + static_cast<std::ptrdiff_t>(row * targets));
  for (const gltf::ElementSource& element : source.elements) {
    const Result<std::vector<float>> own = bytes.times(element.input), weights = bytes.floats(element.output);
    if (!own) return own.error();
    if (!weights) return weights.error();
    gltf::write_column({own.value(), weights.value(), element.interpolation}, times.value(), is_cubic, element.target,
                       targets, keys.values);
  }
  return keys;
}

// Counts the keys of tracks that are assembled from channels with different times. If the times cannot be read, the
// count does not change, and the error is reported later, when the keys are read.
void count_keys(gltf::Bytes& bytes, gltf::Model& model) {
  for (std::size_t a = 0; a < model.animations.size(); ++a) {
    for (std::size_t t = 0; t < model.animations[a].tracks.size(); ++t) {
      const gltf::TrackSource& source = model.track_sources[a][t];
      const bool has_one = std::all_of(source.elements.begin(), source.elements.end(),
                                       [&](const gltf::ElementSource& each) { return each.input == source.input; });
      if (has_one) continue;
      if (const Result<std::vector<float>> times = times_of_all(bytes, source))
        model.animations[a].tracks[t].key_count = times.value().size();
    }
  }
}

// Drops the tracks whose numbers cannot be read, with a note for each array at fault. An array without a buffer view is
// not checked here, but when its keys are read.
void drop_unreadable(gltf::Bytes& bytes, gltf::Model& model) {
  // For each accessor that was tried, as times (true) or as other numbers (false): true if the accessor can be read.
  std::map<std::pair<std::size_t, bool>, bool> known;
  const auto can_read = [&](std::size_t accessor, bool has_times) {
    const auto [found, is_new] = known.try_emplace({accessor, has_times}, true);
    if (!is_new || !model.accessors[accessor].view) return found->second;
    const auto read = has_times ? bytes.times(accessor) : bytes.floats(accessor);
    found->second = read.ok();
    if (!read) model.notes.push_back(read.error());
    return found->second;
  };
  const auto can_read_all = [&](const gltf::TrackSource& source) {
    bool all = true;
    for (const gltf::ElementSource& element : source.elements)
      all = can_read(element.input, true) && can_read(element.output, false) && all;
    return source.elements.empty() ? can_read(source.input, true) && can_read(source.output, false) : all;
  };
  for (std::size_t a = 0; a < model.animations.size(); ++a) {
    std::vector<GltfTrack>& tracks = model.animations[a].tracks;
    std::vector<gltf::TrackSource>& sources = model.track_sources[a];
    std::vector<std::size_t> now(tracks.size());
    std::size_t kept = 0;
    for (std::size_t t = 0; t < tracks.size(); ++t) {
      if (!can_read_all(sources[t])) {
        std::vector<GltfUnreadTrack>& unread = model.animations[a].unread;
        const bool is_known = !unread.empty() && unread.back().channel == tracks[t].channel;
        if (!tracks[t].is_assembled && !is_known)
          unread.push_back({tracks[t].node, tracks[t].channel, sources[t].output});
        continue;
      }
      now[t] = kept;
      // The earlier track with the same keys reads the same arrays, so the earlier track was kept as well.
      tracks[t].same_keys_as = now[tracks[t].same_keys_as];
      if (kept != t) {
        tracks[kept] = std::move(tracks[t]);
        sources[kept] = std::move(sources[t]);
      }
      ++kept;
    }
    tracks.resize(kept);
    sources.resize(kept);
  }
}

}  // namespace

Result<GltfDocument> GltfDocument::read(std::string_view bytes, const std::string& name,
                                        const std::optional<std::string>& folder, const GltfOptions& options) {
  const Expansion expansion(options.max_expansion, bytes.size());
  gltf::Origin origin{name, folder, std::nullopt, options.allow_external, expansion, options.resolve};
  GlbChunks chunks{bytes, 0, std::nullopt, {}};
  if (Status is_other = check_kind(bytes, binary::place(name, 0), "gltf"); !is_other) return is_other.error();
  if (is_glb_extension(lower_extension(name)) && !recognises(bytes.substr(0, 512)))
    return invalid_input(binary::place(name, 0),
                         "this is not a glTF file, since it begins neither with the word glTF (GLB) nor with { (JSON); "
                         "name a .glb or .gltf file");
  if (is_glb(bytes)) {
    Result<GlbChunks> found = read_glb(bytes, name);
    if (!found) return found.error();
    chunks = found.value();
  }
  origin.bin = chunks.bin;
  Result<gltf::Model> model = gltf::parse_model(chunks.json, name, chunks.json_offset, bytes.size(), options.strict);
  if (!model) return model.error();
  auto state = std::make_unique<State>(chunks, std::move(model).value(), std::move(origin), options.most_bytes);
  if (!options.strict) drop_unreadable(state->bytes, state->model);
  count_keys(state->bytes, state->model);
  return GltfDocument(std::move(state));
}

Result<GltfGeometry> GltfDocument::geometry(std::size_t mesh, std::size_t primitive, const Wanted& wanted) const {
  const GltfPrimitive& declared = meshes()[mesh].primitives[primitive];
  const gltf::PrimitiveSource& source = state_->model.sources[mesh][primitive];
  gltf::Bytes& bytes = state_->bytes;
  const std::string pointer = gltf::primitive_pointer(mesh, primitive);
  const std::size_t vertex_count = declared.vertex_count, targets = wanted.targets ? declared.targets.size() : 0;
  if (Status status = state_->check_size(mesh, primitive, targets, wanted.shading); !status) return status.error();

  GltfGeometry geometry;
  if (source.draco) {
    const Result<gltf::View> view = bytes.view(source.draco->view);
    if (!view) return view.error();
    Result<GltfGeometry> decoded =
        gltf::decode_draco(view.value().bytes, state_->model, source, wanted.shading, bytes.expansion(),
                           bytes.place(pointer + "/extensions/KHR_draco_mesh_compression"));
    if (!decoded) return decoded;
    geometry = std::move(decoded).value();
    if (source.indices && geometry.corners.size() != declared.element_count)
      return invalid_input(bytes.place(pointer + "/indices"),
                           "the accessor declares " + counted(declared.element_count, "index", "indices") +
                               ", but the Draco data have " + grouped(geometry.corners.size()) +
                               "; export the file again");
  } else {
    if (source.indices) {
      Result<std::vector<std::uint32_t>> indices = bytes.indices(*source.indices, vertex_count);
      if (!indices) return indices.error();
      geometry.corners = to_triangles(declared.mode, std::move(indices).value());
    } else {
      geometry.corners = to_triangles(declared.mode, all_vertices(vertex_count));
    }
  }

  // A compressed mesh may contain only some attributes of a primitive. The other attributes are read from their
  // accessors.
  if (Status status =
          state_->read(source.base, wanted.shading, geometry.positions, geometry.normals, geometry.tangents);
      !status)
    return status.error();
  geometry.targets.resize(targets);
  for (std::size_t k = 0; k < targets; ++k) {
    GltfGeometry::Target& target = geometry.targets[k];
    if (Status status =
            state_->read(source.targets[k], wanted.shading, target.positions, target.normals, target.tangents);
        !status)
      return status.error();
  }
  state_->release(vertex_count * (targets + 1));
  return geometry;
}

Result<GltfGeometry::Target> GltfDocument::target(std::size_t mesh, std::size_t primitive, std::size_t index,
                                                  bool shading) const {
  const GltfPrimitive& declared = meshes()[mesh].primitives[primitive];
  if (Status status = state_->check_size(mesh, primitive, declared.targets.size(), shading); !status)
    return status.error();
  GltfGeometry::Target target;
  const gltf::Attributes& attributes = state_->model.sources[mesh][primitive].targets[index];
  if (Status status = state_->read(attributes, shading, target.positions, target.normals, target.tangents); !status)
    return status.error();
  state_->release(declared.vertex_count);
  return target;
}

Status GltfDocument::State::check_size(std::size_t mesh, std::size_t primitive, std::size_t targets, bool shading) {
  const GltfPrimitive& declared = model.meshes[mesh].primitives[primitive];
  const std::size_t vertices = declared.vertex_count, per_vertex = shading ? 40 : 12;
  const std::string place = bytes.place(gltf::primitive_pointer(mesh, primitive));
  if (vertices <= most_bytes / per_vertex / (targets + 1)) {
    const std::uint64_t corners = std::uint64_t{declared.element_count} * (declared.mode == 4 ? 1 : 3);
    return bytes.expansion().check(vertices * per_vertex * (targets + 1) + sizeof(std::uint32_t) * corners, place);
  }
  return invalid_input(place, "the " + counted(vertices, "vertex", "vertices") + " and " +
                                  counted(targets, "target", "targets") + " of this primitive would need more than " +
                                  counted(most_bytes, "byte", "bytes") +
                                  " of memory; split the mesh, or remove targets");
}

Status GltfDocument::State::read(const gltf::Attributes& attributes, bool shading, std::vector<float>& positions,
                                 std::vector<float>& normals, std::vector<float>& tangents) {
  const auto read_one = [this](const std::optional<std::size_t>& accessor, std::vector<float>& result) -> Status {
    if (!accessor || !result.empty()) return Success{};
    Result<std::vector<float>> floats = bytes.floats(*accessor);
    if (!floats) return floats.error();
    result = std::move(floats).value();
    return Success{};
  };
  if (Status status = read_one(attributes.position, positions); !status) return status;
  if (!shading) return Success{};
  if (Status status = read_one(attributes.normal, normals); !status) return status;
  return read_one(attributes.tangent, tangents);
}

void GltfDocument::State::release(std::size_t vertices) const noexcept {
  // A call for fewer vertices would release too little memory to be worth its time.
  constexpr std::size_t kMany = std::size_t{1} << 16;
  if (vertices < kMany) return;
  if (file) file->release();
  bytes.release();
}

Result<GltfKeys> GltfDocument::keys(std::size_t animation, std::size_t track) const {
  const gltf::TrackSource& source = state_->model.track_sources[animation][track];
  const GltfTrack& of_track = animations()[animation].tracks[track];
  if (of_track.is_assembled) return assembled_keys(state_->bytes, source, of_track);
  const Result<std::vector<float>> times = state_->bytes.times(source.input);
  if (!times) return times.error();
  GltfKeys keys{{times.value().begin(), times.value().end()}, {}};
  const Result<std::vector<float>> values = state_->bytes.floats(source.output);
  if (!values) return values.error();
  keys.values.assign(values.value().begin(), values.value().end());
  return keys;
}

Result<std::vector<float>> GltfDocument::unread_weights(const GltfUnreadTrack& track) const {
  if (!track.output) return invalid_input(name(), "the channel has no weights; remove the channel");
  return state_->bytes.floats(*track.output);
}

Result<std::size_t> GltfDocument::find_animation(const std::string& name_or_index) const {
  const std::vector<GltfAnimation>& all = animations();
  const auto named = std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.name == name_or_index; });
  if (named != all.end() && !name_or_index.empty()) return static_cast<std::size_t>(named - all.begin());
  std::size_t index = 0;
  const char* const end = name_or_index.data() + name_or_index.size();
  const auto [stop, code] = from_chars(name_or_index.data(), end, index);
  if (code == std::errc() && stop == end && index < all.size()) return index;

  constexpr std::size_t kMostNamed = 20;
  std::string message = "the file has no animation '" + name_or_index + "'";
  if (all.empty()) message += " and no other animation; leave --animation out";
  for (std::size_t i = 0; i < std::min(all.size(), kMostNamed); ++i)
    message.append(i == 0 ? "; choose one of " : ", ").append(std::to_string(i)).append(" ").append(all[i].name);
  if (all.size() > kMostNamed) message += ", ...";
  return Error{ErrorCode::kUsage, name(), message};
}

}  // namespace chronormal

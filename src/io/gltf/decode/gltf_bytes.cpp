#include "io/gltf/decode/gltf_bytes.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/bytes/expansion.h"
#include "io/gltf/decode/gltf_octahedral.h"
#include "io/gltf/model/gltf_uri.h"

namespace chronormal::inline internal::gltf {
namespace {

std::uint32_t load_index(const char* at, Component component) noexcept {
  constexpr std::endian kOrder = std::endian::little;
  if (component == Component::kUint8) return binary::load<std::uint8_t>(at, kOrder);
  if (component == Component::kUint16) return binary::load<std::uint16_t>(at, kOrder);
  return binary::load<std::uint32_t>(at, kOrder);
}

// Returns the largest index that a type can hold. glTF forbids this index, because some graphics hardware takes it as
// the command to begin a new strip.
std::uint32_t restart_index(Component component) noexcept {
  if (component == Component::kUint8) return 0xFF;
  return component == Component::kUint16 ? 0xFFFF : 0xFFFFFFFF;
}

std::string pointer_to(const char* array, std::size_t index) {
  return std::string("/").append(array).append("/").append(std::to_string(index));
}

}  // namespace

double load_number(const char* at, Component component, bool normalized) noexcept {
  const auto fraction = [normalized](auto value) {
    using T = decltype(value);
    if (!normalized) return static_cast<double>(value);
    return std::max(static_cast<double>(value) / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
  };
  constexpr std::endian kOrder = std::endian::little;
  switch (component) {
    case Component::kInt8:
      return fraction(binary::load<std::int8_t>(at, kOrder));
    case Component::kUint8:
      return fraction(binary::load<std::uint8_t>(at, kOrder));
    case Component::kInt16:
      return fraction(binary::load<std::int16_t>(at, kOrder));
    case Component::kUint16:
      return fraction(binary::load<std::uint16_t>(at, kOrder));
    case Component::kUint32:
      return static_cast<double>(binary::load<std::uint32_t>(at, kOrder));
    case Component::kFloat:
      return static_cast<double>(binary::load<float>(at, kOrder));
  }
  return 0;
}

Result<std::string> Origin::path_of(std::string_view uri, const std::string& uri_place) const {
  if (resolve) return name_file_uri(uri, folder, uri_place);
  return resolve_file_uri(uri, folder, allow_external, uri_place);
}

Result<FileBytes> Origin::open(const std::string& path, const std::string& uri_place) const {
  Result<FileBytes> file = FileBytes::open(path, resolve);
  if (!file) return invalid_input(uri_place, file.error().text());
  return file;
}

void Bytes::release() const noexcept {
  for (const auto& [buffer, file] : files_) file.release();
}

std::string Bytes::place(std::string_view pointer) const {
  return std::string(origin_.name).append(", ").append(pointer);
}

std::string Bytes::accessor_place(std::size_t index) const { return place(pointer_to("accessors", index)); }

Result<std::string_view> Bytes::buffer(std::size_t index) {
  if (const auto found = files_.find(index); found != files_.end()) return found->second.bytes();
  if (const auto found = embedded_.find(index); found != embedded_.end()) return std::string_view(found->second);

  const Buffer& declared = model_.buffers[index];
  const std::string pointer = pointer_to("buffers", index), uri_place = place(pointer + "/uri");
  if (!declared.uri) {
    if (index != 0 || !origin_.bin)
      return invalid_input(place(pointer), index == 0
                                               ? "the data of this buffer are missing, since the buffer has no uri and "
                                                 "the file has no BIN chunk; export the file again"
                                               : "the data of this buffer are missing, since the buffer has no uri and "
                                                 "only buffer 0 may use the BIN chunk; export the file again");
    if (origin_.bin->size() < declared.byte_length)
      return invalid_input(place(pointer + "/byteLength"),
                           "the BIN chunk has only " + counted(origin_.bin->size(), "byte", "bytes") +
                               ", but byteLength is " + grouped(declared.byte_length) + "; export the file again");
    if (origin_.bin->size() - declared.byte_length > 3)
      return invalid_input(place(pointer + "/byteLength"),
                           "the BIN chunk has " + counted(origin_.bin->size(), "byte", "bytes") +
                               ", but may have at most 3 bytes more than byteLength says; export the file again");
    return origin_.bin->substr(0, declared.byte_length);
  }
  if (is_data_uri(*declared.uri)) {
    Result<std::string> bytes = decode_data_uri(*declared.uri, declared.byte_length, uri_place);
    if (!bytes) return bytes.error();
    return std::string_view(embedded_.emplace(index, std::move(bytes).value()).first->second);
  }
  const Result<std::string> path = origin_.path_of(*declared.uri, uri_place);
  if (!path) return path.error();
  Result<FileBytes> file = origin_.open(path.value(), uri_place);
  if (!file) return file.error();
  if (file.value().bytes().size() < declared.byte_length)
    return invalid_input(uri_place, "the file has " + counted(file.value().bytes().size(), "byte", "bytes") +
                                        ", but byteLength is " + grouped(declared.byte_length) +
                                        "; export the file again");
  return files_.emplace(index, std::move(file).value()).first->second.bytes();
}

const Expansion& Bytes::expansion() {
  if (expansion_) return *expansion_;
  Expansion found = origin_.expansion;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < model_.buffers.size(); ++i) {
    const std::optional<std::string>& uri = model_.buffers[i].uri;
    if (!uri || is_data_uri(*uri) || !seen.insert(*uri).second) continue;
    // A buffer that cannot be read does not count here. The error is reported when the data of that buffer are needed.
    if (const Result<std::string_view> bytes = buffer(i)) found.add_read(bytes.value().size());
  }
  expansion_ = found;
  return *expansion_;
}

Result<std::string> Bytes::decompress(std::size_t view_index, const Compression& compression) {
  const Result<std::string_view> whole = buffer(compression.buffer);
  if (!whole) return whole.error();
  const std::string_view source = whole.value().substr(compression.offset, compression.length);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(source.data());
  const std::string pointer = pointer_to("bufferViews", view_index) + "/extensions/" +
                              (compression.is_khr ? "KHR_meshopt_compression" : "EXT_meshopt_compression");
  if (Status status = expansion().check(compression.count * compression.stride, place(pointer)); !status)
    return status.error();
  std::string result(compression.count * compression.stride, '\0');
  const auto decode = [&] {
    switch (compression.mode) {
      case Compression::Mode::kAttributes:
        return meshopt_decodeVertexBuffer(result.data(), compression.count, compression.stride, bytes, source.size());
      case Compression::Mode::kTriangles:
        return meshopt_decodeIndexBuffer(result.data(), compression.count, compression.stride, bytes, source.size());
      case Compression::Mode::kIndices:
        return meshopt_decodeIndexSequence(result.data(), compression.count, compression.stride, bytes, source.size());
    }
    return -1;
  };
  if (decode() != 0) {
    return invalid_input(place(pointer),
                         compression.is_khr
                             ? "the compressed data are damaged, or a newer version of the codec has compressed them; "
                               "export the file uncompressed, or compress it with EXT_meshopt_compression (gltfpack -c)"
                             : "the compressed data are damaged; export the file again");
  }
  switch (compression.filter) {
    case Compression::Filter::kNone:
      break;
    case Compression::Filter::kOctahedral:
      decode_octahedral(result, compression.stride);
      break;
    case Compression::Filter::kQuaternion:
      meshopt_decodeFilterQuat(result.data(), compression.count, compression.stride);
      break;
    case Compression::Filter::kExponential:
      meshopt_decodeFilterExp(result.data(), compression.count, compression.stride);
      break;
  }
  return result;
}

Result<View> Bytes::view(std::size_t index) {
  const BufferView& view = model_.views[index];
  if (!view.compression) {
    const Result<std::string_view> whole = buffer(view.buffer);
    if (!whole) return whole.error();
    return View{whole.value().substr(view.offset, view.length), nullptr};
  }
  const auto found = views_.find(index);
  if (found != views_.end()) return View{*found->second, found->second};
  Result<std::string> bytes = decompress(index, *view.compression);
  if (!bytes) return bytes.error();
  auto owner = std::make_shared<const std::string>(std::move(bytes).value());
  if (kept_bytes_ + owner->size() > kMostKeptBytes) {
    views_.clear();
    kept_bytes_ = 0;
  }
  if (owner->size() <= kMostKeptBytes) {
    views_.emplace(index, owner);
    kept_bytes_ += owner->size();
  }
  return View{*owner, owner};
}

template <class Read>
Status Bytes::read_elements(std::size_t index, const Read& read) {
  const Accessor& accessor = model_.accessors[index];
  if (!accessor.view) return Success{};
  const Result<View> found = view(*accessor.view);
  if (!found) return found.error();
  const std::size_t stride = model_.views[*accessor.view].stride.value_or(accessor.element_size());
  const char* const first = found.value().bytes.data() + accessor.offset;
  for (std::size_t i = 0; i < accessor.count; ++i) read(i, first + i * stride);
  return Success{};
}

template <class Put>
Status Bytes::for_each_sparse(std::size_t index, const Put& put) {
  const Accessor& accessor = model_.accessors[index];
  if (!accessor.sparse) return Success{};
  const Sparse& sparse = *accessor.sparse;
  const Result<View> indices = view(sparse.indices_view);
  if (!indices) return indices.error();
  const Result<View> values = view(sparse.values_view);
  if (!values) return values.error();
  const std::size_t index_size = component_size(sparse.indices_component), size = accessor.element_size();
  std::size_t least = 0;
  for (std::size_t i = 0; i < sparse.count; ++i) {
    const std::size_t element =
        load_index(indices.value().bytes.data() + sparse.indices_offset + i * index_size, sparse.indices_component);
    if (element < least || element >= accessor.count)
      return invalid_input(accessor_place(index) + "/sparse/indices",
                           "item " + std::to_string(i) + " is " + std::to_string(element) +
                               ", but sparse indices must ascend and be less than " + std::to_string(accessor.count) +
                               "; export the file again");
    least = element + 1;
    put(element, values.value().bytes.data() + sparse.values_offset + i * size);
  }
  return Success{};
}

// Opens the buffer of an accessor that has a buffer view. Callers open the buffer before they take memory, since an
// accessor may declare more numbers than its buffer has.
Status Bytes::open_buffer_of(const Accessor& accessor) {
  if (!accessor.view) return Success{};
  const Result<View> found = view(*accessor.view);
  if (!found) return found.error();
  return Success{};
}

Result<std::vector<float>> Bytes::floats(std::size_t index) {
  const Accessor& accessor = model_.accessors[index];
  if (Status status = open_buffer_of(accessor); !status) return status.error();
  std::vector<float> result(accessor.count * accessor.components, 0.0F);
  const std::size_t size = component_size(accessor.component);
  std::size_t first_fault = accessor.count;
  const auto read = [&](std::size_t element, const char* at) {
    for (std::size_t c = 0; c < accessor.components; ++c) {
      const double value = load_number(at + c * size, accessor.component, accessor.normalized);
      if (!std::isfinite(value)) first_fault = std::min(first_fault, element);
      result[element * accessor.components + c] = static_cast<float>(value);
    }
  };
  if (Status status = read_elements(index, read); !status) return status.error();
  if (Status status = for_each_sparse(index, read); !status) return status.error();
  if (first_fault < accessor.count)
    return invalid_input(accessor_place(index),
                         "element " + std::to_string(first_fault) + " is NaN or infinite; export the file again");
  return result;
}

Result<std::vector<float>> Bytes::times(std::size_t index) {
  Result<std::vector<float>> times = floats(index);
  if (!times) return times;
  if (times.value().front() < 0)
    return invalid_input(accessor_place(index),
                         "the first key is before time 0; move the animation so that it starts at 0 or later");
  for (std::size_t k = 1; k < times.value().size(); ++k) {
    if (!(times.value()[k - 1] < times.value()[k]))
      return invalid_input(accessor_place(index),
                           "the time of key " + std::to_string(k) +
                               " is not later than the time of the key before; export the animation again");
  }
  return times;
}

Result<std::vector<std::uint32_t>> Bytes::indices(std::size_t index, std::size_t vertex_count) {
  const Accessor& accessor = model_.accessors[index];
  if (Status status = open_buffer_of(accessor); !status) return status.error();
  std::vector<std::uint32_t> result(accessor.count, 0);
  const auto read = [&](std::size_t element, const char* at) { result[element] = load_index(at, accessor.component); };
  if (Status status = read_elements(index, read); !status) return status.error();
  if (Status status = for_each_sparse(index, read); !status) return status.error();
  const std::uint32_t restart = restart_index(accessor.component);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (result[i] == restart)
      return invalid_input(
          accessor_place(index),
          "index " + std::to_string(i) + " is " + std::to_string(restart) +
              ", which means primitive restart and is not allowed in glTF; export the mesh as plain triangles");
    if (result[i] >= vertex_count)
      return invalid_input(accessor_place(index), "index " + std::to_string(i) + " refers to vertex " +
                                                      std::to_string(result[i]) + ", but the primitive has only " +
                                                      counted(vertex_count, "vertex", "vertices") +
                                                      "; export the file again");
  }
  return result;
}

}  // namespace chronormal::inline internal::gltf

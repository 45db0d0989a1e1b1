#include "io/gltf/glb/glb_builder.h"

#include <algorithm>
#include <bit>
#include <string_view>
#include <utility>
#include <vector>

#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/gltf/glb/glb.h"

namespace chronormal::inline internal {
namespace {

using Json = nlohmann::ordered_json;

// Accessor 0 and buffer view 0 belong to the triangles. The accessors and the buffer views of other arrays follow.
constexpr std::size_t kTriangles = 0, kFirstArray = 1;

}  // namespace

GlbBuilder::Take GlbBuilder::gather_in(std::string& file) {
  return [&file](std::string_view bytes, std::size_t file_size) -> Status {
    file.reserve(file_size);
    file += bytes;
    return Success{};
  };
}

std::string_view generator_name() noexcept { return "chronormal " CHRONORMAL_VERSION; }

GlbBuilder::GlbBuilder(std::optional<std::size_t> most_bytes, Spool spool)
    : document_(Json::object()),
      arrays_(std::move(spool)),
      most_bytes_(std::min(most_bytes.value_or(kMostBytes), kMostBytes)) {
  document_["asset"] = {{"version", "2.0"}, {"generator", generator_name()}};
}

std::size_t GlbBuilder::set_triangles(std::span<const std::uint32_t> corners, std::size_t vertex_count) {
  constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125;
  // An index of 16 bits must not be 65535, since this number restarts primitives (section 3.7.2.1 of the
  // specification).
  const bool is_short = vertex_count <= 0xFFFF;
  indices_.clear();
  indices_.reserve((is_short ? 2 : 4) * corners.size() + 2);
  const auto append_each = [&](auto narrowed) {
    for (const std::uint32_t corner : corners) binary::append(indices_, narrowed(corner), std::endian::little);
  };
  if (is_short)
    append_each([](std::uint32_t corner) { return static_cast<std::uint16_t>(corner); });
  else if (std::endian::native == std::endian::little)
    indices_.assign(reinterpret_cast<const char*>(corners.data()), corners.size_bytes());
  else
    append_each([](std::uint32_t corner) { return corner; });
  index_accessor_ = {{"bufferView", kTriangles},
                     {"componentType", is_short ? kUnsignedShort : kUnsignedInt},
                     {"count", corners.size()},
                     {"type", "SCALAR"}};
  return kTriangles;
}

std::size_t GlbBuilder::add_vectors(std::span<const float> vectors, const GltfVectors& options) {
  return kFirstArray + arrays_.add(vectors, 3, options);
}

std::size_t GlbBuilder::add_scalars(std::span<const float> scalars, const GltfVectors& options) {
  return kFirstArray + arrays_.add(scalars, 1, options);
}

std::size_t GlbBuilder::add_table(std::size_t rows, std::size_t width,
                                  const std::function<void(std::size_t row, std::span<float> values)>& fill) {
  return kFirstArray + arrays_.add_table(rows, width, fill);
}

void GlbBuilder::put_in_order(std::span<const std::size_t> order) {
  std::vector<std::size_t> arrays;
  for (const std::size_t accessor : order) arrays.push_back(accessor - kFirstArray);
  arrays_.put_in_order(arrays);
}

Result<std::size_t> GlbBuilder::finish(const Take& take) {
  constexpr int kElementArrayBuffer = 34963;
  if (!status()) return status().error();
  const std::size_t index_bytes = indices_.size();
  indices_.resize((index_bytes + 3) / 4 * 4, '\0');
  document_["buffers"] = Json::array({{{"byteLength", byte_count()}}});
  Json views = Json::array({{{"buffer", 0}, {"byteLength", index_bytes}, {"target", kElementArrayBuffer}}});
  Json accessors = Json::array({index_accessor_});
  const gltf::NewArrays::Json arrays = arrays_.json(0, indices_.size(), kFirstArray);
  for (const std::string& view : arrays.views) views.push_back(Json::parse(view));
  for (const std::string& accessor : arrays.accessors) accessors.push_back(Json::parse(accessor));
  document_["bufferViews"] = std::move(views);
  document_["accessors"] = std::move(accessors);

  const std::string text = document_.dump();
  const Result<GlbFrame> framed = frame_glb(text.size(), byte_count(), 0, "");
  if (!framed) return framed.error();
  const GlbFrame& frame = framed.value();
  if (frame.size > most_bytes_)
    return invalid_input("", "the result would have " + counted(frame.size, "byte", "bytes") +
                                 ", but may have at most " + grouped(most_bytes_) + "; use fewer keyframes or targets");
  const auto size = static_cast<std::size_t>(frame.size);
  for (const std::string_view piece : {std::string_view(frame.before_json), std::string_view(text),
                                       std::string_view(frame.behind_json), std::string_view(indices_)}) {
    if (const Status status = take(piece, size); !status) return status.error();
  }
  Status status = arrays_.give_away([&](std::string_view bytes) { return take(bytes, size); });
  if (status) status = take(frame.behind_bin, size);
  if (!status) return status.error();
  return size;
}

Result<std::string> GlbBuilder::finish() {
  std::string file;
  const Result<std::size_t> size = finish(gather_in(file));
  if (!size) return size.error();
  return file;
}

}  // namespace chronormal::inline internal

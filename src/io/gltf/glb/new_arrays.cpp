#include "io/gltf/glb/new_arrays.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "core/blocks.h"
#include "io/bytes/binary.h"
#include "io/json/json_writer.h"

namespace chronormal::inline internal::gltf {
namespace {

constexpr std::size_t kFloat = 5126, kArrayBuffer = 34962;
// The number of characters by which the JSON of a sparse accessor is longer than the JSON of a dense accessor. The
// number is an estimate.
constexpr std::size_t kSparseJson = 130;

void pad(std::string& bytes) { bytes.resize((bytes.size() + 3) / 4 * 4, '\0'); }

std::string bytes_of(std::span<const float> values) {
  std::string bytes;
  bytes.reserve(values.size() * sizeof(float));
  for (const float value : values) binary::append(bytes, value, std::endian::little);
  return bytes;
}

// Facts about an array, found in one pass over its values.
struct ArraySurvey {
  std::array<float, 3> least{}, most{};  // lower and upper bound of each component
  std::size_t used = 0, last_used = 0;   // number of elements that are not zero, and index of the last one
  std::size_t hash = 0;                  // hash of the bytes
};

std::string_view native_bytes(std::span<const float> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

template <std::size_t kComponents>
ArraySurvey survey_elements(std::span<const float> values, std::size_t first, std::size_t end) {
  ArraySurvey result;
  const float* at = values.data() + kComponents * first;
  for (std::size_t c = 0; c < kComponents; ++c) result.least[c] = result.most[c] = at[c];
  for (std::size_t i = first; i < end; ++i, at += kComponents) {
    bool is_used = false;
    for (std::size_t c = 0; c < kComponents; ++c) {
      result.least[c] = std::min(result.least[c], at[c]);
      result.most[c] = std::max(result.most[c], at[c]);
      is_used |= at[c] != 0;
    }
    result.used += is_used ? 1U : 0U;
    result.last_used = is_used ? i : result.last_used;
  }
  const std::span<const float> all = values.subspan(kComponents * first, kComponents * (end - first));
  result.hash = std::hash<std::string_view>()(native_bytes(all));
  return result;
}

std::size_t joined_hash(std::size_t first, std::size_t second) { return first * 1000003 ^ second; }

ArraySurvey survey_array(std::span<const float> values, std::size_t components) {
  constexpr std::size_t kBlock = 16384;
  const std::size_t count = values.size() / components;
  std::vector<ArraySurvey> of_blocks(block_count(count, kBlock));
  numbered_blocks(count, kBlock, [&](std::size_t b, std::size_t first, std::size_t end) {
    of_blocks[b] = components == 3 ? survey_elements<3>(values, first, end) : survey_elements<1>(values, first, end);
  });
  ArraySurvey all = of_blocks.front();
  for (std::size_t b = 1; b < of_blocks.size(); ++b) {
    const ArraySurvey& block = of_blocks[b];
    for (std::size_t c = 0; c < components; ++c) {
      all.least[c] = std::min(all.least[c], block.least[c]);
      all.most[c] = std::max(all.most[c], block.most[c]);
    }
    all.used += block.used;
    if (block.used > 0) all.last_used = block.last_used;
    all.hash = joined_hash(all.hash, block.hash);
  }
  return all;
}

// Returns the bounds of all components as JSON. Readers of the file compare these bounds in double with the values of
// the array, so the digits must read back as exactly the same double.
std::string bound_json(std::span<const float> bounds) {
  std::string json = "[";
  for (std::size_t c = 0; c < bounds.size(); ++c)
    // A bound of -0 is written as 0, which is equal.
    json.append(c > 0 ? "," : "").append(json_number(bounds[c] == 0 ? 0.0 : double{bounds[c]}));
  return json + "]";
}

// Adds the place of an array to the JSON of its accessor: "bufferView":3,"byteOffset":16.
void add_place(std::size_t view, std::uint64_t offset, JsonObject& object) {
  object.add("bufferView", view);
  if (offset > 0) object.add("byteOffset", std::to_string(offset));
}

std::size_t bytes_of_index(std::size_t last_used) { return last_used < 256 ? 1 : last_used < 65536 ? 2 : 4; }

}  // namespace

std::size_t bytes_of_floats(std::size_t used, std::size_t last_used, std::size_t count, std::size_t components) {
  const std::size_t of_value = components * sizeof(float), dense = count * of_value;
  if (used == 0) return 0;
  const std::size_t indices = (used * bytes_of_index(last_used) + 3) / 4 * 4, sparse = used * of_value + indices;
  return sparse + kSparseJson >= dense ? dense : sparse;
}

void NewArrays::encode(std::span<const float> values, std::size_t components, const GltfVectors& options,
                       Encoded& result) {
  Array& array = result.array;
  array.components = components;
  array.count = values.size() / components;
  const ArraySurvey found = survey_array(values, components);
  if (options.bounds) {
    array.least = bound_json(std::span(found.least).first(components));
    array.most = bound_json(std::span(found.most).first(components));
  }
  result.hash = array.count;
  for (const std::string* const bound : {&array.least, &array.most})
    result.hash = joined_hash(result.hash, std::hash<std::string>()(*bound));

  const std::size_t used = found.used, last_used = found.last_used;
  const std::size_t index_size = bytes_of_index(last_used);
  if (options.dense || bytes_of_floats(used, last_used, array.count, components) >= values.size_bytes()) {
    result.hash = joined_hash(result.hash, found.hash);
    if constexpr (std::endian::native == std::endian::little) {
      result.dense = native_bytes(values);
    } else {
      result.swapped = bytes_of(values);
      result.dense = result.swapped;
    }
    return;
  }
  if (used == 0) return;
  const auto element = [&](std::size_t i) { return values.subspan(i * components, components); };
  const auto is_zero = [&](std::size_t i) {
    return std::all_of(element(i).begin(), element(i).end(), [](float value) { return value == 0; });
  };
  array.sparse_count = used;
  array.index_type = index_size == 1 ? 5121 : index_size == 2 ? 5123 : 5125;
  result.indices.reserve(used * index_size + 3);
  result.values.reserve(used * components * sizeof(float));
  for (std::size_t i = 0; i < array.count; ++i) {
    if (is_zero(i)) continue;
    if (index_size == 1)
      binary::append(result.indices, static_cast<std::uint8_t>(i), std::endian::little);
    else if (index_size == 2)
      binary::append(result.indices, static_cast<std::uint16_t>(i), std::endian::little);
    else
      binary::append(result.indices, static_cast<std::uint32_t>(i), std::endian::little);
    for (const float value : element(i)) binary::append(result.values, value, std::endian::little);
  }
  pad(result.indices);
  for (const std::string* const part : {&result.indices, &result.values})
    result.hash = joined_hash(result.hash, std::hash<std::string>()(*part));
}

bool NewArrays::is_same(const Stored& stored, const Encoded& encoded) {
  const bool are_as_long = stored.dense == encoded.dense.size() && stored.indices == encoded.indices.size() &&
                           stored.values == encoded.values.size();
  return are_as_long && stored.array == encoded.array && spool_.has(stored.at, encoded.dense) &&
         spool_.has(stored.at + stored.dense, encoded.indices) &&
         spool_.has(stored.at + stored.dense + stored.indices, encoded.values);
}

std::size_t NewArrays::add(std::span<const float> values, std::size_t components, const GltfVectors& options) {
  assert(!values.empty() && values.size() % components == 0);
  assert(std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); }));
  Encoded encoded;
  encode(values, components, options, encoded);
  const auto [first, end] = by_hash_.equal_range(encoded.hash);
  const auto found =
      std::find_if(first, end, [&](const auto& entry) { return is_same(arrays_[entry.second], encoded); });
  if (found != end) return found->second;
  by_hash_.emplace(encoded.hash, arrays_.size());
  arrays_.push_back(
      {std::move(encoded.array), spool_.size(), encoded.dense.size(), encoded.indices.size(), encoded.values.size()});
  spool_.append(encoded.dense);
  spool_.add(std::move(encoded.indices));
  spool_.add(std::move(encoded.values));
  return arrays_.size() - 1;
}

void NewArrays::put_in_order(std::span<const std::size_t> order) {
  assert(order.size() == arrays_.size());
  std::vector<Stored> arrays;
  for (const std::size_t index : order) arrays.push_back(std::move(arrays_[index]));
  arrays_ = std::move(arrays);
  by_hash_.clear();
}

std::size_t NewArrays::add_table(std::size_t rows, std::size_t width,
                                 const std::function<void(std::size_t row, std::span<float> values)>& fill) {
  constexpr std::size_t kPart = std::size_t{1} << 20;  // bytes that are added to the spool at once
  Stored stored;
  stored.array.count = rows * width;
  stored.at = spool_.size();
  std::vector<float> row(width);
  std::string part;
  for (std::size_t i = 0; i < rows; ++i) {
    std::fill(row.begin(), row.end(), 0.0F);
    fill(i, row);
    assert(std::all_of(row.begin(), row.end(), [](float value) { return std::isfinite(value); }));
    part += bytes_of(row);
    if (part.size() >= kPart || i + 1 == rows) spool_.add(std::exchange(part, {}));
  }
  stored.dense = spool_.size() - stored.at;
  arrays_.push_back(std::move(stored));
  return arrays_.size() - 1;
}

NewArrays::Sizes NewArrays::sizes() const noexcept {
  Sizes result;
  for (const Stored& stored : arrays_) {
    (stored.array.components == 1 ? result.scalars : result.vectors) += stored.dense;
    result.sparse += stored.indices + stored.values;
  }
  return result;
}

std::uint64_t NewArrays::byte_count() const noexcept {
  const Sizes all = sizes();
  return all.vectors + all.scalars + all.sparse;
}

std::size_t NewArrays::view_count() const noexcept {
  const Sizes all = sizes();
  return (all.vectors > 0 ? 1U : 0U) + (all.scalars > 0 ? 1U : 0U) + (all.sparse > 0 ? 1U : 0U);
}

template <class Body>
Status NewArrays::each_place(const Body& body) const {
  for (const std::size_t components : {std::size_t{3}, std::size_t{1}}) {
    for (const Stored& stored : arrays_) {
      if (stored.array.components != components) continue;
      if (Status status = body(stored.at, stored.dense); !status) return status;
    }
  }
  for (const Stored& stored : arrays_) {
    if (Status status = body(stored.at + stored.dense, stored.indices + stored.values); !status) return status;
  }
  return status();
}

Status NewArrays::give_away(const Spool::Take& take) {
  return each_place([&](std::uint64_t at, std::uint64_t size) { return spool_.give_away(at, size, take); });
}

std::vector<std::string_view> NewArrays::pieces() const {
  std::vector<std::string_view> result;
  const auto take = [&](std::string_view bytes) -> Status {
    result.push_back(bytes);
    return Success{};
  };
  (void)each_place([&](std::uint64_t at, std::uint64_t size) { return spool_.hand_over(at, size, take); });
  return result;
}

NewArrays::Json NewArrays::json(std::size_t buffer, std::uint64_t offset, std::size_t first_view) const {
  Json result;
  const Sizes all = sizes();
  const auto add_view = [&](std::uint64_t size, bool of_vertices) {
    const std::size_t index = first_view + result.views.size();
    if (size == 0) return index;
    JsonObject view;
    view.add("buffer", buffer);
    if (offset > 0) view.add("byteOffset", std::to_string(offset));
    view.add("byteLength", std::to_string(size));
    // Views with several vertex attributes need a stride, and other views must not have one.
    if (of_vertices) view.add("byteStride", 3 * sizeof(float)).add("target", kArrayBuffer);
    result.views.push_back(view.text());
    offset += size;
    return index;
  };
  const std::size_t vectors_view = add_view(all.vectors, true), scalars_view = add_view(all.scalars, false),
                    sparse_view = add_view(all.sparse, false);

  Sizes at;
  for (const Stored& stored : arrays_) {
    const Array& array = stored.array;
    JsonObject accessor;
    if (stored.dense > 0) {
      std::uint64_t& place = array.components == 1 ? at.scalars : at.vectors;
      add_place(array.components == 1 ? scalars_view : vectors_view, place, accessor);
      place += stored.dense;
    }
    accessor.add("componentType", kFloat).add("count", array.count);
    accessor.add("type", quote_json(array.components == 1 ? "SCALAR" : "VEC3"));
    if (!array.least.empty()) accessor.add("min", array.least).add("max", array.most);
    if (array.sparse_count > 0) {
      JsonObject sparse, indices, values;
      add_place(sparse_view, at.sparse, indices);
      indices.add("componentType", array.index_type);
      at.sparse += stored.indices;
      add_place(sparse_view, at.sparse, values);
      at.sparse += stored.values;
      sparse.add("count", array.sparse_count).add("indices", indices.text()).add("values", values.text());
      accessor.add("sparse", sparse.text());
    }
    result.accessors.push_back(accessor.text());
  }
  return result;
}

}  // namespace chronormal::inline internal::gltf

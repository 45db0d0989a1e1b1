#include "workflow/report/container.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <new>
#include <string_view>
#include <type_traits>
#include <utility>

#include "io/bytes/binary.h"
#include "io/gltf/model/gltf_bake_mark.h"
#include "workflow/json/object.h"
#include "workflow/report/worst_figures.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kAlignment = 8;
constexpr std::uint32_t kLayout = 1;

void pad(std::string& bytes, char with) {
  bytes.resize((bytes.size() + kAlignment - 1) / kAlignment * kAlignment, with);
}

// The bytes of the arrays that follow the JSON of a container.
class Arrays {
 public:
  template <class T>
  Json add(const std::vector<T>& values) {
    pad(bytes_, '\0');
    const char* const type = std::is_same_v<T, float> ? "f32" : std::is_same_v<T, double> ? "f64" : "u32";
    Json json = {{"offset", bytes_.size()}, {"type", type}, {"count", values.size()}};
    for (const T value : values) binary::append(bytes_, value, std::endian::little);
    return json;
  }
  template <class T>
  Json add_or_null(const std::vector<T>& values) {
    return values.empty() ? Json() : add(values);
  }
  // Adds vectors to the arrays, and returns a JSON object with the fields "indices" and `name`. The indices are null if
  // all vertices have a vector.
  Json add(const ModelVectors& vectors, const char* name) {
    return {{"indices", vectors.is_dense ? Json() : add(vectors.vertices)}, {name, add(vectors.values)}};
  }
  // Adds vectors to the arrays. Returns the array itself if all vertices have a vector, and otherwise an object with
  // the indices of the vertices.
  Json add_keyframe(const ModelVectors& vectors) {
    return vectors.is_dense ? add(vectors.values) : add(vectors, "values");
  }

  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  std::string bytes_;
};

Json motion_json(const ModelMotion& motion, Arrays& arrays) {
  const AuditSubject& subject = motion.subject;
  Json json = {{"kind", audit_subject_name(subject.kind)},
               {"name", subject.name},
               {"animation", or_null(subject.animation)},
               {"node", or_null(subject.node)},
               {"target", or_null(subject.target)},
               {"expression", or_null(subject.expression)},
               {"seconds", std::string_view(audit_moment_name(subject.kind)) == "time"},
               {"subject", motion.subject_index},
               {"at", arrays.add(motion.at)}};
  if (motion.weights.empty()) {
    json["segment"] = arrays.add(motion.segments);
    json["t"] = arrays.add(motion.t);
  }
  for (const ModelWeights& weights : motion.weights)
    json["weights"].push_back({{"viewers", weights.viewers},
                               {"targets", arrays.add(weights.targets)},
                               {"values", arrays.add(weights.values)}});
  json["worst"] = arrays.add(motion.worst);
  json["mean"] = arrays.add(motion.mean);
  json["least"] = arrays.add_or_null(motion.least);
  if (!motion.weights.empty()) return json;
  json["schemes"] = Json::array();
  for (const ModelMotion::Scheme& scheme : motion.schemes)
    json["schemes"].push_back(
        {{"name", scheme.name}, {"worst", arrays.add(scheme.worst)}, {"mean", arrays.add(scheme.mean)}});
  return json;
}

void add_gltf(const ModelPart& part, Arrays& arrays, Json& json) {
  json["targets"] = Json::array();
  for (std::size_t k = 0; k < part.targets.size(); ++k) {
    bool is_extra = false;
    if (part.mark)
      is_extra = std::any_of(part.mark->extras.begin(), part.mark->extras.end(),
                             [k](const GltfExtraTarget& extra) { return extra.target == k; });
    Json target = {{"name", part.target_names[k]}, {"extra", is_extra}};
    target.update(arrays.add(part.targets[k], "positions"));
    json["targets"].push_back(std::move(target));
  }
  json["mark"] = part.mark ? Json(gltf::bake_mark_json(*part.mark)) : Json();
  json["shown"] = Json::array();
  for (const ModelShown& shown : part.shown) {
    Json targets = Json::array();
    for (const ModelVectors& target : shown.targets) targets.push_back(arrays.add(target, "deltas"));
    json["shown"].push_back({{"viewers", shown.viewers},
                             {"halves", shown.keeps_halves},
                             {"least_weight", shown.least_weight},
                             {"normals", arrays.add(shown.normals)},
                             {"targets", std::move(targets)}});
  }
}

Json offsets_json(const ModelTruth& truth, Arrays& arrays) {
  if (truth.offsets.empty()) return {};
  std::vector<std::uint32_t> elements, first = {0}, edges, references;
  std::vector<float> sides, base;
  std::vector<double> turned;
  for (const ModelOffset& offset : truth.offsets) {
    elements.push_back(offset.element);
    sides.push_back(offset.is_other_side ? -1.0F : 1.0F);
    edges.insert(edges.end(), offset.edges.begin(), offset.edges.end());
    first.push_back(static_cast<std::uint32_t>(edges.size() / 2));
    references.push_back(offset.reference);
    if (offset.reference == kNoReportElement) turned.insert(turned.end(), offset.turned.begin(), offset.turned.end());
    base.insert(base.end(), offset.base.begin(), offset.base.end());
  }
  Json targets = Json::array();
  for (const ModelTruth::Changes& changes : truth.changes)
    targets.push_back({{"indices", arrays.add(changes.offsets)}, {"changes", arrays.add(changes.values)}});
  return {{"elements", arrays.add(elements)},
          {"sides", arrays.add(sides)},
          {"first", arrays.add(first)},
          {"edges", arrays.add(edges)},
          {"references", arrays.add(references)},
          {"turned", arrays.add_or_null(turned)},
          {"base", arrays.add(base)},
          {"targets", std::move(targets)}};
}

Json truth_json(const ModelTruth& truth, Arrays& arrays) {
  Json polygons;
  if (!truth.first.empty()) polygons = {{"first", arrays.add(truth.first)}, {"corners", arrays.add(truth.corners)}};
  return {{"polygons", std::move(polygons)},
          {"terms", arrays.add_or_null(truth.terms)},
          {"offsets", offsets_json(truth, arrays)}};
}

void add_keyframes(const ModelPart& part, Arrays& arrays, Json& json) {
  Json positions = Json::array(), normals;
  for (const ModelVectors& keyframe : part.keyframe_positions) positions.push_back(arrays.add_keyframe(keyframe));
  for (const ModelVectors& keyframe : part.keyframe_normals) normals.push_back(arrays.add_keyframe(keyframe));
  json["keyframes"] = {{"times", arrays.add(part.times)},
                       {"numbers", part.keyframe_numbers},
                       {"positions", std::move(positions)},
                       {"normals", std::move(normals)},
                       {"segments", arrays.add(part.segments)}};
}

Json part_json(const ModelPart& part, Arrays& arrays) {
  Json json = {{"name", part.name},
               {"mesh", or_null(part.mesh)},
               {"vertices", part.vertex_count()},
               {"labels", arrays.add_or_null(part.labels)},
               {"primitives", Json::array()},
               {"triangles", arrays.add(part.triangles)},
               {"faces", arrays.add_or_null(part.faces)},
               {"coarse", arrays.add_or_null(part.coarse)},
               {"elements", part.elements},
               {"element", arrays.add(part.element)},
               {"weighting", weighting_name(part.weighting)},
               {"positions", arrays.add(part.positions)},
               {"normals", arrays.add_or_null(part.normals)}};
  if (!part.backs.empty()) json["backs"] = arrays.add(part.backs);
  for (const ModelPrimitive& primitive : part.primitives)
    json["primitives"].push_back({{"primitive", primitive.primitive},
                                  {"first", primitive.first},
                                  {"count", primitive.count},
                                  {"flat", primitive.is_flat}});
  if (part.shown.empty())
    add_keyframes(part, arrays, json);
  else
    add_gltf(part, arrays, json);
  if (!part.truth.is_plain()) json["truth"] = truth_json(part.truth, arrays);
  json["motions"] = Json::array();
  for (const ModelMotion& motion : part.motions) json["motions"].push_back(motion_json(motion, arrays));
  return json;
}

}  // namespace

std::string write_container(const std::string& head, const ReportModel& model) {
  Json json;
  Arrays arrays;
  json["kind"] = model.kind;
  json["thinned"] = model.thinned;
  json["parts"] = Json::array();
  for (const ModelPart& part : model.parts) json["parts"].push_back(part_json(part, arrays));
  json["worst"] = Json::array();
  for (const ReportPlace& place : model.worst)
    json["worst"].push_back({{"part", place.part},
                             {"motion", place.motion},
                             {"sample", place.sample},
                             {"vertex", place.vertex},
                             {"degrees", place.degrees},
                             {"label", place.label},
                             {"moment", place.moment}});
  json["figures"] = worst_figures(model);
  const std::string own = json.dump(-1, ' ', false, Json::error_handler_t::replace), text = '{' + head + own.substr(1);
  std::string bytes = "CHRONRPT";
  binary::append(bytes, kLayout, std::endian::little);
  binary::append(bytes, static_cast<std::uint32_t>(text.size()), std::endian::little);
  bytes += text;
  pad(bytes, ' ');
  bytes += arrays.bytes();
  return bytes;
}

std::string gzipped(std::string_view bytes) {
  constexpr int kGzip = 16 + MAX_WBITS, kMemory = 8;
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  // Names Unix as the operating system in the header of gzip, so that all systems write the same bytes.
  gz_header header{};
  header.os = 3;
  deflateSetHeader(&stream, &header);
  std::string result;
  // Compresses the text block by block, because zlib counts bytes in 32 bits.
  constexpr std::size_t kAtOnce = std::size_t{1} << 20;
  std::string block(kAtOnce, '\0');
  int state = Z_OK;
  while (state != Z_STREAM_END) {
    const std::size_t given = std::min(kAtOnce, bytes.size());
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(given);
    bytes.remove_prefix(given);
    do {
      stream.next_out = reinterpret_cast<Bytef*>(block.data());
      stream.avail_out = static_cast<uInt>(block.size());
      state = deflate(&stream, bytes.empty() ? Z_FINISH : Z_NO_FLUSH);
      result.append(block.data(), block.size() - stream.avail_out);
    } while (stream.avail_out == 0);
  }
  deflateEnd(&stream);
  return result;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) result += k <= count ? kDigits[bits >> (18 - 6 * k) & 63U] : '=';
  }
  return result;
}

}  // namespace chronormal::inline internal

#include "io/gltf/gltf_bake_mark.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "io/json/json.h"

namespace chronormal::inline internal::gltf {
namespace {

constexpr std::size_t kVersion = 1;
constexpr const char* kBase = "base";

// A factor: the index of a target, or "base".
std::size_t read_factor(const JsonView& factors, const nlohmann::json& value, std::size_t index,
                        std::size_t target_count) {
  if (value.is_string()) {
    if (value.get_ref<const std::string&>() == kBase) return GltfExtraTarget::kBase;
    factors.item(index).complain("a factor is the index of a target or \"base\"");
    return 0;
  }
  return factors.item(index).as_index(target_count, "targets").value_or(0);
}

GltfExtraTarget read_extra(const JsonView& item, const nlohmann::json& value, std::size_t target_count) {
  GltfExtraTarget extra;
  extra.target = item.required_index("target", target_count, "targets").value_or(0);
  const std::optional<JsonView> factors = item.array("factors");
  if (!factors || factors->size() != 2) {
    item.complain("factors", "there must be two factors");
    return extra;
  }
  extra.i = read_factor(*factors, value["factors"][0], 0, target_count);
  extra.j = read_factor(*factors, value["factors"][1], 1, target_count);
  return extra;
}

// Extra targets ascend, and their factors are none of them.
void check_extras(const JsonView& list, const std::vector<GltfExtraTarget>& extras) {
  std::vector<std::size_t> targets;
  for (std::size_t n = 0; n < extras.size(); ++n) {
    if (n > 0 && extras[n].target <= targets.back())
      return list.item(n).complain("target", "the extra targets must ascend");
    targets.push_back(extras[n].target);
  }
  for (std::size_t n = 0; n < extras.size(); ++n) {
    for (const std::size_t factor : {extras[n].i, extras[n].j}) {
      if (std::binary_search(targets.begin(), targets.end(), factor))
        return list.item(n).complain("factors", "an extra target cannot be a factor");
    }
  }
}

GltfBakeMark read_mark(const JsonView& view, const nlohmann::json& value, std::size_t target_count) {
  GltfBakeMark mark;
  const std::size_t version = view.required_count("version", std::size_t{1} << 31);
  if (version != kVersion) view.complain("version", "it was written by another version of chronormal");
  const std::optional<BakeEncoding> encoding = find_bake_encoding(view.required_text("encode"));
  if (!encoding) view.complain("encode", "it is neither exact nor endpoint");
  mark.encoding = encoding.value_or(BakeEncoding::kExact);
  mark.sequence = view.flag("sequence");
  const auto list = value.find("extras");
  if (list == value.end() || (list->is_array() && list->empty())) return mark;
  const std::optional<JsonView> extras = view.array("extras");
  if (!extras) return mark;
  if (extras->size() > target_count) {
    extras->complain("there are more of them than targets");
    return mark;
  }
  for (std::size_t n = 0; n < extras->size(); ++n) {
    if (!extras->item(n).is_object()) return mark;
    mark.extras.push_back(read_extra(extras->item(n), (*list)[n], target_count));
  }
  check_extras(*extras, mark.extras);
  return mark;
}

}  // namespace

void read_bake_mark(const nlohmann::json& document, const std::string& pointer, const std::string& name,
                    GltfMesh& mesh) {
  const std::string extras = pointer + "/extras";
  const nlohmann::json::json_pointer at(extras);
  if (!document.contains(at) || !document.at(at).is_object()) return;
  const nlohmann::json& members = document.at(at);
  const auto found = members.find("chronormal");
  if (found == members.end()) return;
  JsonComplaint complaint(name);
  const JsonView view(*found, extras + "/chronormal", complaint);
  GltfBakeMark mark;
  if (view.is_object()) mark = read_mark(view, *found, mesh.target_count);
  if (complaint.first())
    mesh.mark_fault = complaint.first();
  else
    mesh.mark = std::move(mark);
}

nlohmann::ordered_json bake_mark_json(const GltfBakeMark& mark) {
  using Json = nlohmann::ordered_json;
  const auto factor = [](std::size_t i) { return i == GltfExtraTarget::kBase ? Json(kBase) : Json(i); };
  Json extras = Json::array();
  for (const GltfExtraTarget& extra : mark.extras)
    extras.push_back({{"target", extra.target}, {"factors", Json::array({factor(extra.i), factor(extra.j)})}});
  return {{"version", kVersion},
          {"encode", name_of(mark.encoding)},
          {"sequence", mark.sequence},
          {"extras", std::move(extras)}};
}

}  // namespace chronormal::inline internal::gltf

namespace chronormal {

std::string_view name_of(BakeEncoding encoding) noexcept {
  return std::find_if(kBakeEncodings.begin(), kBakeEncodings.end(),
                      [&](const BakeEncodingName& known) { return known.encoding == encoding; })
      ->name;
}

std::optional<BakeEncoding> find_bake_encoding(std::string_view name) noexcept {
  for (const BakeEncodingName& known : kBakeEncodings)
    if (known.name == name) return known.encoding;
  return std::nullopt;
}

}  // namespace chronormal

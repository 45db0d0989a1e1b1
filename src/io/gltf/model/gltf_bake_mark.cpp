#include "io/gltf/model/gltf_bake_mark.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "io/json/json.h"

namespace chronormal::inline internal::gltf {
namespace {

using Json = nlohmann::json;

// The versions of the mark of a bake: the present version, and the version that had factors. Version 1 had two factors
// for each correction target. Each factor was the index of a target, or "base", which is 1 minus the sum of the weights
// of all other targets.
constexpr std::size_t kVersion = 2, kVersionOfFactors = 1;

// Returns the items of the array that is the member `key`. Returns no items if the array is missing or empty. Complains
// and returns no items if the member is not an array.
std::vector<JsonView> items_of(const JsonView& view, const Json& value, const char* key) {
  const auto found = value.find(key);
  if (found == value.end() || (found->is_array() && found->empty())) return {};
  std::vector<JsonView> items;
  if (const std::optional<JsonView> list = view.array(key)) {
    for (std::size_t n = 0; n < list->size(); ++n) items.push_back(list->item(n));
  }
  return items;
}

// Returns true if a term is an array with `size` items, and complains otherwise.
bool is_term(const JsonView& term, const Json& value, std::size_t size, const char* form) {
  if (value.is_array() && value.size() == size) return true;
  term.complain(std::string("a term must be ") + form + "; bake the original file again");
  return false;
}

void read_terms(const JsonView& item, const Json& value, std::size_t target_count, GltfExtraTarget& extra) {
  const auto index = [&](const JsonView& term, std::size_t n) {
    return term.item(n).as_index(target_count, "targets").value_or(0);
  };
  const std::vector<JsonView> linear = items_of(item, value, "linear"), quadratic = items_of(item, value, "quadratic");
  for (std::size_t n = 0; n < linear.size(); ++n) {
    if (is_term(linear[n], value["linear"][n], 2, "[target, factor]"))
      extra.linear.push_back({index(linear[n], 0), linear[n].item(1).as_number()});
  }
  for (std::size_t n = 0; n < quadratic.size(); ++n) {
    if (is_term(quadratic[n], value["quadratic"][n], 3, "[target, target, factor]"))
      extra.quadratic.push_back({index(quadratic[n], 0), index(quadratic[n], 1), quadratic[n].item(2).as_number()});
  }
}

// Reads the two factors that a mark of version 1 has for a correction target. `own` are the targets that are not
// correction targets.
void read_factors(const JsonView& item, const Json& value, std::size_t target_count,
                  const std::vector<std::size_t>& own, GltfExtraTarget& extra) {
  const std::optional<JsonView> factors = item.array("factors");
  if (!factors || factors->size() != 2)
    return item.complain("factors", "factors must be a list of two items; bake the original file again");
  std::array<std::optional<std::size_t>, 2> targets;  // no value stands for "base"
  for (std::size_t n = 0; n < 2; ++n) {
    const Json& factor = value["factors"][n];
    if (!factor.is_string())
      targets[n] = factors->item(n).as_index(target_count, "targets").value_or(0);
    else if (factor.get_ref<const std::string&>() != "base")
      return factors->item(n).complain(
          "a factor must be the index of a target or \"base\"; bake the original file again");
  }
  if (targets[0] && targets[1]) {
    extra.quadratic.push_back({*targets[0], *targets[1], 1});
  } else if (targets[0] || targets[1]) {
    const std::size_t j = targets[0].value_or(targets[1].value_or(0));
    extra.linear.push_back({j, 1});
    for (const std::size_t i : own) extra.quadratic.push_back({i, j, -1});
  } else {
    factors->complain("both factors are \"base\", but one must be a target; bake the original file again");
  }
}

// Checks that the correction targets ascend, and that none depends on another correction target.
void check_extras(const std::vector<JsonView>& list, const std::vector<GltfExtraTarget>& extras) {
  const auto is_extra = [&](std::size_t i) {
    const auto found = std::lower_bound(extras.begin(), extras.end(), i,
                                        [](const GltfExtraTarget& extra, std::size_t t) { return extra.target < t; });
    return found != extras.end() && found->target == i;
  };
  for (std::size_t n = 1; n < extras.size(); ++n) {
    if (extras[n].target <= extras[n - 1].target)
      return list[n].complain("target",
                              "correction targets must be listed in ascending order; bake the original file again");
  }
  for (std::size_t n = 0; n < extras.size(); ++n) {
    const bool follows_extras =
        std::any_of(extras[n].linear.begin(), extras[n].linear.end(), [&](const auto& t) { return is_extra(t.i); }) ||
        std::any_of(extras[n].quadratic.begin(), extras[n].quadratic.end(),
                    [&](const auto& t) { return is_extra(t.i) || is_extra(t.j); });
    if (follows_extras)
      return list[n].complain(
          "a correction target must not be computed from another correction target; bake the original file again");
  }
}

// Returns the indices of the author's targets, which are all targets except correction targets.
std::vector<std::size_t> own_targets(const std::vector<GltfExtraTarget>& extras, std::size_t target_count) {
  std::vector<bool> is_extra(target_count);
  for (const GltfExtraTarget& extra : extras) is_extra[extra.target] = true;
  std::vector<std::size_t> own;
  for (std::size_t i = 0; i < target_count; ++i)
    if (!is_extra[i]) own.push_back(i);
  return own;
}

// Reads a flag that may also be 0 or 1, because editors that keep extras as custom properties store no booleans
// (Blender 3.4).
bool read_flag(const JsonView& view, const Json& value, const char* key) {
  const auto found = value.find(key);
  if (found != value.end() && (*found == 0 || *found == 1)) return *found == 1;
  return view.flag(key);
}

GltfBakeMark read_mark(const JsonView& view, const Json& value, std::size_t target_count) {
  GltfBakeMark mark;
  const std::size_t version = view.required_count("version", std::size_t{1} << 31);
  if (version != kVersion && version != kVersionOfFactors)
    view.complain("version", "another version of chronormal has baked this file; bake the original file again");
  const std::optional<BakeEncoding> encoding = find_bake_encoding(view.required_text("encode"));
  if (!encoding)
    view.complain("encode", "encode must be harmless, exact, endpoint or smallest; bake the original file again");
  mark.encoding = encoding.value_or(BakeEncoding::kExact);
  mark.sequence = read_flag(view, value, "sequence");
  mark.animations_only = read_flag(view, value, "animations_only");
  mark.author = read_flag(view, value, "author");
  const std::vector<JsonView> extras = items_of(view, value, "extras");
  if (extras.size() > target_count) {
    view.complain("extras",
                  "the list has more correction targets than the mesh has targets; bake the original file again");
    return mark;
  }
  for (const JsonView& item : extras) {
    if (!item.is_object()) return mark;
    mark.extras.emplace_back().target = item.required_index("target", target_count, "targets").value_or(0);
  }
  const std::vector<std::size_t> own = own_targets(mark.extras, target_count);
  for (std::size_t n = 0; n < extras.size(); ++n) {
    if (version == kVersionOfFactors)
      read_factors(extras[n], value["extras"][n], target_count, own, mark.extras[n]);
    else
      read_terms(extras[n], value["extras"][n], target_count, mark.extras[n]);
  }
  check_extras(extras, mark.extras);
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
  using Ordered = nlohmann::ordered_json;
  Ordered extras = Ordered::array();
  for (const GltfExtraTarget& extra : mark.extras) {
    Ordered linear = Ordered::array(), quadratic = Ordered::array();
    for (const auto& term : extra.linear) linear.push_back(Ordered::array({term.i, term.a}));
    for (const auto& term : extra.quadratic) quadratic.push_back(Ordered::array({term.i, term.j, term.q}));
    extras.push_back({{"target", extra.target}, {"linear", std::move(linear)}, {"quadratic", std::move(quadratic)}});
  }
  Ordered result = {{"version", kVersion}, {"encode", name_of(mark.encoding)}, {"sequence", mark.sequence}};
  if (mark.animations_only) result["animations_only"] = true;
  if (mark.author) result["author"] = true;
  result["extras"] = std::move(extras);
  return result;
}

}  // namespace chronormal::inline internal::gltf

namespace chronormal {

double GltfExtraTarget::weight(std::span<const double> weights) const noexcept {
  double sum = 0;
  for (const LinearTerm& term : linear) sum += term.a * weights[term.i];
  for (const QuadraticTerm& term : quadratic) sum += term.q * (weights[term.i] * weights[term.j]);
  return sum;
}

bool GltfExtraTarget::follows(std::size_t i) const noexcept {
  return std::any_of(linear.begin(), linear.end(), [i](const LinearTerm& term) { return term.i == i; }) ||
         std::any_of(quadratic.begin(), quadratic.end(),
                     [i](const QuadraticTerm& term) { return term.i == i && term.j == i; });
}

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

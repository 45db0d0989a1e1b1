// Reads animations. Tracks of weights come from channels of nodes or from KHR_animation_pointer; channels of single
// weights of one mesh become one track. Other channels move, turn or scale nodes.
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/charconv.h"
#include "core/text.h"
#include "io/gltf/model/gltf_model_parser.h"

namespace chronormal::inline internal::gltf {
namespace {

// Returns the JSON pointer that KHR_animation_pointer gives as the target of a channel, or an empty text without this
// extension.
std::string pointer_of(const JsonView& target) {
  const std::optional<JsonView> extensions = target.object("extensions");
  const std::optional<JsonView> extension = extensions ? extensions->object("KHR_animation_pointer") : std::nullopt;
  return extension ? extension->required_text("pointer") : std::string();
}

std::size_t saturating_sum(std::size_t a, std::size_t b) {
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  return a > most - b ? most : a + b;
}

std::string node_weights(std::size_t node) { return "/nodes/" + std::to_string(node) + "/weights"; }

}  // namespace

Parser::Driven Parser::pointed_to(const JsonView& target) {
  const std::string pointer = pointer_of(target);
  Driven driven;
  bool is_unknown = false;
  // Parses "/nodes/3/weights" and "/nodes/3/weights/1".
  const auto index_in = [&](std::string_view list) -> std::optional<std::size_t> {
    std::size_t index = 0, weight = 0;
    if (!pointer.starts_with(list)) return std::nullopt;
    const char* const end = pointer.data() + pointer.size();
    const auto [stop, code] = from_chars(pointer.data() + list.size(), end, index);
    const std::string_view rest(stop, static_cast<std::size_t>(end - stop));
    constexpr std::string_view kWeights = "/weights";
    if (code != std::errc() || !rest.starts_with(kWeights)) return std::nullopt;
    if (rest == kWeights) return index;
    if (rest[kWeights.size()] != '/') return std::nullopt;
    const auto [last, weight_code] = from_chars(stop + kWeights.size() + 1, end, weight);
    is_unknown = weight_code != std::errc() || last != end;
    driven.target = weight;
    return index;
  };
  const std::optional<std::size_t> node = index_in("/nodes/"), mesh = index_in("/meshes/");
  if (is_unknown || (node && *node >= model_.nodes.size()) || (mesh && *mesh >= model_.meshes.size())) {
    target.complain("the channel drives " + pointer + ", which the file does not have; remove the channel");
    return {};
  }
  if (node) return {{*node}, driven.target};
  std::vector<std::size_t> all;
  for (std::size_t n = 0; mesh && n < model_.nodes.size(); ++n) {
    if (model_.nodes[n].mesh != mesh) continue;
    all.push_back(n);
    if (model_.nodes[n].weights.empty()) driven.nodes.push_back(n);
  }
  // If all nodes have their own weights, no node uses the weights of the mesh. The track then belongs to the first
  // node.
  if (driven.nodes.empty() && !all.empty()) driven.nodes.push_back(all.front());
  return driven;
}

void Parser::parse_channels(const JsonView& item, GltfAnimation& animation, std::vector<TrackSource>& sources) {
  std::set<std::string> known;
  // The channels of single weights, listed for each node.
  std::map<std::size_t, std::vector<LoneWeight>> lone;
  const std::optional<JsonView> channels = item.array("channels"), samplers = item.array("samplers");
  if (!channels || !samplers)
    return item.complain("an animation must have channels and samplers; remove it, or export the file again");
  animation.channel_count = channels->size();
  const auto read = [&](std::size_t c, Driven& driven) {
    const JsonView channel = channels->item(c);
    if (!channel.is_object()) return;
    const std::optional<JsonView> target = channel.object("target");
    if (!target) return channel.complain("target", "the channel has no target; remove the channel");
    const std::string path = target->required_text("path");
    if (path == "pointer") driven = pointed_to(*target);
    if (path == "weights" && target->has("node")) {
      if (const auto node = target->find_index("node", model_.nodes.size(), "nodes")) driven.nodes.push_back(*node);
    }
    if (driven.nodes.empty()) return;
    const std::string weights = path == "pointer" ? pointer_of(*target) : node_weights(driven.nodes.front());
    if (known.contains(weights))
      return target->complain(
          "another channel of this animation drives the same weights; remove one of the two channels");
    for (const std::size_t node : driven.nodes) {
      if (driven.target)
        lone[node].push_back({c, *driven.target});
      else
        parse_track(item, c, node, animation, sources);
    }
    if (!complaint_.first()) known.insert(weights);
  };
  for (std::size_t c = 0; c < channels->size() && !complaint_.first(); ++c) {
    Driven driven;
    if (!understands([&] { read(c, driven); })) keep_unread(item, c, driven, animation);
  }
  for (auto& of_node : lone) {
    std::vector<LoneWeight>& weights = of_node.second;
    std::stable_sort(weights.begin(), weights.end(),
                     [](const LoneWeight& a, const LoneWeight& b) { return a.target < b.target; });
    (void)understands([&] { assemble_track(item, of_node.first, weights, animation, sources); });
  }
}

void Parser::keep_unread(const JsonView& animation, std::size_t channel_index, const Driven& driven,
                         GltfAnimation& result) {
  if (driven.target || driven.nodes.empty()) return;
  GltfUnreadTrack track{driven.nodes.front(), channel_index, std::nullopt};
  (void)fault_of([&] {
    const JsonView channel = animation.array("channels")->item(channel_index), samplers = *animation.array("samplers");
    const std::optional<std::size_t> sampler = channel.required_index("sampler", samplers.size(), "samplers");
    if (sampler && samplers.item(*sampler).is_object())
      track.output = parse_use(samplers.item(*sampler), "output", Use::kWeights);
  });
  result.unread.push_back(track);
}

void Parser::parse_animation(const JsonView& item) {
  GltfAnimation animation;
  std::vector<TrackSource> sources;
  animation.name = item.text("name");
  if (complaint_.first()) return;
  const bool has_channels = understands([&] { parse_channels(item, animation, sources); });
  if (complaint_.first()) return;
  // Tracks with equal accessors have the same weights only if their interpolation and their number of targets are also
  // equal.
  std::map<std::tuple<std::size_t, std::size_t, GltfInterpolation, std::size_t>, std::size_t> first_track;
  for (std::size_t t = 0; t < sources.size(); ++t) {
    GltfTrack& track = animation.tracks[t];
    if (track.is_assembled) {
      const auto same = std::find_if(sources.begin(), sources.end(), [&](const TrackSource& source) {
        return source.elements == sources[t].elements && source.rest == sources[t].rest;
      });
      track.same_keys_as = static_cast<std::size_t>(same - sources.begin());
      continue;
    }
    const std::size_t target_count = model_.meshes[*model_.nodes[track.node].mesh].target_count;
    const std::tuple curve(sources[t].input, sources[t].output, track.interpolation, target_count);
    track.same_keys_as = first_track.try_emplace(curve, t).first->second;
  }
  model_.animations.push_back(std::move(animation));
  model_.track_sources.push_back(std::move(sources));
  NodeChannels& moving = model_.node_channels.emplace_back();
  if (!has_channels || model_.skins.empty()) return;
  moving.fault = fault_of([&] { parse_node_channels(item, moving.channels); });
}

void Parser::parse_track(const JsonView& animation, std::size_t channel_index, std::size_t node, GltfAnimation& result,
                         std::vector<TrackSource>& sources) {
  GltfTrack track;
  TrackSource source;
  track.node = node;
  track.channel = channel_index;
  const JsonView channel = animation.array("channels")->item(channel_index);
  if (!channel.required_index("sampler", animation.array("samplers")->size(), "samplers")) return;
  const std::optional<std::uint32_t> mesh = model_.nodes[node].mesh;
  const std::size_t target_count = mesh ? model_.meshes[*mesh].target_count : 0;
  if (target_count == 0)
    return channel.object("target")->complain(
        "node", "the channel drives weights of a node that has no mesh with morph targets; remove the channel");
  if (!parse_sampler(animation, channel_index, Use::kWeights, target_count, track, source)) return;
  result.tracks.push_back(track);
  sources.push_back(std::move(source));
}

void Parser::assemble_track(const JsonView& animation, std::size_t node, const std::vector<LoneWeight>& weights,
                            GltfAnimation& result, std::vector<TrackSource>& sources) {
  GltfTrack track;
  TrackSource source;
  track.node = node;
  track.is_assembled = true;
  std::set<std::size_t> inputs;
  const std::optional<std::uint32_t> mesh = model_.nodes[node].mesh;
  const std::size_t target_count = mesh ? model_.meshes[*mesh].target_count : 0;
  for (const LoneWeight& weight : weights) {
    const JsonView channel = animation.array("channels")->item(weight.channel), target = *channel.object("target");
    const bool is_known = std::any_of(result.tracks.begin(), result.tracks.end(),
                                      [&](const GltfTrack& other) { return other.node == node; });
    if (weight.target >= target_count)
      return target.complain("the channel drives " + pointer_of(target) +
                             ", which the file does not have; remove the channel");
    if (is_known || (!source.elements.empty() && source.elements.back().target == weight.target))
      return target.complain(
          "another channel of this animation drives the same weights; remove one of the two channels");
    GltfTrack of_weight;
    TrackSource read;
    if (!parse_sampler(animation, weight.channel, Use::kWeights, 1, of_weight, read)) return;
    if (source.elements.empty()) {
      track.channel = weight.channel;
      track.interpolation = of_weight.interpolation;
      source = read;
    }
    // The count of keys is an upper bound here, because several channels may have keys at the same times. The true
    // count is known only when the keys are read.
    if (inputs.insert(read.input).second) track.key_count = saturating_sum(track.key_count, of_weight.key_count);
    // A line can be written as a cubic, so linear and cubic channels can share a track. A step cannot be written as a
    // line or a cubic.
    const bool is_step = of_weight.interpolation == GltfInterpolation::kStep;
    if (is_step != (track.interpolation == GltfInterpolation::kStep))
      return target.complain(
          "the weights of node " + std::to_string(node) +
          " are partly STEP and partly LINEAR or CUBICSPLINE; give all of them the same interpolation");
    if (of_weight.interpolation == GltfInterpolation::kCubicSpline) track.interpolation = of_weight.interpolation;
    source.elements.push_back({weight.target, read.input, read.output, of_weight.interpolation});
  }
  source.rest = model_.nodes[node].weights.empty() ? model_.meshes[*mesh].weights : model_.nodes[node].weights;
  result.tracks.push_back(track);
  sources.push_back(std::move(source));
}

void Parser::parse_node_channels(const JsonView& animation, std::vector<NodeChannel>& result) {
  using Path = NodeChannel::Path;
  constexpr std::array<std::pair<std::string_view, Path>, 3> kPaths = {
      {{"translation", Path::kTranslation}, {"rotation", Path::kRotation}, {"scale", Path::kScale}}};
  std::set<std::pair<std::size_t, Path>> known;
  const JsonView channels = *animation.array("channels");
  for (std::size_t c = 0; c < channels.size() && !complaint_.first(); ++c) {
    const JsonView channel = channels.item(c);
    const std::optional<JsonView> target = channel.object("target");
    std::optional<std::size_t> node;
    std::string path = target->text("path");
    if (path == "pointer") {
      // Pointers to the transform of a node look like "/nodes/3/rotation".
      const std::string pointer = pointer_of(*target);
      constexpr std::string_view kNodes = "/nodes/";
      std::size_t index = 0;
      if (!pointer.starts_with(kNodes)) continue;
      const char* const end = pointer.data() + pointer.size();
      const auto [stop, code] = from_chars(pointer.data() + kNodes.size(), end, index);
      if (code != std::errc() || stop == end) continue;
      path.assign(stop + 1, end);
      if (index < model_.nodes.size()) node = index;
    } else {
      node = target->find_index("node", model_.nodes.size(), "nodes");
    }
    const auto* const found =
        std::find_if(kPaths.begin(), kPaths.end(), [&](const auto& known_path) { return known_path.first == path; });
    if (!node || found == kPaths.end()) continue;
    if (!known.emplace(*node, found->second).second)
      return target->complain("another channel of this animation drives the " + path +
                              " of the same node; remove one of the two channels");
    if (!std::holds_alternative<NodeTransform>(placement_of(model_, *node)))
      return target->complain("the channel drives the " + path +
                              " of a node that has a matrix; give the node translation, rotation and scale instead");
    GltfTrack track;
    TrackSource source;
    const Use use = found->second == Path::kRotation ? Use::kTurnedNode : Use::kMovedNode;
    if (!parse_sampler(animation, c, use, 1, track, source)) return;
    result.push_back(
        {static_cast<std::uint32_t>(*node), found->second, track.interpolation, source.input, source.output});
  }
}

bool Parser::parse_sampler(const JsonView& animation, std::size_t channel_index, Use use, std::size_t per_key,
                           GltfTrack& track, TrackSource& source) {
  const JsonView channel = animation.array("channels")->item(channel_index), samplers = *animation.array("samplers");
  const std::optional<std::size_t> sampler_index = channel.required_index("sampler", samplers.size(), "samplers");
  if (!sampler_index) return false;
  source.sampler = *sampler_index;
  const JsonView sampler = samplers.item(source.sampler);
  if (!sampler.is_object()) return false;
  const std::string interpolation = sampler.text("interpolation");
  if (interpolation == "STEP")
    track.interpolation = GltfInterpolation::kStep;
  else if (interpolation == "CUBICSPLINE")
    track.interpolation = GltfInterpolation::kCubicSpline;
  else if (!interpolation.empty() && interpolation != "LINEAR")
    sampler.complain("interpolation", "interpolation must be LINEAR, STEP or CUBICSPLINE; export the file again");
  for (const char* key : {"input", "output"}) {
    if (!sampler.has(key))
      sampler.complain(std::string("the sampler has no ").append(key).append("; export the file again"));
  }
  const std::optional<std::size_t> input = parse_use(sampler, "input", Use::kTimes);
  const std::optional<std::size_t> output = parse_use(sampler, "output", use);
  if (!input || !output) return false;

  track.key_count = model_.accessors[*input].count;
  if (track.interpolation == GltfInterpolation::kCubicSpline) per_key *= 3;
  const std::size_t given = model_.accessors[*output].count;
  if (given % per_key != 0 || given / per_key != track.key_count) {
    sampler.complain(
        "output", "the output has " +
                      (use == Use::kWeights ? counted(given, "weight", "weights") : counted(given, "value", "values")) +
                      " for " + counted(track.key_count, "key", "keys") + ", but must have " + grouped(per_key) +
                      " for each key; export the animation again");
    return false;
  }
  if (track.interpolation == GltfInterpolation::kCubicSpline && track.key_count < 2) {
    sampler.complain("input", "a cubic spline needs at least two keys; add a key, or choose LINEAR");
    return false;
  }
  source.input = *input;
  source.output = *output;
  return true;
}

}  // namespace chronormal::inline internal::gltf

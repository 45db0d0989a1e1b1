// Writes and reads the text at the end of the file of a shard, and finds the keyframes on which the file depends.
#include "workflow/sample/sample_part.h"

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/bytes/checksum.h"
#include "io/json/json.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMostRows = std::size_t{1} << (std::numeric_limits<std::size_t>::digits > 52 ? 52 : 31);

}  // namespace

std::string SamplePart::text() const {
  const nlohmann::ordered_json json = {
      {"chronormal_part", kPartVersion}, {"command", "sample"}, {"first", first}, {"total", total}, {"array", array},
      {"checksums", checksums}};
  return with_checksum(json.dump());
}

Result<SamplePart> SamplePart::read(std::string_view text, const std::string& name) {
  if (text.empty())
    return invalid_input(name, "this file was not written by sample --shard, but is a whole array; give only shards");
  if (!has_its_checksum(text)) return invalid_input(name, std::string(kDamagedPart));
  const Result<nlohmann::json> json = parse_json(text, name, 0, {});
  if (!json) return json.error();
  JsonComplaint complaint(name);
  const JsonView view(json.value(), "", complaint);
  SamplePart part;
  check_part_version(view);
  if (view.required_text("command") != "sample")
    view.complain("command",
                  "this file is a shard of another command than sample; merge the shards of each command separately");
  part.first = view.required_count("first", kMostRows);
  part.total = view.required_count("total", kMostRows);
  part.array = static_cast<std::uint32_t>(view.required_count("array", 0xFFFFFFFF));
  part.checksums = read_task_checksums(view);
  if (complaint.first()) return *complaint.first();
  return part;
}

std::uint32_t checksum_of_options(const SampleOptions& options, const Moments& moments) {
  NumberChecksum sum;
  for (const std::uint64_t number :
       {static_cast<std::uint64_t>(options.elements.kind), static_cast<std::uint64_t>(options.weighting),
        static_cast<std::uint64_t>(options.length), std::uint64_t{moments.times.size()},
        std::uint64_t{moments.weights.size()}})
    sum.add(number);
  if (!options.scheme.empty()) sum.add(options.scheme);
  if (options.stepping)
    for (const std::size_t number : {options.stepping->steps, options.stepping->anchor_interval})
      sum.add(std::uint64_t{number});
  for (const double time : moments.times) sum.add(time);
  for (const std::vector<double>& weights : moments.weights)
    for (const double weight : weights) sum.add(weight);
  return sum.value();
}

std::set<std::size_t> keyframes_of_moments(const Motion& motion, const Moments& moments, const Shard& shard) {
  std::set<std::size_t> keyframes;
  const IndexRange share = shard.of(moments.count());
  if (!moments.weights.empty())
    for (std::size_t k = 0; k < motion.keyframes.size(); ++k) keyframes.insert(k);
  if (moments.times.empty()) return keyframes;
  for (std::size_t i = share.first; i < std::min(share.end() + 1, moments.count()); ++i) {
    const std::size_t segment = find_instant(motion, moments.times[i]).value().segment;
    const auto [first, last] = motion.segments[segment];
    for (std::size_t k = first; k <= (i < share.end() ? last : first); ++k) keyframes.insert(k);
  }
  return keyframes;
}

}  // namespace chronormal::inline internal

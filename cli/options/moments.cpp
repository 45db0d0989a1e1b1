// Reads the values of --times, --weights and --step.
#include "cli/options/moments.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/io/input.h"
#include "cli/options/command.h"
#include "cli/terminal/format.h"
#include "cli/terminal/text.h"
#include "core/charconv.h"

namespace chronormal::cli {
namespace {

constexpr std::size_t kMostTimes = 1000000;

std::vector<std::string_view> split(std::string_view list, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t first = 0;;) {
    const std::size_t end = list.find(separator, first);
    parts.push_back(list.substr(first, end == std::string_view::npos ? end : end - first));
    if (end == std::string_view::npos) return parts;
    first = end + 1;
  }
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

Result<double> parse_number(const std::string& option, std::string_view word) {
  std::string_view digits = trimmed(word);
  if (digits.size() > 1 && digits.starts_with('+') && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, code] = from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || code != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
    return misuse(option, formatted("'{}' is not a number; give a number such as 0.5", word));
  return value;
}

// Appends the times of a range FIRST:STEP:LAST. If the steps lead to LAST except for rounding errors, the last time is
// exactly LAST.
Status append_range(const std::vector<std::string_view>& ends, std::string_view text, std::vector<double>& times) {
  const auto wrong = [&](const char* why) { return misuse("--times", formatted("'{}': {}", text, why)); };
  if (ends.size() != 3) return wrong("a range must be FIRST:STEP:LAST, such as 0:0.1:2");
  double numbers[3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const Result<double> number = parse_number("--times", ends[i]);
    if (!number) return number.error();
    numbers[i] = number.value();
  }
  const auto [first, step, last] = numbers;
  if (!(step > 0) || !(first <= last))
    return wrong("the step must be greater than 0, and the last time must not be before the first");
  const double steps = (last - first) / step;
  if (!(steps + static_cast<double>(times.size()) < static_cast<double>(kMostTimes)))
    return wrong("the list has more than 1,000,000 times; take a larger step");
  const double rounded = std::round(steps);
  const bool reaches = std::fabs(steps - rounded) <= 1e-9 * std::fmax(1, steps);
  const auto count = static_cast<std::size_t>(reaches ? rounded : std::floor(steps));
  for (std::size_t i = 0; i <= count; ++i)
    times.push_back(reaches && i == count ? last : first + static_cast<double>(i) * step);
  return Success{};
}

Result<std::vector<double>> parse_times(const std::string& list) {
  std::vector<double> times;
  for (const std::string_view part : split(list, ',')) {
    const std::vector<std::string_view> ends = split(part, ':');
    if (ends.size() > 1) {
      if (Status status = append_range(ends, part, times); !status) return status.error();
      continue;
    }
    const Result<double> time = parse_number("--times", part);
    if (!time) return time.error();
    times.push_back(time.value());
  }
  if (times.size() > kMostTimes) return misuse("--times", "the list has more than 1,000,000 times; give fewer times");
  return times;
}

// Removes a name in double quotes from the beginning of the text and returns it. Returns nothing if the closing quote
// is missing.
std::optional<std::string> take_quoted(std::string_view& text) {
  std::string name;
  for (std::size_t i = 1; i < text.size(); ++i) {
    const bool is_quote = text[i] == '"', is_pair = is_quote && text.substr(i + 1).starts_with('"');
    if (is_quote && !is_pair) {
      text.remove_prefix(i + 1);
      return name;
    }
    name += text[i];
    if (is_pair) ++i;
  }
  return std::nullopt;
}

// Removes the text up to and including the next comma from the beginning of `text`, and returns it without the comma.
std::string_view take_part(std::string_view& text) {
  const std::size_t comma = std::min(text.find(','), text.size());
  const std::string_view part = text.substr(0, comma);
  text.remove_prefix(std::min(comma + 1, text.size()));
  return part;
}

Result<AskedMoments::Pose> parse_pose(const std::string& list) {
  AskedMoments::Pose pose;
  std::string_view rest = list;
  for (bool more = true; more;) {
    std::optional<std::string> name;
    while (rest.starts_with(' ')) rest.remove_prefix(1);
    const bool is_quoted = rest.starts_with('"');
    if (is_quoted) {
      name = take_quoted(rest);
      if (!name)
        return misuse("--weights",
                      formatted("a closing quote is missing in '{}'; write names as \"NAME\"=WEIGHT", list));
      rest = trimmed(rest);
      if (!rest.starts_with('='))
        return misuse("--weights", formatted("target '{}' has no weight; write \"{}\"=WEIGHT", *name, *name));
    }
    more = rest.find(',') != std::string_view::npos;
    std::string_view part = take_part(rest);
    const std::size_t equals = is_quoted ? 0 : part.rfind('=');
    if (equals != std::string_view::npos) {
      if (!is_quoted) name = trimmed(part.substr(0, equals));
      part.remove_prefix(equals + 1);
    }
    const Result<double> weight = parse_number("--weights", part);
    if (!weight) return misuse("--weights", weight.error().message + (name ? "" : ", or NAME=WEIGHT"));
    if (name)
      pose.named.emplace_back(*name, weight.value());
    else
      pose.numbers.push_back(weight.value());
  }
  if (!pose.numbers.empty() && !pose.named.empty())
    return misuse(
        "--weights",
        formatted("'{}' mixes numbers with NAME=WEIGHT; give a number for each target, or NAME=WEIGHT for each", list));
  return pose;
}

// Parses the value of --step: N or N:M, where N is the number of steps per segment, and M the number of steps after
// which normals are computed anew.
Result<Stepping> parse_step(const std::string& text) {
  Stepping stepping;
  const std::vector<std::string_view> parts = split(text, ':');
  const auto read = [](std::string_view part, std::size_t& number) {
    const auto [end, code] = from_chars(part.data(), part.data() + part.size(), number);
    return !part.empty() && code == std::errc{} && end == part.data() + part.size() && number <= kMostTimes;
  };
  if (parts.size() > 2 || !read(parts[0], stepping.steps) || stepping.steps == 0 ||
      (parts.size() == 2 && !read(parts[1], stepping.anchor_interval)))
    return misuse("--step", formatted("'{}' must be N or N:M, whole numbers up to 1,000,000, with N at least 1", text));
  return stepping;
}

std::string range_of(const Motion& motion) {
  double first = motion.keyframes.front().time, last = first;
  for (const auto& keyframe : motion.keyframes) {
    first = std::fmin(first, keyframe.time);
    last = std::fmax(last, keyframe.time);
  }
  return formatted("{:g} to {:g}", first, last);
}

Result<std::vector<double>> weights_of(const AskedMoments::Pose& pose, const TargetNames& names) {
  if (pose.named.empty()) return pose.numbers;
  std::vector<std::optional<double>> given(names.size());
  for (const auto& [name, weight] : pose.named) {
    const Result<std::size_t> target = find_target(names, name);
    if (!target) return misuse("--weights", target.error().message);
    std::optional<double>& own = given[target.value()];
    if (own)
      return misuse("--weights", formatted("target {} has two weights in this pose; give only one",
                                           target_label(names, target.value())));
    own = weight;
  }
  std::vector<double> weights;
  weights.reserve(given.size());
  for (const std::optional<double>& weight : given) weights.push_back(weight.value_or(0));
  return weights;
}

// Checks that a motion of this kind can be sampled at the requested moments.
Status check_kind(const Motion& motion, const AskedMoments& asked) {
  const bool has_times = asked.at_keys || !asked.times.empty(), has_weights = !asked.poses.empty();
  if (motion.segments.empty()) {
    if (has_weights) return misuse("--weights", "the mesh has no targets; leave --weights out");
    for (const double time : asked.times) {
      if (time != 0) return misuse("--times", "the mesh does not move; leave --times out");
    }
    if (asked.times.size() > 1) return misuse("--times", "the mesh does not move; leave --times out");
    return Success{};
  }
  if (motion.kind == MotionKind::kTargets) {
    const std::size_t count = motion.segments.size();
    const std::string how = formatted("give --weights, {} for each pose, or NAME=WEIGHT for some targets",
                                      counted(count, "number", "numbers"));
    if (has_times) return misuse("--times", "blend shapes have no times; " + how);
    if (!has_weights) return misuse("--weights", "the input has blend shapes, which need weights; " + how);
    return Success{};
  }
  if (has_weights)
    return misuse("--weights", "weights are only for blend shapes; give --times instead, from " + range_of(motion));
  if (!has_times)
    return misuse("--times",
                  "the times are missing; give --times within the motion, which goes from " + range_of(motion));
  return Success{};
}

}  // namespace

std::vector<Option> MomentArguments::table() {
  return {{"--times LIST", &times,
           "compute normals at these times in seconds\nLIST is 0,0.5,1 or FIRST:STEP:LAST, or the word keys, which "
           "stands for the times of the keyframes. A mesh that does not move needs no times"},
          {"--weights LIST", &weights,
           "compute normals in this pose of blend shapes\nLIST is NAME=W,... or W1,W2,... With names, all other "
           "weights are 0; without names, each target needs a weight. Repeat the option for more poses"},
          {"--step N",
           &step,
           "play a scheme in N equal steps for each segment\nNeeds --scheme. Each step only adds to the result of the "
           "step before. Every 64 steps, normals are computed anew from the curve, or every M steps with N:M, or never "
           "with N:0. The largest drift is printed",
           {.excludes = "--times", .rare = true}}};
}

std::size_t AskedMoments::count() const noexcept {
  return times.empty() && poses.empty() ? 1 : times.size() + poses.size();
}

Result<AskedMoments> understand(const MomentArguments& arguments) {
  AskedMoments asked;
  if (!arguments.step.empty()) {
    if (!arguments.weights.empty()) return misuse("--step", "--step goes through all targets; leave --weights out");
    const Result<Stepping> stepping = parse_step(arguments.step);
    if (!stepping) return stepping.error();
    asked.stepping = stepping.value();
    return asked;
  }
  if (!arguments.times.empty() && !arguments.weights.empty())
    return misuse(
        "--weights",
        "--times and --weights cannot be used together; give --weights for blend shapes, --times for other motions");
  asked.at_keys = arguments.times == "keys";
  if (!arguments.times.empty() && !asked.at_keys) {
    Result<std::vector<double>> times = parse_times(arguments.times);
    if (!times) return times.error();
    asked.times = std::move(times).value();
  }
  for (const std::string& list : arguments.weights) {
    Result<AskedMoments::Pose> pose = parse_pose(list);
    if (!pose) return pose.error();
    asked.poses.push_back(std::move(pose).value());
  }
  return asked;
}

Result<Moments> moments_of(Input& input, const AskedMoments& asked) {
  const Result<MotionStream*> stream = input.stream();
  if (!stream) return stream.error();
  const Motion& motion = stream.value()->motion();
  if (asked.stepping) {
    const std::size_t steps = asked.stepping->steps, segments = motion.segments.size();
    if (segments == 0) return misuse("--step", "the mesh does not move, so there are no steps; leave --step out");
    if (steps >= kMostTimes / segments)
      return misuse("--step",
                    "the steps of all segments together are more than 1,000,000 moments; give a smaller --step");
    return step_moments(motion, steps);
  }
  if (const Status status = check_kind(motion, asked); !status) return status.error();
  Moments moments;
  if (motion.segments.empty()) return moments;
  moments.times = asked.at_keys ? input.key_times().value() : asked.times;
  const Result<TargetNames> names = target_names(input);
  if (!names) return names.error();
  for (const AskedMoments::Pose& pose : asked.poses) {
    Result<std::vector<double>> weights = weights_of(pose, names.value());
    if (!weights) return weights.error();
    moments.weights.push_back(std::move(weights).value());
  }
  return moments;
}

}  // namespace chronormal::cli

// Defines the question `facing` of the command `query`: the times when faces show their front to a viewer, and
// silhouette edges.

#include <cmath>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>

#include "cli/commands/query_question.h"
#include "cli/options/command.h"
#include "cli/terminal/format.h"
#include "core/charconv.h"

namespace chronormal::cli {
namespace {

struct FacingOptions {
  std::optional<std::string> direction, eye;
  bool silhouettes = false;
};

// Parses a list of numbers between commas, each within the range of float32. Errors: kUsage, with `option` as the
// place.
Result<std::vector<double>> parse_numbers(const std::string& option, std::string_view list) {
  std::vector<double> values;
  for (;;) {
    const std::string_view word = list.substr(0, list.find(','));
    double value = 0;
    const auto [end, code] = from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || code != std::errc{} || end != word.data() + word.size() ||
        !std::isfinite(static_cast<float>(value)))
      return misuse(option, formatted("'{}' is not a number of float32; give numbers such as 4,-5,2", word));
    values.push_back(value);
    if (word.size() == list.size()) return values;
    list.remove_prefix(word.size() + 1);
  }
}

Result<View> view_of(const FacingOptions& options) {
  if (options.direction && options.eye)
    return misuse("--direction", "there are two cameras; give either --direction X,Y,Z or --eye X,Y,Z");
  if (!options.direction && !options.eye)
    return misuse("--direction", "the camera is missing; give either --direction X,Y,Z or --eye X,Y,Z");
  const std::string option = options.eye ? "--eye" : "--direction";
  const Result<std::vector<double>> numbers = parse_numbers(option, options.eye ? *options.eye : *options.direction);
  if (!numbers) return numbers.error();
  const std::vector<double>& n = numbers.value();
  if (n.size() == 6 && options.eye) return View::of_moving_eye({n[0], n[1], n[2]}, {n[3], n[4], n[5]});
  if (n.size() != 3)
    return misuse(option, options.eye
                              ? "the value must be three numbers X,Y,Z, or six for a camera that moves: X,Y,Z,X,Y,Z"
                              : "the value must be three numbers X,Y,Z, such as 4,-5,2");
  if (options.eye) return View::of_eye({n[0], n[1], n[2]});
  return View::of_direction({n[0], n[1], n[2]});
}

}  // namespace

Question facing_question() {
  auto options = std::make_shared<FacingOptions>();
  return {
      "facing",
      "when faces or vertices face a camera, and silhouette edges",
      {{"--direction X,Y,Z", &options->direction, "look from a camera that is far away in this direction"},
       {"--eye X,Y,Z", &options->eye,
        "look from a camera at this point\nWith X,Y,Z,X,Y,Z the camera moves straight to the second point, from the "
        "first to the last time of the motion"},
       {"--silhouettes", &options->silhouettes, "also list the silhouette edges"}},
      [options]() -> Result<Ask> {
        const Result<View> view = view_of(*options);
        if (!view) return view.error();
        return Ask([view = view.value(), with = options->silhouettes](const Motion& motion, const QuerySpan& span,
                                                                      const QueryProgress& progress,
                                                                      const ElementOptions& elements) {
          return query_facing(motion, view, with, span, progress, elements);
        });
      },
      true};
}

}  // namespace chronormal::cli

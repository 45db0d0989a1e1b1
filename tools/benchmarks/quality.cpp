// How good schemes are against what they cost, and how far every path is off.

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "benchmarks/sections.h"

namespace chronormal::benchmarks {
namespace {

struct SchemeAim {
  double small, large;  // ns per face at 15 k and 1 M
};

const std::map<std::string, SchemeAim>& scheme_aims() {
  static const std::map<std::string, SchemeAim> all = {{"linear", {0.34, 1.2}}, {"quadratic", {0.40, 1.7}},
                                                       {"cubic", {0.48, 2.2}},  {"slerp", {0.39, 1.4}},
                                                       {"circle", {0.45, 1.9}}, {"decasteljau:4", {8, 9}}};
  return all;
}

const SchemeQuality& quality_of(const Results& results, const std::string& scheme) {
  return *std::find_if(results.qualities.begin(), results.qualities.end(),
                       [&](const SchemeQuality& one) { return one.scheme == scheme && one.mesh == "twist"; });
}

// 1.7e-3, and 1e-6 without a decimal that says nothing.
std::string shortest(double value) {
  std::string text = scientific(value, 1);
  if (const std::size_t zero = text.find(".0"); zero != std::string::npos) text.erase(zero, 2);
  return text;
}

bool is_exact(const std::string& scheme) {
  return scheme == "polynomial" || scheme == "rational" || scheme == "recompute";
}

// Approximations lie above, exact ones below, and what the marks are in between.
Panel quality_panel(const Results& results, const std::string& size, const std::string& title) {
  constexpr Mark kMarks[] = {Mark::kSquare,       Mark::kTriangle,    Mark::kDiamond, Mark::kOpenSquare,
                             Mark::kOpenTriangle, Mark::kOpenDiamond, Mark::kCross};
  constexpr Colour kColours[] = {Colour::kOrange, Colour::kPurple, Colour::kGreen, Colour::kBlack};
  Panel panel;
  panel.title = title;
  panel.x = {
      "ns per face", 0.1, 1000, true, {{0.1, "0.1"}, {0.3, "0.3"}, {1, "1"}, {3, "3"}, {10, "10"}, {100, "100"}}};
  panel.y = {"mean error on twist, degrees",
             1e-7,
             30,
             true,
             {{1e-6, "10^{-6}"}, {1e-4, "10^{-4}"}, {1e-2, "0.01"}, {0.1, "0.1"}, {1, "1"}, {10, "10"}}};
  panel.legend = "center center maxrows 7";
  std::size_t approximations = 0, exact = 0;
  for (const std::string& scheme : schemes()) {
    std::size_t& place = is_exact(scheme) ? exact : approximations;
    Series series{scheme, {}, Colour::kBlue, 0, false, kMarks[place % std::size(kMarks)], 1.1};
    if (!is_exact(scheme)) series.colour = kColours[place % std::size(kColours)];
    series.points.emplace_back(results.find("schemes", size, kGrid, scheme)->ns,
                               quality_of(results, scheme).mean_degrees);
    panel.series.push_back(std::move(series));
    ++place;
  }
  return panel;
}

}  // namespace

void add_schemes(Page& page, const Results& results) {
  std::vector<Cells> rows;
  for (const std::string& scheme : schemes()) {
    Cells cells = {fmt::format("`{}`", scheme)};
    for (const bool large : {false, true}) {
      const char* const size = large ? "1M" : "15k";
      const Row& row = *results.find("schemes", size, kGrid, scheme);
      const Row* const played = results.find("schemes", size, kGrid, fmt::format("{}, played", scheme));
      const auto aim = scheme_aims().find(scheme);
      std::string text = nanoseconds(row.ns);
      if (aim != scheme_aims().end()) {
        const double wanted = large ? aim->second.large : aim->second.small;
        text = emphasised(fmt::format("{} / {:g}", text, wanted), row.ns <= wanted);
      }
      cells.push_back(std::move(text));
      cells.push_back(played == nullptr ? "-" : nanoseconds(played->ns));
    }
    const SchemeQuality& quality = quality_of(results, scheme);
    cells.insert(cells.end(),
                 {fmt::format("{:.0f}", quality.bytes), ratio(quality.mean_degrees), ratio(quality.max_degrees)});
    rows.push_back(std::move(cells));
  }
  page.table("schemes", {"scheme", "ns, 15 k", "played", "ns, 1 M", "played", "bytes", "mean, degrees", "max"}, rows);
  Figure figure{fmt::format("benchmarks_{}_quality", results.name), 1000, 620, 2, {}};
  figure.panels = {quality_panel(results, "15k", "15 k faces, in the caches of a core"),
                   quality_panel(results, "1M", "1 M faces")};
  page.picture("quality", figure);
}

void add_accuracy(Page& page, const Results& results) {
  for (const std::string of : {"faces", "vertices"}) {
    Cells header = {of, "promised"};
    for (const std::string& mesh : accuracy_meshes()) header.push_back(mesh);
    std::vector<Cells> rows;
    for (const std::string& path : accuracy_paths()) {
      Cells cells = {path, ""};
      for (const std::string& mesh : accuracy_meshes()) {
        const auto one = std::find_if(results.accuracies.begin(), results.accuracies.end(), [&](const Accuracy& entry) {
          return entry.of == of && entry.mesh == mesh && entry.path == path;
        });
        cells[1] = shortest(one->bound);
        cells.push_back(
            fmt::format("{} / {} / {}", scientific(one->mean), scientific(one->share_9999), scientific(one->max, 1)));
      }
      rows.push_back(std::move(cells));
    }
    page.table("accuracy_" + of, header, rows);
  }
}

}  // namespace chronormal::benchmarks

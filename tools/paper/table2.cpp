// Section 2: the paper's Table 2, in operations, bytes and nanoseconds. The only section with times in it.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <initializer_list>
#include <map>

#include "paper/morphs.h"
#include "paper/sections.h"

namespace chronormal::paper {
namespace {

struct Row {
  const char* scheme;
  const char* normalised;  // in the paper's column "Requires normalization"
  const char* paper;       // in its column "Computation"
};
constexpr std::array kRows = {
    Row{"recompute", "yes", "9 additions, 6 multiplications (text)"},
    Row{"linear", "yes", "3 linear interpolation"},
    Row{"quadratic", "yes", "3 evaluation of degree two"},
    Row{"cubic", "yes", "3 evaluation of degree three"},
    Row{"polynomial", "yes", "3 evaluation of degree two"},
    Row{"rational", "no", "3 evaluation of rational polynomial"},
    Row{"slerp", "no", "1 SLERP"},
    Row{"decasteljau:4", "no", "n(n-1)/2 SLERPs"},
    Row{"quaternion:matrix", "no", "1 SLERP, quaternion to matrix"},
    Row{"quaternion:optimal", "", "ours"},
    Row{"circle", "", "ours"},
    Row{"circle:timed", "", "ours"},
    Row{"linear:scaled", "", "ours"},
};

std::string counts(const OperationCounts& c) {
  return fmt::format("{} / {} / {} / {} / {}", c.add, c.multiply, c.divide, c.sqrt, c.trigonometric);
}

// Nanoseconds per face, one value per block.
struct Times {
  std::vector<double> prepare, random, sequential;
};

constexpr std::size_t kBlock = 1024, kBlocks = 12, kSteps = 200;

double nanoseconds_per_face(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / kBlock;
}

Times time_scheme(const Row& row, const Segment& segment) {
  using Clock = std::chrono::steady_clock;
  Times times;
  std::vector<float> planes(3 * kBlock);
  const auto result =
      VectorView<float>::planes(planes.data(), planes.data() + kBlock, planes.data() + 2 * kBlock, kBlock);
  const std::size_t steps = std::string_view(row.scheme).starts_with("decasteljau") ? kSteps / 10 : kSteps;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    const auto before = Clock::now();
    const PreparedScheme scheme(row.scheme, segment, {b * kBlock, kBlock});
    times.prepare.push_back(nanoseconds_per_face(before));

    const auto random = Clock::now();
    for (std::size_t i = 0; i < steps; ++i)
      scheme->evaluate(static_cast<double>(i * 89 % steps) / static_cast<double>(steps), result);
    times.random.push_back(nanoseconds_per_face(random) / static_cast<double>(steps));

    const auto playback = scheme->play(0, 1.0 / static_cast<double>(steps), kDefaultAnchorInterval);
    if (!playback) continue;
    const auto sequential = Clock::now();
    for (std::size_t i = 0; i < steps; ++i) playback->next(result);
    times.sequential.push_back(nanoseconds_per_face(sequential) / static_cast<double>(steps));
  }
  return times;
}

// The median, and the half of the values around it.
std::string spread(const std::vector<double>& values) {
  if (values.empty()) return "";
  const auto text = [](double v) { return v < 100 ? fmt::format("{:.1f}", v) : grouped(v); };
  return fmt::format("{} ({} to {})", text(quantile(values, 0.5)), text(quantile(values, 0.25)),
                     text(quantile(values, 0.75)));
}

void add_times(Page& page, const Segment& segment) {
  std::map<std::string_view, Times> times;
  std::vector<Cells> rows;
  // One after the other: a second thread would share the caches.
  for (const Row& row : kRows) {
    const Times& of_scheme = times[row.scheme] = time_scheme(row, segment);
    rows.push_back({fmt::format("`{}`", row.scheme), spread(of_scheme.prepare), spread(of_scheme.random),
                    spread(of_scheme.sequential)});
  }
  page.table("times", {"ns per face", "prepare", "random", "sequential"}, rows);
  const auto random = [&](std::string_view scheme) { return quantile(times.at(scheme).random, 0.5); };
  const auto played = [&](std::string_view scheme) { return quantile(times.at(scheme).sequential, 0.5); };
  for (const char* scheme : {"slerp", "circle", "polynomial", "linear", "quadratic", "cubic"})
    page.set(fmt::format("sequence_gain_{}", scheme), fmt::format("{:.1f}", random(scheme) / played(scheme)));
  for (const char* scheme : {"polynomial", "slerp", "recompute"})
    page.set(fmt::format("{}_time", scheme), fmt::format("{:.2f}", random(scheme) / random("linear")));
  for (const char* scheme : {"polynomial", "slerp"})
    page.set(fmt::format("{}_time_played", scheme), fmt::format("{:.2f}", played(scheme) / played("linear")));
  page.set({{"blocks", grouped(kBlocks)},
            {"block_faces", grouped(kBlock)},
            {"access_steps", grouped(kSteps)},
            {"anchor_interval", grouped(kDefaultAnchorInterval)}});
}

}  // namespace

void measure_table2(Page& page) {
  const Segment segment = morph("bend").segment(0);
  std::vector<Cells> rows;
  for (const Row& row : kRows) {
    const PreparedScheme scheme(row.scheme, segment, {0, kBlock});
    const auto sequential = scheme->sequential_operations();
    rows.push_back({fmt::format("`{}`", row.scheme), counts(scheme->operations()),
                    sequential ? counts(*sequential) : "none", fmt::format("{}", scheme->bytes() / kBlock),
                    row.normalised, row.paper});
  }
  page.table("operations", {"scheme", "random access", "sequential access", "bytes", "normalise", "in the paper"}, rows,
             4);

  const auto random = [](std::string_view name) { return make_scheme(name).value()->operations(); };
  const auto played = [](std::string_view name) { return make_scheme(name).value()->sequential_operations().value(); };
  const OperationCounts linear = random("linear"), polynomial = random("polynomial"), slerp = random("slerp"),
                        casteljau = random("decasteljau:4"), recompute = random("recompute"), circle = random("circle"),
                        played_linear = played("linear"), played_polynomial = played("polynomial"),
                        played_slerp = played("slerp");
  // A normalisation: 2 additions, 6 multiplications, a division, a root.
  constexpr int kNormaliseAdd = 2, kNormaliseMultiply = 6, kNormalise = 10;
  constexpr int kCasteljauSlerps = 4 * 3 / 2;
  require(played_polynomial.add == 6 + kNormaliseAdd && played_polynomial.multiply == kNormaliseMultiply,
          "two additions per component");
  require(played_slerp.trigonometric == 0 && played("circle").trigonometric == 0, "no trigonometry in sequence");
  require(casteljau.trigonometric > kCasteljauSlerps, "de Casteljau needs inner angles");
  require(polynomial.divide == linear.divide && polynomial.sqrt == linear.sqrt, "both normalise");
  for (const auto& [name, count] : std::initializer_list<std::pair<const char*, int>>{
           {"polynomial_add", polynomial.add - kNormaliseAdd},
           {"polynomial_multiply", polynomial.multiply - kNormaliseMultiply},
           {"played_polynomial_add", played_polynomial.add - kNormaliseAdd},
           {"played_polynomial_add_per_component", (played_polynomial.add - kNormaliseAdd) / 3},
           {"played_polynomial_operations", played_polynomial.add + played_polynomial.multiply + 2},
           {"normalisation", kNormalise},
           {"linear_add", linear.add - kNormaliseAdd},
           {"linear_multiply", linear.multiply - kNormaliseMultiply},
           {"more_add", polynomial.add - linear.add},
           {"more_multiply", polynomial.multiply - linear.multiply},
           {"played_more_add", played_polynomial.add - played_linear.add},
           {"played_more_multiply", played_polynomial.multiply - played_linear.multiply},
           {"slerp_add", slerp.add},
           {"slerp_multiply", slerp.multiply},
           {"played_slerp_add", played_slerp.add},
           {"played_slerp_multiply", played_slerp.multiply},
           {"circle_add", circle.add},
           {"circle_multiply", circle.multiply},
           {"circle_more_add", circle.add - slerp.add},
           {"circle_more_multiply", circle.multiply - slerp.multiply},
           {"casteljau_slerps", kCasteljauSlerps},
           {"casteljau_trigonometric", casteljau.trigonometric},
           {"casteljau_arc_tangents", casteljau.trigonometric - kCasteljauSlerps},
           {"recompute_add", recompute.add},
           {"recompute_multiply", recompute.multiply}})
    page.set(name, fmt::format("{}", count));
  add_times(page, segment);
}

}  // namespace chronormal::paper

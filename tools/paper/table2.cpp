// Section 2: the paper's Table 2, in operations, bytes and nanoseconds. The only section with times in it.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>

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

}  // namespace

void write_table2(Page& page) {
  const Motion& bend = morph("bend");
  const Segment segment = bend.segment(0);

  page.heading("2 Table 2: cost");
  page.text(
      "The paper counts in SLERPs and polynomial evaluations, and leaves it to the reader what those cost. Here is "
      "what runs, counted on the code itself: additions / multiplications / divisions / square roots / "
      "trigonometric functions per face and time, the normalisation included. A sine with its cosine counts as "
      "one. What all faces share at one t (powers of t, weights) is computed once and not counted. Bytes are what "
      "an evaluation reads per face.");
  std::vector<std::vector<std::string>> rows;
  std::vector<std::unique_ptr<PreparedScheme>> schemes;
  const auto of = [](std::string_view name) { return make_scheme(name).value(); };
  for (const Row& row : kRows) {
    const PreparedScheme scheme(row.scheme, segment, {0, kBlock});
    const auto sequential = scheme->sequential_operations();
    rows.push_back({fmt::format("`{}`", row.scheme), counts(scheme->operations()),
                    sequential ? counts(*sequential) : "none", fmt::format("{}", scheme->bytes() / kBlock),
                    row.normalised, row.paper});
  }
  page.table({"scheme", "random access", "sequential access", "bytes", "normalise", "in the paper"}, rows, 4);

  const OperationCounts linear = of("linear")->operations(), polynomial = of("polynomial")->operations();
  const OperationCounts slerp = of("slerp")->operations(), casteljau = of("decasteljau:4")->operations();
  const OperationCounts recompute = of("recompute")->operations(), circle = of("circle")->operations();
  const OperationCounts played = of("polynomial")->sequential_operations().value();
  const OperationCounts played_circle = of("circle")->sequential_operations().value();
  const OperationCounts played_linear = of("linear")->sequential_operations().value();
  const OperationCounts played_slerp = of("slerp")->sequential_operations().value();
  // A normalisation: 2 additions, 6 multiplications, a division, a root.
  constexpr int kNormaliseAdd = 2, kNormaliseMultiply = 6;
  page.bullet(
      fmt::format("**Exact is nearly as cheap as linear.** Before the normalisation, which both need, `polynomial` "
                  "takes {} additions and {} multiplications; the paper says 6 and 6, by Horner. Ours is the "
                  "Bernstein form, which meets both ends without rounding. `linear` takes {} and {}.",
                  polynomial.add - kNormaliseAdd, polynomial.multiply - kNormaliseMultiply, linear.add - kNormaliseAdd,
                  linear.multiply - kNormaliseMultiply));
  require(played.add == 6 + kNormaliseAdd && played.multiply == kNormaliseMultiply, "two additions per component");
  page.bullet(fmt::format(
      "**Two additions.** Played, `polynomial` takes {} additions a component and no multiplication before the "
      "normalisation: the paper's figure. The normalisation is then the larger part, {} of {} operations.",
      (played.add - kNormaliseAdd) / 3, kNormaliseAdd + kNormaliseMultiply + 2, played.add + played.multiply + 2));
  require(played_slerp.trigonometric == 0 && played_circle.trigonometric == 0, "no trigonometry in sequence");
  page.bullet(
      fmt::format("**Slerp** needs no normalisation, as the paper says, but a sine at random access. Written as "
                  "cos(tT) u0 + sin(tT) q it is {} additions, {} multiplications and one sine with its cosine; the "
                  "paper's Eq. 5 has two sines and a division by sin T. In sequence the sine goes away as well: {} "
                  "and {}, with neither root nor division, which no polynomial does without. In quality it is the "
                  "worst row of Table 1.",
                  slerp.add, slerp.multiply, played_slerp.add, played_slerp.multiply));
  page.bullet(
      fmt::format("**Quaternions** cost no quaternion. The normal runs on a circle (section 5), so \"1 SLERP, "
                  "quaternion to matrix conversion\" is {} additions, {} multiplications and one sine with its "
                  "cosine: {} and {} more than vector slerp.",
                  circle.add, circle.multiply, circle.add - slerp.add, circle.multiply - slerp.multiply));
  page.bullet(
      fmt::format("**De Casteljau** over n = 4 normals is n(n-1)/2 = {} slerps, as the paper says. Of its {} "
                  "trigonometric functions, {} are the sines; the others are arc tangents, since the angles "
                  "between the points of the inner levels are not known beforehand.",
                  4 * 3 / 2, casteljau.trigonometric, 4 * 3 / 2));
  require(casteljau.trigonometric > 6, "de Casteljau needs inner angles");
  page.bullet(
      fmt::format("**Recompute** is the paper's \"9 additions, 6 multiplications\" and then the vertices: moving "
                  "three of them to t takes the rest of its {} additions and {} multiplications. (The paper takes "
                  "them as moved.)",
                  recompute.add, recompute.multiply));
  page.line("");

  std::vector<Times> times(kRows.size());
  // One after the other: a second thread would share the caches.
  for (std::size_t r = 0; r < kRows.size(); ++r) times[r] = time_scheme(kRows[r], segment);
  page.line("<!-- times -->");
  page.text(
      fmt::format("Times, nanoseconds per face: median over {} blocks of {} faces of bend that stay in cache, one "
                  "thread, and the middle half of the blocks. Preparation includes the control normals. Access is "
                  "to {} times t; played ones are made anew every {} steps. They are of the machine that made this "
                  "page, which had other work to do; only ratios within the table mean anything.",
                  kBlocks, grouped(kBlock), kSteps, kDefaultAnchorInterval));
  rows.clear();
  for (std::size_t r = 0; r < kRows.size(); ++r)
    rows.push_back({fmt::format("`{}`", kRows[r].scheme), spread(times[r].prepare), spread(times[r].random),
                    spread(times[r].sequential)});
  page.table({"ns per face", "prepare", "random", "sequential"}, rows);
  const auto median = [&](std::string_view scheme, std::vector<double> Times::*what) {
    for (std::size_t r = 0; r < kRows.size(); ++r) {
      if (scheme == kRows[r].scheme) return quantile(times[r].*what, 0.5);
    }
    return 0.0;
  };
  const auto gain = [&median](std::string_view scheme) {
    return median(scheme, &Times::random) / median(scheme, &Times::sequential);
  };
  page.text(
      fmt::format("\"Linear interpolation always will be faster than any other\": `polynomial` took {:.2f} times "
                  "as long as `linear` at random access and {:.2f} times in sequence; `slerp` {:.2f} and {:.2f}; "
                  "`recompute` {:.2f} at random.",
                  median("polynomial", &Times::random) / median("linear", &Times::random),
                  median("polynomial", &Times::sequential) / median("linear", &Times::sequential),
                  median("slerp", &Times::random) / median("linear", &Times::random),
                  median("slerp", &Times::sequential) / median("linear", &Times::sequential),
                  median("recompute", &Times::random) / median("linear", &Times::random)));
  page.text(
      fmt::format("What sequence gains (random over sequential): `slerp` {:.1f} times, `circle` {:.1f}, "
                  "`polynomial` {:.1f}, `linear` {:.1f}, `quadratic` {:.1f}, `cubic` {:.1f}. Arcs save the sine, "
                  "polynomials multiplications; all pay with a state that is read and written at every step, and made "
                  "anew in double every 64. Where sixteen sines are computed at once, that costs more than it saves.",
                  gain("slerp"), gain("circle"), gain("polynomial"), gain("linear"), gain("quadratic"), gain("cubic")));
  page.line("<!-- end of times -->\n");

  page.statement(
      "Horner takes 6 additions and 6 multiplications for the exact quadratic",
      fmt::format("Bernstein form: {} and {} at random, {} and 0 in sequence, then the normalisation",
                  polynomial.add - kNormaliseAdd, polynomial.multiply - kNormaliseMultiply, played.add - kNormaliseAdd),
      "2");
  require(polynomial.divide == linear.divide && polynomial.sqrt == linear.sqrt, "both normalise");
  page.statement(
      "Linear \"always will be faster than any other approach\"",
      fmt::format("by {} additions and {} multiplications a face against the exact one, by {} and {} in sequence; "
                  "in sequence arcs need neither root nor division (times: section 2)",
                  polynomial.add - linear.add, polynomial.multiply - linear.multiply, played.add - played_linear.add,
                  played.multiply - played_linear.multiply),
      "2");
  page.statement("De Casteljau takes n(n-1)/2 SLERPs",
                 fmt::format("yes, and {} arc tangents for n = 4", casteljau.trigonometric - 6), "2");
}

}  // namespace chronormal::paper

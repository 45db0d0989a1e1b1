// Section 1: the paper's Table 1 on our morphs.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "paper/morphs.h"
#include "paper/sections.h"

namespace chronormal::paper {
namespace {

constexpr std::size_t kMorphs = 4;

// As the paper prints it. Its columns are morphs of 15,300, 44,700, 35,180 and 21,040 faces.
struct Row {
  const char* paper_name;
  const char* scheme;
  std::array<double, kMorphs> sums;
};
constexpr std::array kPaper = {
    Row{"Linear", "linear", {18916, 55756, 44078, 20061}},
    Row{"Quadratic", "quadratic", {4820, 15792, 9681, 5425}},
    Row{"Cubic", "cubic", {1906, 6444, 3640, 1572}},
    Row{"t-variant cross product", "polynomial", {0, 0, 0, 0}},
    Row{"Vector SLERP", "slerp", {19427, 57999, 44972, 20861}},
    Row{"Spherical deCasteljau", "decasteljau:4", {7039, 21772, 16068, 7647}},
    Row{"Quaternion SLERP", "quaternion:matrix", {17766, 53492, 42831, 19202}},
};
constexpr std::array<double, kMorphs> kPaperFaces = {15300, 44700, 35180, 21040};
constexpr std::array kOurs = {"quaternion:edge", "quaternion:polar", "quaternion:optimal", "circle",
                              "circle:timed",    "linear:scaled",    "rational",           "recompute"};

// One scheme on the four morphs.
struct Measured {
  std::string scheme;
  std::array<double, kMorphs> degrees{}, ratio{}, mean{}, max{};
};

std::vector<Measured> measure() {
  CompareOptions options;
  options.schemes.clear();
  for (const Row& row : kPaper) options.schemes.emplace_back(row.scheme);
  for (const char* scheme : kOurs) options.schemes.emplace_back(scheme);
  std::vector<Measured> measured(options.schemes.size());
  for (std::size_t m = 0; m < kMorphs; ++m) {
    const Comparison comparison = compare(morphs()[m].motion, options).value();
    for (std::size_t s = 0; s < measured.size(); ++s) {
      const SchemeComparison& row = comparison.schemes[s];
      measured[s].scheme = row.scheme;
      if (row.scheme == "polynomial" && m < 3) require(row.flagged == 0, "no face of a mild morph needs double");
      measured[s].degrees[m] = kDegreesPerRadian * row.quality.sum;
      measured[s].ratio[m] = row.relative_to_linear.value();
      measured[s].mean[m] = kDegreesPerRadian * row.quality.mean();
      measured[s].max[m] = kDegreesPerRadian * row.quality.max;
    }
  }
  return measured;
}

double paper_ratio(const Row& row, std::size_t column) { return row.sums[column] / kPaper[0].sums[column]; }

std::vector<double> paper_ratios(const Row& row) {
  std::vector<double> ratios;
  for (std::size_t m = 0; m < kMorphs; ++m) ratios.push_back(paper_ratio(row, m));
  return ratios;
}

// The rows of the paper's table but the exact one, best first.
template <class Ratio>
std::vector<std::string> order_of(Ratio ratio_of_row) {
  std::vector<std::size_t> rows;
  for (std::size_t r = 0; r < kPaper.size(); ++r) {
    if (std::string_view(kPaper[r].scheme) != "polynomial") rows.push_back(r);
  }
  std::sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return ratio_of_row(a) < ratio_of_row(b); });
  std::vector<std::string> names;
  for (const std::size_t r : rows) names.push_back(fmt::format("`{}`", kPaper[r].scheme));
  return names;
}

// Where the error of slerp comes from: how far the exact normal is from the great circle (a wrong path), and how far
// along it from where slerp is (a wrong speed). Mean degrees.
struct Parts {
  double path = 0, speed = 0;
};

Parts parts_of_slerp(const Motion& motion) {
  Parts parts;
  double count = 0;
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    for (const ControlNormals& normals : all_face_control_normals(motion.segment(s))) {
      const Vec3d u0 = unit_normal_at(normals, 0).vector, u1 = unit_normal_at(normals, 1).vector;
      const Vec3d normal = cross(u0, u1);
      if (length(normal) < 1e-6) continue;
      const Vec3d pole = unit(normal), ahead = cross(pole, u0);
      const double whole = angle_between(u0, u1);
      for (int i = 0; i <= 20; ++i) {
        const double t = i / 20.0;
        const Vec3d u = unit_normal_at(normals, t).vector;
        parts.path += kDegreesPerRadian * std::fabs(std::asin(std::clamp(dot(u, pole), -1.0, 1.0)));
        const double at = std::atan2(dot(u, ahead), dot(u, u0));
        parts.speed += kDegreesPerRadian * std::fabs(std::remainder(at - t * whole, 2 * kPi));
        ++count;
      }
    }
  }
  return {parts.path / count, parts.speed / count};
}

// How far a face turns: the angle between its ends, the largest angle from both of them on the way, the share of the
// time that it is more than 45 degrees from both, the same share for the parabola and the cubic through exact unit
// normals, and the smallest area against the larger end. Means over the faces.
struct Detour {
  double ends = 0, farthest = 0, away = 0, quadratic_away = 0, cubic_away = 0, smallest_area = 0;
};

Detour mean_detour(const Motion& motion) {
  constexpr std::size_t kSteps = 100;
  constexpr double kAway = 45;
  const Segment segment = motion.segment(0);
  const std::vector<ControlNormals> all = all_face_control_normals(segment);
  const IndexRange faces{0, all.size()};
  const PreparedScheme quadratic("quadratic", segment, faces), cubic("cubic", segment, faces);
  std::vector<double> farthest(all.size(), 0), smallest(all.size(), 1);
  Detour mean;
  const double weight = 1 / static_cast<double>(all.size()), step_weight = weight / (kSteps + 1);
  for (std::size_t i = 0; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    const std::vector<Vec3d> of_quadratic = quadratic.at(t), of_cubic = cubic.at(t);
    for (std::size_t f = 0; f < all.size(); ++f) {
      const Vec3d u0 = unit_normal_at(all[f], 0).vector, u1 = unit_normal_at(all[f], 1).vector;
      const auto from_ends = [&](const Vec3d& u) { return std::min(degrees_between(u, u0), degrees_between(u, u1)); };
      const double distance = from_ends(unit_normal_at(all[f], t).vector);
      farthest[f] = std::max(farthest[f], distance);
      mean.away += step_weight * (distance > kAway ? 1 : 0);
      mean.quadratic_away += step_weight * (from_ends(of_quadratic[f]) > kAway ? 1 : 0);
      mean.cubic_away += step_weight * (from_ends(of_cubic[f]) > kAway ? 1 : 0);
      smallest[f] =
          std::min(smallest[f], length(normal_at(all[f], t)) / std::max(length(all[f].n0), length(all[f].n1)));
      if (i == 0) mean.ends += weight * degrees_between(u0, u1);
    }
  }
  mean.farthest = weight * sum(farthest);
  mean.smallest_area = weight * sum(smallest);
  return mean;
}

// The largest change of a ratio of the paper's rows when 98 samples take the place of 21, and where.
struct Change {
  double relative = 0;
  std::string where;
};

Change change_with_samples() {
  std::array<Change, kMorphs> changes;
  parallel_for(kMorphs, [&](std::size_t m) {
    const Motion part = some_pairs(morphs()[m].motion, 2000);
    const PairErrors few(part, 21), many(part, 98);
    const double linear_few = sum(few.sums("linear")), linear_many = sum(many.sums("linear"));
    for (const char* scheme : {"quadratic", "cubic", "slerp", "decasteljau:4", "quaternion:matrix", "circle:timed"}) {
      const double a = sum(few.sums(scheme)) / linear_few, b = sum(many.sums(scheme)) / linear_many;
      const double relative = std::fabs(b / a - 1);
      if (relative > changes[m].relative)
        changes[m] = {relative, fmt::format("`{}` on {}: {} becomes {}", scheme, morphs()[m].name, ratio(a), ratio(b))};
    }
  });
  return *std::max_element(changes.begin(), changes.end(),
                           [](const Change& a, const Change& b) { return a.relative < b.relative; });
}

// Every row against linear, the paper's and ours, and the sums behind ours.
void add_tables(Page& page, const std::vector<Measured>& measured) {
  Cells titles = {"sum relative to linear"}, degree_titles = {"degrees"};
  for (const double faces : kPaperFaces) titles.push_back("paper " + grouped(faces));
  for (const Morph& m : morphs()) titles.push_back(m.name);
  for (const char* what : {"sum", "mean"}) {
    for (const Morph& m : morphs()) degree_titles.push_back(fmt::format("{}, {}", m.name, what));
  }
  std::vector<Cells> ratios, sums;
  for (std::size_t r = 0; r < measured.size(); ++r) {
    const Measured& row = measured[r];
    const bool theirs = r < kPaper.size();
    Cells cells = {theirs ? fmt::format("{} (`{}`)", kPaper[r].paper_name, row.scheme)
                          : fmt::format("ours: `{}`", row.scheme)};
    for (std::size_t m = 0; m < kMorphs; ++m) cells.push_back(theirs ? ratio(paper_ratio(kPaper[r], m)) : "");
    for (const double value : row.ratio) cells.push_back(ratio(value));
    ratios.push_back(std::move(cells));

    cells = {fmt::format("`{}`", row.scheme)};
    for (const double value : row.degrees) cells.push_back(grouped(value, value < 100 ? 1 : 0));
    for (const double value : row.mean) cells.push_back(value < 1e-3 ? scientific(value, 1) : grouped(value, 3));
    sums.push_back(std::move(cells));
  }
  page.table("ratios", titles, ratios);
  page.table("sums", degree_titles, sums);
}

Figure ratios_figure(const std::vector<Measured>& measured) {
  const std::vector<std::string> rows = {"cubic",  "circle:timed",       "quadratic",         "decasteljau:4",
                                         "circle", "quaternion:optimal", "quaternion:matrix", "linear",
                                         "slerp"};
  Panel panel;
  panel.x = {"sum of angles relative to linear",
             0.02,
             1.6,
             true,
             {{0.02, "0.02"}, {0.05, "0.05"}, {0.1, "0.1"}, {0.2, "0.2"}, {0.5, "0.5"}, {1, "1"}}};
  panel.y = {"", 0.4, static_cast<double>(rows.size()) + 0.6, false, {}};
  panel.legend = "outside right center Left reverse width -2";
  const std::array<Colour, kMorphs> colours = {Colour::kBlue, Colour::kGreen, Colour::kOrange, Colour::kRed};
  const std::array<Mark, kMorphs> marks = {Mark::kDisc, Mark::kSquare, Mark::kTriangle, Mark::kDiamond};
  Series paper{"paper, four morphs", {}, Colour::kBlack, 0, false, Mark::kCircle, 0.8};
  std::vector<Series> ours;
  for (std::size_t m = 0; m < kMorphs; ++m)
    ours.push_back({"ours: " + morphs()[m].name, {}, colours[m], 0, false, marks[m], m == 3 ? 1.1 : 0.9});
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double y = static_cast<double>(rows.size() - r);
    panel.y.ticks.emplace_back(y, rows[r]);
    for (const Row& row : kPaper) {
      if (rows[r] != row.scheme) continue;
      for (std::size_t m = 0; m < kMorphs; ++m) paper.points.emplace_back(paper_ratio(row, m), y + 0.22);
    }
    for (const Measured& row : measured) {
      if (rows[r] != row.scheme) continue;
      for (std::size_t m = 0; m < kMorphs; ++m)
        ours[m].points.emplace_back(row.ratio[m], y + 0.06 - 0.12 * static_cast<double>(m));
    }
  }
  panel.series = {paper};
  panel.series.insert(panel.series.end(), ours.begin(), ours.end());
  return {"table1", 860, 440, 1, {panel}};
}

}  // namespace

void measure_table1(Page& page) {
  const std::vector<Measured> measured = measure();
  const auto of = [&measured](std::string_view scheme) -> const Measured& {
    return *std::find_if(measured.begin(), measured.end(), [&](const Measured& m) { return m.scheme == scheme; });
  };
  add_tables(page, measured);
  page.picture("table1", ratios_figure(measured));

  const auto order = order_of([](std::size_t r) { return paper_ratio(kPaper[r], 0); });
  for (std::size_t m = 1; m < kMorphs; ++m)
    require(order_of([m](std::size_t r) { return paper_ratio(kPaper[r], m); }) == order, "one order in the paper");
  std::vector<std::string> same, others;
  for (std::size_t m = 0; m < kMorphs; ++m) {
    const auto ours = order_of([&, m](std::size_t r) { return of(kPaper[r].scheme).ratio[m]; });
    (ours == order ? same : others).push_back(morphs()[m].name);
  }
  require(same == std::vector<std::string>{"bend"}, "the order is the paper's on bend only");
  page.set({{"paper_order", listed(order)}, {"same_order", listed(same)}, {"other_order", listed(others)}});

  const Measured &exact = of("polynomial"), &slerp = of("slerp"), &quadratic = of("quadratic"), &cubic = of("cubic"),
                 &casteljau = of("decasteljau:4"), &matrix = of("quaternion:matrix");
  require(of("linear").ratio[0] == 1, "linear is the measure");
  for (const double r : slerp.ratio) require(r > 1, "slerp is worse than linear everywhere");
  require(quadratic.ratio[3] > slerp.ratio[3], "on eversion quadratic is the worst");
  require(quadratic.ratio[3] > 1, "quadratic is worse than linear on eversion");
  require(matrix.ratio[0] > slerp.ratio[0], "matrix is the worst row on cloth");
  require(of("circle:timed").ratio[3] > of("quaternion:optimal").ratio[3],
          "circle:timed is not the best where faces collapse");
  require(casteljau.ratio[2] < quadratic.ratio[2], "de Casteljau is before quadratic on twist");
  for (std::size_t m = 0; m < 3; ++m) require(cubic.ratio[m] < 0.06, "our cubic is better than theirs");
  const auto [slerp_least, slerp_most] = std::minmax_element(slerp.ratio.begin(), slerp.ratio.end());
  page.set({{"exact_mean", scientific(*std::max_element(exact.mean.begin(), exact.mean.end()), 1)},
            {"exact_max", scientific(*std::max_element(exact.max.begin(), exact.max.end()), 1)},
            {"exact_mean_twist", scientific(exact.mean[2], 1)},
            {"slerp_least", ratio(*slerp_least)},
            {"slerp_most", ratio(*slerp_most)},
            {"optimal_gain_cloth", percent(1 - of("quaternion:optimal").ratio[0], 1)},
            {"matrix_gain_cloth", percent(1 - matrix.ratio[0], 1)},
            {"matrix_gain_bend", percent(1 - matrix.ratio[1])},
            {"matrix_gain_twist", percent(1 - matrix.ratio[2])},
            {"matrix_gain_eversion", percent(1 - matrix.ratio[3])},
            {"quadratic_gain_cloth", fmt::format("{:.1f}", 1 / quadratic.ratio[0])},
            {"quadratic_gain_bend", fmt::format("{:.1f}", 1 / quadratic.ratio[1])},
            {"quadratic_gain_twist", fmt::format("{:.1f}", 1 / quadratic.ratio[2])},
            {"cubic_gain", percent(1 - cubic.ratio[0])}});

  const std::vector<double> their_quadratic = paper_ratios(kPaper[1]), their_cubic = paper_ratios(kPaper[2]),
                            their_matrix = paper_ratios(kPaper[6]);
  page.set({{"paper_quadratic_least", fmt::format("{:.1f}", 1 / largest(their_quadratic))},
            {"paper_quadratic_most", fmt::format("{:.1f}", 1 / smallest(their_quadratic))},
            {"paper_cubic_gain", percent(1 - smallest(their_cubic))},
            {"paper_matrix_gain", percent(1 - sum(their_matrix) / kMorphs, 1)},
            {"paper_matrix_gain_least", percent(1 - largest(their_matrix), 1)},
            {"paper_matrix_gain_most", percent(1 - smallest(their_matrix), 1)}});

  std::array<Parts, kMorphs> parts;
  parallel_for(kMorphs, [&](std::size_t m) { parts[m] = parts_of_slerp(some_pairs(morphs()[m].motion, 4000)); });
  require(parts[0].speed > 5 * parts[0].path, "cloth is a matter of speed");
  require(parts[1].path > parts[1].speed && parts[2].path > parts[2].speed, "bend and twist are matters of path");
  Cells header = {"morph", "off the path, degrees", "wrong speed, degrees"};
  std::vector<Cells> rows;
  for (std::size_t m = 0; m < kMorphs; ++m)
    rows.push_back({morphs()[m].name, grouped(parts[m].path, 2), grouped(parts[m].speed, 2)});
  for (const char* scheme : {"quaternion:matrix", "quaternion:optimal", "linear:scaled", "circle:timed"}) {
    header.push_back(fmt::format("`{}`", scheme));
    for (std::size_t m = 0; m < kMorphs; ++m) rows[m].push_back(ratio(of(scheme).ratio[m]));
  }
  page.table("slerp_parts", header, rows);

  const Detour eversion = mean_detour(some_pairs(morph("eversion"), 2000));
  const Detour twist = mean_detour(some_pairs(morph("twist"), 2000));
  require(eversion.ends < twist.ends && eversion.farthest > 2 * twist.farthest, "eversion is a detour");
  require(eversion.quadratic_away > 2 * eversion.away, "the parabola stays away for longer than linear misses");
  page.set({{"eversion_area", percent(eversion.smallest_area)},
            {"eversion_ends", grouped(eversion.ends)},
            {"eversion_farthest", grouped(eversion.farthest)},
            {"eversion_away", percent(eversion.away)},
            {"quadratic_away", percent(eversion.quadratic_away)},
            {"cubic_away", percent(eversion.cubic_away)},
            {"twist_ends", grouped(twist.ends)},
            {"twist_farthest", grouped(twist.farthest)}});
  const Change change = change_with_samples();
  page.set({{"sampling_change", percent(change.relative, 1)}, {"sampling_change_where", change.where}});
}

}  // namespace chronormal::paper

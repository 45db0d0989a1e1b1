// Section 4: the paper's Figure 2, measured: lengths between the nodes, and what a high degree does.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "paper/morphs.h"
#include "paper/sections.h"

namespace chronormal::paper {
namespace {

using Complex = std::complex<double>;

// The Lagrange polynomial of degree K through exact unit normals, before it is normalised, in double.
Vec3d lagrange(const ControlNormals& normals, std::size_t degree, double t) {
  Vec3d value;
  for (std::size_t k = 0; k <= degree; ++k) {
    double weight = 1;
    for (std::size_t j = 0; j <= degree; ++j) {
      const double distance = static_cast<double>(k) - static_cast<double>(j);
      if (j != k) weight *= (t * static_cast<double>(degree) - static_cast<double>(j)) / distance;
    }
    value = value + weight * unit_normal_at(normals, static_cast<double>(k) / static_cast<double>(degree)).vector;
  }
  return value;
}

double error_at(const ControlNormals& normals, std::size_t degree, double t) {
  return degrees_between(unit(lagrange(normals, degree, t)), unit_normal_at(normals, t).vector);
}

// Off every inner node of degree up to 16.
constexpr std::size_t kSamples = 98;

// The largest distance of the polynomial from the unit normal, before it is normalised: what Runge's theory is about.
double largest_distance(const ControlNormals& normals, std::size_t degree) {
  constexpr std::size_t kPlaces = 198;
  double worst = 0;
  for (std::size_t i = 1; i + 1 < kPlaces; ++i) {
    const double t = static_cast<double>(i) / (kPlaces - 1);
    worst = std::max(worst, length(lagrange(normals, degree, t) - unit_normal_at(normals, t).vector));
  }
  return worst;
}

// The complex t at which n(t).n(t) = 0: four, by the simultaneous iteration of Durand and Kerner.
std::array<Complex, 4> zeros_of_squared_length(const ControlNormals& normals) {
  const Vec3d c2 = normals.n0 - 2.0 * normals.m + normals.n1, c1 = 2.0 * (normals.m - normals.n0), &c0 = normals.n0;
  const std::array<double, 5> c = {dot(c0, c0), 2 * dot(c0, c1), dot(c1, c1) + 2 * dot(c0, c2), 2 * dot(c1, c2),
                                   dot(c2, c2)};
  const auto value = [&c](Complex z) { return (((c[4] * z + c[3]) * z + c[2]) * z + c[1]) * z + c[0]; };
  std::array<Complex, 4> zeros;
  for (std::size_t i = 0; i < 4; ++i) zeros[i] = std::pow(Complex(0.4, 0.9), static_cast<double>(i));
  for (int iteration = 0; iteration < 200; ++iteration) {
    double change = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      Complex product = c[4];
      for (std::size_t j = 0; j < 4; ++j) {
        if (j != i) product *= zeros[i] - zeros[j];
      }
      const Complex step = value(zeros[i]) / product;
      zeros[i] -= step;
      change = std::max(change, std::abs(step));
    }
    if (change < 1e-14) break;
  }
  return zeros;
}

// Interpolation at K + 1 equidistant nodes on [0, 1] converges as exp(-K g), g the smallest of this over the singular
// points; where that is negative, it diverges (Runge 1901).
double margin(Complex z) {
  const auto z_log_z = [](Complex w) { return std::abs(w) > 0 ? w * std::log(w) : Complex(0); };
  return (z_log_z(z) - z_log_z(z - 1.0)).real();
}

struct Singularity {
  Complex at;
  double margin;
};

Singularity nearest_singularity(const ControlNormals& normals) {
  Singularity nearest{{}, 1e9};
  for (const Complex z : zeros_of_squared_length(normals)) {
    if (std::isfinite(z.real()) && std::isfinite(z.imag()) && margin(z) < nearest.margin) nearest = {z, margin(z)};
  }
  return nearest;
}

// The boundary of Runge's region above the real axis.
std::vector<std::pair<double, double>> runge_boundary() {
  std::vector<std::pair<double, double>> points;
  for (int i = 0; i <= 200; ++i) {
    const double x = i / 200.0;
    double low = 0, high = 1;
    for (int k = 0; k < 50; ++k) {
      const double y = (low + high) / 2;
      (margin({x, y}) < 0 ? low : high) = y;
    }
    points.emplace_back(x, i == 0 || i == 200 ? 0.0 : low);
  }
  return points;
}

struct Method {
  std::size_t degree;
  const char* name;
  Colour colour;
};
constexpr std::array kMethods = {Method{1, "linear", Colour::kSky}, Method{2, "quadratic", Colour::kBlue},
                                 Method{3, "cubic", Colour::kPurple}, Method{8, "degree 8", Colour::kRed}};

void measure_lengths(Page& page) {
  // The face of twist that linear interpolation has most trouble with, and one that nearly collapses.
  const Comparison comparison = compare(morph("twist"), {{"linear"}, 21, Access::kRandom, {}}).value();
  const std::size_t face = comparison.schemes[0].quality.max_at.element;
  std::vector<ControlNormals> normals(1);
  face_control_normals(morph("twist").segment(0), {face, 1}, normals);

  std::array<Panel, 2> panels;
  panels[0].title = "length before it is normalised";
  panels[0].x = panels[1].x = {"t", 0, 1, false, {}};
  panels[0].y = {"length", 0.5, 1.2, false, {}};
  panels[1].title = "error of the direction";
  panels[1].y = {"degrees", 0, 45, false, {}};
  panels[1].legend = "at graph 0.99,0.99 right top Left reverse";
  std::array<double, kMethods.size()> shortest, longest;
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    Series lengths{kMethods[m].name, {}, kMethods[m].colour, 2}, errors = lengths;
    shortest[m] = longest[m] = 1;
    for (int i = 0; i <= 200; ++i) {
      const double t = i / 200.0, size = length(lagrange(normals[0], kMethods[m].degree, t));
      shortest[m] = std::min(shortest[m], size), longest[m] = std::max(longest[m], size);
      lengths.points.emplace_back(t, size);
      errors.points.emplace_back(t, error_at(normals[0], kMethods[m].degree, t));
    }
    panels[0].series.push_back(lengths);
    panels[1].series.push_back(errors);
  }
  page.picture("figure2_length", {"figure2_length", 900, 360, 2, {panels[0], panels[1]}});
  page.set({{"worst_face", grouped(static_cast<double>(face))},
            {"linear_shortest", ratio(shortest[0])},
            {"quadratic_shortest", ratio(shortest[1])},
            {"quadratic_longest", ratio(longest[1])},
            {"cubic_shortest", ratio(shortest[2])},
            {"cubic_longest", ratio(longest[2])}});
}

// Errors of lagrange:K on some faces of a morph, for K = 1 to 16.
struct AgainstDegree {
  std::string name;
  std::array<double, 17> mean{}, max{};
  double inside = 0;  // share of pairs with a singularity in Runge's region
};

AgainstDegree against_degree(const std::string& name) {
  const Motion part = some_pairs(morph(name), 2000);
  AgainstDegree result{name};
  const PairErrors errors(part, kSamples);
  for (std::size_t degree = 1; degree <= 16; ++degree) {
    const std::string scheme = fmt::format("lagrange:{}", degree);
    result.mean[degree] = sum(errors.sums(scheme)) / static_cast<double>(errors.pairs() * kSamples);
    result.max[degree] = largest(errors.largest(scheme));
  }
  double inside = 0;
  for (std::size_t s = 0; s < part.segments.size(); ++s) {
    for (const ControlNormals& normals : all_face_control_normals(part.segment(s))) {
      if (nearest_singularity(normals).margin < 0) ++inside;
    }
  }
  result.inside = inside / static_cast<double>(errors.pairs());
  return result;
}

constexpr std::array kNames = {"cloth", "bend", "twist", "eversion", "soup"};
using Results = std::array<AgainstDegree, kNames.size()>;

Panel degree_panel(const Results& results) {
  Panel panel;
  panel.title = "all morphs: mean error";
  panel.x = {"degree K",
             1,
             16,
             false,
             {{1, "1"}, {2, "2"}, {4, "4"}, {6, "6"}, {8, "8"}, {10, "10"}, {12, "12"}, {14, "14"}, {16, "16"}}};
  panel.y = {"degrees", 1e-6, 300, true, {}};
  panel.legend = "at graph 0.03,0.03 left bottom Left reverse";
  constexpr std::array kColours = {Colour::kBlue, Colour::kGreen, Colour::kOrange, Colour::kRed, Colour::kPurple};
  constexpr std::array kMarks = {Mark::kDisc, Mark::kSquare, Mark::kTriangle, Mark::kDiamond, Mark::kOpenSquare};
  for (std::size_t i = 0; i < results.size(); ++i) {
    Series series{kNames[i], {}, kColours[i], 1.6, false, kMarks[i], 0.6};
    for (std::size_t degree = 1; degree <= 16; ++degree)
      series.points.emplace_back(static_cast<double>(degree), results[i].mean[degree]);
    panel.series.push_back(series);
  }
  return panel;
}

void add_degrees(Page& page, const Results& results) {
  Cells header = {"K"};
  for (const char* name : kNames) header.push_back(fmt::format("{}, mean", name));
  for (const char* name : kNames) header.push_back(fmt::format("{}, max", name));
  const auto angle = [](double v) { return v < 0.01 ? scientific(v, 1) : fmt::format("{:.2f}", v); };
  std::vector<Cells> rows;
  for (const std::size_t degree : {1u, 2u, 3u, 4u, 6u, 8u, 12u, 16u}) {
    Cells row = {fmt::format("{}", degree)};
    for (const auto& r : results) row.push_back(angle(r.mean[degree]));
    for (const auto& r : results) row.push_back(angle(r.max[degree]));
    rows.push_back(std::move(row));
  }
  page.table("by_degree", header, rows);
  for (std::size_t i = 0; i < 3; ++i) require(results[i].inside == 0, "no zero inside on mild morphs");
  const auto& [cloth, bend, twist, eversion, soup] = results;
  const auto least = std::min_element(cloth.mean.begin() + 1, cloth.mean.end());
  page.set({{"cloth_least", scientific(*least, 1)},
            {"cloth_least_at", fmt::format("{}", least - cloth.mean.begin())},
            {"soup_8", grouped(soup.mean[8], 1)},
            {"soup_16", grouped(soup.mean[16], 1)},
            {"soup_inside", percent(soup.inside)},
            {"eversion_inside", percent(eversion.inside)}});
}

// A face of soup: what its zeros predict, and whether its error grows from one degree to twice that.
constexpr std::size_t kLow = 12, kHigh = 24;
struct Face {
  ControlNormals normals;
  Singularity singularity;
  bool grows = false;
};

std::vector<Face> faces_of_soup() {
  const std::vector<ControlNormals> normals = all_face_control_normals(some_faces(morph("soup"), 2000).segment(0));
  std::vector<Face> faces(normals.size());
  parallel_for(faces.size(), [&](std::size_t f) {
    faces[f] = {normals[f], nearest_singularity(normals[f]),
                largest_distance(normals[f], kHigh) > largest_distance(normals[f], kLow)};
  });
  return faces;
}

void add_lens(Page& page, const std::vector<Face>& faces) {
  double right = 0, inside = 0, clear = 0, clear_right = 0;
  Panel lens;
  lens.x = {"real part of t", -0.15, 1.15, false, {}};
  lens.y = {"imaginary part of t", 0, 0.6, false, {}};
  lens.legend = "outside right center Left reverse width -4";
  Series better{
      fmt::format("error shrinks from K = {} to {}", kLow, kHigh), {}, Colour::kBlue, 0, false, Mark::kDisc, 0.35};
  Series worse{"error grows", {}, Colour::kRed, 0, false, Mark::kTriangle, 0.45};
  for (const Face& face : faces) {
    const auto& [at, margin] = face.singularity;
    const bool predicted = margin < 0;
    inside += predicted ? 1 : 0;
    right += predicted == face.grows ? 1 : 0;
    if (std::fabs((kHigh - kLow) * margin) > std::log(2.0)) {  // a factor of 2 from one degree to the other
      clear += 1;
      clear_right += predicted == face.grows ? 1 : 0;
    }
    (face.grows ? worse : better).points.emplace_back(at.real(), std::fabs(at.imag()));
  }
  lens.series = {better, worse, {"Runge's lens", runge_boundary(), Colour::kBlack, 2}};
  page.picture("figure2_zeros", {"figure2_zeros", 860, 380, 1, {lens}});
  const double count = static_cast<double>(faces.size());
  require(right / count > 0.9, "the lens predicts the oscillation");
  page.set({{"lens_faces", grouped(count)},
            {"lens_share", percent(inside / count)},
            {"lens_low", grouped(kLow)},
            {"lens_high", grouped(kHigh)},
            {"lens_right", percent(right / count, 1)},
            {"lens_clear", grouped(clear)},
            {"lens_clear_right", percent(clear_right / clear, 1)}});
}

// The face shown is that with its zero nearest to a tenth above the middle.
Panel shown_panel(Page& page, const std::vector<Face>& faces) {
  const auto distance = [](const Face& face) {
    const Complex z = face.singularity.at;
    return std::abs(Complex(z.real(), std::fabs(z.imag())) - Complex(0.5, 0.1));
  };
  const Face& shown = *std::min_element(faces.begin(), faces.end(),
                                        [&](const Face& a, const Face& b) { return distance(a) < distance(b); });
  Panel panel;
  panel.title = "one face of soup: error over t";
  panel.x = {"t", 0, 1, false, {}};
  panel.y = {"degrees", 0, 100, false, {}};
  panel.legend = "at graph 0.5,0.98 center top Left reverse";
  std::array<double, 17> worst{}, worst_inside{};  // over t, and over t in [0.3, 0.7]
  for (const auto& [degree, colour] : {std::pair{4u, Colour::kBlue}, {8u, Colour::kGreen}, {16u, Colour::kRed}}) {
    Series series{fmt::format("K = {}", degree), {}, colour, 1.8};
    for (int i = 0; i <= 400; ++i) {
      const double error = error_at(shown.normals, degree, i / 400.0);
      series.points.emplace_back(i / 400.0, error);
      worst[degree] = std::max(worst[degree], error);
      if (120 <= i && i <= 280) worst_inside[degree] = std::max(worst_inside[degree], error);
    }
    panel.series.push_back(series);
  }
  require(worst_inside[16] < worst_inside[8] && worst_inside[8] < worst_inside[4] && worst[16] > 2 * worst[8],
          "the face shown gets better and then swings out");
  const Complex zero = shown.singularity.at;
  page.set({{"shown_inside_16", grouped(worst_inside[16], 1)},
            {"shown_worst_8", grouped(worst[8], 1)},
            {"shown_worst_16", grouped(worst[16], 1)},
            {"shown_zero", fmt::format("{:.2f} + {:.2f} i", zero.real(), std::fabs(zero.imag()))}});
  return panel;
}

}  // namespace

void measure_figure2(Page& page) {
  measure_lengths(page);
  Results results;
  parallel_for(kNames.size(), [&](std::size_t i) { results[i] = against_degree(kNames[i]); });
  add_degrees(page, results);
  const std::vector<Face> faces = faces_of_soup();
  page.picture("figure2_oscillation",
               {"figure2_oscillation", 900, 380, 2, {shown_panel(page, faces), degree_panel(results)}});
  add_lens(page, faces);
}

}  // namespace chronormal::paper

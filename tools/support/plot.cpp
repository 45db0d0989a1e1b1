// A figure becomes a script for gnuplot, and what gnuplot says of itself is taken out of the SVG that it writes.
#include "support/plot.h"

#include <fmt/core.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace chronormal::pages {
namespace {

// In the order of Colour.
constexpr const char* kHex[] = {"#000000", "#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8c8c8c"};
const char* hex(Colour colour) { return kHex[static_cast<std::size_t>(colour)]; }

// What gnuplot calls them, in the order of Mark.
constexpr int kPointTypes[] = {0, 7, 6, 5, 4, 9, 8, 13, 12, 2};
int point_type(Mark mark) { return kPointTypes[static_cast<std::size_t>(mark)]; }

std::string axis(const char* name, const Axis& axis) {
  std::string script =
      fmt::format("set {0}label \"{1}\"\nset {0}range [{2:g}:{3:g}]\n", name, axis.label, axis.from, axis.to);
  script += axis.logarithmic ? fmt::format("set logscale {}\n", name) : fmt::format("unset logscale {}\n", name);
  if (axis.ticks.empty()) {
    script += fmt::format("set {}tics autofreq scale 0.6 nomirror\n", name);
    if (axis.logarithmic)
      script += fmt::format("set format {} \"10^{{%L}}\"\n", name);
    else
      script += fmt::format("set format {} \"%g\"\n", name);
  } else {
    script += fmt::format("set {}tics scale 0.6 nomirror (", name);
    for (std::size_t i = 0; i < axis.ticks.size(); ++i)
      script += fmt::format("{}\"{}\" {:g}", i == 0 ? "" : ", ", axis.ticks[i].second, axis.ticks[i].first);
    script += ")\n";
  }
  return script;
}

std::string panel_script(const Panel& panel) {
  std::string script = fmt::format("set title \"{}\"\n", panel.title);
  script += axis("x", panel.x) + axis("y", panel.y);
  script += panel.legend.empty() ? "unset key\n" : fmt::format("set key {} samplen 2 spacing 1.15\n", panel.legend);

  if (panel.equal_axes) script += "set size ratio -1\n";
  script += "unset label\nunset object\n";
  for (const Label& label : panel.labels) {
    const char* align = label.align == Label::Align::kLeft    ? "left"
                        : label.align == Label::Align::kRight ? "right"
                                                              : "center";
    script += fmt::format("set label \"{}\" at {:g},{:g} {} tc rgb \"{}\" front\n", label.text, label.x, label.y, align,
                          hex(label.colour));
  }
  for (const Band& band : panel.bands)
    script += fmt::format(
        "set object rectangle from {:g}, graph 0 to {:g}, graph 1 fc rgb \"#eeeeee\" fs solid noborder behind\n",
        band.from, band.to);

  std::string plots;
  for (std::size_t s = 0; s < panel.series.size(); ++s) {
    const Series& series = panel.series[s];
    script += fmt::format("$data{} << end\n", s);
    for (const auto& [x, y] : series.points) script += fmt::format("{:.6g} {:.6g}\n", x, y);
    script += "end\n";
    const bool line = series.line > 0, mark = series.mark != Mark::kNone;
    plots += fmt::format("{}$data{} with {} {}", s == 0 ? "plot " : ", ", s,
                         line ? mark ? "linespoints" : "lines" : "points",
                         series.title.empty() ? "notitle" : fmt::format("title \"{}\"", series.title));
    plots += fmt::format(" lc rgb \"{}\"", hex(series.colour));
    if (line) plots += fmt::format(" lw {:g} dt {}", series.line, series.dashed ? 2 : 1);
    if (mark) {
      plots += fmt::format(" pt {} ps {:g}", point_type(series.mark), series.mark_size);
      if (line && series.mark_every > 1) plots += fmt::format(" pi {}", series.mark_every);
    }
  }
  return script + plots + "\n";
}

std::string script_of(const Figure& figure, const std::string& path) {
  const std::size_t panels = figure.panels.size(), columns = static_cast<std::size_t>(figure.columns);
  std::string script = fmt::format(
      "set encoding utf8\nset terminal svg size {},{} fixed enhanced font \"Helvetica\" fontscale 1.05 background "
      "\"#ffffff\"\n",
      figure.width, figure.height);
  script += fmt::format("set output \"{}\"\n", path);
  script += "set border 3 lc rgb \"#444444\"\nset grid lc rgb \"#dddddd\" lw 0.7 dt 1\nset tics tc rgb \"#000000\"\n";
  script += fmt::format("set multiplot layout {},{}\n", (panels + columns - 1) / columns, columns);
  for (const Panel& panel : figure.panels) script += panel_script(panel);
  return script + "unset multiplot\nset output\n";
}

}  // namespace

void draw(const Figure& figure, const std::string& path) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  FILE* const gnuplot = popen("LC_ALL=C.UTF-8 gnuplot -", "w");
  if (gnuplot == nullptr) throw std::runtime_error("gnuplot cannot be started");
  const std::string script = script_of(figure, path);
  std::fwrite(script.data(), 1, script.size(), gnuplot);
  const int status = pclose(gnuplot);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(fmt::format("gnuplot failed on {}; is Debian's gnuplot-nox installed?", figure.name));

  // Nothing of the program's version stays in it.
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  std::string svg = bytes.str();
  const std::size_t first = svg.find("<title>"), last = svg.find("</desc>");
  if (first == std::string::npos || last == std::string::npos)
    throw std::runtime_error("gnuplot wrote no SVG: " + path);
  svg.replace(first, last + 7 - first, fmt::format("<title>{}</title>", figure.name));
  std::ofstream(path, std::ios::binary) << svg;
}

}  // namespace chronormal::pages

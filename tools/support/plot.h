/// Pictures for the document: data here, lines by gnuplot, the same bytes on every run.
#ifndef SUPPORT_PLOT_H_
#define SUPPORT_PLOT_H_

#include <string>
#include <utility>
#include <vector>

namespace chronormal::pages {

/// Colours that colour-blind readers tell apart (Okabe and Ito 2008).
enum class Colour { kBlack, kBlue, kOrange, kGreen, kPurple, kSky, kRed, kGrey };

enum class Mark {
  kNone,
  kDisc,
  kCircle,
  kSquare,
  kOpenSquare,
  kTriangle,
  kOpenTriangle,
  kDiamond,
  kOpenDiamond,
  kCross
};

struct Series {
  std::string title;  ///< in the legend; empty: not there
  std::vector<std::pair<double, double>> points;
  Colour colour = Colour::kBlack;
  double line = 2;  ///< width; 0: none
  bool dashed = false;
  Mark mark = Mark::kNone;
  double mark_size = 0.9;
  std::size_t mark_every = 1;
};

struct Axis {
  std::string label;
  double from = 0, to = 1;
  bool logarithmic = false;
  /// Places and texts; empty: gnuplot's own.
  std::vector<std::pair<double, std::string>> ticks;
};

struct Label {
  std::string text;
  double x = 0, y = 0;
  Colour colour = Colour::kBlack;
  enum class Align { kLeft, kCentre, kRight } align = Align::kLeft;
};

/// A vertical strip of light grey from one x to another.
struct Band {
  double from = 0, to = 0;
};

struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  std::string legend;  ///< gnuplot's words for where it stands; empty: none
  std::vector<Label> labels;
  std::vector<Band> bands;
  bool equal_axes = false;  ///< one unit is as long in x as in y
};

struct Figure {
  std::string name;  ///< of the file, without .svg
  int width = 800, height = 400;
  int columns = 1;  ///< of panels
  std::vector<Panel> panels;
};

/// Writes the picture as SVG on white. Throws std::runtime_error where gnuplot fails.
void draw(const Figure& figure, const std::string& path);

}  // namespace chronormal::pages

#endif  // SUPPORT_PLOT_H_

#pragma once

#include "canvas.h"

/// The look that all figures share. Sizes of text in pt, lengths in pixels.
namespace foucault::plot::style {

constexpr double millimetres(double mm) { return mm * kPixelsPerMillimetre; }

constexpr double kTitlePoints = 13;
constexpr double kSubtitlePoints = 9.5;
constexpr double kAxisPoints = 10;
constexpr double kTickPoints = 9;
constexpr double kNotePoints = 9;
/// Figures for papers: the usual widths of a column and of a page, and how much smaller all that is
/// on them is, so that numbers at the axes have 7 pt.
constexpr double kColumnMm = 85;
constexpr double kTextWidthMm = 178;
constexpr double kPaperScale = 7 / kTickPoints;

constexpr double kShadeOpacity = 0.16;

constexpr double kOuter = millimetres(4);
constexpr double kPanelGap = millimetres(6);
constexpr double kStackedGap = millimetres(3);
constexpr double kTickLength = millimetres(1);
/// Between the upper end of an axis and words: markers at that end reach beyond it.
constexpr double kAboveData = millimetres(1.8);
constexpr double kHeadLine = millimetres(5);
constexpr double kColourBar = millimetres(4);

constexpr Rgb kSpine{90, 95, 102};
constexpr Rgb kGrid{228, 230, 233};
constexpr Rgb kMinorGrid{242, 243, 245};
constexpr Rgb kText{28, 30, 33};
constexpr Rgb kSoftText{86, 91, 98};

constexpr int kGridWidth = 2;   // [px]
constexpr int kSpineWidth = 2;  // [px]

}  // namespace foucault::plot::style

#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace foucault::plot {

/// An image of blue, green and red as the content of a PNG file: with a palette where 256 colours
/// show every pixel as it is or so nearly that nobody sees it, which takes half the room and time.
/// cv::imencode would do, but brings 80 libraries of other formats with it.
std::vector<unsigned char> to_png(const cv::Mat& image);

}  // namespace foucault::plot

#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace foucault::reports {

/// A PNG file's content of an image of blue, green, red bytes. Rows are not filtered: figures are
/// flat areas and few colours, which compress as well without, in half the time.
/// Throws std::runtime_error if zlib fails.
std::vector<unsigned char> to_png(const cv::Mat& image);

}  // namespace foucault::reports

#pragma once

#include <string>

#include "foucault/page/report_page.h"

namespace foucault::page {

/// The page as one HTML file that needs nothing but the figures' files beside it.
std::string to_html(const ReportPage& page);

}  // namespace foucault::page

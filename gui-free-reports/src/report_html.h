#pragma once

#include <string>

#include "foucault/reports/report_page.h"

namespace foucault::reports {

/// The page as one HTML file that needs nothing but the figures' files beside it.
std::string to_html(const ReportPage& page);

}  // namespace foucault::reports

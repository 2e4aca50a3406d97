#include "gzip_inflater.h"

namespace foucault::rawlog {

std::unique_ptr<GzipInflater> isal_inflater() { return nullptr; }

}  // namespace foucault::rawlog

#include "mrpt_entries.h"

extern "C" const foucault::rawlog::MrptPart* foucault_mrpt_part() {
  using namespace foucault::rawlog;
  static constexpr MrptPart part{mrpt_reading, mrpt_writing, mrpt_info, mrpt_notes};
  return &part;
}

#pragma once

#include <mrpt/obs/CObservationComment.h>

#include "rawlog_stream.h"

namespace foucault::rawlog {

/// First line of the comment that holds the notes: until MRPT 2.6 comments keep no label.
inline constexpr const char* kNotesTitle = "# Foucault: notes of the import\n";

/// The comment of the notes, if the observation is one.
inline const mrpt::obs::CObservationComment* notes_comment(const LoggedObservation& logged) {
  const auto* comment =
      dynamic_cast<const mrpt::obs::CObservationComment*>(logged.observation.get());
  return comment != nullptr && comment->text.rfind(kNotesTitle, 0) == 0 ? comment : nullptr;
}

}  // namespace foucault::rawlog

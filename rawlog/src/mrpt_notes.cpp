#include <fmt/format.h>

#include "foucault/core/error.h"
#include "mrpt_entries.h"
#include "notes_comment.h"

namespace foucault::rawlog {

RecordingNotes mrpt_notes(const std::string& path) {
  RecordingNotes notes;
  RawlogStream stream(path);
  const std::optional<LoggedObservation> first = stream.next();
  const auto* comment = first ? notes_comment(*first) : nullptr;
  if (comment == nullptr) return notes;
  try {
    load_config_text(comment->text, "notes", notes);
  } catch (const UsageError& error) {
    throw DataError(
        fmt::format("'{}': its notes are of another version of this program ({}); import it again",
                    path, error.what()));
  }
  return notes;
}

}  // namespace foucault::rawlog

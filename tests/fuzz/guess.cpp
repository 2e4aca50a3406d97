#include "foucault/core/config.h"
#include "foucault/rawlog/guess_mapping.h"
#include "foucault/rawlog/recognize.h"
#include "fuzzing.h"
#include "reading.h"

/// Two tables, the second may be empty. What is guessed of them is a mapping that can be read.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  const std::vector<std::string_view> files = files_of(text_of(data, size), 2);
  std::vector<std::string> paths{folder().write("imu.csv", files[0])};
  if (!files[1].empty()) paths.push_back(folder().write("gnss.csv", files[1]));
  contained([&] { rawlog::recognize(paths.front()); });
  rawlog::MappingGuess guess;
  if (!contained([&] { guess = rawlog::guess_mapping(paths, "."); })) return 0;
  rawlog::ImportMapping read;
  load_config_text(rawlog::mapping_text(guess), "guess", read);
  return 0;
}

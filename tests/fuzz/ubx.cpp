#include <cstdlib>
#include <string>

#include "foucault/rawlog/import_raw_gnss.h"
#include "fuzzing.h"
#include "reading.h"

namespace {

/// Makes the checksums of UBX messages right: no mutation would find them.
std::string with_checksums(std::string_view bytes) {
  constexpr size_t kFrame = 8;
  std::string right(bytes);
  for (size_t at = 0; at + kFrame <= right.size(); ++at) {
    if (right.compare(at, 2, "\xb5\x62") != 0) continue;
    const size_t length = static_cast<unsigned char>(right[at + 4]) |
                          static_cast<size_t>(static_cast<unsigned char>(right[at + 5])) << 8U;
    if (at + kFrame + length > right.size()) continue;
    unsigned a = 0;
    unsigned b = 0;
    for (size_t i = at + 2; i < at + kFrame - 2 + length; ++i) {
      a += static_cast<unsigned char>(right[i]);
      b += a;
    }
    right[at + kFrame - 2 + length] = static_cast<char>(a);
    right[at + kFrame - 1 + length] = static_cast<char>(b);
    at += kFrame - 1 + length;
  }
  return right;
}

}  // namespace

/// The bytes are UBX, with its checksums made right unless they begin with an 'X'. Programs of
/// RTKLIB are not found.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  setenv("PATH", "", 1);
  const std::string_view bytes = text_of(data, size);
  const bool as_it_is = !bytes.empty() && bytes.front() == 'X';
  rawlog::UbxImport import;
  import.rover = folder().write("log.ubx", as_it_is ? std::string(bytes) : with_checksums(bytes));
  import.out = folder() / "out.rawlog";
  import.lever_arm = Eigen::Vector3d::Zero();
  for (const bool skip_bad_rows : {false, true}) {
    import.skip_bad_rows = skip_bad_rows;
    if (contained([&] { rawlog::import_ubx(import); })) read_own_rawlog(import.out);
  }
  return 0;
}

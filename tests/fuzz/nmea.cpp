#include <algorithm>
#include <string>

#include "foucault/rawlog/import_nmea.h"
#include "fuzzing.h"
#include "reading.h"

namespace {

/// Every line as a sentence with a right checksum, whatever stands in it.
std::string summed(std::string_view text) {
  std::string sentences;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    std::string_view body = text.substr(0, std::min(text.find('*'), end));
    if (!body.empty() && body.front() == '$') body.remove_prefix(1);
    unsigned sum = 0;
    for (const char c : body) sum ^= static_cast<unsigned char>(c);
    constexpr const char* kDigits = "0123456789ABCDEF";
    sentences.append("$").append(body).append("*");
    sentences.append({kDigits[sum / 16], kDigits[sum % 16], '\n'});
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return sentences;
}

}  // namespace

/// NMEA, with an IMU that is there at all times. Bytes hardly ever have a right checksum: each line
/// gets its own.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  static const std::string mapping = folder().write("mapping.yaml", R"(
imu:
  columns: {time: "1", gyro_x: "2", gyro_y: "3", gyro_z: "4", accel_x: "5", accel_y: "6", accel_z: "7"}
  header: false
  time: {system: unix}
)");
  static const std::string imu = folder().write("imu.csv",
                                                "-600000000,0,0,0,0,0,-9.8\n"
                                                "-599999999,0,0,0,0,0,-9.8\n"
                                                "4102444800,0,0,0,0,0,-9.8\n"
                                                "4102444801,0,0,0,0,0,-9.8\n");
  rawlog::NmeaImport import;
  import.mapping = mapping;
  import.imu = imu;
  import.out = folder() / "out.rawlog";
  for (const std::string& text : {std::string(text_of(data, size)), summed(text_of(data, size))}) {
    import.gnss = folder().write("gnss.nmea", text);
    for (const bool skip_bad_rows : {false, true}) {
      import.skip_bad_rows = skip_bad_rows;
      if (contained([&] { rawlog::import_nmea(import); })) read_own_rawlog(import.out);
    }
  }
  return 0;
}

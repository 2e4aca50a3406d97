#include "foucault/plot/files.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "foucault/core/error.h"

namespace foucault::plot {
namespace {

TEST(Files, KeepEveryByte) {
  const std::string path = ::testing::TempDir() + "/foucault_plot_files_test";
  const std::string content("a\0b\r\n\xff", 6);
  write_file(path, content);
  EXPECT_EQ(read_file(path), content);
  write_file(path, "");
  EXPECT_EQ(read_file(path), "") << "replaced, not appended";
  std::filesystem::remove(path);
}

TEST(Files, ErrorsNameTheFile) {
  for (const bool reading : {true, false}) {
    try {
      reading ? void(read_file("/no/such/file")) : write_file("/no/such/file", "x");
      FAIL();
    } catch (const DataError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("/no/such/file: cannot be ", 0), 0U);
    }
  }
}

}  // namespace
}  // namespace foucault::plot

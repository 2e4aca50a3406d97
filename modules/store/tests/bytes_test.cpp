#include "foucault/store/bytes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace foucault::store {
namespace {

TEST(Bytes, ComeBackWithoutLoss) {
  ByteWriter writer;
  const double odd = std::nextafter(0.1, 1);
  writer.put(odd);
  writer.put(-std::numeric_limits<double>::infinity());
  writer.put(std::numeric_limits<double>::quiet_NaN());
  writer.put(-0.0);
  writer.put(std::numeric_limits<int64_t>::min());
  writer.put(std::string_view("a\0b", 3));
  writer.put(std::string_view());
  ByteReader reader(writer.bytes());
  EXPECT_EQ(reader.number(), odd);
  EXPECT_EQ(reader.number(), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(reader.number()));
  EXPECT_TRUE(std::signbit(reader.number()));
  EXPECT_EQ(reader.integer(), std::numeric_limits<int64_t>::min());
  EXPECT_EQ(reader.text(), std::string("a\0b", 3));
  EXPECT_EQ(reader.text(), "");
  EXPECT_NO_THROW(reader.finish());
}

TEST(Bytes, TooFewAndTooMany) {
  ByteWriter writer;
  writer.put(std::string_view("abc"));
  ByteReader cut(std::string_view(writer.bytes()).substr(0, 10));
  EXPECT_THROW(cut.text(), BytesError);
  ByteReader short_of_a_size(std::string_view("1234567"));
  EXPECT_THROW(short_of_a_size.count(), BytesError);
  ByteReader left(writer.bytes());
  left.count();
  EXPECT_THROW(left.finish(), BytesError);
}

}  // namespace
}  // namespace foucault::store
